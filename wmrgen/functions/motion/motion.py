"""The pose after constant joint rates: a straight line or an arc (Konstantinov, case of constant speeds)."""

from __future__ import annotations

from wmrgen.functions.motion.compose import include
from wmrgen.functions.motion.joints import driven, geometry, joint_ports
from wmrgen.functions.registry import function
from wmrgen.kinematics.odometry import POSE, odometry
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


@function("Konstantinov, case of constant speeds; Tzafestas (2.36), (2.38) integrated")
def motion(robot: Robot, _: Mobility) -> Formula:
    """Sensed joint rates held for dt: the pose after it, exactly (a straight line or an arc)."""
    names = Locals()
    joints, twist = driven(robot, names)
    ride = odometry()
    end = include(ride, dict(zip(("vx", "vy", "omega"), twist, strict=True)), names)
    outputs = tuple((port, end[port.name]) for port in POSE)
    inputs = (*joint_ports(joints), *POSE, ride.inputs[-1], *geometry(joints))
    text = "pose after holding constant joint rates for dt, steering held"
    return Formula("motion", inputs, tuple(names.items), outputs, text)
