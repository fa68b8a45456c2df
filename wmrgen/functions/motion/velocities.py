"""Velocities in the world frame, and of the contact points: v_c = H(gamma) xi + Q(gamma) gamma_dot.

The world frame turns the functions of the robot frame by the heading, xi_R = R(theta) xi_I (Siegwart (3.2), (3.10);
Tzafestas (2.37d), (2.41c), (2.75), (2.83), (2.85); Konstantinov (4), (5)).

With B the contact point and A the steering axis, in the robot frame,

    v_B = v + omega z x B + steer_rate z x (B - A)

which is a rigid body's velocity (Kelly Box 4.2, (4.39), (4.62)); Q is zero where contact and axis coincide.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.constraints import View, heading, symbolic_view, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.functions.motion.paths import include, named
from wmrgen.functions.registry import function
from wmrgen.kinematics.dynamics import RATES
from wmrgen.kinematics.forward import forward
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, given, joint_port, tunable_ports, twist_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, matrix, signal, subtract, times

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


@function("Kelly (4.39), (4.40), Box 4.2, (4.62)")
def contact_velocity(robot: Robot, _: Mobility) -> Formula:
    """Twist, steering angles and steering rates to the velocity of every contact point, robot frame."""
    names, points = Locals(), contact_points(robot)
    outputs = []
    for p, (a, b) in zip(points, velocities(points, names), strict=True):
        outputs.append((point_port(p.wheel, "vx", "velocity of the contact point, robot frame"), a))
        outputs.append((point_port(p.wheel, "vy", "velocity of the contact point, robot frame"), b))
    inputs = point_inputs(robot, points, theta=False, headings=False)
    text = "velocity of every contact point in the robot frame: H xi + Q steer_rate"
    return Formula("contact_velocity", inputs, tuple(names.items), tuple(outputs), text)


@function("Konstantinov (1)-(3), (2) corrected; Tzafestas (2.71)")
def projections(robot: Robot, _: Mobility) -> Formula:
    """Twist and heading to the contact velocities along e and n and in the world (Konstantinov (2), (3)).

    ``along`` = e . v (lambda_i), ``across`` = n . v (mu_i); for a Swedish-90 wheel the rim and the roller speed.
    """
    names, points = Locals(), contact_points(robot)
    c = names.define("cos_theta", sympy.cos(signal("theta")))
    s = names.define("sin_theta", sympy.sin(signal("theta")))
    outputs: list[tuple[Port, Expr]] = []
    for p, (a, b) in zip(points, velocities(points, names), strict=True):
        w = p.wheel
        if w.kind.directed:
            g = working_view(w)
            ex, ey = heading(w, g)
            vx, vy = Poly.gen("local", f"{w.name}_x"), Poly.gen("local", f"{w.name}_y")
            outputs += [
                (
                    point_port(w, "along", "contact velocity along the rolling direction e"),
                    expression(ex * vx + ey * vy),
                ),
                (
                    point_port(w, "across", "contact velocity along the lateral n"),
                    expression(ex * vy - ey * vx),
                ),
            ]
        outputs += [
            (point_port(w, "x_rate", "contact velocity along world x"), subtract(times(c, a), times(s, b))),
            (point_port(w, "y_rate", "contact velocity along world y"), add(times(s, a), times(c, b))),
        ]
    inputs = point_inputs(robot, points, theta=True, headings=True)
    text = "contact velocities along and across each wheel, and in the world"
    return Formula("projections", inputs, tuple(names.items), tuple(outputs), text)
