"""Angles that were meant to be special: 1.57 for pi/2.

An unsnapped 1.57 turns a differential drive into a robot that cannot move. Within 1e-3 rad of a
multiple of pi/12 an angle is taken as that multiple, and a note says so; a little farther away a note
says that it was kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from wmrgen.exact.evaluate import angle_value, number, parameters_in, pi_multiple, pi_rational
from wmrgen.exact.poly import Poly

TOLERANCE = Fraction(1, 1000)
SUSPICIOUS = Fraction(1, 200)  # nearer than this, but not snapped: 3.14 for pi
_SAME = Fraction(1, 10**35)


def snap(
    angle: Poly, values: Mapping[str, Poly], tunable: frozenset[str], what: str
) -> tuple[Poly, str | None]:
    """The angle, or the multiple of pi/12 it stands for, and the note that says so.

    An angle that depends on a tunable parameter is left alone: it is an input.
    """
    if parameters_in(angle) & tunable:
        return angle, None
    exact = pi_multiple(angle_value(angle, values))
    if exact is not None and (12 * exact).denominator == 1:
        return angle, None
    value = number(angle, values).rational()
    step = pi_rational() / 12
    k = round(value / step)
    error = abs(value - k * step)
    if error >= TOLERANCE:
        if error >= SUSPICIOUS:
            return angle, None
        return (
            angle,
            f"{what}: {float(value):.12g} rad is {float(error):.2g} rad from {pi_text(k)}, kept as written",
        )
    snapped = Poly.gen("pi").scale(Fraction(k, 12))
    if error < _SAME:
        return snapped, None
    return snapped, f"{what}: {float(value):.12g} rad taken as {pi_text(k)} ({float(error):.2g} rad away)"


def pi_text(k: int) -> str:
    """k pi/12 in words a reader would write: pi/2, -3*pi/4, 0."""
    f = Fraction(k, 12)
    if not f:
        return "0"
    head = {1: "pi", -1: "-pi"}.get(f.numerator, f"{f.numerator}*pi")
    return head if f.denominator == 1 else f"{head}/{f.denominator}"
