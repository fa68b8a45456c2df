"""Flat outputs: positions whose motion determines every state and input (Fliess, Levine, Martin, Rouchon 1995).

The flat output of a robot with a fixed axle, also of a car, is the axle's centre Q. With trailers coupled on the axle
it is the last axle. Travelling forward, theta is the direction of Q', and the curvature (x' y'' - y' x'') / v**3 gives
yaw rate and steering. The flat output of a robot whose pose is free, (3, 0), is its pose; for a robot that only
translates it is its position.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, UnderivableError, function
from wmrgen.functions.system import Gate, rate_port
from wmrgen.functions.trailers.train import Steering, Train, V, train
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import POSE, TWIST, Port, output
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    norm,
    rotated,
    rotated_back,
    signal,
    square,
    subtract,
    times,
)

STANDSTILL = sympy.Rational(1, 10**6)  # [m/s] below this speed the direction of travel is undefined
_ORDERS = (("", "m", "position"), ("_rate", "m/s", "velocity"), ("_accel", "m/s^2", "acceleration"),
           ("_jerk", "m/s^3", "jerk"))  # fmt: skip


class Flatness(NamedTuple):
    """The flat outputs of a robot."""

    outputs: str  # the flat outputs in words
    order: int  # of the derivatives that state and inputs need
    text: str  # why they are flat outputs


def flatness(robot: Robot, mobility: Mobility) -> Flatness:
    """Return the flat outputs of a robot. Raise NotDerivableError if none are known."""
    kind = mobility.robot_type
    if kind == (3, 0) and not robot.trailers:
        return Flatness(
            "x, y, theta of the body", 1, "the pose is free; inputs are its velocity in the robot frame"
        )
    if kind in ((2, 1), (1, 2)) and not robot.trailers:
        return Flatness(
            "x, y, theta of the body", 2,
            "three inputs and a pose that can follow any smooth path: while their pivots move, the steered wheels have "
            "the angles that `inverse` returns for the twist; steering rates need the acceleration",
        )  # fmt: skip
    if _translates(robot, mobility):
        return Flatness(
            "x, y of the body", 2,
            "theta is constant, and while the robot moves, the wheels point along its path",
        )  # fmt: skip
    t = train(robot, mobility, what="a flat output")
    order = t.size - 1
    if t.robot.trailers:
        last = t.robot.trailers[-1].name
        return Flatness(
            f"x, y of the axle of {last}",
            order,
            f"the last axle; derivatives of its path up to order {order} determine all states and inputs",
        )
    text = "the direction of its path is the heading, the curvature gives the turning"
    return Flatness("x, y of the centre of the axle", order, text)


def _translates(robot: Robot, mobility: Mobility) -> bool:
    """Return whether a robot is a synchro drive: it only translates, in two directions (Siegwart 3.3.3)."""
    return mobility.robot_type == (1, 1) and mobility.dof == 2 and not robot.trailers


@function("ours; Tzafestas (2.66)-(2.69) solved for the inputs", reads=("trailers",))
def flat(robot: Robot, mobility: Mobility) -> Formula:
    """Return state and inputs for derivatives of the flat outputs, travelling forward; at standstill rates are 0."""
    claim = flatness(robot, mobility)
    if mobility.robot_type == (3, 0):
        return _pose(robot)
    if mobility.robot_type in ((2, 1), (1, 2)) or _translates(robot, mobility):
        raise UnderivableError(
            f"{robot.name} has the flat outputs {claim.outputs}; `inverse` returns its joints for the twist",
            Reason.FLAT_OUTPUTS,
        )
    t = train(robot, mobility, what="a flat output")
    if t.robot.trailers:
        raise UnderivableError(
            f"{robot.name} has the flat outputs {claim.outputs}; the formulas for states and inputs exist only for "
            "robots without trailers. `chained_input` steers the last axle through derivatives of its path",
            Reason.FLAT_OUTPUTS,
        )
    return _axle(robot, t, claim)


def _pose(robot: Robot) -> Formula:
    """Return the function of a (3, 0) robot: the twist of P from the rates of the pose (Siegwart (3.2))."""
    theta = signal("theta")
    rates = tuple(rate_port(p) for p in POSE)
    x, y, turn = (signal(p.name) for p in rates)
    values = (*rotated_back(sympy.cos(theta), sympy.sin(theta), x, y), turn)
    outputs = tuple(zip(TWIST, values, strict=True))
    return Formula(
        "flat", (POSE[2], *rates, *tunable_ports(robot)), (), outputs,
        "flat outputs x, y, theta: their rates to the twist of P",
    )  # fmt: skip


def _axle(robot: Robot, t: Train, claim: Flatness) -> Formula:
    """Return the function of a robot with a fixed axle."""
    names, axle = Locals(), t.axle
    dx, dy, ax, ay = (signal(n) for n in ("x_rate", "y_rate", "x_accel", "y_accel"))
    v = names.define("speed", norm(dx, dy))
    over = Gate(v, STANDSTILL).inverse(names, v, "speed_kept", "over_speed")
    cross = names.define("turning", subtract(times(dx, ay), times(dy, ax)))
    omega = names.define("yaw_rate", times(cross, over, over))
    cosine = names.define("travel_cosine", times(dx, over))
    sine = names.define("travel_sine", times(dy, over))
    # Cosine and sine of the robot's heading, from the heading of its axle.
    c, s = rotated_back(*axle.direction, cosine, sine)
    c, s = names.define("cos_theta", c), names.define("sin_theta", s)
    x, y = rotated(c, s, *axle.centre)
    twist = (*axle.velocity_of_p(v, omega), omega)
    outputs: list[tuple[Port, Expr]] = [
        (POSE[0], subtract(signal("x"), x)),
        (POSE[1], subtract(signal("y"), y)),
        (POSE[2], angle_of(s, c)),
        (V, v),
        *zip(TWIST, twist, strict=True),
    ]
    if t.steering is not None:
        kappa = names.define("curvature", times(omega, over))
        bend = _curvature_rate(names, kappa, over)
        outputs += _steering(t, t.steering, names, kappa, bend)
    text = f"flat outputs {claim.outputs} with derivatives to pose, inputs and steering, travelling forward"
    return names.formula("flat", (*_inputs(claim.order), *tunable_ports(robot)), outputs, text)


def _inputs(order: int) -> tuple[Port, ...]:
    """Return the derivatives of the flat outputs up to an order."""
    return tuple(
        output(f"{axis}{suffix}", unit, f"{what} of the flat output along world {axis}")
        for suffix, unit, what in _ORDERS[: order + 1]
        for axis in ("x", "y")
    )


def _curvature_rate(names: Locals, kappa: Expr, over: Expr) -> Expr:
    """Return kappa' = (x' y''' - y' x''') / v**3 - 3 kappa (x' x'' + y' y'') / v**2."""
    dx, dy, ax, ay = (signal(n) for n in ("x_rate", "y_rate", "x_accel", "y_accel"))
    jx, jy = signal("x_jerk"), signal("y_jerk")
    turning = times(subtract(times(dx, jy), times(dy, jx)), over, over, over)
    stretching = times(sympy.Integer(3), kappa, add(times(dx, ax), times(dy, ay)), over, over)
    return names.define("curvature_rate", subtract(turning, stretching))


def _steering(t: Train, s: Steering, names: Locals, kappa: Expr, bend: Expr) -> list[tuple[Port, Expr]]:
    """Return steering angle and rate.

    tan h = kappa X / (1 - kappa Y), with h the heading of the steered wheel's pivot; beta = h - zero heading.
    """
    port = t.steering_port
    assert port is not None
    a = names.define("pivot_along", subtract(sympy.S.One, times(kappa, expression(s.y))))
    b = names.define("pivot_across", times(kappa, expression(s.x)))
    along, across = rotated_back(expression(s.ch), expression(s.sh), a, b)
    size = names.define("pivot_squared", add(square(a), square(b)))
    rate = times(expression(s.x), bend, sympy.Pow(size, -1))  # size >= X**2 / (X**2 + Y**2)
    return [(port, angle_of(across, along)), (t.turning, rate)]
