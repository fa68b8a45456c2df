"""The continuous posture model (Siegwart 3.4; Campion (1996)): what a model predictive controller integrates.

    d/dt (x, y, theta) = R(theta)^T N(beta) eta,    d/dt beta = steering rates

eta (as many as delta_m) are coordinates of the twist in the null space of C1; beta are the steering angles of
the wheels that choose the ICR, the others follow. N is polynomial in cosines and sines: its Jacobian exists
everywhere.
"""

from __future__ import annotations

import sympy

from wmrgen.constraints import sliding_row, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract

RATES = (
    Port("x_rate", Role.COMMAND, "m/s", "velocity of P along world x"),
    Port("y_rate", Role.COMMAND, "m/s", "velocity of P along world y"),
    Port("theta_rate", Role.COMMAND, "rad/s", "yaw rate"),
)


def dynamics(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta, steering, eta and steering rates to the rates of the state."""
    names = Locals()
    columns = mobility.null_space
    etas = [
        Port(f"eta{k + 1}", Role.COMMAND, "", f"coordinate along column {k + 1} of the null space")
        for k in range(len(columns))
    ]
    wheels = [robot.wheel(n) for n in mobility.basis_wheels]
    twist: list[Expr] = []
    for i, name in enumerate(("vx_body", "vy_body", "omega_body")):
        value = Poly.sum(
            column[i] * Poly.gen("input", e.name) for column, e in zip(columns, etas, strict=True)
        )
        twist.append(names.define(name, value) if value else sympy.S.Zero)
    theta = signal("theta")
    c, s = sympy.cos(theta), sympy.sin(theta)
    steered = [joint_port(w, "steer_rate", Role.COMMAND) for w in wheels]
    swivels = _swivelling(robot, columns)
    outputs = (
        (RATES[0], subtract(twist[0] * c, twist[1] * s)),
        (RATES[1], add(twist[0] * s, twist[1] * c)),
        (RATES[2], twist[2]),
        *((p, signal(p.name)) for p in steered),
        *((joint_port(w, "steer_rate", Role.COMMAND), _swivel_rate(w, names)) for w in swivels),
    )
    steers = [joint_port(w, "steer", Role.STATE) for w in (*wheels, *swivels)]
    inputs = (*POSE, *steers, *etas, *steered, *tunable_ports(robot))
    return Formula(
        "dynamics", inputs, tuple(names.items), outputs, "rates of pose and steering: the posture model"
    )


def _swivelling(robot: Robot, columns: tuple[Row, ...]) -> list[Wheel]:
    """Castors whose angle the null space depends on (coupled ones): states that the motion turns."""
    seen = {g.name for column in columns for p in column for g in p.generators if g.kind in ("cos", "sin")}
    return [w for w in robot.wheels if w.kind.swivels and w.name in seen]


def _swivel_rate(w: Wheel, names: Locals) -> Expr:
    """-(sliding row . xi) / d (Siegwart (3.18))."""
    g = working_view(w)
    defined = {symbol.name for symbol, _ in names.items}
    twist = [Poly.gen("local", n) if n in defined else Poly({}) for n in ("vx_body", "vy_body", "omega_body")]
    slide = dot(sliding_row(w, g).row, (twist[0], twist[1], twist[2]))
    return expression(-(slide * g.d.inverse()))
