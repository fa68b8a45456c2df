"""Motion of contacts without a constraint: rollers of Swedish wheels, and spheres.

A roller allows the motion across the rolling direction of the wheel: r_sw roller = n_g . v_A + r spin sin gamma
(Siegwart (3.20), with the sign corrected). A sphere rolls along the velocity of its contact (Siegwart (3.21), (3.22)).
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.geometry.constraints import XI, along, rolling_direction, working_view
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import dot
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    angle_of,
    at_least,
    expression,
    norm,
    number,
    select,
    signal,
    times,
)

Outputs = list[tuple[Port, Expr]]
# Divisors of `quotient` (numbers and sines) below this are treated as 0.
TINY = number(Exact(Fraction(1, 10**12)))


def contacts(robot: Robot) -> Formula | None:
    """Return the function from vx, vy, omega to roller rates and the rolling of spheres; None if there are neither.

    Rollers need ``r_sw`` in the robot file, spheres ``r``.
    """
    names = Locals()
    outputs: Outputs = []
    for w in robot.wheels:
        if w.kind.rollers and w.nominal.r_sw:
            outputs.append(_roller(w))
        if w in robot.bodies and (w.ball or not w.kind.directed) and w.nominal.r:
            outputs += _sphere(w, w.ball or w.name, names)
    if not outputs:
        return None
    text = "twist of P in the robot frame to roller rates and the rolling of spheres"
    return names.formula("contacts", (*TWIST, *tunable_ports(robot)), outputs, text)


def _roller(w: Wheel) -> tuple[Port, Expr]:
    """Return (n_g . v_A + tan gamma e_g . v_A) / r_sw, with e_g the rolling direction rotated by gamma."""
    g = working_view(w)
    e = rolling_direction(w, g)
    across = dot(along((-e[1], e[0]), g), XI)
    drive = dot(along(e, g), XI) * g.sg * g.cg.inverse()
    text = "roller rate, positive moves the hub along the roller's own rolling direction n_gamma"
    port = Port(f"{w.name}.roller", Role.COMMAND, "rad/s", text)
    return port, expression((across + drive) * g.r_sw.inverse())


def _sphere(w: Wheel, name: str, names: Locals) -> Outputs:
    """Return the direction of the contact's velocity [rad, robot frame] and the roll rate along it [rad/s]."""
    g, (vx, vy) = working_view(w), pivot(w, XI)
    a = names.define(f"{name}_x", vx, f"v_Ax of {name}")
    b = names.define(f"{name}_y", vy, f"v_Ay of {name}")
    direction = Port(f"{name}.direction", Role.COMMAND, "rad", "direction of rolling, from x")
    roll = Port(f"{name}.roll", Role.COMMAND, "rad/s", "rate of rolling")
    return [(direction, angle_of(b, a)), (roll, times(expression(g.r.inverse()), norm(a, b)))]


def quotient(names: Locals, name: str, above: Expr, below: Expr) -> Expr:
    """Divide two expressions, with a result of 0 for a divisor of about 0, so that derivatives are finite.

    Args:
        names: Collects intermediate results.
        name: The name of the quotient.
        above: The numerator.
        below: The divisor.

    Returns:
        The symbol of above / below, which is 0 if |below| <= 1e-12.
    """
    divisor = names.define(f"{name}_divisor", at_least(below, TINY))
    return names.define(name, select(TINY, absolute(below), above / divisor, sympy.S.Zero))


def mecanum_roller() -> Formula:
    """Return the function for the roller sizes of a mecanum wheel, Tzafestas (2.86)-(2.91); 0 if impossible."""
    inputs = (
        Port("radius", Role.COMMAND, "m", "radius R of the wheel"),
        Port("count", Role.COMMAND, "", "number of rollers"),
        Port("angle", Role.COMMAND, "rad", "hub axis to roller axis; 90 deg for an omni wheel"),
    )
    R, count, alpha = (signal(port.name) for port in inputs)
    names = Locals()
    half = names.define("half", R * sympy.sin(quotient(names, "step", sympy.pi, count)))
    length = quotient(names, "length", 2 * half, sympy.sin(alpha))
    outputs = (
        (Port("length", Role.COMMAND, "m", "roller length D_r"), length),
        (Port("width", Role.COMMAND, "m", "width d of the wheel"), length * sympy.cos(alpha)),
        (Port("half_chord", Role.COMMAND, "m", "half the chord b between neighbouring rollers"), half),
    )
    text = "length and width of the rollers of a mecanum wheel, Tzafestas (2.86)-(2.91)"
    return names.formula("mecanum_roller", inputs, outputs, text)
