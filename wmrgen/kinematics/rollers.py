"""The rollers of a mecanum wheel: sizes from the wheel's radius, their number and their angle (Tzafestas 2.4.4)."""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.exact.number import Exact
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, absolute, at_least, number, select, signal

TINY = number(Exact(Fraction(1, 10**12)))


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
    return Formula("mecanum_roller", inputs, tuple(names.items), outputs, text)
