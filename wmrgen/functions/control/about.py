"""Joint commands for a twist about another point than P, the centre of rotation: `inverse_about`.

WPILib's toSwerveModuleStates has the same point as its second argument. C is at (centre_x, centre_y) in the robot
frame, (vx, vy) is the velocity of C, and omega is the yaw rate. Then P moves at

    vx_P = vx + omega centre_y    vy_P = vy - omega centre_x

With vx = vy = 0 the robot turns about C.
"""

from __future__ import annotations

from wmrgen.analysis.kinematics import inverse
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import function
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES, Limits, Port, Role, output
from wmrgen.geometry.symbolic import add, signal, subtract, times

_CENTRE = (
    Port("centre_x", Role.COMMAND, "m", "centre of rotation, robot frame"),
    Port("centre_y", Role.COMMAND, "m", "centre of rotation, robot frame"),
)
_TWIST = (
    output("vx", "m/s", "velocity of the centre of rotation forward, robot frame"),
    output("vy", "m/s", "velocity of the centre of rotation to the left, robot frame"),
    output("omega", "rad/s", "yaw rate, counter-clockwise"),
)


@function("rigid body, Siegwart (3.2); WPILib's centerOfRotation", limits=Limits.ASKED)
def inverse_about(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands for the twist of a point of the robot and the present steering angles."""
    names = Locals()
    vx, vy, omega, x, y = (signal(p.name) for p in (*_TWIST, *_CENTRE))
    moved = {
        "vx": names.define("vx_of_p", add(vx, times(omega, y))),
        "vy": names.define("vy_of_p", subtract(vy, times(omega, x))),
    }
    formula = inverse(robot, mobility)
    commands = names.adopt(formula, moved)
    return names.formula(
        "inverse_about",
        (*_TWIST, *_CENTRE, *(p for p in formula.inputs if p.name not in TWIST_NAMES)),
        ((port, commands[port.name]) for port, _ in formula.outputs),
        "twist of a point of the robot frame, the centre of rotation, to joint commands",
    )
