"""Degrees do not depend on the unit of length or on the position of P."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import wmrgen
from wmrgen.analysis.mobility.analyse import analyse
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout import build
from wmrgen.geometry.layout.records import Geometry, Robot, T
from wmrgen.robotfile.load import read_robot, read_text
from wmrgen.robotfile.records import Binary, Num, Quantity, RobotSpec

SCALES = (Fraction(1, 10**4), Fraction(1, 1000), Fraction(1000), Fraction(10**4))
FAR = 10_000  # [m]
ROBOTS = sorted((Path(__file__).parents[3] / "robots").glob("*.yaml"))
TOP = "wmrgen: 1\nname: robot\nsnap: false\nwheels:\n"
# A coincidence that misses by 1e-7 of the robot's size, couplings, castors that steer together.
NEARLY = {
    "axles 1e-7 apart": (
        "  - {name: a, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}\n"
        "  - {name: b, type: fixed, x: 0.0000001, y: -0.3, heading: 0, r: 0.1}\n"
    ),
    "headings 1e-6 apart": (
        "  - {name: a, type: fixed, x: 0.5, y: 0.3, heading: 0, r: 0.1}\n"
        "  - {name: b, type: fixed, x: 0.5, y: -0.3, heading: 0.000001, r: 0.1}\n"
    ),
    "a right angle in four digits": (
        "  - {name: a, type: fixed, x: 0.5, y: 0.3, heading: 1.5708, r: 0.1}\n"
        "  - {name: b, type: fixed, x: -0.5, y: 0.3, heading: -1.5708, r: 0.1}\n"
        "  - {name: c, type: steered, x: 0, y: -0.4, heading: 0, r: 0.1}\n"
    ),
    "mecanum nearly square": (
        "  - {name: a, type: swedish, x: 0.3, y: 0.3000001, heading: 0, gamma: 45 deg, r: 0.1}\n"
        "  - {name: b, type: swedish, x: 0.3, y: -0.3, heading: 0, gamma: -45 deg, r: 0.1}\n"
        "  - {name: c, type: swedish, x: -0.3, y: 0.3, heading: 0, gamma: -45 deg, r: 0.1}\n"
        "  - {name: d, type: swedish, x: -0.3, y: -0.3, heading: 0, gamma: 45 deg, r: 0.1}\n"
    ),
    "coupled": (
        "  - {name: a, type: castor, x: 0.25, y: 0, heading: 0, r: 0.1, d: -0.07}\n"
        "  - {name: b, type: castor, x: -0.3, y: 0, heading: pi, r: 0.1, d: 0.05}\n"
        "  - {name: c, type: steered, x: 0.12, y: -0.2, heading: pi/4, r: 0.1}\n"
        "couplings: [{equal: [a.steer, b.steer]}]\n"
    ),
    "coupled pairs": (
        "  - {name: a, type: steered, x: -0.3, y: 0.37, heading: -pi/3, r: 0.1}\n"
        "  - {name: b, type: castor, x: 0.12, y: 0.15, heading: pi, r: 0.1, d: -0.07}\n"
        "  - {name: c, type: castor, x: 0.3, y: 0, heading: pi, r: 0.1, d: -0.07}\n"
        "  - {name: d, type: steered, x: 0.3, y: 0.15, heading: pi, r: 0.1}\n"
        "couplings: [{equal: [a.steer, d.steer]}, {equal: [b.steer, c.steer]}]\n"
    ),
}


def scaled(spec: RobotSpec, k: Fraction) -> RobotSpec:
    """The robot with every length of a wheel k times as long."""

    def times(q: Quantity | None) -> Quantity | None:
        return None if q is None else replace(q, expr=Binary("*", Num(k), q.expr))

    keys = ("x", "y", "l", "r", "d", "offset_y", "r_sw")
    wheels = tuple(replace(w, **{key: times(getattr(w, key)) for key in keys}) for w in spec.wheels)
    return replace(spec, wheels=wheels, trailers=(), virtual=(), functions=(), cg=None)


def facts(spec: RobotSpec) -> dict[str, object]:
    m = wmrgen.derive(build(spec)).mobility
    return {
        "degrees": (m.degree_of_mobility, m.degree_of_steerability),
        "ranks": (m.rank_C1f.value, m.rank_C1.value),
        "exact": (m.rank_C1f.exact, m.rank_C1.exact), "dof": (m.ddof, m.dof), "growth": m.growth_vector,
        "type": (m.robot_type, m.degenerate, m.holonomic), "actuation": m.actuation,
        "reasons": [r.key for r in m.explanation if r.key != "rank_uncertain"],
        "singularities": [(s.kind, s.wheels) for s in m.singularities],
    }  # fmt: skip


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_degrees_of_the_gallery(path: Path) -> None:
    spec = read_robot(path)
    wanted = facts(scaled(spec, Fraction(1)))
    for k in SCALES:
        assert facts(scaled(spec, k)) == wanted, float(k)


def far(robot: Robot, distance: int = FAR) -> Robot:
    """The robot seen from a point P ``distance`` [m] behind it."""

    def moved(g: Geometry[T]) -> Geometry[T]:
        return replace(g, x=g.x + distance)

    wheels = (
        replace(w, symbolic=moved(w.symbolic), working=moved(w.working), nominal=moved(w.nominal))
        for w in robot.wheels
    )
    return replace(robot, wheels=tuple(wheels))


def degrees(m: Mobility) -> tuple[object, ...]:
    pair = m.degree_of_mobility, m.degree_of_steerability
    return *pair, m.rank_C1f.value, m.rank_C1.value, m.dof, m.growth_vector


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_degrees_of_the_gallery_from_far_away(path: Path) -> None:
    robot = build(read_robot(path))
    assert degrees(analyse(far(robot))) == degrees(analyse(robot))


@pytest.mark.parametrize("name", NEARLY)
def test_degrees_where_a_coincidence_is_missed(name: str) -> None:
    spec = read_text(TOP + NEARLY[name], "robot.yaml")
    wanted = facts(spec)
    for k in SCALES:
        assert facts(scaled(spec, k)) == wanted, float(k)


OMNI = (
    "  - {name: a, type: swedish, x: 0.2, y: 0, heading: pi/2, gamma: 0, r: 0.1}\n"
    "  - {name: b, type: swedish, x: -0.1, y: 0.17, heading: 7*pi/6, gamma: 0, r: 0.1}\n"
    "  - {name: c, type: swedish, x: -0.1, y: -0.17, heading: -pi/6, gamma: 0, r: 0.1}\n"
)


def test_forward_inverts_inverse_from_far_away() -> None:
    """The rank of the measurements does not depend on where P lies: three omni wheels, 100 km away from it."""
    derivation = wmrgen.derive(far(build(read_text(TOP + OMNI, "robot.yaml")), 10 * FAR))
    twist = {"vx": Exact(Fraction(3, 10)), "vy": Exact(Fraction(-1, 5)), "omega": Exact(Fraction(7, 10))}
    found = derivation.evaluate("forward", derivation.evaluate("inverse", twist))
    assert found == {**twist, "slip": Exact(0)}
