"""Velocities of the contact points: v_c = H(gamma) xi + Q(gamma) gamma_dot (Kelly Box 4.2, (4.39), (4.62)).

With B the contact point and A the steering axis, in the robot frame,

    v_B = v + omega z x B + steer_rate z x (B - A)

which is a rigid body's velocity; Q is zero where contact and axis coincide.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.constraints import View, heading, symbolic_view, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Locals, given, joint_port, tunable_ports, twist_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, matrix

ZERO, ONE = Poly({}), Poly.of(1)


@dataclass(frozen=True, slots=True)
class ContactPoint:
    """Contact B of a wheel. ``rows``: H, velocity along x and y per twist; ``swing``: Q, the same per steering rate."""

    wheel: Wheel
    rows: tuple[Row, Row]
    swing: tuple[Poly, Poly]

    @property
    def swings(self) -> bool:
        """True where steering moves the contact point."""
        return any(self.swing)


def contact_points(robot: Robot, view: View = working_view) -> tuple[ContactPoint, ...]:
    """The contact of every wheel, in the order of the file; couplings are not applied."""
    points = []
    for w in robot.wheels:
        g = view(w)
        c, s = heading(w, g)
        ax, ay = g.d * c - g.o * s, g.d * s + g.o * c
        swing = (-ay, ax) if w.turns else (ZERO, ZERO)
        points.append(ContactPoint(w, ((ONE, ZERO, -(g.y + ay)), (ZERO, ONE, g.x + ax)), swing))
    return tuple(points)


def matrices(robot: Robot, view: View) -> tuple[list[Row], list[list[Poly]]]:
    """H (2N x 3) and Q (2N x steering joints): rows x, y of each wheel, columns of Q in wheel order."""
    points = contact_points(robot, view)
    turning = [p.wheel.index for p in points if p.wheel.turns]
    H = [row for p in points for row in p.rows]
    Q = [
        [value if k == p.wheel.index else ZERO for k in turning]
        for p in points
        for value in p.swing
    ]  # fmt: skip
    return H, Q


def twist_matrix(robot: Robot) -> sympy.Matrix:
    """H, 2N x 3, every named parameter a symbol."""
    return matrix(matrices(robot, symbolic_view)[0], 3)


def steering_matrix(robot: Robot) -> sympy.Matrix:
    """Q, 2N x M for M wheels that turn, every named parameter a symbol."""
    return matrix(matrices(robot, symbolic_view)[1], sum(w.turns for w in robot.wheels))


def velocities(points: tuple[ContactPoint, ...], names: Locals) -> list[tuple[Expr, Expr]]:
    """(x, y) velocity of every contact in the robot frame, named."""
    twist: Row = (given("vx"), given("vy"), given("omega"))
    result = []
    for p in points:
        rate = given(f"{p.wheel.name}.steer_rate") if p.swings else ZERO
        a, b = (dot(row, twist) + k * rate for row, k in zip(p.rows, p.swing, strict=True))
        result.append((names.define(f"{p.wheel.name}_x", a), names.define(f"{p.wheel.name}_y", b)))
    return result


def point_inputs(
    robot: Robot, points: tuple[ContactPoint, ...], theta: bool, headings: bool
) -> tuple[Port, ...]:
    """Twist, the steering angles that matter, the rates of contacts that swing."""
    ports = [*twist_ports()]
    if theta:
        ports.append(POSE[2])
    for p in points:
        if p.swings or (headings and p.wheel.turns):
            ports.append(joint_port(p.wheel, "steer", Role.STATE))
        if p.swings:
            ports.append(joint_port(p.wheel, "steer_rate", Role.COMMAND))
    return (*ports, *tunable_ports(robot))


def point_port(w: Wheel, name: str, text: str) -> Port:
    """A component [m/s] of the velocity of a contact."""
    return Port(f"{w.name}.{name}", Role.COMMAND, "m/s", text)
