"""What the unconstrained contacts do: rollers of Swedish wheels, whose sizes a design gives, and spheres.

A roller takes up what the wheel does not: r_sw roller = n_g . v_A + r spin sin gamma (Siegwart (3.20), corrected
sign). A sphere rolls along the velocity of its contact (Siegwart (3.21), (3.22)).
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
TINY = number(Exact(Fraction(1, 10**12)))


def contacts(robot: Robot) -> Formula | None:
    """vx vy omega to roller rates and the rolling of spheres; None where the robot has neither.

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
    """(n_g . v_A + tan gamma e_g . v_A) / r_sw, e_g the rolling direction turned by gamma."""
    g = working_view(w)
    e = rolling_direction(w, g)
    across = dot(along((-e[1], e[0]), g), XI)
    drive = dot(along(e, g), XI) * g.sg * g.cg.inverse()
    text = "roller rate, positive moves the hub along the roller's own rolling direction n_gamma"
    port = Port(f"{w.name}.roller", Role.COMMAND, "rad/s", text)
    return port, expression((across + drive) * g.r_sw.inverse())


def _sphere(w: Wheel, name: str, names: Locals) -> Outputs:
    """Direction of the contact's velocity [rad, robot frame] and the roll rate along it [rad/s]."""
    g = working_view(w)
    a, b = (
        names.define(f"{name}_{axis}", part, f"v_A{axis} of {name}")
        for axis, part in zip("xy", pivot(w, XI), strict=True)
    )
    return [
        (Port(f"{name}.direction", Role.COMMAND, "rad", "direction of rolling, from x"), angle_of(b, a)),
        (
            Port(f"{name}.roll", Role.COMMAND, "rad/s", "rate of rolling"),
            times(expression(g.r.inverse()), norm(a, b)),
        ),
    ]


def quotient(names: Locals, name: str, above: Expr, below: Expr) -> Expr:
    """above / below, 0 where |below| <= 1e-12; the divisor is kept off zero, and derivatives are finite."""
    divisor = names.define(f"{name}_divisor", at_least(below, TINY))
    return names.define(name, select(TINY, absolute(below), above / divisor, sympy.S.Zero))


def mecanum_roller() -> Formula:
    """Tzafestas (2.86)-(2.91): sizes of the rollers of a mecanum wheel; 0 for an impossible design."""
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
