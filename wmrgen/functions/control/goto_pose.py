"""`goto_pose`: from the pose error to wheel commands by the polar feedback law (Siegwart 3.6.2).

v = k_rho rho, omega = k_alpha alpha + k_beta beta (Siegwart (3.56), (3.57)); driving backwards is the same law for
a robot that faces the other way, v -> -v, which is (3.55) as corrected. The law holds at a point that drives
(v, 0, omega): the centre of the fixed axle. When P is at the goal with heading 0, that point is at its own
place in the robot frame.
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.functions.control.drive import Reference, commands, reference
from wmrgen.functions.control.gains import TEXTBOOK, judge, nominal_gains, shown
from wmrgen.functions.registry import function
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)

AT_GOAL = number(Exact(Fraction(1, 10**9)))  # [m]: nearer counts as there: directions mean nothing, it stands
BORDER = number(Exact(Fraction(1, 10**6)))  # [rad]: so near a border of the angles counts as on it

_OUTPUTS = (
    Port("v", Role.COMMAND, "m/s", "speed forward of the axle centre"),
    Port("omega", Role.COMMAND, "rad/s", "yaw rate, counter-clockwise"),
    Port("rho", Role.COMMAND, "m", "distance to the goal"),
    Port("alpha", Role.COMMAND, "rad", "direction of the goal from the direction of driving"),
    Port("beta", Role.COMMAND, "rad", "-theta - alpha"),
    Port("direction", Role.COMMAND, "", "+1 forward, -1 backwards: keep it as the next input"),
)


@function("Siegwart (3.50)-(3.58), (3.55) corrected")
def goto_pose(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta relative to the goal, direction and present steering to every joint's command."""
    _require_stable(robot)
    ref = reference(robot, mobility, "goto_pose")
    names = Locals()
    rho, alpha, beta, way = _polar(ref, names)
    k_rho, k_alpha, k_beta = (_gain(robot, name) for name in TEXTBOOK)
    v = names.define("v_value", select(AT_GOAL, rho, times(way, k_rho, rho), sympy.S.Zero))
    omega = names.define("omega_value", add(times(k_alpha, alpha), times(k_beta, beta)))
    more, outputs = commands(robot, mobility, ref, v, omega, names)
    inputs = (
        *(Port(p.name, p.role, p.unit, f"{p.text}, goal frame") for p in _GOAL_FRAME),
        Port("direction", Role.STATE, "", "+1 forward, -1 backwards, 0: as the goal lies ahead or behind"),
        *more,
    )
    results = zip(_OUTPUTS, (v, omega, rho, alpha, beta, way), strict=True)
    return Formula(
        "goto_pose", inputs, tuple(names.items), (*outputs, *results),
        "pose relative to the goal to joint commands, polar feedback law (Siegwart (3.56)-(3.58))",
    )  # fmt: skip


_GOAL_FRAME = (
    Port("x", Role.STATE, "m", "position of P"),
    Port("y", Role.STATE, "m", "position of P"),
    Port("theta", Role.STATE, "rad", "heading"),
)


def _require_stable(robot: Robot) -> None:
    gains = nominal_gains(robot)
    verdict = judge(**gains)
    if not verdict.stable:
        raise NotDerivableError(
            f"{robot.name} has no goto_pose: gains {shown(gains)} do not stabilise it. Violated: "
            f"{', '.join(verdict.violated)} (Siegwart (3.61)-(3.64)). Under gains: write others; without any, "
            f"{shown(TEXTBOOK)} are taken."
        )


def _gain(robot: Robot, name: str) -> Expr:
    return expression(robot.gains[name].working) if name in robot.gains else number(TEXTBOOK[name])


def _polar(ref: Reference, names: Locals) -> tuple[Expr, Expr, Expr, Expr]:
    """rho, alpha, beta (Siegwart (3.50)-(3.52)) and the direction of driving.

    Bearings come from the goal seen in the robot frame, so nothing needs wrapping; a bearing of -pi is given as pi.
    """
    x, y, theta = (signal(p.name) for p in POSE)
    c, s = names.define("theta_cos", sympy.cos(theta)), names.define("theta_sin", sympy.sin(theta))
    if ref.x or ref.y:
        qx, qy = expression(ref.x), expression(ref.y)
        x = add(x, subtract(times(c, qx), times(s, qy)), times(-1, qx))
        y = add(y, add(times(s, qx), times(c, qy)), times(-1, qy))
    px, py = ref.turned(x, y, names, "axle")
    ahead = names.define("goal_ahead", times(-1, add(times(c, px), times(s, py))))
    left = names.define("goal_left", subtract(times(s, px), times(c, py)))
    rho = names.define("rho_value", root(add(square(px), square(py))))
    way = names.define("direction_value", _direction(ahead, rho))
    there = (names.define("alpha_raw", angle_of(times(way, left), times(way, ahead))),
             names.define("beta_raw", angle_of(times(way, py), times(-1, way, px))))  # fmt: skip
    alpha, beta = (
        names.define(name, select(AT_GOAL, rho, _half_open(raw), sympy.S.Zero))
        for name, raw in zip(("alpha_value", "beta_value"), there, strict=True)
    )
    return rho, alpha, beta, way


def _half_open(angle: Expr) -> Expr:
    """-pi is pi: rounding and the sign of zero must not choose the side."""
    return select(angle, add(times(-1, sympy.pi), BORDER), sympy.pi, angle)


def _direction(ahead: Expr, rho: Expr) -> Expr:
    """As commanded; 0: forward when |alpha| <= pi/2, the set I1 (Siegwart (3.54))."""
    wanted, zero, one = signal("direction"), sympy.S.Zero, sympy.S.One
    bearing = select(ahead, times(-1, BORDER, rho), sympy.S.NegativeOne, one)
    return select(zero, wanted, one, select(wanted, zero, sympy.S.NegativeOne, bearing))
