"""Velocities of the contact points in the robot frame (Kelly (4.39), (4.62))."""

from __future__ import annotations

from wmrgen.functions.motion.points import contact_points, point_inputs, point_port, velocities
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


@function("Kelly (4.39), (4.40), Box 4.2, (4.62)")
def contact_velocity(robot: Robot, _: Mobility) -> Formula:
    """Twist, steering angles and steering rates to the velocity of every contact point, robot frame."""
    names, points = Locals(), contact_points(robot)
    outputs = []
    for p, (a, b) in zip(points, velocities(points, names), strict=True):
        outputs.append((point_port(p.wheel, "vx", "velocity of the contact point, robot frame"), a))
        outputs.append((point_port(p.wheel, "vy", "velocity of the contact point, robot frame"), b))
    inputs = point_inputs(robot, points, theta=False, headings=False)
    text = "velocity of every contact point in the robot frame: H xi + Q steer_rate"
    return Formula("contact_velocity", inputs, tuple(names.items), tuple(outputs), text)
