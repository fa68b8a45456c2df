"""The line along which a pivot moves, as a joint angle: headings count modulo a half turn.

A steered wheel rolls along its pivot's velocity (a, b) forwards or backwards, so only the line matters. With the
size s = sqrt(a**2 + b**2), half the angle of the line has the tangent +-b / (s + |a|), its sign that of a: it lies in
[-1, 1], from one quotient and one arctangent, and nothing cancels. The divisor is kept above `STILL`, so that whoever
reads the C, an analyser too, sees that it is not zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import mpmath
import sympy

from wmrgen.constraints import along, working_view
from wmrgen.exact.evaluate import PRECISION, add_angles, circle_point, to_fraction, to_mpf, twelfths
from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Wheel
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    arctangent,
    expression,
    maximum,
    number,
    root,
    square,
    subtract,
    times,
    with_sign_of,
)

Velocity = tuple[Poly, Poly]
STILL = Exact(Fraction(1, 10**20))  # m/s


@dataclass(frozen=True, slots=True)
class Line:
    """``heading``: joint angle [rad] of one direction of the line, that in which the pivot moves where a >= 0.

    ``size``: of the velocity [m/s]. Up to `STILL` the pivot counts as standing, and there is no heading.
    """

    heading: Expr
    size: Expr


def line(a: Expr, b: Expr, zero: Expr, names: Locals, name: str) -> Line:
    """The line of the velocity (a, b) [m/s] in a frame at the angle ``zero`` [rad] short of the joint's zero."""
    size = names.define(f"{name}size", root(add(square(a), square(b))))
    kept = names.define(f"{name}kept", maximum(number(STILL), size))
    slope = names.define(f"{name}slope", b / add(kept, absolute(a)))
    heading = times(with_sign_of(sympy.Integer(2), a), arctangent(slope))
    return Line(subtract(heading, zero), size)


def pivot(w: Wheel, twist: Row) -> Velocity:
    """Velocity of the pivot A in the robot frame [m/s]."""
    g = working_view(w)
    one, zero = Poly.of(1), Poly({})
    return dot(along((one, zero), g), twist), dot(along((zero, one), g), twist)


def short(names: Locals, name: str, value: Poly) -> Expr:
    """A sum gets a name; a single term stays."""
    return names.define(name, value) if len(value.terms) > 1 else expression(value)


def turned_by(w: Wheel, velocity: Velocity, angle: Exact = ZERO) -> Velocity:
    """The velocity along and across the wheel at joint angle ``angle``."""
    g = working_view(w)
    c, s = g.ch, g.sh
    if angle:
        cosine, sine = circle_point(angle.rational())
        c, s = add_angles((c, s), (Poly.of(cosine), Poly.of(sine)))
    return velocity[0] * c + velocity[1] * s, velocity[1] * c - velocity[0] * s


def near_zero(w: Wheel, velocity: Velocity) -> tuple[Velocity, Expr]:
    """The velocity in a frame at a fixed angle [rad] short of the wheel's zero, and that angle.

    Turning by a quarter is free and by a tunable angle there is no other way. By any other the velocity is left in
    the robot frame, where its cancelling terms have the plain coordinates of the pivot for factors.
    """
    g = working_view(w)
    c, s = g.ch.constant, g.sh.constant
    if c is None or s is None or not (c and s):
        return turned_by(w, velocity), sympy.S.Zero
    for k in range(24):
        if twelfths(k) == (c, s):
            return velocity, times(sympy.Rational(k if k <= 12 else k - 24, 12), sympy.pi)
    with mpmath.workdps(PRECISION):
        angle = mpmath.atan2(to_mpf(s.rational()), to_mpf(c.rational()))
    return velocity, number(Exact(to_fraction(angle)))
