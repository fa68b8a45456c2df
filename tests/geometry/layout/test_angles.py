"""Angles given by expressions, tunable or not, and snapping of angles with two decimals, as in URDF files."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from tests.depth import everyday
from tests.oracle.harness import Model
from wmrgen.geometry.layout import build
from wmrgen.robotfile.load import read_text

ROBOT = """\
wmrgen: 1
name: pair
parameters: {{a: {0}, b: {1}}}
wheels:
  - {{name: left,  type: fixed, x: 0, y: 0.2, heading: '{2}', r: '{3}'}}
  - {{name: right, type: steered, x: 0, y: -0.2, heading: 0, r: 0.1}}
"""
NUMBERS = {
    "sqrt(2)/3": math.sqrt(2) / 3,
    "pi*sqrt(2)/7": math.pi * math.sqrt(2) / 7,
    "pi*pi/7": math.pi**2 / 7,
    "1/pi": 1 / math.pi,
    "atan2(1, 2)": math.atan2(1, 2),
    "-atan2(sqrt(5), 2)/2 + sqrt(sqrt(2)) - pi/7": -math.atan2(5**0.5, 2) / 2 + 2**0.25 - math.pi / 7,
}
# Angle as written, and as Python computes it.
TUNABLE: dict[str, Callable[[float, float], float]] = {
    "a/2": lambda a, b: a / 2,
    "a*pi/180": lambda a, b: a * math.pi / 180,
    "a*b": lambda a, b: a * b,
    "1/a": lambda a, b: 1 / a,
    "5*a - pi/4 + sqrt(2)*b": lambda a, b: 5 * a - math.pi / 4 + math.sqrt(2) * b,
    "atan2(a, b)/2": lambda a, b: math.atan2(a, b) / 2,
    "atan2(sqrt(b), sin(a/3))": lambda a, b: math.atan2(math.sqrt(b), math.sin(a / 3)),
    "tan(a*b)**2": lambda a, b: math.tan(a * b) ** 2,
}
EVERY_DAY = ("a/2", "1/a", "5*a - pi/4 + sqrt(2)*b", "atan2(sqrt(b), sin(a/3))")


def written(folder: Path, a: str, b: str, heading: str, r: str = "0.1") -> Path:
    path = folder / "robot.yaml"
    path.write_text(ROBOT.format(a, b, heading, r), encoding="utf-8")
    return path


@pytest.mark.parametrize("text", NUMBERS)
def test_an_angle_of_numbers(text: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    file = written(tmp_path, "1", "1", text, f"cos({text})**2")
    wheel = wmrgen.load(file).wheels[0]
    assert wheel.heading == pytest.approx(NUMBERS[text], rel=1e-15)
    assert float(wheel.nominal.ch) == pytest.approx(math.cos(NUMBERS[text]), rel=1e-15)
    assert float(wheel.nominal.sh) == pytest.approx(math.sin(NUMBERS[text]), rel=1e-15)
    assert float(wheel.nominal.r) == pytest.approx(math.cos(NUMBERS[text]) ** 2, rel=1e-15)
    assert abs(float(wheel.nominal.ch**2 + wheel.nominal.sh**2 - 1)) < 1e-30
    assert wmrgen_cli("derive", file, "-o", tmp_path / "out").code == 0


@pytest.mark.parametrize("a", ["1 - pi", "{value: 1 - pi, tunable: true}"])
def test_an_angle_divided_by_a_parameter_that_holds_pi(a: str, tmp_path: Path) -> None:
    wheel = wmrgen.load(written(tmp_path, a, "1", "2/a")).wheels[0]
    assert float(wheel.nominal.sh) == pytest.approx(math.sin(2 / (1 - math.pi)), rel=1e-15)


@pytest.mark.parametrize("text", everyday(TUNABLE, EVERY_DAY))
def test_an_angle_of_tunable_parameters(
    text: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """All back ends agree, at values that are not nominal, with a file that has the angle as a number."""
    tunable = written(tmp_path, "{value: 0.5, tunable: true}", "{value: 0.7, tunable: true}", text)
    assert wmrgen_cli("derive", tunable, "-o", tmp_path / "out").code == 0
    a, b = 0.625, 0.5625
    twist = ["vx=0.5", "vy=-0.25", "omega=1.5"]
    found = {
        backend: json.loads(
            wmrgen_cli(
                "eval", tunable, "inverse", *twist, f"a={a}", f"b={b}", "--backend", backend, "--json"
            ).out
        )
        for backend in ("exact", "casadi", "c")
    }
    model = wmrgen.derive(wmrgen.load(tunable))
    given = {"a": a} | ({"b": b} if "b" in text else {})
    numbers = model.numpy().inverse(vx=0.5, vy=-0.25, omega=1.5, right_steer=0.0, **given)
    plain = written(tmp_path, "1", "1", f"{TUNABLE[text](a, b):.17f}")
    wanted = json.loads(wmrgen_cli("eval", plain, "inverse", *twist, "--json").out)
    for backend, values in found.items():
        assert values == pytest.approx(wanted, rel=2e-6, abs=2e-6), backend
    assert {k: float(v) for k, v in numbers.items()} == pytest.approx(wanted, rel=1e-12, abs=1e-12)
    data = json.loads((tmp_path / "out/pair/model.json").read_text(encoding="utf-8"))
    syntax = {name: getattr(math, name) for name in "pi sqrt sin cos tan atan2".split()}
    h, (row, _) = TUNABLE[text](a, b), data["J1"]
    values = [eval(entry, {**syntax, "a": a, "b": b}) for entry in row]
    assert values == pytest.approx([math.cos(h), math.sin(h), -0.2 * math.cos(h)], rel=1e-12)


@pytest.mark.parametrize(
    "d", ["sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)", "sqrt(5)*sqrt(7) - sqrt(35)", "sqrt(3 + 2*sqrt(2) - (1 + sqrt(2))**2)"]
)  # fmt: skip
def test_a_castor_with_an_offset_of_roots_that_is_zero(
    d: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    file = written(tmp_path, "1", "1", "0")
    with file.open("a", encoding="utf-8") as text:
        text.write(f"  - {{name: c, type: castor, x: -0.2, y: 0, heading: 0, d: {d}, r: 0.03}}\n")
    done = wmrgen_cli("derive", file, "-o", tmp_path / "out")
    assert done.code == 2 and "WMR109" in done.err and f"{file}:7:" in done.err


ROOTS = {
    "heading": "x: 0.1, y: 0.2, heading: sqrt(a)",
    "x": "x: sqrt(a), y: 0.2, heading: 0",
    "polar": "l: 0.1+sqrt(a), alpha: sqrt(a), beta: 0",
}


@pytest.mark.parametrize("name", everyday(ROOTS, ["polar"]))
@pytest.mark.slow
def test_the_root_of_a_tunable_parameter_that_is_zero(
    name: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """At its nominal value and near it, the results equal those of a file with numbers."""

    def robot(a: str, root: str) -> Path:
        place = ROOTS[name].replace("sqrt(a)", root)
        path = tmp_path / "robot.yaml"
        path.write_text(
            f"wmrgen: 1\nname: three\nsnap: false\nparameters: {{a: {a}}}\nwheels:\n"
            f"  - {{name: left, type: swedish, gamma: 0, {place}, r: 0.1}}\n"
            "  - {name: right, type: swedish, gamma: 0, x: 0, y: -0.2, heading: 0.5, r: 0.1}\n"
            "  - {name: back, type: swedish, gamma: 0, x: -0.3, y: 0, heading: pi/2, r: 0.1}\n",
            encoding="utf-8",
        )
        return path

    spins = ["left.spin=1", "right.spin=-0.5", "back.spin=0.25"]
    for a, root in (("0", "0"), ("0.01", "0.1")):
        plain = robot("0", root)
        wanted = json.loads(wmrgen_cli("eval", plain, "forward", *spins, "--json").out)
        tunable = robot("{value: 0, tunable: [0, 0.01]}", "sqrt(a)")
        assert wmrgen_cli("derive", tunable, "-o", tmp_path / "out").code == 0
        for backend in ("exact", "casadi", "numpy", "c"):
            done = wmrgen_cli("eval", tunable, "forward", *spins, f"a={a}", "--backend", backend, "--json")
            assert json.loads(done.out) == pytest.approx(wanted, rel=1e-5, abs=1e-5), backend


DRIVE = """wmrgen: 1
name: drive
wheels:
  - {{name: left, type: fixed, l: 0.2, alpha: 1.57, beta: 0, r: 0.1}}
  - {{name: right, type: fixed, l: 0.2, alpha: {alpha}, beta: {beta}, r: 0.1}}
"""


@pytest.mark.parametrize("alpha, beta", [("-1.57", "3.14"), ("-1.5708", "3.1416"), ("-1.571", "3.142")])
def test_the_heading_as_written_decides(tmp_path: Path, alpha: str, beta: str) -> None:
    """alpha + beta - pi/2 = -1.57 + 3.14 - pi/2 is 0.0008 from 0, although 3.14 is 0.0016 from pi.

    Rounding errors of alpha and beta cancel in the sum, so the sum of what the file says is what to snap, not
    the sum after alpha alone was moved.
    """
    m = Model.of(DRIVE.format(alpha=alpha, beta=beta), tmp_path).derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability) == (2, 0)


def test_angles_snap_one_by_one_where_their_sum_does_not() -> None:
    wheel = build(read_text(DRIVE.format(alpha="0.7", beta="3.14"), "drive.yaml")).wheels[1]
    assert math.remainder(wheel.heading - (0.7 + math.pi / 2), 2 * math.pi) == pytest.approx(0, abs=1e-12)


PLACES = {
    "alpha": "type: fixed, l: 0.2, alpha: {}, heading: 0",
    "beta": "type: fixed, l: 0.2, alpha: pi/2, beta: {}",
    "heading": "type: fixed, x: 0, y: 0.2, heading: {}",
    "gamma": "type: swedish, x: 0, y: 0.2, heading: 0, gamma: {}",
}


@pytest.mark.parametrize("key", PLACES)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("off", "snapped"), [(0.0008, True), (0.00199, True), (0.00201, False), (0.004, False)]
)
def test_an_angle_snaps_within_two_thousandths(key: str, side: int, off: float, snapped: bool) -> None:
    angle = math.pi / 4 + side * off
    text = f"wmrgen: 1\nname: drive\nwheels:\n  - {{name: a, {PLACES[key].format(repr(angle))}, r: 0.1}}\n"
    robot = build(read_text(text, "drive.yaml"))
    assert getattr(robot.wheels[0], key) == pytest.approx(math.pi / 4 if snapped else angle, abs=1e-12)
    assert any(key in note and "pi/4" in note for note in robot.notes)


def test_3_14_is_pi() -> None:
    text = "wmrgen: 1\nname: one\nwheels:\n  - {name: a, type: fixed, x: 0, y: 1, heading: 3.14, r: 0.1}\n"
    wheel = build(read_text(text, "one.yaml")).wheels[0].nominal
    assert (wheel.ch, wheel.sh) == (-1, 0)


@pytest.mark.parametrize(("alpha", "beta"), [(0.7, -1.1), (-2.9, 0.4), (2.0, 2.5), (-0.3, -2.2)])
def test_a_layout_says_what_the_file_says(tmp_path: Path, alpha: float, beta: float) -> None:
    """Siegwart's alpha, beta and l, and the heading alpha + beta - pi/2 of the wheel plane."""
    path = tmp_path / "drive.yaml"
    path.write_text(DRIVE.format(alpha=alpha, beta=beta), encoding="utf-8")
    wheel = wmrgen.load(path).wheels[1]
    assert (wheel.l, wheel.alpha, wheel.beta) == pytest.approx((0.2, alpha, beta), abs=1e-12)
    assert math.remainder(wheel.heading - (alpha + beta - math.pi / 2), 2 * math.pi) == pytest.approx(
        0, abs=1e-12
    )
