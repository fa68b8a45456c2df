"""Odometry over many steps: `odometry_increment`, what a step adds to the pose.

`odometry` gives the pose after a step. In float it stands still where a step is less than half a unit in the last
place of the pose: at 100 m that is 3.8 um, the way of 3 mm/s in 1.3 ms. Whoever has a double to add in adds the
increments of each step there; only theta is needed to compute them.
"""

from __future__ import annotations

from wmrgen.functions.registry import function
from wmrgen.kinematics.pose import DT, POSE, increments
from wmrgen.kinematics.records import Formula, Locals, twist_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Limits, output

_INCREMENTS = (
    output("x_step", "m", "what the step adds to x"),
    output("y_step", "m", "what the step adds to y"),
    output("theta_step", "rad", "what the step adds to theta"),
)


@function("Konstantinov, case of constant speeds; sinc near 0 is ours", limits=Limits.MEASURED)
def odometry_increment(_: Robot, __: Mobility) -> Formula:
    """What a step at constant twist adds to x, y and theta, in the world frame."""
    names = Locals()
    outputs = zip(_INCREMENTS, increments(names), strict=True)
    text = "what driving a constant twist for dt adds to the pose, world frame"
    return names.formula("odometry_increment", (POSE[2], *twist_ports(), DT), outputs, text)
