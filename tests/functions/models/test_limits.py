"""Limits of a robot file in a model: bounds of x and u, and of h(x, u, p), against velocities of contact points."""

from __future__ import annotations

from math import inf
from typing import Any

import casadi
import numpy as np
import pytest

from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.geometry.layout.records import Robot, Wheel

LIMITS = (
    "limits: {vx: 2, vy: 1, omega: [-3, 2.5], vx_rate: 4, spin: 9, steer: [-1, 0.9], steer_rate: [-2, 1.5]}"
)
FOUR = f"""\
wmrgen: 1
name: four
parameters: {{base: {{value: 1.2, tunable: true}}}}
{LIMITS}
%s
wheels:
  - {{name: a, type: steered, x: base, y: 0.3, heading: 0, r: 0.2, offset_y: 0.05}}
  - {{name: b, type: steered, x: 0.1, y: -0.4, heading: 0, r: 0.25}}
  - {{name: c, type: steered, x: -1, y: 0.2, heading: 0.2, r: 0.2, offset_y: -0.04, limits: {{steer_rate: 1}}}}
"""
CAR = f"""\
wmrgen: 1
name: car
{LIMITS}
%s
wheels:
  - {{name: left, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.3}}
  - {{name: right, type: fixed, x: 0, y: -0.4, heading: 0, r: 0.3}}
  - {{name: front_left, type: steered, x: 1.1, y: 0.4, heading: 0, r: 0.3, actuated: [steer], limits: {{spin: 12}}}}
  - {{name: front_right, type: steered, x: 1.1, y: -0.4, heading: 0, r: 0.3, actuated: [steer]}}
"""
VIRTUAL = "virtual: [{name: front, steers: [front_left, front_right]}, {name: rear, drives: [left, right]}]\n"
LAG = "lag: {steer: 0.3}"
ON_AXLE = CAR.partition("  - {name: front_left")[0] + (
    "  - {name: mid, type: steered, x: 0, y: 0.1, heading: 0.2, r: 0.3, actuated: [steer]}\n"
)
TWINS = f"""\
wmrgen: 1
name: twins
{LIMITS}
wheels:
  - {{name: a, type: steered, x: 0.5, y: 0.1, heading: 0, r: 0.1}}
  - {{name: b, type: steered, x: 0.5, y: 0.1, heading: 0.2, r: 0.1}}
"""
CASTORS = f"""\
wmrgen: 1
name: castors
{LIMITS}
wheels:
  - {{name: a, type: castor, x: 0.3, y: 0.2, d: -0.05, r: 0.05, actuated: [spin, steer]}}
  - {{name: b, type: castor, x: -0.3, y: -0.2, d: -0.05, r: 0.05, actuated: [spin, steer]}}
"""


def moving(
    robot: Robot, f: casadi.Function, entries: dict[str, Any], x: np.ndarray, u: np.ndarray
) -> dict[str, float]:
    """What the robot does by the rates of its model, by contract names: pivots and headings, no formula of ours."""
    p = [entry["nominal"] for entry in entries["p"]]
    state = [entry["name"] for entry in entries["x"]]

    def twist_at(at: np.ndarray) -> tuple[complex, float, np.ndarray]:
        rates = f(at, u, p).full().ravel()
        return complex(rates[0], rates[1]) * np.exp(-1j * at[2]), rates[2], rates

    def angle(w: Wheel, at: np.ndarray) -> float:
        if f"{w.name}.steer" in state:
            return float(at[state.index(f"{w.name}.steer")])
        v, omega, _ = twist_at(at)
        direction = np.angle((v + 1j * omega * w.pivot) / w.zero_heading)
        return float(direction - np.pi * np.round(direction / np.pi))

    v, omega, rates = twist_at(x)
    result = {"vx": v.real, "vy": v.imag, "omega": omega}
    for w in robot.wheels:
        steer, steer_rate = 0.0, 0.0
        if w.turns:
            steer = angle(w, x)
            ends = [angle(w, x + sign * 1e-6 * rates) for sign in (1, -1)]
            steer_rate = (ends[0] - ends[1]) / 2e-6
            result |= {f"{w.name}.steer": steer, f"{w.name}.steer_rate": steer_rate}
        heading = w.zero_heading * np.exp(1j * steer)
        contact = v + 1j * omega * w.pivot + 1j * (omega + steer_rate) * float(w.nominal.o) * 1j * heading
        rolls = heading * np.exp(1j * w.gamma)  # square to the axes of rollers
        result[f"{w.name}.spin"] = (contact / rolls).real / float(w.nominal.r) / np.cos(w.gamma)
    return result


def keeps(robot: Robot, does: dict[str, float]) -> bool:
    """Whether all limits of the robot file hold."""
    limits = {name: limit for name, limit in robot.limits.items() if name in does}
    for w in robot.wheels:
        limits |= {f"{w.name}.{q}": v for q in ("spin", "steer", "steer_rate") if (v := robot.limit(w, q))}
    return all(float(v.low) <= does[name] <= float(v.high) for name, v in limits.items())


def bounded(entries: list[dict[str, Any]], values: np.ndarray) -> bool:
    return all(
        (-inf if e["lower"] is None else e["lower"]) <= v <= (inf if e["upper"] is None else e["upper"])
        for e, v in zip(entries, values, strict=True)
    )


@pytest.mark.parametrize(
    ("robot", "form", "names"),
    [
        pytest.param(FOUR % "", "posture", "vx vy omega b.spin c.spin b.steer b.steer_rate", marks=pytest.mark.slow),
        pytest.param(
            FOUR % LAG, "posture", "vx vy omega b.spin c.spin a.steer_rate b.steer_rate c.steer_rate b.steer",
            marks=pytest.mark.slow,
        ),
        pytest.param(FOUR % "", "eta", "vx vy omega a.spin b.spin c.spin b.steer b.steer_rate", marks=pytest.mark.slow),
        (FOUR % LAG, "twist", "a.spin b.spin c.spin a.steer_rate b.steer_rate c.steer_rate"),
        (CAR % "", "posture", "vx omega right.spin front_left.spin front_right.steer_rate"),
        (CAR % "", "twist", "left.spin right.spin front_left.spin"),
        (
            CAR % LAG + VIRTUAL, "posture",
            "vx omega left.spin right.spin front_left.spin front_left.steer_rate front_right.steer_rate",
        ),
        (ON_AXLE % "", "posture", "vx omega mid.steer"),
        (
            CAR % "" + ON_AXLE.splitlines(True)[-1], "posture",
            "vx omega right.spin front_left.spin front_right.steer_rate mid.steer",
        ),
        (TWINS, "posture", "vx vy omega a.spin b.spin a.steer a.steer_rate"),
        (CASTORS, None, "a.spin b.spin a.steer_rate b.steer_rate"),
        ("kuka_youbot", None, "vx vy omega br.spin"),
        ("textbook_tricycle", None, "vx omega"),
        ("wpilib_swervebot", None, "front_left.spin front_right.spin back_left.spin back_right.spin"),
        ("agilex_ranger", None, ""),
    ],
)  # fmt: skip
def test_a_model_keeps_its_limits_where_the_robot_does(robot: str, form: str | None, names: str) -> None:
    """What is neither state nor input is a function of both, with the values of moving contacts; bounds of x, u and h
    hold at random points exactly where all limits of the file do."""
    d = of_gallery(robot) if robot in ROBOTS else of_text(robot)
    f, h, entries = d.state_space(form), d.limits(form), d.entries(form)
    limits = [entry["name"] for entry in entries["limits"]]
    assert sorted(limits) == sorted(names.split()) and not entries["absent_limits"] and bool(h) == bool(names)
    p = [entry["nominal"] for entry in entries["p"]]
    random, seen = np.random.default_rng(2), set()
    for share in np.geomspace(0.005, 1, 15):
        x, u = (share * random.uniform(-most, most, f.size1_in(i)) for i, most in enumerate((0.9, 20)))
        does = moving(d.robot, f, entries, x, u)
        values = h(x, u, p).full().ravel() if h else np.array([])
        assert values == pytest.approx([does[name] for name in limits], rel=1e-6, abs=1e-6)
        every = [entry for key in ("x", "u", "limits") for entry in entries[key]]
        kept = keeps(d.robot, does)
        assert bounded(every, np.concatenate([x, u, values])) == kept
        seen.add(kept)
    assert seen == {True, False}


def test_what_a_model_has_no_variable_for_is_named() -> None:
    """Angles of idle castors are no states of the twist form, so their own limits are none of its: they are named."""
    idle = CASTORS.replace(
        "actuated: [spin, steer]}", "actuated: [], limits: {spin: 9, steer: 1, steer_rate: 2}}"
    )
    entries = of_text(idle).entries("twist")
    assert entries["absent_limits"] == [
        "a.spin",
        "b.spin",
        "a.steer",
        "a.steer_rate",
        "b.steer",
        "b.steer_rate",
    ]
    entries = of_text(CASTORS).entries("posture")
    assert not entries["absent_limits"] and [e["name"] for e in entries["limits"]]


def test_how_fast_joints_may_change_is_in_every_form() -> None:
    """At entries of u and h; a joint that has such a limit alone is one of h, without bounds. Coupled ones share it."""
    more = "spin_rate: 30, steer_acceleration: [-4, 5]"
    wheels = (CAR % "").replace("steer_rate: [-2, 1.5]}", f"steer_rate: [-2, 1.5], {more}}}")
    wheels = wheels.replace("limits: {spin: 12}", "limits: {spin: 12, spin_rate: 3}")
    entries = of_text(wheels).entries("posture")
    rates = {
        e["name"]: (e["rate_lower"], e["rate_upper"])
        for key in ("u", "limits")
        for e in entries[key]
        if "rate_lower" in e
    }
    assert rates == {
        "left.spin": (-30, 30), "right.spin": (-30, 30), "front_left.spin": (-3, 3), "vx": (-4, 4),
        "front_left.steer_rate": (-4, 5), "front_right.steer_rate": (-4, 5),
    }  # fmt: skip
    alone = of_text(wheels.replace("spin: 9, ", "").replace("spin: 12, ", "")).entries("twist")
    spins = [e for e in alone["limits"] if e["name"].endswith(".spin")]
    assert [e["name"] for e in spins] == ["left.spin", "right.spin", "front_left.spin"]
    assert all(e["lower"] is None and e["rate_upper"] > 0 for e in spins)
    robot = of_text(wheels).robot
    limit = robot.limit_of("front_left.spin_rate")
    assert limit is not None and (float(limit.low), float(limit.high)) == (-3, 3)
    coupled = (
        "couplings: [{equal: [left.spin, right.spin], ratios: [1, -2]}]\nlimits: {spin_rate: 8}\nwheels:"
    )
    robot = of_text((CAR % "").replace(LIMITS, "").replace("wheels:", coupled)).robot
    low, high = ((v.low, v.high) if (v := robot.limit(w, "spin_rate")) else None for w in robot.wheels[:2])
    assert (low, high) == ((-4, 4), (-8, 8))


def test_how_fast_a_twist_may_change_stands_at_the_twist() -> None:
    limits = of_text(CAR % "").entries("posture")["limits"]
    assert (limits[0]["rate_lower"], limits[0]["rate_upper"]) == (-4, 4)
    assert [e["name"] for e in limits if "rate_lower" in e] == ["vx"]


@pytest.mark.parametrize("zero", [0, 90, -90, 180, 60])
@pytest.mark.parametrize("back", [0, 180])
def test_bounds_turn_with_the_zero_of_steering(zero: int, back: int) -> None:
    """Wheels that are mounted turned, with limits by as much less, steer as before: their coordinate is as much less,
    also where they roll backwards. What is square to the way at its zero goes straight on at 90 and at -90 degrees:
    the limits say at which."""

    def bounds(zero: int, back: int) -> np.ndarray:
        wheels = [
            f"  - {{name: {name}, type: steered, x: {x}, y: {y}, heading: {zero + back} deg, r: 0.3, "
            f"limits: {{steer: [{-most - zero} deg, {most - zero} deg]}}}}\n"
            for name, x, y, most in (("a", 1, 0.5, 80), ("b", 1.5, -0.5, 70))
        ]
        left = "{name: left, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.3}"
        virtual = "virtual: [{name: front, steers: [a, b]}]"
        text = f"wmrgen: 1\nname: car\n{virtual}\nwheels:\n  - {left}\n{''.join(wheels)}"
        angle = of_text(text).entries("posture")["x"][3]
        return np.array([angle["lower"], angle["upper"]])

    straight = bounds(0, 0)
    assert bounds(zero, back) == pytest.approx(straight - np.radians(zero))
    assert straight[0] < 0 < straight[1]


def test_limits_that_no_angle_keeps_are_told() -> None:
    """Of two wheels that steer as one, mirrored: 0.3 rad of one is about 0.25 rad of the other, never -0.3."""
    text = (CAR % "").replace("limits: {spin: 12}", "limits: {steer: [0.3, 0.5]}")
    entries = of_text(text.replace("[steer]}", "[steer], limits: {steer: [-0.5, -0.3]}}")).entries("posture")
    (angle,) = [e for e in entries["x"] if e["name"].endswith(".steer")]
    assert angle["lower"] > angle["upper"]
    assert angle["name"] in entries["text"].split("; ")[-1]


@pytest.mark.parametrize("away", [0, 10_000, 100_000])
def test_a_wheel_on_a_slanting_axle_line_bounds_no_coordinate(away: int) -> None:
    """Its angle is the same in every motion, also where P is so far that doubles round its place by more."""

    def wheel(name: str, kind: str, ahead: float, aside: float) -> str:
        x = f"{away} + {ahead}*cos(pi/6) - {aside}/2"
        y = f"{away} + {ahead}/2 + {aside}*cos(pi/6)"
        limits = ", limits: {steer: 0.5}" * (name == "mid")
        return f"  - {{name: {name}, type: {kind}, x: {x}, y: {y}, heading: 30 deg, r: 0.3{limits}}}\n"

    wheels = (
        wheel("left", "fixed", 0, 0.4) + wheel("mid", "steered", 0, 0.1) + wheel("front", "steered", 1.1, 0)
    )
    entries = of_text(f"wmrgen: 1\nname: slanting\nwheels:\n{wheels}").entries("posture")
    assert entries["x"][3]["name"] == "front.steer" and entries["x"][3]["upper"] is None
    assert [(e["name"], e["upper"]) for e in entries["limits"]] == [("mid.steer", 0.5)]
