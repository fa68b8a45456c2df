"""slip = 0 promises rolling: the commanded joints, fed back, leave no residual."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.oracle import oracle
from tests.oracle.harness import Model, named

BELT = """wmrgen: 1
name: belt
wheels:
  - {name: a, type: steered, x: 0.3, y: 0.2, heading: 0, r: 0.1}
  - {name: b, type: steered, x: -0.3, y: 0.1, heading: 0.5, r: 0.12}
couplings: [{equal: [a.steer, b.steer]}]
"""
CAR_ON_A_BELT = """wmrgen: 1
name: car
wheels:
  - {name: a, type: steered, x: 0.3, y: 0.2, heading: 0, r: 0.1}
  - {name: b, type: steered, x: 0.3, y: -0.2, heading: 0, r: 0.1}
  - {name: c, type: fixed, x: -0.3, y: 0.2, heading: 0, r: 0.1}
  - {name: d, type: fixed, x: -0.3, y: -0.2, heading: 0, r: 0.1}
couplings: [{equal: [a.steer, b.steer]}]
"""
LIMITED = """wmrgen: 1
name: limited
wheels:
  - {name: a, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1, limits: {steer: [-30 deg, 30 deg]}}
  - {name: b, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}
"""
LOCKED_PAIR = """wmrgen: 1
name: locked_pair
wheels:
  - {name: a, type: swedish, x: 0.3, y: 0.2, heading: 0, gamma: pi/4, r: 0.1}
  - {name: b, type: swedish, x: -0.3, y: 0.2, heading: 0, gamma: -pi/4, r: 0.1}
  - {name: c, type: swedish, x: 0.3, y: -0.2, heading: 0, gamma: -pi/4, r: 0.1}
  - {name: d, type: swedish, x: -0.3, y: -0.2, heading: 0, gamma: pi/4, r: 0.1}
couplings: [{equal: [a.spin, b.spin]}]
"""
ROBOTS = {"belt": BELT, "car on a belt": CAR_ON_A_BELT, "limited": LIMITED}


@pytest.mark.parametrize("name", ROBOTS)
def test_no_slip_told_means_rolling(tmp_path: Path, name: str) -> None:
    model = Model.of(ROBOTS[name], tmp_path)
    rng = np.random.default_rng(7)
    for _ in range(40):
        joints = model.call("inverse", named([rng.uniform(-1, 1), 0.0, rng.uniform(-3, 3)]))
        slip = joints.pop("slip")
        if slip < 1e-9:
            assert model.call("forward", joints)["slip"] == pytest.approx(0.0, abs=1e-8)


def test_a_forbidden_twist_is_projected(tmp_path: Path) -> None:
    """A robot of type (2, 0), whose coupling forbids a twist, is driven as the nearest one: all its wheels agree."""
    model = Model.of(LOCKED_PAIR, tmp_path)
    assert model.derivation.mobility.robot_type == (2, 0)
    joints = model.call("inverse", named([1.0, 0.2, 0.5]))
    assert joints.pop("slip") > 0.01
    assert model.call("forward", joints)["slip"] == pytest.approx(0.0, abs=1e-9)


# Offsets and radii [m] of two wheels on one pivot; the inverse may reuse the spin of a first wheel without offset.
TWINS = [
    ((0.0, 0.05), (0.1, 0.1)),
    ((0.05, 0.0), (0.1, 0.1)),
    ((0.0, 0.0), (0.1, 0.12)),
    ((0.05, -0.02), (0.1, 0.1)),
    ((0.04, 0.04), (0.1, 0.12)),
]


@pytest.mark.parametrize(("offsets", "radii"), TWINS)
def test_twin_wheels_of_one_motor_roll_each_at_its_own_speed(
    tmp_path: Path, offsets: tuple[float, float], radii: tuple[float, float]
) -> None:
    """Their contacts are at different places of one axle, so that each spin follows from its own contact's velocity."""
    twins = "".join(
        f"  - {{name: {n}, type: steered, x: 0.4, y: 0.1, heading: 0, r: {r}, offset_y: {o}}}\n"
        for n, r, o in zip("ab", radii, offsets, strict=True)
    )
    rear = "  - {name: c, type: steered, x: -0.3, y: 0, heading: 0, r: 0.1}\n"
    text = f"wmrgen: 1\nname: twins\nwheels:\n{twins}{rear}couplings: [{{equal: [a.steer, b.steer]}}]\n"
    model = Model.of(text, tmp_path)
    rng = np.random.default_rng(3)
    for _ in range(20):
        twist = rng.uniform(-1, 1, 3)
        joints = model.call("inverse", named(twist))
        assert joints.pop("slip") == pytest.approx(0.0, abs=1e-9)
        assert joints["a.steer"] == joints["b.steer"]
        for name, r, o in zip("ab", radii, offsets, strict=True):
            heading = joints[f"{name}.steer"]
            e, n = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
            velocity = oracle.point_velocity(np.array([0.4, 0.1]) + o * n, twist)
            assert joints[f"{name}.spin"] == pytest.approx(float(e @ velocity) / r, abs=1e-9)
