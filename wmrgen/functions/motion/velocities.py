"""Velocities in the world frame, and of contact points, which may slip: v_c = H(gamma) xi + Q(gamma) gamma_dot.

Functions of the world frame are functions of the robot frame rotated by the heading, xi_R = R(theta) xi_I (Siegwart
(3.2), (3.10); Tzafestas (2.37d), (2.41c), (2.75), (2.83), (2.85); Konstantinov (4), (5)).

With B the contact point and A the steering axis, in the robot frame,

    v_B = v + omega z x B + steer_rate z x (B - A)

which is a rigid body's velocity (Kelly Box 4.2, (4.39), (4.62)). Q is zero if contact and axis coincide. With e the
present rolling direction of a wheel and n = z x e, wheels that slip satisfy (Tzafestas Example 2.2, corrected for
steered wheels)

    r spin = e . v_B + slip_x,     slip_y = n . v_B
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.forward import forward
from wmrgen.analysis.kinematics.inverse import inverse
from wmrgen.analysis.kinematics.pose import RATES
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, signal_poly, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.motion.paths import named_twist
from wmrgen.functions.registry import function
from wmrgen.geometry.constraints import (
    XI,
    View,
    arm,
    heading,
    rolling_row,
    sliding_row,
    symbolic_view,
    working_view,
)
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import POSE, TWIST, TWIST_NAMES, Limits, Port, Role, output
from wmrgen.geometry.symbolic import Expr, expression, matrix, rotated, rotated_back, signal

ZERO, ONE = Poly({}), Poly.of(1)


def _turn(names: Locals) -> tuple[Expr, Expr]:
    """Return cosine and sine of the heading as intermediate results."""
    theta = signal("theta")
    return names.define("cos_theta", sympy.cos(theta)), names.define("sin_theta", sympy.sin(theta))


@function("Siegwart (3.2); Tzafestas (2.41c), (2.75) corrected, (2.85); Konstantinov (4)")
def inverse_world(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands for theta, the world velocity and the present steering angles."""
    names = Locals()
    a, b, omega = (signal(p.name) for p in RATES)
    vx, vy = rotated_back(*_turn(names), a, b)
    twist = {"vx": names.define("vx_robot", vx), "vy": names.define("vy_robot", vy), "omega": omega}
    formula = inverse(robot, mobility)
    commands = names.adopt(formula, twist)
    return names.formula(
        "inverse_world",
        (POSE[2], *RATES, *(p for p in formula.inputs if p.name not in TWIST_NAMES)),
        ((port, commands[port.name]) for port, _ in formula.outputs),
        "velocity of P in the world frame to joint commands",
    )


@function("Siegwart (3.9), (3.10); Tzafestas (2.37d), (2.83); Konstantinov (5)")
def forward_world(robot: Robot, _: Mobility) -> Formula:
    """Return the velocity in the world frame and ``slip`` for theta and sensed joint rates."""
    names = Locals()
    c, s = _turn(names)
    formula = forward(robot)
    values = names.adopt(formula, {})
    vx, vy, omega = named_twist(values, "robot", names)
    slip = tuple((port, values[port.name]) for port, _ in formula.outputs if port.name == "slip")
    return names.formula(
        "forward_world",
        (POSE[2], *formula.inputs),
        (*zip(RATES, (*rotated(c, s, vx, vy), omega), strict=True), *slip),
        "sensed joint rates to the velocity of P in the world frame, least squares",
    )


class ContactPoint(NamedTuple):
    """Contact B of a wheel."""

    wheel: Wheel
    rows: tuple[Row, Row]  # H: velocity along x and y per twist
    swing: tuple[Poly, Poly]  # Q: velocity along x and y per steering rate

    @property
    def swings(self) -> bool:
        """Return whether steering moves the contact point."""
        return any(self.swing)


def contact_points(robot: Robot, view: View = working_view) -> tuple[ContactPoint, ...]:
    """Return the contact of every wheel, in the order of the file; couplings are not applied."""
    points = []
    for w in robot.wheels:
        g = view(w)
        ax, ay = arm(g, *heading(w, g))
        swing = (-ay, ax) if w.turns else (ZERO, ZERO)
        points.append(ContactPoint(w, ((ONE, ZERO, -(g.y + ay)), (ZERO, ONE, g.x + ax)), swing))
    return tuple(points)


def twist_matrix(robot: Robot) -> sympy.Matrix:
    """Return H, 2N x 3: rows x, y of each wheel, with every named parameter as a symbol."""
    return matrix([row for p in contact_points(robot, symbolic_view) for row in p.rows], 3)


def steering_matrix(robot: Robot) -> sympy.Matrix:
    """Return Q, 2N x M for the M wheels that turn, in wheel order, with every named parameter as a symbol."""
    turning = [w for w in robot.wheels if w.turns]
    points = contact_points(robot, symbolic_view)
    rows = []
    for p in points:
        for entry in p.swing:
            rows.append([entry if w is p.wheel else ZERO for w in turning])
    return matrix(rows, len(turning))


def velocities(points: tuple[ContactPoint, ...], names: Locals) -> list[tuple[Poly, Poly]]:
    """Return the (x, y) velocity of every contact in the robot frame, as intermediate results."""
    result = []
    for p in points:
        rate = signal_poly(f"{p.wheel.name}.steer_rate") if p.swings else ZERO
        a, b = (dot(row, XI) + k * rate for row, k in zip(p.rows, p.swing, strict=True))
        result.append((names.poly(f"{p.wheel.name}_x", a), names.poly(f"{p.wheel.name}_y", b)))
    return result


def _joints(points: tuple[ContactPoint, ...], headings: bool) -> Iterator[Port]:
    """Yield angle and rate of the joints that swing a contact; with ``headings`` the angles of all that turn."""
    for p in points:
        if p.swings or (headings and p.wheel.turns):
            yield joint_port(p.wheel, "steer", Role.STATE)
        if p.swings:
            yield joint_port(p.wheel, "steer_rate", Role.COMMAND)


@function("Kelly (4.39), (4.40), Box 4.2, (4.62)", contacts=True)
def contact_velocity(robot: Robot, _: Mobility) -> Formula:
    """Return the velocity of every contact point, robot frame, for a twist, steering angles and rates."""
    names, points = Locals(), contact_points(robot)
    text = "velocity of the contact point, robot frame"
    outputs = []
    for p, velocity in zip(points, velocities(points, names), strict=True):
        for component, value in zip(("vx", "vy"), velocity, strict=True):
            outputs.append((output(f"{p.wheel.name}.{component}", "m/s", text), expression(value)))
    return names.formula(
        "contact_velocity",
        (*TWIST, *_joints(points, headings=False), *tunable_ports(robot)),
        outputs,
        "velocity of every contact point in the robot frame: H xi + Q steer_rate",
    )


@function("Konstantinov (1)-(3), (2) corrected; Tzafestas (2.71)", contacts=True)
def projections(robot: Robot, _: Mobility) -> Formula:
    """Return the contact velocities along e and n and in the world for a twist and heading (Konstantinov (2), (3)).

    ``along`` = e . v (lambda_i), ``across`` = n . v (mu_i); for a Swedish-90 wheel the rim speed and the roller speed.
    """
    names, points = Locals(), contact_points(robot)
    c, s = _turn(names)
    outputs: list[tuple[Port, Expr]] = []
    for p, (vx, vy) in zip(points, velocities(points, names), strict=True):
        w = p.wheel
        parts: list[tuple[str, str, Expr]] = []
        if w.kind.directed:
            ex, ey = heading(w, working_view(w))
            parts += [
                ("along", "the rolling direction e", expression(ex * vx + ey * vy)),
                ("across", "the lateral n", expression(ex * vy - ey * vx)),
            ]
        a, b = rotated(c, s, expression(vx), expression(vy))
        parts += [("x_rate", "world x", a), ("y_rate", "world y", b)]
        outputs += [
            (output(f"{w.name}.{name}", "m/s", f"contact velocity along {direction}"), value)
            for name, direction, value in parts
        ]
    return names.formula(
        "projections",
        (*TWIST, POSE[2], *_joints(points, headings=True), *tunable_ports(robot)),
        outputs,
        "contact velocities along and across each wheel, and in the world",
    )


def _slip_port(w: Wheel, name: str) -> Port:
    """Return the port ``<wheel>.slip_x`` or ``<wheel>.slip_y``."""
    if w.kind.rollers:
        text = "slip along the roller axis: rim speed minus velocity of the contact"
    elif name == "slip_x":
        text = "longitudinal slip: rim speed minus speed of the contact along the rolling direction"
    else:
        text = "lateral slip: velocity of the contact to the left of the rolling direction"
    return output(f"{w.name}.{name}", "m/s", text)


@function("Tzafestas Example 2.2, corrected for steered wheels", limits=Limits.COMMANDED, contacts=True)
def slip_inverse(robot: Robot, _: Mobility) -> Formula:
    """Return every wheel's spin and every standard wheel's slip_y for a twist, steering and slip_x.

    The twist is not projected: the wheels slip where they cannot roll.
    """
    inputs = [*TWIST]
    inputs += [joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.turns]
    inputs += [joint_port(w, "steer_rate", Role.COMMAND) for w in robot.wheels if _swings(w)]
    outputs: list[tuple[Port, Expr]] = []
    for w in robot.wheels:
        g = working_view(w)
        rate = signal_poly(f"{w.name}.steer_rate") if _swings(w) else Poly({})
        if w.has_spin:
            inputs.append(_slip_port(w, "slip_x"))
            rim = dot(rolling_row(w, g).row, XI) - g.steer_arm * rate + signal_poly(f"{w.name}.slip_x")
            spin = expression(rim * g.rolling_radius.inverse())
            outputs.append((joint_port(w, "spin", Role.COMMAND), spin))
        if w.kind.sliding_row:
            lateral = dot(sliding_row(w, g).row, XI) + g.d * rate
            outputs.append((_slip_port(w, "slip_y"), expression(lateral)))
    return Formula(
        "slip_inverse", (*inputs, *tunable_ports(robot)), (), tuple(outputs),
        "twist of P, steering and longitudinal slip to wheel speeds and lateral slip",
    )  # fmt: skip


def _swings(w: Wheel) -> bool:
    """Return whether the steering rate moves the contact."""
    return w.turns and bool(w.nominal.d or w.nominal.steer_arm)
