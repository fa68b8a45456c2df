"""Odometry: the exact SE(2) exponential, smooth through omega = 0.

A constant twist moves P along an arc whose chord points along theta + h and is dt sinc(h) times the velocity,
h = omega dt / 2. sinc(h) = sin(h)/h, and for |h| < 1/20 its series to h**6: the first term left out,
h**8 / 9!, is then below 1.08e-16, half a unit in the last place of a double.
"""

from __future__ import annotations

import sympy

from wmrgen.kinematics.records import Formula, Locals, twist_ports
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, absolute, add, maximum, select, signal, subtract

SWITCH = sympy.Rational(1, 20)  # largest h with h**8 / 9! <= 2**-53, rounded down
WORST_ERROR = float(SWITCH) ** 8 / 362880

POSE = (
    Port("x", Role.STATE, "m", "position of P in the world frame"),
    Port("y", Role.STATE, "m", "position of P in the world frame"),
    Port("theta", Role.STATE, "rad", "heading of the robot, counter-clockwise from world x"),
)


def _nested(q: Expr) -> Expr:
    """1 - q/6 + q**2/120 - q**3/5040, nested."""
    series: Expr = sympy.Rational(1, 5040)
    for p in (120, 6, 1):
        series = subtract(sympy.Rational(1, p), q * series)
    return series


def odometry() -> Formula:
    """x y theta vx vy omega dt to the pose after dt."""
    names = Locals()
    x, y, theta, vx, vy, omega, dt = (signal(n) for n in ("x", "y", "theta", "vx", "vy", "omega", "dt"))
    h = names.define("half_turn", omega * dt / 2)
    q, size = names.define("half_turn_squared", h**2), names.define("half_turn_size", absolute(h))
    series = names.define("sinc_series", _nested(q))
    safe = names.define("half_turn_safe", maximum(size, SWITCH))
    sinc = select(size, SWITCH, series, sympy.sin(safe) / safe)
    chord = names.define("chord", dt * sinc)
    middle = names.define("middle", add(theta, h))
    c, s = sympy.cos(middle), sympy.sin(middle)
    outputs = (
        (POSE[0], add(x, chord * subtract(vx * c, vy * s))),
        (POSE[1], add(y, chord * add(vx * s, vy * c))),
        (POSE[2], add(theta, omega * dt)),
    )
    inputs = (*POSE, *twist_ports(), Port("dt", Role.COMMAND, "s", "duration of the step"))
    return Formula(
        "odometry", inputs, tuple(names.items), outputs, "pose after driving a constant twist for dt"
    )
