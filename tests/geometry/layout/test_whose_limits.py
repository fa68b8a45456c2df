"""The robot's limits apply to every commanded joint; a passive joint has only the limits of its own wheel."""

from __future__ import annotations

import pytest

from tests.robotfile.files import read
from tests.robots import of_text
from wmrgen.geometry.layout import build

WHEELS = """\
wmrgen: 1
name: mixed
limits: {{vx: 1, omega: 1, spin: 15, steer: 1.5, steer_rate: 2}}
wheels:
  - {{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}}
  - {{name: idle, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1, actuated: [], sensed: [spin]{own}}}
  - {{name: front, type: steered, x: 0.4, y: 0, heading: 0, r: 0.1, actuated: []}}
  - {{name: tail, type: castor, x: -0.3, y: 0, d: 0.05, r: 0.025, sensed: [spin, steer]}}
  - {{name: motor, type: castor, x: -0.3, y: 0.1, d: 0.05, r: 0.1, actuated: [spin, steer]}}
"""
QUANTITIES = ("spin", "steer", "steer_rate")


@pytest.mark.parametrize(
    ("name", "limited"),
    [
        ("left", {"spin"}),
        ("idle", set()),
        ("front", {"steer", "steer_rate"}),  # its angle is chosen, whoever turns it
        ("tail", set()),
        ("motor", {"spin", "steer", "steer_rate"}),
    ],
)
def test_the_joints_that_the_limits_of_the_robot_bound(name: str, limited: set[str]) -> None:
    robot = build(read(WHEELS.format(own="")))
    assert {q for q in QUANTITIES if robot.limit(robot.wheel(name), q) is not None} == limited


def test_a_wheel_may_name_the_limit_of_its_passive_joint() -> None:
    robot = build(read(WHEELS.format(own=", limits: {spin: 30}")))
    limit = robot.limit(robot.wheel("idle"), "spin")
    assert limit is not None and float(limit.high) == 30


def test_a_wheel_coupled_to_a_driven_one_keeps_its_limit() -> None:
    robot = build(read(WHEELS.format(own="") + "couplings: [{equal: [left.spin, idle.spin]}]\n"))
    assert robot.limit(robot.wheel("idle"), "spin") == robot.limit(robot.wheel("left"), "spin")


def test_a_passive_joint_may_turn_as_fast_as_the_twist_requires() -> None:
    """A 25 mm castor at 1 m/s turns at 40 rad/s, which the checked `forward` must take."""
    text = WHEELS.format(own="").partition("  - {name: front")[0] + WHEELS.splitlines()[-2].format() + "\n"
    robot = of_text(text)
    declared = robot.bounds.declared
    assert "left.spin" in declared and "tail.spin" not in declared and "tail.steer" not in declared
    (forward,) = (f for f in robot.bounds.functions if f.name == "forward")
    assert forward.inputs["tail.spin"][1] > 40
