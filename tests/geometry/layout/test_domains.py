"""Conditions on geometry over the ranges of tunable parameters.

A violated condition is reported with a point that violates it. Verdicts are compared with dense sampling by exact
rationals, and generated C is run at the corners of the box.
"""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import ClassVar

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wmrgen
from tests.codegen.c.harness import COMPILERS
from tests.conftest import GALLERY, Outcome
from tests.depth import everyday, examples
from tests.robotfile.files import read
from tests.rules.probe import printed
from wmrgen.errors import RobotFileError, UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout import build
from wmrgen.geometry.layout.records import Robot

ROBOT = """\
wmrgen: 1
name: probed
parameters: {{{0}}}
wheels:
  - {{name: left,  type: swedish, x: "{1}", y: 0.2,  heading: 0, gamma: -45 deg, r: "{2}"}}
  - {{name: right, type: swedish, x: 0.3, y: -0.2, heading: 0, gamma: 45 deg, r: 0.1}}
  - {{name: back,  type: swedish, x: -0.3, y: 0.2, heading: 0, gamma: 45 deg, r: 0.1}}
limits: {{vx: 1, vy: 1, omega: 1}}
"""
A, B = "a: {value: 1, tunable: true}", "b: {value: 2, tunable: true}"
BOTH = f"{A}, {B}"


def laid_out(parameters: str, x: str = "0.3", r: str = "0.1") -> Robot:
    return build(read(ROBOT.format(parameters, x, r)))


@pytest.mark.parametrize(
    ("parameters", "x", "r"),
    [
        (A, "0.3", "a - 0.95"),
        (A, "0.3", "a - 0.9"),  # 0 at the end itself
        (A, "0.3", "(a - 0.95)*a"),
        (A, "0.3", "-(0.95 - a)**3"),
        ("a: {value: 0, tunable: true}", "0.3", "0.01 + a"),
        ("a: {value: 0.2, tunable: [-1, 1]}", "0.3", "a"),
        (f"{A}, c: a - 0.95", "0.3", "c/10"),
        (B, "sqrt(2 - b)", "0.1"),  # 0 nominally
        (BOTH, "sqrt(a**2 - (0.48*b)**2)", "0.1"),
        (BOTH, "1/(a - b/2 + 0.05)", "0.1"),
        (BOTH, "(a - b/2 + 0.05)**-3", "0.1"),
        (BOTH, "1/(a - b/2 + 0.05)**2", "0.1"),  # the divisor never changes its sign
        (BOTH, "1/sqrt((a - b/2 + 0.05)**2)", "0.1"),
        (BOTH, "sin(atan2(a - 0.95, b - 1.9))", "0.1"),
        ("a: {value: 86 deg, tunable: true}", "tan(a)", "0.1"),
        ("a: {value: 1, tunable: [0.9, 4]}", "1/(2 + cos(a)*2.5)", "0.1"),
    ],
)
def test_a_crossing_is_refused(parameters: str, x: str, r: str) -> None:
    """The error has the place, the parameter that causes it, and a range that satisfies the condition."""
    with pytest.raises(RobotFileError) as caught:
        laid_out(parameters, x, r)
    (error,) = caught.value.parts
    assert error.mark and error.mark.line == (3 if "c:" in parameters and r == "0.1" else 5)
    assert re.search(r"\ba\b|\bb\b", error.what) and error.code == "WMR109"
    suggested = dict(re.findall(r"(\w): \{value: [^,]*, tunable: (\[[^]]*\])", error.instead))
    assert suggested, error.instead
    for name, ends in suggested.items():
        parameters = re.sub(
            rf"{name}: {{value: ([^,]*), tunable: (?:true|\[[^]]*\])}}",
            rf"{name}: {{value: \1, tunable: {ends}}}", parameters,
        )  # fmt: skip
    laid_out(parameters, x, r)


@pytest.mark.parametrize(
    ("parameters", "x", "r"),
    [
        (A, "0.3", "a - 0.89"),
        ("a: {value: 1, tunable: [0.951, 1.1]}", "0.3", "a - 0.95"),
        ("b: {value: 2, tunable: [1.8, 2]}", "sqrt(2 - b)", "0.1"),  # 0 at the end, which a root may be
        (BOTH, "sqrt((a - b/2)*(a - b/2))", "0.1"),
        (BOTH, "sqrt((a - b/2)**2)", "0.1"),
        (BOTH, "1/(a + b)", "a*b/20"),
        ("a: {value: 0, tunable: true}", "1/(1 + a)", "0.1 + a"),
        ("a: {value: -0.1, tunable: true}", "0.3", "-a"),
        (BOTH, "sin(atan2(a - 1, b))", "0.1"),
        (BOTH, "a - a", "a/a - 0.9*a/a"),  # each occurrence alone would cross
        ("a: {value: 1, tunable: [-3, 3]}", "1/(1.5 + sin(a)*cos(a) + a**2/100)", "0.1"),
    ],
)
def test_what_holds_is_accepted(parameters: str, x: str, r: str) -> None:
    laid_out(parameters, x, r)


def test_every_place_counts() -> None:
    """Offsets of castors, rollers, trailers, pivots with beta, what parts beside wheels are computed from."""
    crossing = "a: {value: 1, tunable: true}, b: {value: 1, tunable: true}"
    wheel = "  - {name: w, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}\n"
    head = f"wmrgen: 1\nname: p\nparameters: {{{crossing}}}\nwheels:\n{wheel}"
    for more in (
        "  - {name: v, type: castor, x: -0.2, y: 0, d: a - 0.95, r: 0.1}\n",
        "  - {name: v, type: castor, x: -0.2, y: 0, d: 0.95 - a, r: 0.1}\n",
        "  - {name: v, type: swedish, x: -0.2, y: 0, heading: 0, gamma: 1.5*a, r: 0.1}\n",
        "  - {name: v, type: swedish, x: -0.2, y: 0, heading: 0, r_sw: a - 0.95, r: 0.1}\n",
        "  - {name: v, type: fixed, x: a - 0.95, y: b - 0.95, beta: 0, r: 0.1}\n",
        "trailers: [{length: a - 0.95}]\n",
        "trailers: [{length: 1, hitch: 1/(a - 0.95)}]\n",
        "cg: {x: 'sqrt(a - 0.95)', y: 0, z: 0.1}\n",
        "gains: {k_rho: 1/(a - 0.95)}\n",
        "virtual: [{name: v, drives: [w], x: 1/(a - 0.95), y: 0}]\n",
    ):
        with pytest.raises(RobotFileError) as caught:
            build(read(head + more))
        assert caught.value.mark and caught.value.mark.line == 6, more
        assert caught.value.code == "WMR109" and re.search(r"\ba\b", caught.value.what), more


def test_one_line_for_one_cause() -> None:
    """An error that follows from a part of a value, or that occurs in several wheels, is reported once."""
    text = ROBOT.format(A, "0.3", "1/sqrt(a - 0.95)").replace(
        "x: 0.3, y: -0.2", "x: 1/sqrt(a - 0.95), y: -0.2"
    )
    with pytest.raises(RobotFileError) as caught:
        build(read(text))
    (error,) = caught.value.parts
    assert error.code == "WMR109" and len(error.again) == 1
    assert error.mark and error.mark.line == 5 and [mark.line for mark in error.again] == [6]


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_every_robot_of_the_gallery_loads(path: Path) -> None:
    assert wmrgen.load(path).name


# ---- drawn expressions

_LEAVES = st.sampled_from(["a", "b", "c", "0.5", "1", "2", "0.95", "1/3", "1.9"])


def _grown(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        st.tuples(inner, st.sampled_from(["2", "3", "-1", "-2"])).map(lambda t: f"({t[0]})**{t[1]}"),
        inner.map(lambda t: f"sqrt({t})"),
        inner.map(lambda t: f"-({t})"),
    )


class _Wrong(Exception):
    """No value at a point."""


class _N:
    """A number of 50 digits that notes the signs of what it is divided by."""

    divisors: ClassVar[list[int]] = []

    def __init__(self, value: object) -> None:
        self.v = mpmath.mpf(value)

    def __add__(self, other: _N) -> _N:
        return _N(self.v + other.v)

    def __sub__(self, other: _N) -> _N:
        return _N(self.v - other.v)

    def __mul__(self, other: _N) -> _N:
        return _N(self.v * other.v)

    def __neg__(self) -> _N:
        return _N(-self.v)

    def __truediv__(self, other: _N) -> _N:
        if abs(other.v) < 1e-40:
            raise _Wrong
        _N.divisors.append(int(mpmath.sign(other.v)))
        return _N(self.v / other.v)

    def __pow__(self, power: int) -> _N:
        return _N(self.v**power) if power > 0 else _N(1) / (self if power == -1 else self._odd(power))

    def _odd(self, power: int) -> _N:
        _N(1) / self  # what an even power hides
        return _N(self.v**-power)


def _root(value: _N) -> _N:
    if value.v < -(mpmath.mpf(10) ** -40):
        raise _Wrong
    return _N(mpmath.sqrt(abs(value.v)))


class _Tried:
    """A drawn expression evaluated by Python's own grammar."""

    def __init__(self, text: str) -> None:
        self.code = compile(
            re.sub(r"(?<![\w.*])(?<!\*\*-)(\d+(?:\.\d+)?)", r"N('\1')", text), "drawn", "eval"
        )
        self.signs = self._signs(Fraction(1), Fraction(2))

    def _signs(self, a: Fraction, b: Fraction) -> list[int] | None:
        """The signs of the divisors at a point; None where there is no value."""
        with mpmath.workdps(50):
            one, two = (_N(mpmath.mpf(x.numerator) / x.denominator) for x in (a, b))
            _N.divisors = []
            names = {"a": one, "b": two, "c": one - _N(two.v / 2), "N": _N, "sqrt": _root, "__builtins__": {}}
            try:
                eval(self.code, names)
            except _Wrong:
                return None
            return _N.divisors

    def wrong_at(self, a: Fraction, b: Fraction) -> bool:
        """A root has a negative argument, or a divisor is 0 or has another sign than it has nominally."""
        return self._signs(a, b) != self.signs


def grid(low: Fraction, high: Fraction, count: int = 20) -> Iterator[Fraction]:
    return (low + (high - low) * k / count for k in range(count + 1))


@settings(max_examples=examples(120))
@given(st.recursive(_LEAVES, _grown, max_leaves=6))
def test_verdicts_are_those_of_dense_sampling(text: str) -> None:
    """c = a - b/2 is 0 nominally. A file with a wrong point on the grid is rejected, and a rejected file is wrong near
    the point in the message."""
    parameters = f"{BOTH}, c: a - b/2"
    try:
        laid_out("a: 1, b: 2, c: a - b/2", text)
    except RobotFileError:
        return  # wrong nominally
    tried = _Tried(text)
    points = itertools.product(grid(Fraction(9, 10), Fraction(11, 10)), grid(Fraction(9, 5), Fraction(11, 5)))
    wrong = next((point for point in points if tried.wrong_at(*point)), None)
    try:
        laid_out(parameters, text)
    except RobotFileError as error:
        at = {name: Fraction(value) for name, value in re.findall(r"\b([ab]) = (\S+)", error.what)}
        a, b = at.get("a", Fraction(1)), at.get("b", Fraction(2))
        beyond = (a + (a - 1) / 1000, b + (b - 2) / 1000)  # a message has six digits
        assert tried.wrong_at(a, b) or tried.wrong_at(*beyond), (text, error.what)
    else:
        assert wrong is None, (text, wrong)


# ---- where values are given


NARROW = (
    "a: {value: 1, tunable: [0.96, 1.1]}, b: {value: 2, tunable: [1.9, 2]}",
    "sqrt(2 - b)",
    "a - 0.95",
)


@pytest.mark.parametrize("backend", everyday(["exact", "casadi", "c"], ["exact", "c"]))
@pytest.mark.parametrize(
    ("given", "problem"),
    [("b=2.1", "b = 2.1"), ("a=0.95", "a = 0.95"), ("a=0.9", "a = 0.9")],
)
def test_eval_refuses_parameters_without_geometry(
    given: str, problem: str, backend: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    path = tmp_path / "probed.yaml"
    path.write_text(ROBOT.format(*NARROW))
    twist = ("vx=1", "vy=0", "omega=0")
    done = wmrgen_cli("eval", path, "inverse", *twist, given, "--backend", backend)
    assert done.code == 2 and problem in done.err and f"{path}:5:" in done.err
    cases = tmp_path / "cases.json"
    name, value = given.split("=")
    still = {"vx": 1, "vy": 0, "omega": 0}
    cases.write_text(json.dumps([still, {**still, name: value}]))
    done = wmrgen_cli("eval", path, "inverse", "--cases", cases, "--backend", backend)
    assert done.code == 2 and "case 1" in done.err and problem in done.err


def test_a_value_outside_its_range_is_a_warning(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    path = tmp_path / "probed.yaml"
    path.write_text(ROBOT.format(*NARROW))
    done = wmrgen_cli("eval", path, "inverse", "vx=1", "vy=0", "omega=0", "a=1.2", "--json")
    assert done.code == 0 and json.loads(done.out)
    assert re.search(r"\ba\b.*\b0\.96\b.*\b1\.1\b", done.err)


def test_python_refuses_them_too() -> None:
    derivation = wmrgen.derive(laid_out(*NARROW))
    one = Exact(1)
    derivation.evaluate("inverse", {"vx": one})
    with pytest.raises(UsageError) as caught:
        derivation.evaluate("inverse", {"vx": one, "b": one * 3})
    assert "b = 3" in caught.value.what and ":5:" in caught.value.what


BODY = """
    probed_params params, nominal;
    probed_prepared prepared, normal;
    const probed_twist in = {{0.5f, 0.25f, -0.5f}};
    probed_wheels out;
    int i, accepted = 0, refused = 0;
    (void)bad; (void)k;
    probed_params_default(&nominal);
    probed_prepare(&nominal, &normal);
    EXPECT(probed_prepare_checked(&nominal, &prepared) == PROBED_OK);
    EXPECT(memcmp(&prepared, &normal, sizeof normal) == 0);
    for (k = 0; k <= 20; ++k) {{
        for (i = 0; i <= 20; ++i) {{
            probed_status status;
            params = nominal;
            {0}
            status = probed_prepare_checked(&params, &prepared);
            accepted += status == PROBED_OK;
            refused += status != PROBED_OK;
            EXPECT(status == PROBED_OK || memcmp(&prepared, &normal, sizeof normal) == 0);
            EXPECT(probed_inverse_checked(&prepared, &in, &out) == PROBED_OK);
            EXPECT(fabsf(out.left.spin) < 1e5f && out.left.spin > 0.0f);
            EXPECT(fabsf(out.right.spin) < 100.0f && fabsf(out.back.spin) < 100.0f);
        }}
    }}
    EXPECT(accepted > 0 && (refused > 0) == {1});
"""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize(
    ("x", "r", "refused"),
    [
        ("sqrt(2 - b)", "a - 0.95", 0),  # holds everywhere
        ("0.3 + 0.1*sin(atan2(a - 1.02, a - 1.02))", "0.1", 1),  # no value at 1.02, which is not decided
        ("0.3 + 0.1*cos(atan2((a - 1.02)*b, (b - 1.95)*(a - 1.02)))", "0.1", 1),
        ("0.3 + 0.1*sqrt(a*a - a*b + b*b/4)", "0.1*a", 0),  # a square, but for rounding, which may refuse
    ],
)
def test_what_is_computed_is_checked_in_c(x: str, r: str, refused: int, tmp_path: Path) -> None:
    """At the corners and on a grid of the box: OK and a wheel that turns forward, or the nominal robot."""
    text = ROBOT.format(NARROW[0], x, r)
    assert wmrgen.derive(build(read(text))).c_module.needs
    set_ = "params.a = 0.96f + 0.007f*(float)k; params.b = 1.9f + 0.005f*(float)i;"
    set_ += " if (k == 6) { params.a = 1.02f; } if (k == 20) { params.a = 1.1f; } if (i == 20) { params.b = 2.0f; }"
    expected = "(refused > 0)" if "a*a" in x else str(refused)
    assert printed(tmp_path, text, BODY.format(set_, expected)) == ""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
def test_divisors_of_the_formulas_are_checked_in_c(tmp_path: Path) -> None:
    """Two wheels whose distance may vanish: a robot for each value, and `forward` divides by none that is 0."""
    text = """\
wmrgen: 1
name: probed
parameters: {a: {value: 1, tunable: true}}
wheels:
  - {name: left,  type: fixed, x: 0, y: a - 0.95, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: 0.95 - a, heading: 0, r: 0.1}
limits: {vx: 1, omega: 1, spin: 20}
"""
    body = """
    probed_params params;
    probed_prepared prepared;
    probed_wheels wheels;
    probed_twist out;
    (void)bad;
    for (k = -10; k <= 10; ++k) {
        params.a = k ? 1.0f + 0.01f*(float)k : 0.95f;
        if (k == -5) { continue; }
        EXPECT(probed_prepare_checked(&params, &prepared) == (k ? PROBED_OK : PROBED_OUT_OF_RANGE));
        wheels.left.spin = 1.0f;
        wheels.right.spin = 2.0f;
        probed_forward(&prepared, &wheels, &out);
        EXPECT(fabsf(out.omega) < 10.0f && fabsf(out.omega) > 0.1f);
    }
"""
    assert printed(tmp_path, text, body) == ""


def test_derive_reports_what_is_not_proved(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    path = tmp_path / "probed.yaml"
    for x, proved in (("0.3 + 0.1*sqrt(a*a - a*b + b*b/4)", False), ("sqrt(2.5 - b)", True)):
        path.write_text(ROBOT.format(NARROW[0], x, "0.1"))
        done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
        lines = [line for line in done.err.splitlines() if "numerics.md" in line]
        assert done.code == 0 and len(lines) == (not proved)
        assert proved or "inverse" in lines[0]
