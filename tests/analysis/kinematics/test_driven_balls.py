"""Balls that are driven in one or two directions, held to the velocity of their contact points in plain numpy.

A drive along the unit vector e turns the ball at r spin = e . (v + omega x B), and nothing else holds the ball.
"""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from wmrgen import derive, load
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code, NotDerivableError, RobotFileError, WmrgenError
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower
from wmrgen.tools.exporting.bodies import bodies
from wmrgen.tools.exporting.drives import drive_with

Array = NDArray[np.float64]
SEEDS = range(6)


class Ball(NamedTuple):
    """A ball at (x, y) [m] with radius r [m], driven along ``driven`` [rad]."""

    name: str
    x: float
    y: float
    r: float
    driven: tuple[float, ...]

    @property
    def drives(self) -> dict[str, float]:
        """Name of each joint's owner -> its direction [rad]."""
        if len(self.driven) == 1:
            return {self.name: self.driven[0]}
        return {f"{self.name}_{k + 1}": angle for k, angle in enumerate(self.driven)}


def contact_velocity(ball: Ball, twist: Array) -> Array:
    """v + omega x B [m/s]."""
    return np.array([twist[0] - twist[2] * ball.y, twist[1] + twist[2] * ball.x])


def spins(balls: list[Ball], twist: Array) -> dict[str, float]:
    return {
        f"{name}.spin": float(np.array([math.cos(a), math.sin(a)]) @ contact_velocity(ball, twist)) / ball.r
        for ball in balls
        for name, a in ball.drives.items()
    }


def rows(balls: list[Ball]) -> Array:
    """Rim speeds [m/s] of all drives for each unit twist, as columns."""
    radii = [ball.r for ball in balls for _ in ball.driven]
    columns = [np.array([*spins(balls, twist).values()]) * radii for twist in np.eye(3)]
    return np.array(columns).T


def drawn(seed: int) -> list[Ball]:
    """Two to four balls with unequal radii anywhere about an origin that is in no middle."""
    rng = random.Random(seed)
    balls = []
    for k in range(rng.randint(2, 4)):
        first = rng.uniform(-3, 3)
        angles = (first, first + rng.choice((math.pi / 2, 0.7, -2.2)))
        count = 2 if k == 0 else rng.choice((0, 1, 2))
        place = rng.uniform(-0.5, 0.9), rng.uniform(-0.9, 0.5), rng.uniform(0.03, 0.2)
        balls.append(Ball(f"b{k}", *(round(v, 3) for v in place), tuple(round(a, 2) for a in angles[:count])))
    return balls


def text(balls: list[Ball], tunable: bool, more: str = "", rest: str = "") -> str:
    parameters = []

    def value(name: str, number: float) -> str:
        if not tunable:
            return repr(number)
        parameters.append(f"  {name}: {{value: {number!r}, tunable: true}}")
        return name

    wheels = [
        f"  - {{name: {b.name}, type: spherical, x: {value(f'x_{b.name}', b.x)}, y: {value(f'y_{b.name}', b.y)}, "
        f"r: {value(f'r_{b.name}', b.r)}, "
        f"driven: [{', '.join(value(f'a{k}_{b.name}', a) for k, a in enumerate(b.driven))}]}}"
        for b in balls
    ]
    head = ["wmrgen: 1", "name: sample", *(["parameters:", *parameters] if tunable else [])]
    return "\n".join([*head, "wheels:", *wheels, more, rest, ""])


def derivation(folder: Path, words: str) -> Derivation:
    path = folder / "sample.yaml"
    path.write_text(words, encoding="utf-8")
    return derive(load(path))


def call(d: Derivation, function: str, **values: float) -> dict[str, float]:
    ir = lower(d.formula(function))
    given = {p.name: values.get(p.name, float(p.default or 0)) for p in ir.inputs}
    return evaluate(ir, given, FLOAT64)


@pytest.mark.parametrize("tunable", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_spins_are_contact_velocities(seed: int, tunable: bool, tmp_path: Path) -> None:
    balls = drawn(seed)
    d = derivation(tmp_path, text(balls, tunable))
    expected_rank = int(np.linalg.matrix_rank(rows(balls)))
    assert (d.mobility.degree_of_mobility, d.mobility.degree_of_steerability) == (3, 0)
    assert d.mobility.omnidirectional and d.mobility.dof == 3 and not d.mobility.degenerate
    assert d.J1.rows == sum(len(b.driven) for b in balls) and d.C1f.rows == d.C1s.rows == 0
    (driving,) = d.mobility.actuation
    assert (driving.motors, driving.independent) == (d.J1.rows, expected_rank)
    for twist in (np.array([0.4, -0.7, 1.3]), np.array([-0.0, 0.2, -0.0]), np.array([-1.0, 0.3, -0.8])):
        out = call(d, "inverse", **dict(zip(("vx", "vy", "omega"), twist, strict=True)))
        expected = spins(balls, twist)
        assert out.pop("slip") == 0
        assert out == pytest.approx(expected, rel=1e-9, abs=1e-9)
        back = call(d, "forward", **expected)
        found = np.array([back[name] for name in ("vx", "vy", "omega")])
        least, *_ = np.linalg.lstsq(rows(balls), rows(balls) @ twist, rcond=1e-9)
        if expected_rank == 3:
            assert found == pytest.approx(twist, rel=1e-7, abs=1e-7)
        else:
            assert rows(balls) @ found == pytest.approx(rows(balls) @ least, abs=1e-7)
        assert back["slip"] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_no_motion_explains_is_slip(seed: int, tmp_path: Path) -> None:
    balls = drawn(seed)
    d, rng = derivation(tmp_path, text(balls, False)), np.random.default_rng(seed)
    h = rows(balls)
    z = rng.normal(size=len(h))
    radii = [b.r for b in balls for _ in b.driven]
    names = [f"{name}.spin" for b in balls for name in b.drives]
    twist, *_ = np.linalg.lstsq(h, z, rcond=1e-9)
    out = call(d, "forward", **dict(zip(names, z / radii, strict=True)))
    if np.linalg.matrix_rank(h) == 3:
        assert [out[k] for k in ("vx", "vy", "omega")] == pytest.approx(twist, abs=1e-9)
    assert out["slip"] == pytest.approx(float(np.linalg.norm(h @ twist - z)), abs=1e-9)


def test_balls_beside_fixed_wheels_leave_their_axle_to_them(tmp_path: Path) -> None:
    """A differential drive that one ball pushes: type (2, 0), and the ball measures what the wheels do."""
    fixed = "".join(
        f"  - {{name: {n}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1, actuated: []}}\n"
        for n, y in (("left", 0.2), ("right", -0.2))
    )
    ball = Ball("ball", -0.3, 0.1, 0.04, (0.3, 1.9))
    d = derivation(tmp_path, text([ball], False, fixed))
    assert d.mobility.robot_type == (2, 0) and d.mobility.rank_C1f.value == 1
    out = call(d, "inverse", vx=0.4, vy=0.25, omega=-1.0)
    expected = spins([ball], np.array([0.4, 0.0, -1.0]))  # the axle takes vy
    assert {k: out[k] for k in expected} == pytest.approx(expected, rel=1e-12)
    back = call(d, "forward", **expected)
    assert [back[k] for k in ("vx", "vy", "omega")] == pytest.approx([0.4, 0.0, -1.0], abs=1e-12)


def test_one_direction_loses_what_it_does_not_measure(tmp_path: Path) -> None:
    """Three balls driven along lines through one point: turning about it turns none."""
    places = ((0.3, 0.0), (-0.1, 0.2), (0.1, -0.4))
    balls = [Ball(f"b{k}", x, y, 0.05, (math.atan2(y, x),)) for k, (x, y) in enumerate(places)]
    d = derivation(tmp_path, text(balls, False))
    assert [s.kind for s in d.mobility.singularities] == ["rolling_rank"]
    assert d.mobility.actuation[0].lacking == 1


def test_joints_are_named_after_the_ball(tmp_path: Path) -> None:
    one, two = Ball("one", 0, 0.2, 0.05, (0.0,)), Ball("two", 0, -0.2, 0.05, (0.0, math.pi / 2))
    none = "  - {name: idle, type: spherical, x: 1, y: 0, r: 0.02, driven: []}\n"
    rest = "couplings: [{equal: [one.spin, two_1.spin]}]\nlimits: {spin: 30}\nencoder: {spin: {counts: 100}}"
    d = derivation(tmp_path, text([one, two], False, none, rest))
    assert [w.name for w in d.robot.wheels] == ["one", "two_1", "two_2", "idle"]
    assert [w.name for w in d.robot.bodies] == ["one", "two_1", "idle"]
    assert [w.actuated for w in d.robot.wheels] == [("spin",), ("spin",), ("spin",), ()]
    assert all(w.sensed == w.actuated for w in d.robot.wheels)
    assert all(d.robot.limit_of(f"{w.name}.spin") for w in d.robot.wheels if w.has_spin)
    assert d.mobility.degree_of_mobility == 2  # one.spin = two_1.spin forbids turning


WRONG: dict[str, tuple[str, Code, str]] = {
    "parallel": ("x: 0, y: 0, r: 0.1, driven: [0, pi]", Code.VALUE, "pi]"),
    "snapped to parallel": ("x: 0, y: 0, r: 0.1, driven: [0, 0.001]", Code.VALUE, "0.001"),
    "three": ("x: 0, y: 0, r: 0.1, driven: [0, 1, 2]", Code.FORM, "2]"),
    "no radius": ("x: 0, y: 0, driven: [0]", Code.MISSING, "{name: b"),
    "heading too": ("x: 0, y: 0, r: 0.1, heading: 0, driven: [0]", Code.TWICE, "heading"),
    "no list": ("x: 0, y: 0, r: 0.1, driven: 0", Code.FORM, "0}"),
    "a length": ("x: 0, y: 0, r: 0.1, driven: [3 mm]", Code.FORM, "3 mm"),
    "no positive radius": ("x: 0, y: 0, r: 0, driven: [0]", Code.VALUE, "0, driven"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused_and_where(name: str, tmp_path: Path) -> None:
    keys, code, at = WRONG[name]
    line = f"  - {{name: b, type: spherical, {keys}}}"
    with pytest.raises(RobotFileError) as caught:
        derivation(tmp_path, f"wmrgen: 1\nname: sample\nwheels:\n{line}\n")
    error: WmrgenError = caught.value
    assert error.code is code and error.mark is not None
    assert line[error.mark.column - 1 :].startswith(at)


@pytest.mark.parametrize(
    ("wheels", "code"),
    [
        ("{name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1, driven: [0]}", Code.TWICE),
        ("{name: b_1, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}", Code.TWICE),
        (f"{{name: {'n' * 30}, type: spherical, x: 0, y: 1, r: 1, driven: [0, 1]}}", Code.NAME),
        ("{name: c_, type: spherical, x: 0, y: 1, r: 1, driven: [0, 1]}", Code.NAME),
    ],
)
def test_names_and_types_that_do_not_fit(wheels: str, code: Code, tmp_path: Path) -> None:
    ball = "  - {name: b, type: spherical, x: 0, y: 0, r: 0.1, driven: [0, 1]}"
    with pytest.raises(RobotFileError) as caught:
        derivation(tmp_path, f"wmrgen: 1\nname: sample\nwheels:\n{ball}\n  - {wheels}\n")
    assert caught.value.code is code


def test_a_coupling_of_the_ball_itself_names_no_joint(tmp_path: Path) -> None:
    ball = Ball("b", 0, 0, 0.1, (0.0, 1.0))
    with pytest.raises(RobotFileError) as caught:
        derivation(tmp_path, text([ball], False, rest="couplings: [{equal: [b.spin, b_1.spin]}]"))
    assert caught.value.code is Code.UNDECLARED


def test_other_formats_know_no_driven_ball(tmp_path: Path) -> None:
    sides = [Ball("left", 0, 0.2, 0.05, (0.0,)), Ball("right", 0, -0.2, 0.05, (0.0,))]
    d = derivation(tmp_path, text(sides, False))
    with pytest.raises(NotDerivableError):
        bodies(d.robot)
    with pytest.raises(NotDerivableError):  # it can be pushed sideways: no differential drive
        drive_with(d.robot, {"differential": "DiffDrive"}.get)


def values(found: Any) -> Array:
    return np.array([found[k] for k in ("vx", "vy", "omega")])


def test_the_texts_two_spheres_and_tribolo() -> None:
    """Siegwart, problem 3.7.2: the least-squares inverse; Tribolo: the three rows of his (3.32)-(3.34)."""
    robots = Path(__file__).resolve().parents[3] / "robots"
    d = derive(load(robots / "textbook_two_spheres.yaml"))
    joints = ("right_1", "right_2", "left_1", "left_2")
    columns = [values(call(d, "forward", **{f"{n}.spin": 1.0})) for n in joints]
    expected = [[0.05, 0, 0.05, 0], [0, 0.05, 0, 0.05], [0.125, 0, -0.125, 0]]
    assert pytest.approx(np.array(expected), abs=1e-12) == np.array(columns).T
    t = derive(load(robots / "textbook_tribolo.yaml"))
    assert t.mobility.robot_type == (3, 0) and t.mobility.actuation[0].surplus == 0
    turning = call(t, "inverse", omega=1.0)
    assert [turning[f"{n}.spin"] for n in ("left", "rear", "right")] == pytest.approx([4.0] * 3)
