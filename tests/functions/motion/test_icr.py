"""Whether axles agree at given angles, how far they pass from a point, and the centre of a twist: plain geometry."""

from __future__ import annotations

import math
import random
from functools import cache

import pytest

from tests.functions.motion.common import derived
from wmrgen import derive
from wmrgen.functions.motion.icr import axle_distances, check_steering
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.interpret import FLOAT64, evaluate_module

WHEELS = """\
wmrgen: 1
name: several
wheels:
  - {name: one, type: steered, x: 0.9, y: 0.35, heading: 20 deg, r: 0.1}
  - {name: two, type: steered, x: -0.4, y: -0.5, heading: -70 deg, r: 0.08}
  - {name: three, type: steered, x: 0.2, y: -0.65, heading: 0, r: 0.12}
"""
FOURTH = "  - {name: four, type: steered, x: -0.6, y: 0.5, heading: 0, r: 0.1}\n"
FIXED = "  - {name: rear, type: fixed, x: -0.2, y: 0.1, heading: 100 deg, r: 0.1}\n"
FREE = """\
  - {name: tail, type: castor, x: -0.5, y: 0.3, d: 0.05, r: 0.05}
  - {name: roller, type: swedish, x: 0.5, y: 0.3, heading: 0, gamma: pi/4, r: 0.05}
  - {name: ball, type: spherical, x: 0.4, y: -0.3}
"""


def robot(text: str) -> Robot:
    return derived(text).robot


def to_centre(r: Robot, x: float, y: float) -> dict[str, float]:
    """The angles at which the axles of steered wheels meet in (x, y)."""
    result = {}
    for w in r.wheels:
        if w.kind.steers:
            towards = math.atan2(y - float(w.nominal.y), x - float(w.nominal.x)) - math.pi / 2
            result[w.name] = towards - w.heading
    return result


def test_distances_of_axles_from_a_point() -> None:
    """Of every wheel that has an axle to keep, and of no other; a wheel that is not named stands at 0."""
    r = robot(WHEELS + FIXED + FREE)
    chance = random.Random(3)
    for _ in range(5):
        steer = {name: chance.uniform(-3, 3) for name in ("one", "three")}
        x, y = chance.uniform(-2, 2), chance.uniform(-2, 2)
        distances = axle_distances(r, steer, (x, y))
        assert list(distances) == ["one", "two", "three", "rear"]
        for name, distance in distances.items():
            w = r.wheel(name)
            h = w.heading + steer.get(name, 0.0)
            wanted = (x - float(w.nominal.x)) * math.cos(h) + (y - float(w.nominal.y)) * math.sin(h)
            assert type(distance) is float and distance == pytest.approx(abs(wanted), abs=1e-12)


def test_axles_that_meet_have_no_distance_from_there() -> None:
    r = robot(WHEELS)
    assert max(axle_distances(r, to_centre(r, 1.3, -0.8), (1.3, -0.8)).values()) < 1e-12


@pytest.mark.parametrize("free", ["", FREE])
def test_axles_that_meet_have_rank_2(free: str) -> None:
    r = robot(WHEELS + FOURTH + free)
    steer = to_centre(r, 1.3, -0.8)
    check = check_steering(r, steer)
    assert (check.rank, check.mobility, check.odd) == (2, 1, ())
    for name in steer:
        check = check_steering(r, steer | {name: steer[name] + 1e-3})
        assert (check.rank, check.mobility, check.odd) == (3, 0, (name,)), "the rest meet as before"
        # Rows are told apart down to the tolerance of all ranks.
        assert check_steering(r, steer | {name: steer[name] + 1e-13}).rank == 2


def test_several_that_are_odd_are_not_named() -> None:
    r = robot(WHEELS + FOURTH)
    steer = to_centre(r, 1.3, -0.8)
    both = steer | {"one": steer["one"] + 0.1, "two": steer["two"] - 0.2}
    assert check_steering(r, both).odd == ()
    three = robot(WHEELS)
    assert len(check_steering(three, {"one": 0.1}).odd) == 3, "any two axles of three meet"


def test_a_fixed_wheel_is_never_the_odd_one() -> None:
    r = robot(WHEELS + FIXED)
    steer = to_centre(r, 1.3, -0.8)
    check = check_steering(r, steer)
    assert check.rank == 3 and check.odd == ()


def test_parallel_axles_are_rank_2_and_one_line_is_rank_1() -> None:
    r = robot(WHEELS)
    crab = {w.name: 0.7 - w.heading for w in r.wheels}
    assert check_steering(r, crab).rank == 2
    line = robot(
        "wmrgen: 1\nname: line\nwheels:\n"
        "  - {name: a, type: steered, x: 0.5, y: 0.1, heading: 0, r: 0.1}\n"
        "  - {name: b, type: steered, x: -0.5, y: 0.1, heading: 0, r: 0.1}\n"
    )
    check = check_steering(line, {"a": math.pi / 2, "b": -math.pi / 2})
    assert (check.rank, check.mobility, check.odd) == (1, 2, ())
    assert check_steering(line, {}).rank == 2


def test_what_keeps_no_axle_leaves_three_freedoms() -> None:
    check = check_steering(robot("wmrgen: 1\nname: loose\nwheels:\n" + FREE), {})
    assert (check.rank, check.mobility) == (0, 3)


@cache
def module(function: str) -> object:
    return derive(derived(WHEELS).robot, [function]).raw_module


def call(function: str, values: dict[str, float]) -> dict[str, float]:
    return {k: float(v) for k, v in evaluate_module(module(function), function, values, FLOAT64).items()}


def test_the_centre_of_a_twist_stands_still() -> None:
    chance = random.Random(8)
    for _ in range(20):
        vx, vy, omega, px, py = (chance.uniform(-2, 2) for _ in range(5))
        out = call("icr", {"vx": vx, "vy": vy, "omega": omega, "point.x": px, "point.y": py})
        x, y = out["icr.x"] / out["icr.w"], out["icr.y"] / out["icr.w"]
        assert vx - omega * y == pytest.approx(0, abs=1e-12) and vy + omega * x == pytest.approx(0, abs=1e-12)
        assert out["turns"] == math.copysign(1, omega)
        assert out["radius"] == pytest.approx(math.hypot(x, y))
        assert out["curvature"] == pytest.approx(omega / math.hypot(vx, vy))
        assert [out["point.vx"], out["point.vy"]] == pytest.approx([vx - omega * py, vy + omega * px])
        assert out["point.radius"] == pytest.approx(math.hypot(px - x, py - y))


@pytest.mark.parametrize(
    ("twist", "turns", "radius", "curvature", "point"),
    [
        ((0.3, 0.4, 0.0), 0, 1e9, 0.0, 1e9),  # a translation
        ((0.3, 0.4, 1e-10), 0, 1e9, 2e-10, 1e9),  # a circle beyond 1e9 counts as one
        ((0.3, 0.4, 1e-9), 1, 5e8, 2e-9, 5e8),
        ((0.3, 0.4, -1e-9), -1, 5e8, -2e-9, 5e8),
        ((0.0, 0.0, 0.0), 0, 0.0, 0.0, 0.0),  # standstill
        ((0.0, 0.0, 2.0), 1, 0.0, 1e9, 5.0),  # on the spot
        ((0.0, 0.0, -2.0), -1, 0.0, -1e9, 5.0),
        ((0.0, 0.0, 2e-12), 1, 0.0, 2.0, 5.0),
        ((0.0, 0.0, 5e-13), 0, 0.0, 0.5, 2.5),  # less counts as standstill
    ],
)
def test_the_edges_of_a_circle(
    twist: tuple[float, float, float], turns: int, radius: float, curvature: float, point: float
) -> None:
    out = call("icr", dict(zip(("vx", "vy", "omega"), twist, strict=True)) | {"point.x": 3.0, "point.y": 4.0})
    assert out["turns"] == turns
    assert out["radius"] == pytest.approx(radius, rel=1e-6)
    assert out["curvature"] == pytest.approx(curvature, rel=1e-6)
    assert out["point.radius"] == pytest.approx(point, rel=1e-6)
