"""Inverse and forward kinematics in the world frame: the robot-frame ones, turned by the heading.

xi_R = R(theta) xi_I        (Siegwart (3.2), (3.10); Tzafestas (2.37d), (2.41c), (2.75), (2.83), (2.85);
                             Konstantinov (4), (5))
"""

from __future__ import annotations

import sympy

from wmrgen.functions.motion.compose import include, named
from wmrgen.functions.registry import function
from wmrgen.kinematics.dynamics import RATES
from wmrgen.kinematics.forward import forward
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.symbolic import Expr, add, signal, subtract, times

TWIST = ("vx", "vy", "omega")


def _turn(names: Locals) -> tuple[Expr, Expr]:
    theta = signal("theta")
    return names.define("cos_theta", sympy.cos(theta)), names.define("sin_theta", sympy.sin(theta))


@function("Siegwart (3.2); Tzafestas (2.41c), (2.75) corrected, (2.85); Konstantinov (4)")
def inverse_world(robot: Robot, mobility: Mobility) -> Formula:
    """theta, world velocity and present steering to every joint's command."""
    names = Locals()
    c, s = _turn(names)
    a, b, omega = (signal(p.name) for p in RATES)
    vx = names.define("vx_robot", add(times(c, a), times(s, b)))
    vy = names.define("vy_robot", subtract(times(c, b), times(s, a)))
    formula = inverse(robot, mobility)
    found = include(formula, {"vx": vx, "vy": vy, "omega": omega}, names)
    inputs = (POSE[2], *RATES, *(p for p in formula.inputs if p.name not in TWIST))
    outputs = tuple((port, found[port.name]) for port, _ in formula.outputs)
    text = "velocity of P in the world frame to joint commands"
    return Formula("inverse_world", inputs, tuple(names.items), outputs, text, calls=tuple(names.calls))


@function("Siegwart (3.9), (3.10); Tzafestas (2.37d), (2.83); Konstantinov (5)")
def forward_world(robot: Robot, _: Mobility) -> Formula:
    """theta and sensed joint rates to the velocity in the world frame and ``slip``."""
    names = Locals()
    c, s = _turn(names)
    formula = forward(robot)
    found = include(formula, {}, names)
    vx, vy, omega = named(found, TWIST, "robot", names)
    outputs = (
        (RATES[0], subtract(times(c, vx), times(s, vy))),
        (RATES[1], add(times(s, vx), times(c, vy))),
        (RATES[2], omega),
        *((port, found[port.name]) for port, _ in formula.outputs if port.name == "slip"),
    )
    text = "sensed joint rates to the velocity of P in the world frame, least squares"
    return Formula("forward_world", (POSE[2], *formula.inputs), tuple(names.items), outputs, text)
