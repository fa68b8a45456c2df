"""Formulas of peers, written down from their sources, against inverse, forward and the state space at random values."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from tests.robots import of_text

CHANCE = random.Random(19)
TRACK, BASE, R = 0.62, 1.13, 0.17


def car() -> str:
    rear = "".join(f"  - {{name: r{s}, type: fixed, x: 0, y: {y}, heading: 0, r: {R}}}\n" for s, y in SIDES)
    front = "".join(
        f"  - {{name: f{s}, type: steered, x: {BASE}, y: {y}, heading: 0, r: {R}, actuated: [steer]}}\n"
        for s, y in SIDES
    )
    return f"wmrgen: 1\nname: peer\nwheels:\n{rear}{front}"


SIDES = (("l", TRACK / 2), ("r", -TRACK / 2))


def test_commands_of_ackermann_steering_of_ros2_controllers() -> None:
    """steering_controllers_library/src/steering_kinematics.cpp: `get_commands`, and its odometry back."""
    kinematics = of_text(car()).numpy()
    for _ in range(20):
        v, phi = CHANCE.choice((-1, 1)) * CHANCE.uniform(0.2, 2), CHANCE.uniform(-0.9, 0.9)
        omega, turning = v * math.tan(phi) / BASE, BASE / math.tan(phi)
        expected = {
            "rl.spin": v / R * (turning - TRACK / 2) / turning,
            "rr.spin": v / R * (turning + TRACK / 2) / turning,
        }
        for name, sign in (("fl.steer", -1), ("fr.steer", 1)):
            ahead = 2 * BASE * math.cos(phi) + sign * TRACK * math.sin(phi)
            expected[name] = math.atan2(2 * BASE * math.sin(phi), ahead)
        found = kinematics.inverse(vx=v, vy=0.0, omega=omega, fl_steer=0.0, fr_steer=0.0)
        assert {n: float(found[n]) for n in expected} == pytest.approx(expected, abs=1e-12)
        back = kinematics.forward(**{n.replace(".", "_"): value for n, value in expected.items()})
        assert (back["vx"], back["omega"], back["slip"]) == pytest.approx((v, omega, 0), abs=1e-12)


def test_modules_of_wpilib_about_any_centre_of_rotation() -> None:
    """wpimath SwerveDriveKinematics: `toSwerveModuleVelocities` with a centre, `toChassisVelocities` of any modules."""
    places = [(0.31, 0.27), (0.29, -0.33), (-0.4, 0.1), (-0.22, -0.35)]
    lines = [
        f"  - {{name: m{k}, type: steered, x: {x}, y: {y}, heading: 0, r: 1}}"
        for k, (x, y) in enumerate(places)
    ]
    kinematics = of_text("\n".join(["wmrgen: 1", "name: peer", "wheels:", *lines, ""])).numpy()
    now = {f"m{k}_steer": 0.0 for k in range(4)}
    rows = np.array([row for x, y in places for row in ([1, 0, -y], [0, 1, x])])
    for _ in range(20):
        vx, vy, omega, cx, cy = (CHANCE.uniform(-2, 2) for _ in range(5))
        found = kinematics.inverse(vx=vx + omega * cy, vy=vy - omega * cx, omega=omega, **now)
        for k, (x, y) in enumerate(places):
            module = found[f"m{k}.spin"] * np.exp(1j * found[f"m{k}.steer"])
            assert module == pytest.approx(complex(vx - omega * (y - cy), vy + omega * (x - cx)), abs=1e-12)
        speeds, angles = ([CHANCE.uniform(-3, 3) for _ in places] for _ in range(2))
        moved = np.array(
            [s * f(a) for s, a in zip(speeds, angles, strict=True) for f in (math.cos, math.sin)]
        )
        measured = {
            f"m{k}_{n}": v for n, each in (("spin", speeds), ("steer", angles)) for k, v in enumerate(each)
        }
        twist = kinematics.forward(**measured)
        assert [twist[n] for n in ("vx", "vy", "omega")] == pytest.approx(
            np.linalg.lstsq(rows, moved)[0], abs=1e-9
        )


def test_ackermann_kinematics_of_matlab() -> None:
    """ackermannKinematics of the Robotics System Toolbox: x' = v cos(theta), theta' = v tan(psi) / wheel base."""
    lines = (
        f"  - {{name: rear, type: fixed, x: 0, y: 0, heading: 0, r: {R}}}",
        f"  - {{name: front, type: steered, x: {BASE}, y: 0, heading: 0, r: {R}, actuated: [steer]}}",
    )
    ode = of_text("\n".join(["wmrgen: 1", "name: peer", "wheels:", *lines, ""])).state_space()
    for _ in range(10):
        theta, psi, v, rate = (CHANCE.uniform(-1.3, 1.3) for _ in range(4))
        found = np.array(ode([5, -3, theta, psi], [v / R, rate], [])).ravel()
        expected = [v * math.cos(theta), v * math.sin(theta), v / BASE * math.tan(psi), rate]
        assert found == pytest.approx(expected, abs=1e-12)
