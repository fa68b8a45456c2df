"""Names, decimals and signs as LaTeX: one notation for the report, the models and the proofs."""

from __future__ import annotations

import re
from fractions import Fraction

import pytest
import sympy

import wmrgen
from tests.conftest import ROOT
from tests.robots import of_gallery
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.sheet import latex, sheet_of
from wmrgen.functions.registry import names
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.printing import Latex, Text
from wmrgen.geometry.symbolic import add, local, nearest, parameter, signal, times


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("omega", r"\omega"),
        ("dt", r"\Delta t"),
        ("vx", "v_x"),
        ("vx_driven", "v_x^{*}"),
        ("vx_rate", r"\dot{v}_x"),
        ("x_rate", r"\dot{x}"),
        ("eta1", r"\eta_{1}"),
        ("k_rho", r"k_{\rho}"),
        ("omega_max", r"\omega_{\mathrm{max}}"),
        ("slip", r"\mathrm{slip}"),
        ("half_track", r"\mathrm{half\;track}"),
        ("left.spin", r"\dot{\varphi}_{\mathrm{left}}"),
        ("front_left.steer_rate", r"\dot{\psi}_{\mathrm{front\_left}}"),
        ("point.vx", r"v_{x,\mathrm{point}}"),
        ("v_m.x", "v_{m,x}"),
        ("icr.x", r"x_{\mathrm{icr}}"),
        ("trailer1.theta_rate", r"\dot{\theta}_{\mathrm{trailer1}}"),
        ("rear.speed", r"v_{\mathrm{rear}}"),
        ("xy", r"\sigma_{x\,y}"),
        ("vxomega", r"\sigma_{v_x\,\omega}"),
    ],
)
def test_ports(name: str, shown: str) -> None:
    assert notation.port(name) == shown


def test_parameters() -> None:
    names = {
        "r": "r",
        "d_1": "d_{1}",
        "hx": "h_{x}",
        "half_track": r"\mathit{half\_track}",
        "h": "h",
        "L": r"\mathtt{L}",
        "gamma": r"\mathtt{gamma}",
        "v_x": r"\mathtt{v\_x}",
        "c1": r"\mathtt{c1}",
    }
    assert {n: notation.parameter(n) for n in names} == names


def test_symbols_know_their_joint() -> None:
    assert notation.symbol("front_left_steer_rate") == notation.port("front_left.steer_rate")
    assert sympy.latex(signal("left.spin")) == notation.port("left.spin")


def test_no_port_of_any_function_has_two_indices() -> None:
    """LaTeX refuses a second subscript: ``v_x_{\\mathrm{point}}``."""
    derivation = wmrgen.derive(wmrgen.load(ROOT / "robots/car_with_trailers.yaml"), [])
    shown = {}
    for function in names():
        try:
            formula = derivation.formula(function)
        except NotDerivableError:
            continue
        ports = (*formula.inputs, *(p for p, _ in formula.outputs))
        shown |= {p.name: notation.port(p.name) for p in ports}
    assert len(shown) > 50
    assert [name for name, text in shown.items() if _outside(text).count("_") > 1] == []


def _outside(text: str) -> str:
    """LaTeX without what stands in braces."""
    while (shorter := re.sub(r"\{[^{}]*\}", "", text)) != text:
        text = shorter
    return text


def test_signs_of_unevaluated_products_stand_once() -> None:
    a, b = local("a"), times(sympy.Rational(-1, 4), local("b"))
    assert Latex().doprint(add(a, times(-1, b))) == r"a + \frac{b}{4}"
    assert Latex().doprint(add(times(a, a), times(local("c"), b))).count("+ -") == 0


def test_what_github_refuses_is_not_there() -> None:
    x, y = signal("x"), signal("y")
    whole = Latex().doprint(nearest(sympy.atan2(y, x, evaluate=False)) ** 2 * sympy.sign(x) * sympy.atan(y))
    assert "operatorname" not in whole and r"\mathrm{rint}" in whole and r"\arctan\left(y\right)" in whole


@pytest.mark.parametrize(("beside", "style"), [("0.123", "exact"), ("0.123456789", "decimals")])
def test_a_root_is_a_decimal_beside_a_number_that_is_rounded(beside: str, style: str) -> None:
    half_root = Exact(0, Fraction(1, 2))
    assert notation.style_of([half_root, Exact(Fraction(beside))]) == style


def test_pi_is_the_letter() -> None:
    assert Latex().doprint(sympy.pi / 3) == r"\frac{\pi}{3}"
    assert Latex().doprint(sympy.pi**2) == r"\pi^{2}"


def test_text_names_ports_or_stays_python() -> None:
    port = Port("left.spin", Role.STATE, "rad/s")
    expr = signal("left.spin") * parameter("r")
    assert Text((port,)).doprint(expr) in ("left.spin*r", "r*left.spin")
    assert Text().doprint(expr) == sympy.sstr(expr)


def test_models_and_reports_share_the_notation() -> None:
    """A steering angle is psi in both."""
    derivation = of_gallery("bicycle")
    text = latex(sheet_of("posture", derivation.system("posture", symbolic=True)))
    assert notation.port("front.steer") in text and r"\beta" not in text
