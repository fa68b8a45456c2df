"""The pose of P over time: the posture model, and odometry.

A model predictive controller integrates the continuous posture model (Siegwart 3.4; Campion 1996):

    d/dt (x, y, theta) = R(theta)^T N(beta) eta,    d/dt beta = steering rates

eta, with delta_m components, are coordinates of the twist in the null space of C1. beta are the steering angles of the
wheels that determine the ICR; the other wheels follow. N is a polynomial in cosines and sines, so its Jacobian exists
everywhere.

Odometry is the exact exponential of SE(2), which is smooth at omega = 0. A constant twist moves P along an arc. With
h = omega dt / 2, the chord of the arc points along theta + h, and its length is dt sinc(h) times the speed. For
|h| < 3/64, sinc(h) = sin(h)/h is computed by its series up to h**6. The first omitted term, h**8 / 9!, is below
6.5e-17, half a unit in the last place of a double. The heading is wrapped to [-pi, pi], because a float that counts
many turns loses precision.
"""

from __future__ import annotations

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, signal_poly, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.constraints import castor_rate, working_view
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import DT, POSE, TWIST, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    Nearest,
    absolute,
    add,
    expression,
    maximum,
    select,
    signal,
    square,
    subtract,
    times,
)

# [rad] The largest h with h**8 / 9! <= 2**-53, rounded down so that a float represents it exactly.
SWITCH = sympy.Rational(3, 64)
# Of sinc, relative: the first omitted term of the series, 9! = 362880.
WORST_ERROR = float(SWITCH) ** 8 / 362880
# [s] shorter durations are replaced by this; [m] shorter chords are treated as 0.
SHORTEST = sympy.Rational(1, 10**9)


def rate_per_change(dt: Expr) -> Expr:
    """Return 1 / ``dt`` [1/s], or 0 if no time has passed."""
    return select(sympy.S.Zero, dt, 1 / maximum(dt, SHORTEST), sympy.S.Zero)


RATES = (
    Port("x_rate", Role.COMMAND, "m/s", "velocity of P along world x"),
    Port("y_rate", Role.COMMAND, "m/s", "velocity of P along world y"),
    Port("theta_rate", Role.COMMAND, "rad/s", "yaw rate"),
)


def unit_of_eta(column: Row) -> str:
    """Return the unit of the coordinate along a column of the null space."""
    return "rad/s" if column[2].constant == ONE else "m/s"


def dynamics(robot: Robot, mobility: Mobility) -> Formula:
    """Return the posture model: from x, y, theta, steering, eta and steering rates to the rates of the state."""
    names = Locals()
    columns = mobility.scaled
    etas = [
        Port(f"eta{k}", Role.COMMAND, unit_of_eta(column), f"speed along column {k} of the null space")
        for k, column in enumerate(columns, 1)
    ]
    wheels = [robot.wheel(n) for n in mobility.basis_wheels]
    twist = []
    for i in range(3):
        twist.append(Poly.sum(c[i] * signal_poly(e.name) for c, e in zip(columns, etas, strict=True)))
    called = ("vx_body", "vy_body", "omega_body")
    vx, vy, omega = (names.poly(n, p) if p else p for n, p in zip(called, twist, strict=True))
    velocity = names.turned("velocity", (expression(vx), expression(vy)), signal("theta"))
    steered = [joint_port(w, "steer_rate", Role.COMMAND) for w in wheels]
    swivels = _swivelling(robot, columns)
    swings = (expression(castor_rate(w, working_view(w), (vx, vy, omega))) for w in swivels)
    outputs = (
        *zip(RATES, (*velocity, expression(omega)), strict=True),
        *((p, signal(p.name)) for p in steered),
        *zip((joint_port(w, "steer_rate", Role.COMMAND) for w in swivels), swings, strict=True),
    )
    steers = [joint_port(w, "steer", Role.STATE) for w in (*wheels, *swivels)]
    inputs = (*POSE, *steers, *etas, *steered, *tunable_ports(robot))
    return names.formula("dynamics", inputs, outputs, "rates of pose and steering: the posture model")


def _swivelling(robot: Robot, columns: tuple[Row, ...]) -> list[Wheel]:
    """Return the castors whose angles the null space depends on. Their angles are states; they have couplings."""
    names: set[str] = set()
    for column in columns:
        for p in column:
            names |= {g.name for g in p.generators if g.kind in ("cos", "sin")}
    return [w for w in robot.wheels if w.kind.swivels and w.name in names]


def _nested(q: Expr) -> Expr:
    """Return 1 - q/6 + q**2/120 - q**3/5040 in Horner form."""
    series: Expr = sympy.Rational(1, 5040)
    for p in (120, 6, 1):
        series = subtract(sympy.Rational(1, p), q * series)
    return series


def _sinc() -> Formula:
    """Return the function sin(h)/h of an angle h [rad], which uses the series if |h| < `SWITCH`."""
    names, h = Locals(), signal("h")
    squared, size = names.define("h_squared", square(h)), names.define("h_size", absolute(h))
    series = names.define("sinc_series", _nested(squared))
    safe = names.define("h_safe", maximum(size, SWITCH))
    sinc = select(size, SWITCH, series, sympy.sin(safe) / safe)
    inputs, outputs = (Port("h", Role.STATE, "rad", ""),), ((Port("sinc", Role.COMMAND, "", ""), sinc),)
    return names.formula("sinc", inputs, outputs, "sin(h)/h, by its series up to h**6 if |h| < 3/64.")


SINC = _sinc()


def increments(names: Locals) -> tuple[Expr, Expr, Expr]:
    """Return the changes of x, y and theta in a step of dt at a constant twist."""
    theta, vx, vy, omega, dt = (signal(n) for n in ("theta", "vx", "vy", "omega", "dt"))
    h = names.define("half_turn", omega * dt / 2, "sigma")
    (sinc,) = names.call(SINC, {"h": h})
    chord = names.define("chord", dt * sinc)
    middle = names.define("middle", add(theta, h), "theta + sigma")
    c, s = sympy.cos(middle), sympy.sin(middle)
    return chord * subtract(vx * c, vy * s), chord * add(vx * s, vy * c), omega * dt


def wrapped(angle: Expr) -> Expr:
    """Return the angle wrapped to [-pi, pi]; an angle that is already in this range keeps its bits."""
    turns = Nearest(times(1 / (2 * sympy.pi), angle))
    return subtract(angle, times(2 * sympy.pi, turns))


def after(names: Locals) -> tuple[Expr, Expr, Expr]:
    """Return x, y and theta after a step of dt at a constant twist, with theta in [-pi, pi]."""
    x, y, theta = (add(signal(port.name), step) for port, step in zip(POSE, increments(names), strict=True))
    return x, y, wrapped(names.define("theta_whole", theta))


def odometry() -> Formula:
    """Return the function from x, y, theta, vx, vy, omega, dt to the pose after dt, with theta in [-pi, pi]."""
    names = Locals()
    pose = after(names)
    text = "pose after driving a constant twist for dt, heading in [-pi, pi]"
    return names.formula("odometry", (*POSE, *TWIST, DT), zip(POSE, pose, strict=True), text)


def arc() -> Formula:
    """Return `odometry` without wrapping the heading, which therefore has no jump and counts turns."""
    names = Locals()
    pose = (add(signal(port.name), step) for port, step in zip(POSE, increments(names), strict=True))
    text = "pose after driving a constant twist for dt, whole turns counted"
    return names.formula("arc", (*POSE, *TWIST, DT), zip(POSE, pose, strict=True), text)
