"""The instantaneous centre of rotation (ICR), in homogeneous coordinates that stay finite (Kelly 4.2.1).

A twist turns the body about (x, y) / w with (x, y, w) = (-vy, vx, omega) in the robot frame; w = 0 is a
translation: the centre lies at infinity in the direction (x, y), at right angles to the motion.
"""

from __future__ import annotations

import sympy

from wmrgen.functions.motion.circle import FARTHEST, SLOWEST, path
from wmrgen.functions.motion.compose import over
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals, twist_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import add, maximum, number, root, signal, square, subtract, times

POINT = (
    Port("point.x", Role.COMMAND, "m", "a point of the body, robot frame"),
    Port("point.y", Role.COMMAND, "m", "a point of the body, robot frame"),
)


def centre_ports(
    role: Role = Role.COMMAND, unit: str = "m/s", weight: str = "rad/s"
) -> tuple[Port, Port, Port]:
    """icr.x, icr.y, icr.w."""
    return (
        Port(
            "icr.x", role, unit, "homogeneous: the centre of rotation is (icr.x, icr.y) / icr.w, robot frame"
        ),
        Port(
            "icr.y", role, unit, "homogeneous: the centre of rotation is (icr.x, icr.y) / icr.w, robot frame"
        ),
        Port("icr.w", role, weight, "homogeneous weight of the centre; 0: at infinity, a translation"),
    )


@function("Kelly 4.2.1.1; Tzafestas (2.43)")
def icr(robot: Robot, _: Mobility) -> Formula:
    """Twist and a point of the body to the ICR, the curvature of P and the velocity and radius of the point."""
    del robot
    names = Locals()
    vx, vy, omega = (signal(n) for n in ("vx", "vy", "omega"))
    facts = path((vx, vy, omega), names)
    a = names.define("point_x_rate", subtract(vx, omega * signal("point.y")))
    b = names.define("point_y_rate", add(vy, omega * signal("point.x")))
    rate = names.define("rate", maximum(sympy.Abs(omega, evaluate=False), number(SLOWEST)))
    speed = names.define("point_speed", root(add(square(a), square(b))))
    turning = names.define("point_turning", maximum(rate, over(speed, number(FARTHEST))))
    centre = zip(centre_ports(), (times(-1, vy), vx, omega), strict=True)
    outputs = (
        *centre,
        (Port("turns", Role.COMMAND, "", "1 counter-clockwise, -1 clockwise, 0 translation"), facts["turns"]),
        (Port("radius", Role.COMMAND, "m", "distance of P from the centre, at most 1e9"), facts["radius"]),
        (Port("curvature", Role.COMMAND, "1/m", "yaw rate over speed of P, at most 1e9 in size"), facts["curvature"]),
        (Port("point.vx", Role.COMMAND, "m/s", "velocity of the point, robot frame"), a),
        (Port("point.vy", Role.COMMAND, "m/s", "velocity of the point, robot frame"), b),
        (Port("point.radius", Role.COMMAND, "m", "distance of the point from the centre, at most 1e9"),
         over(speed, turning)),
    )  # fmt: skip
    text = "instantaneous centre of rotation of a twist; radius and velocity of a point of the body"
    return Formula("icr", (*twist_ports(), *POINT), tuple(names.items), tuple(outputs), text)
