"""Wheels steered against each other (`ratios: [1, -1]`), held to contact velocities in plain numpy.

With the angle t of the first wheel and -t of the second, the twist that lets both roll is the null vector of their two
sliding rows, computed here from pivots and headings alone.
"""

from __future__ import annotations

import cmath
import math
import random
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from wmrgen import derive, load
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code, NotDerivableError, RobotFileError
from wmrgen.functions.registry import system_builder
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower

Array = NDArray[np.float64]
SEEDS = range(6)
TWIST = ("vx", "vy", "omega")


class Wheel(NamedTuple):
    """A steered wheel at x + iy [m], its heading at steering angle 0 [rad], its radius [m], its angle for 1 of the
    first."""

    name: str
    pivot: complex
    heading: float
    r: float
    sign: int

    def direction(self, t: float) -> complex:
        return cmath.rect(1, self.heading + self.sign * t)

    def velocity(self, twist: Array) -> complex:
        return complex(twist[0], twist[1]) + 1j * twist[2] * self.pivot


def row(w: Wheel, along: complex) -> Array:
    """The row of the pivot's velocity along a direction."""
    return np.array([along.real, along.imag, (w.pivot.conjugate() * along).imag])


def rolling(wheels: list[Wheel], t: float) -> Array:
    """The twist, of unit length, at which no wheel slides at the angle t of the first; its sign is free."""
    slides = np.array([row(w, 1j * w.direction(t)) for w in wheels])
    _, values, vectors = np.linalg.svd(slides)
    assert values[1] > 1e-6 and (len(values) < 3 or values[2] < 1e-9)
    return np.asarray(vectors[2])


def spins(wheels: list[Wheel], t: float, twist: Array) -> dict[str, float]:
    return {
        f"{w.name}.spin": float((w.velocity(twist) * w.direction(t).conjugate()).real) / w.r for w in wheels
    }


def steers(wheels: list[Wheel], t: float) -> dict[str, float]:
    return {f"{w.name}.steer": w.sign * t for w in wheels}


def drawn(seed: int) -> list[Wheel]:
    """Two wheels anywhere, of unequal radii, in any headings."""
    rng = random.Random(seed)

    def number(low: float, high: float) -> float:
        return round(rng.uniform(low, high), 2)

    return [
        Wheel(name, complex(number(*span), number(-0.3, 0.3)), number(-0.4, 0.4), number(0.05, 0.2), sign)
        for name, span, sign in (("front", (0.3, 0.9), 1), ("rear", (-0.9, -0.2), -1))
    ]


BICYCLE = [Wheel("front", 0.5 + 0j, 0.0, 0.1, 1), Wheel("rear", -0.3 + 0j, 0.0, 0.1, -1)]


def text(wheels: list[Wheel], tunable: bool = False, more: str = "", rest: str = "") -> str:
    parameters, lines = [], []

    def value(name: str, number: float) -> str:
        if not tunable:
            return repr(number)
        parameters.append(f"  {name}: {{value: {number!r}, tunable: true}}")
        return name

    for w in wheels:
        keys = {"x": w.pivot.real, "y": w.pivot.imag, "heading": w.heading, "r": w.r}
        said = ", ".join(f"{k}: {value(f'{k}_{w.name}', v)}" for k, v in keys.items())
        lines.append(f"  - {{name: {w.name}, type: steered, {said}}}")
    names, ratios = ", ".join(f"{w.name}.steer" for w in wheels), ", ".join(str(w.sign) for w in wheels)
    head = ["wmrgen: 1", "name: sample", *(["parameters:", *parameters] if tunable else [])]
    coupling = f"couplings: [{{equal: [{names}], ratios: [{ratios}]}}]"
    return "\n".join([*head, "wheels:", *lines, more, rest or coupling, ""])


def derivation(folder: Path, words: str) -> Derivation:
    path = folder / "sample.yaml"
    path.write_text(words, encoding="utf-8")
    return derive(load(path))


def call(formula: Formula, values: dict[str, float]) -> dict[str, float]:
    ir = lower(formula)
    given = {p.name: values.get(p.name, float(p.default or 0)) for p in ir.inputs}
    return evaluate(ir, given, FLOAT64)


def twist_of(values: dict[str, float]) -> Array:
    return np.array([values[name] for name in TWIST])


@pytest.mark.parametrize("tunable", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_there_and_back(seed: int, tunable: bool, tmp_path: Path) -> None:
    wheels = drawn(seed)
    d = derivation(tmp_path, text(wheels, tunable))
    m = d.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability, m.robot_type) == (1, 1, (1, 1))
    assert m.dof == 3 and not m.degenerate
    for t in (0.35, -0.5, 0.01):
        twist = 0.8 * rolling(wheels, t)
        present = steers(wheels, t + 0.2)
        out = call(d.formula("inverse"), dict(zip(TWIST, twist, strict=True)) | present)
        assert out.pop("slip") == pytest.approx(0, abs=1e-9)
        assert out == pytest.approx(spins(wheels, t, twist) | steers(wheels, t), abs=1e-8)
        back = call(d.formula("forward"), out)
        assert twist_of(back) == pytest.approx(twist, abs=1e-8)
        assert back["slip"] == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_twist_that_no_angle_rolls_is_slid_least(seed: int, tmp_path: Path) -> None:
    wheels = drawn(seed)
    d, twist = derivation(tmp_path, text(wheels)), np.array([0.7, 0.5, -0.9])
    out = call(d.formula("inverse"), dict(zip(TWIST, twist, strict=True)))
    t = out["front.steer"]
    assert out["rear.steer"] == pytest.approx(-t)

    def slides(angle: float) -> float:
        lateral = [(w.velocity(twist) * w.direction(angle).conjugate()).imag for w in wheels]
        return float(np.sqrt(np.sum(np.square(lateral))))

    assert out["slip"] == pytest.approx(slides(t), abs=1e-9)
    assert slides(t) <= min(slides(a) for a in np.linspace(-math.pi / 2, math.pi / 2, 721)) + 1e-9


@pytest.mark.parametrize("form", ["posture", "twist", "eta"])
@pytest.mark.parametrize("tunable", [False, True])
@pytest.mark.parametrize("wheels", [*map(drawn, SEEDS[:3]), BICYCLE])
def test_models_move_as_the_wheels_roll(
    wheels: list[Wheel], tunable: bool, form: str, tmp_path: Path
) -> None:
    """x, y and theta at theta = 0 change by the twist, the angle by its rate; other lengths than the nominal ones."""
    d, t = derivation(tmp_path, text(wheels, tunable)), 0.3
    other = [w._replace(pivot=w.pivot * 1.05, r=w.r * 0.95) for w in wheels] if tunable else wheels
    lengths = {
        f"{key}_{w.name}": value
        for w in other
        for key, value in (("x", w.pivot.real), ("y", w.pivot.imag), ("r", w.r))
    }
    system = system_builder(form)(d.robot, d.mobility, False)
    twist = rolling(other, t)
    given = (
        spins(other, t, twist) | dict(zip(TWIST, twist, strict=True)) | {"front.steer_rate": 0.2, "eta1": 1.0}
    )
    rates = call(system.formula(guards=False), given | lengths | {"front.steer": t, "theta": 0.0})
    found = np.array([rates[name] for name in ("x_rate", "y_rate", "theta_rate")])
    if form == "eta":
        found, twist = found / np.linalg.norm(found), twist * np.sign(found @ twist)
    assert found == pytest.approx(twist, abs=1e-9)
    assert rates["front.steer_rate"] == pytest.approx(0.2)


def test_the_constraint_of_the_twist_form_is_zero_where_both_roll(tmp_path: Path) -> None:
    from wmrgen.functions.models.twist import sliding

    wheels, t = drawn(1), 0.4
    d = derivation(tmp_path, text(wheels))
    formula = sliding(d.robot, d.mobility)
    assert formula is not None and len(formula.outputs) == 2
    twist = dict(zip(TWIST, rolling(wheels, t), strict=True))
    assert [*call(formula, twist | {"front.steer": t}).values()] == pytest.approx([0, 0], abs=1e-12)
    off = [*call(formula, twist | {"front.steer": t + 0.1}).values()]
    expected = [float((w.velocity(twist_of(twist)) * w.direction(t + 0.1).conjugate()).imag) for w in wheels]
    assert np.abs(off) == pytest.approx(np.abs(expected), abs=1e-12)


def test_accelerations_are_differences(tmp_path: Path) -> None:
    wheels, h = drawn(2), 1e-5
    path = text(wheels) + "functions: [accelerations]\n"
    d = derivation(tmp_path, path)
    start, rate = 0.8 * rolling(wheels, 0.3), np.array([0.2, -0.3, 0.1])

    def commands(time: float) -> dict[str, float]:
        return call(d.formula("inverse"), dict(zip(TWIST, start + rate * time, strict=True)))

    changes = {f"{n}_rate": r for n, r in zip(TWIST, rate, strict=True)}
    out = call(d.formula("accelerations"), dict(zip(TWIST, start, strict=True)) | changes)
    ahead, behind = commands(h), commands(-h)
    for w in wheels:
        steer_rate = (ahead[f"{w.name}.steer"] - behind[f"{w.name}.steer"]) / (2 * h)
        assert out[f"{w.name}.steer_rate"] == pytest.approx(steer_rate, abs=1e-6)
    assert out["rear.steer_rate"] == pytest.approx(-out["front.steer_rate"])


def test_a_third_wheel_that_steers_by_itself_follows(tmp_path: Path) -> None:
    wheels, t = drawn(3), -0.25
    third = (
        "  - {name: own, type: steered, x: 0.1, y: 0.4, heading: 0, r: 0.1}\nfunctions: [inverse_together]"
    )
    d = derivation(tmp_path, text(wheels, more=third))
    assert d.mobility.robot_type == (1, 1)
    twist = rolling(wheels, t)
    present = steers(wheels, t)
    own = Wheel("own", 0.1 + 0.4j, 0.0, 0.1, 1)
    for function in ("inverse", "inverse_together"):
        out = call(d.formula(function), dict(zip(TWIST, twist, strict=True)) | present)
        assert out["slip"] == pytest.approx(0, abs=1e-9)
        assert out["front.steer"] == pytest.approx(-out["rear.steer"])
        rolls = own.velocity(twist) * cmath.rect(1, -out["own.steer"])
        assert rolls.imag == pytest.approx(0, abs=1e-9)
        assert rolls.real == pytest.approx(out["own.spin"] * own.r, abs=1e-9)
        back = call(d.formula("forward"), out)
        assert twist_of(back) == pytest.approx(twist, abs=1e-8)


AXLE = "".join(
    f"  - {{name: {n}, type: fixed, x: AT, y: {y}, heading: 0, r: 0.1}}\n"
    for n, y in (("left", 0.3), ("right", -0.3))
)


@pytest.mark.parametrize(("x", "kind"), [("0.1", (1, 1)), ("0.0", None)])
def test_a_fixed_axle_leaves_steering_only_halfway(
    x: str, kind: tuple[int, int] | None, tmp_path: Path
) -> None:
    """The axle lines of front and rear meet on the line halfway between them."""
    d = derivation(tmp_path, text(BICYCLE, more=AXLE.replace("AT", x)))
    assert d.mobility.robot_type == kind
    assert d.mobility.degree_of_mobility == 1 and d.mobility.degree_of_steerability == (1 if kind else 0)
    assert bool(d.mobility.verdict) == (kind is None)


def test_four_wheels_in_pairs_leave_straight_motion(tmp_path: Path) -> None:
    """Pairs side by side at equal angles have no common ICR but that of straight motion."""
    corners = [
        Wheel(f"{end}_{side}", complex(x, y), 0.0, 0.1, sign)
        for end, x, sign in (("front", 0.5, 1), ("rear", -0.5, -1))
        for side, y in (("left", 0.3), ("right", -0.3))
    ]
    d = derivation(tmp_path, text(corners))
    assert d.mobility.degenerate and d.mobility.degree_of_steerability == 0 and d.mobility.verdict
    out = call(d.formula("inverse"), {"vx": 0.5})
    assert [out[f"{w.name}.steer"] for w in corners] == pytest.approx([0.0] * 4)
    assert out["slip"] == 0


def test_one_motor_that_also_drives_both(tmp_path: Path) -> None:
    """Equal radii on one shaft roll alike, for both wheels stand as far from the ICR."""
    spun = (
        "couplings: [{equal: [front.steer, rear.steer], ratios: [1, -1]}, {equal: [front.spin, rear.spin]}]"
    )
    d = derivation(tmp_path, text(BICYCLE, rest=spun))
    assert d.mobility.robot_type == (1, 1)
    t = 0.4
    twist = rolling(BICYCLE, t)
    out = call(d.formula("inverse"), dict(zip(TWIST, twist, strict=True)) | steers(BICYCLE, t))
    assert out["slip"] == pytest.approx(0, abs=1e-9)
    assert out["front.spin"] == pytest.approx(out["rear.spin"])
    assert twist_of(call(d.formula("forward"), out)) == pytest.approx(twist, abs=1e-9)


def test_limits_of_either_wheel_bind_both(tmp_path: Path) -> None:
    words = text(BICYCLE).replace("r: 0.1}", "r: 0.1, limits: {steer: [-10 deg, 30 deg]}}", 1)
    d = derivation(tmp_path, words)
    low, high = d.robot.limit_of("rear.steer") or ()
    assert (float(low), float(high)) == pytest.approx((-math.pi / 6, math.pi / 18))
    out = call(
        d.formula("inverse"), dict(zip(TWIST, rolling(BICYCLE, 1.0), strict=True)) | steers(BICYCLE, 0.4)
    )
    assert out["front.steer"] == pytest.approx(math.pi / 6) and out["rear.steer"] == pytest.approx(
        -math.pi / 6
    )


def test_where_the_axles_are_one_line(tmp_path: Path) -> None:
    """At 90 degrees both axles lie along x; wheels that never stand so have no such configuration."""
    d = derivation(tmp_path, text(BICYCLE))
    assert "shared_axle" in [s.kind for s in d.mobility.singularities]
    askew = [BICYCLE[0]._replace(heading=0.3), BICYCLE[1]]
    d = derivation(tmp_path, text(askew))
    assert "shared_axle" not in [s.kind for s in d.mobility.singularities]


@pytest.mark.parametrize(
    ("couplings", "at"),
    [
        ("{equal: [front.steer, rear.steer], ratios: [1, 2]}", "2]"),
        ("{equal: [front.steer, rear.steer], ratios: [-2, 1/2]}", "1/2]"),
        ("{equal: [front.steer, rear.steer], ratios: [1, 0]}", "0]"),
        (
            "{equal: [front.steer, rear.steer]}, {equal: [rear.steer, front.steer, left.steer], ratios: [1, -1, 1]}",
            "",
        ),
    ],
)
def test_other_ratios_are_refused_where_they_are(couplings: str, at: str, tmp_path: Path) -> None:
    third = "  - {name: left, type: steered, x: 0, y: 0.5, heading: 0, r: 0.1}"
    line = f"couplings: [{couplings}]"
    with pytest.raises(RobotFileError) as caught:
        derivation(tmp_path, text(BICYCLE, more=third, rest=line))
    mark = caught.value.mark
    assert caught.value.code is Code.VALUE and mark is not None
    assert line[mark.column - 1 :].startswith(at)


def test_ratios_that_are_equal_are_no_ratios(tmp_path: Path) -> None:
    words = text(BICYCLE, rest="couplings: [{equal: [front.steer, rear.steer], ratios: [-2, -2]}]")
    d = derivation(tmp_path, words)
    assert not d.robot.ratios("steer", ("front", "rear"))
    assert [w.steer_sign for w in d.robot.wheels] == [1, 1]


def test_castors_turn_by_equal_angles_only(tmp_path: Path) -> None:
    castors = "".join(
        f"  - {{name: {n}, type: castor, x: 0.3, y: {y}, d: -0.05, r: 0.1, actuated: [spin, steer]}}\n"
        for n, y in (("a", 0.2), ("b", -0.2))
    )
    rest = "couplings: [{equal: [a.steer, b.steer], ratios: [1, -1]}]"
    with pytest.raises(NotDerivableError):
        derivation(tmp_path, text(BICYCLE, more=castors, rest=rest))
