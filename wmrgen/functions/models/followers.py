"""What wheels do that follow: direction, speed and steering rate as functions of the steering coordinates.

With one freedom of driving, the velocity of every point of the body has a direction that the coordinates fix,
V = N_xy + N_omega z x A. A wheel that follows points along it (the Ackermann condition), on the side that is
nearest to its zero at straight steering.
"""

from __future__ import annotations

from wmrgen.constraints import along, driving_row, sliding_row, steer_gens
from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import sqrt_poly
from wmrgen.exact.poly import Gen, Poly, Row, dot
from wmrgen.functions.models.frame import Frame, cleaned, derivative, generic, nominal_at, straight
from wmrgen.layout.records import Wheel

MOST_TERMS = 120  # a second for their square; twice as many take five
ONE, ZERO = Poly.of(1), Poly({})


def velocity(frame: Frame, wheel: Wheel, column: Row) -> tuple[Poly, Poly]:
    """Velocity of the wheel's pivot under one column of N, robot frame [m/s per unit of eta].

    NotDerivableError where it has too many terms for its square, which directions and rates need.
    """
    g = frame.view(wheel)
    a, b, _ = cleaned((dot(along((ONE, ZERO), g), column), dot(along((ZERO, ONE), g), column), ZERO))
    terms = len(a.terms) + len(b.terms)
    if terms > MOST_TERMS:
        raise NotDerivableError(
            f"{frame.robot.name} has no model of motion that can be written out: the velocity of {wheel.name} has "
            f"{terms} terms in the parameters, more than {MOST_TERMS}.\n"
            "  Give numbers for some of the lengths and angles, or simpler expressions; inverse and forward do not "
            "need it."
        )
    return a, b


def side(frame: Frame, wheel: Wheel, at: tuple[Poly, Poly]) -> int:
    """+1 where the wheel rolls forward under +eta with its heading nearest to its zero, else -1."""
    g = wheel.nominal
    for angles in (straight, generic(frame.robot), generic(frame.robot, 1)):
        a, b = (nominal_at(p, frame.robot, angles) for p in at)
        forward = a * float(g.ch) + b * float(g.sh)
        if abs(forward) > 1e-9:
            return 1 if forward > 0 else -1
    return 1


def turned(frame: Frame, wheel: Wheel, row: Row) -> Row:
    """A row of ``wheel`` in the angle of the coordinate that turns it."""
    lead = frame.leader(wheel)
    if lead is None or lead.name == wheel.name:
        return row

    def value(gen: Gen) -> Poly | None:
        return Poly.gen(gen.kind, lead.name) if gen.kind in ("cos", "sin") else None

    return row[0].substitute(value), row[1].substitute(value), row[2].substitute(value)


def direct(frame: Frame, wheel: Wheel) -> bool:
    """True for a wheel whose heading is constant, its own state, or a coordinate."""
    return not wheel.kind.steers or frame.leader(wheel) is not None


def rim_row(frame: Frame, wheel: Wheel) -> tuple[Poly, ...]:
    """Rim speed [m/s] per unit of each eta, steering rates aside."""
    g = frame.view(wheel)
    if direct(frame, wheel):
        row = turned(frame, wheel, driving_row(wheel, g))
        return tuple(dot(row, column) for column in frame.columns)
    (column,) = frame.columns
    at = velocity(frame, wheel, column)
    speed = length(at[0] * at[0] + at[1] * at[1])
    return (speed.scale(side(frame, wheel, at)) - g.o * column[2],)


def rate_row(frame: Frame, wheel: Wheel) -> dict[str, Poly]:
    """The wheel's steering rate per unit rate of each coordinate."""
    lead = frame.leader(wheel)
    if lead is not None:
        return {lead.name: ONE}
    (column,) = frame.columns
    a, b = velocity(frame, wheel, column)
    squared = (a * a + b * b).inverse()
    found = {w.name: (a * derivative(b, w.name) - b * derivative(a, w.name)) * squared for w in frame.wheels}
    return {name: rate for name, rate in found.items() if rate}


def castor_rate(frame: Frame, wheel: Wheel, twist: Row) -> Poly:
    """-(sliding row . xi) / d (Siegwart (3.18))."""
    g = frame.view(wheel)
    return -(dot(sliding_row(wheel, g).row, twist) * g.d.inverse())


def heading_row(frame: Frame, wheel: Wheel) -> tuple[Poly, Poly]:
    """(cos, sin) of the wheel's steering angle, times a positive factor."""
    lead = frame.leader(wheel)
    if lead is not None:
        return steer_gens(lead)
    (column,) = frame.columns
    a, b = velocity(frame, wheel, column)
    g, sign = frame.view(wheel), side(frame, wheel, (a, b))
    return (a * g.ch + b * g.sh).scale(sign), (b * g.ch - a * g.sh).scale(sign)


def length(squared: Poly) -> Poly:
    """sqrt of a sum of squares; of one square of positive lengths, the length."""
    root = sqrt_poly(squared)
    if root.constant is not None or len(squared.terms) > 1:
        return root
    ((monomial, coefficient),) = squared.terms.items()
    head = sqrt_poly(Poly.of(coefficient))
    if any(e % 2 or g.kind != "param" for g, e in monomial):
        return root
    # |p| as sqrt(p**2), for a parameter of either sign.
    return head * Poly.gen("sqrt", "", Poly({monomial: Poly.of(1).terms[()]}))
