"""The path of a constant twist: a straight line or a circle (Konstantinov, case of constant speeds).

    radius = |v| / |omega|,   centre = P + z x v / omega,   period = 2 pi / |omega|

On a straight line the radius is infinite. Here it ends at `FARTHEST`, with the centre that far to the left, so
that every output is finite and continuous; ``turns`` tells which of the two it is.
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.exact.number import Exact
from wmrgen.functions.motion.compose import over
from wmrgen.functions.motion.joints import driven, geometry, joint_ports
from wmrgen.functions.registry import function
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    maximum,
    number,
    root,
    select,
    signal,
    square,
    times,
)

FARTHEST = Exact(10**9)  # [m] a radius that counts as straight
SLOWEST = Exact(Fraction(1, 10**12))  # [rad/s] a yaw rate that counts as none, [m/s] a speed that does

CIRCLE = (
    ("turns", "", "1 a circle counter-clockwise, -1 clockwise, 0 a straight line or standstill"),
    ("x_centre", "m", "centre of the circle, world frame"),
    ("y_centre", "m", "centre of the circle, world frame"),
    ("radius", "m", "radius of the circle of P, at most 1e9: a straight line"),
    ("curvature", "1/m", "yaw rate over speed of P, at most 1e9 in size: turning on the spot"),
    ("period", "s", "time of one turn"),
    ("speed", "m/s", "speed of P"),
    ("direction", "rad", "direction of motion of P, from x of the robot"),
)


@function("Konstantinov, x_C, y_C and R (corrected); Tzafestas (2.43)")
def circle(robot: Robot, _: Mobility) -> Formula:
    """Sensed joint rates and the pose to the circle or straight line that they drive."""
    names = Locals()
    joints, (vx, vy, omega) = driven(robot, names)
    values = path((vx, vy, omega), names)
    left = names.define("direction_left", add(signal("theta"), values["direction"]))
    reach = names.define(
        "reach", times(select(omega, sympy.S.Zero, sympy.S.NegativeOne, sympy.S.One), values["radius"])
    )
    values["x_centre"] = add(signal("x"), times(-1, reach, sympy.sin(left)))
    values["y_centre"] = add(signal("y"), times(reach, sympy.cos(left)))
    outputs = tuple((Port(n, Role.COMMAND, unit, text), values[n]) for n, unit, text in CIRCLE)
    inputs = (*joint_ports(joints), *POSE, *geometry(joints))
    text = "circle or straight line that constant joint rates drive, steering held"
    return Formula("circle", inputs, tuple(names.items), outputs, text)


def path(twist: tuple[Expr, Expr, Expr], names: Locals) -> dict[str, Expr]:
    """turns, radius, curvature, period, speed and direction of a twist."""
    vx, vy, omega = twist
    zero, one = sympy.S.Zero, sympy.S.One
    least, far = number(SLOWEST), number(FARTHEST)
    speed = names.define("speed_of_path", root(add(square(vx), square(vy))))
    rate = names.define("rate_of_path", absolute(omega))
    turning = names.define("turning", maximum(rate, maximum(over(speed, far), least)))
    moving = names.define("moving", maximum(speed, maximum(over(rate, far), least)))
    way = select(omega, zero, sympy.S.NegativeOne, one)
    straight = maximum(over(speed, far), least)
    return {
        "turns": select(straight, rate, way, zero),
        "radius": over(speed, turning),
        "curvature": over(omega, moving),
        "period": over(2 * sympy.pi, names.define("turning_kept", maximum(rate, least))),
        "speed": speed,
        "direction": angle_of(vy, vx),
    }
