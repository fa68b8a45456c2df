"""How far a twist may go in one step so that steered wheels can follow: the cone of `setpoint`.

See `wmrgen.functions.control.setpoint` for the inequality. A wheel whose steering stop is in the way has no cone to go
through: it `brakes` until it stands, and then `waits`, its pivot no faster than `CREEP`, until it has turned the other
way.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.constraints import working_view
from wmrgen.exact.evaluate import add_angles, circle_point
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly, Row
from wmrgen.kinematics.pivots import Velocity
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.steer import QUARTER, pivot
from wmrgen.kinematics.steer_groups import seen_from
from wmrgen.layout.records import Interval, Wheel
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    expression,
    maximum,
    minimum,
    number,
    select,
    signal,
    subtract,
    times,
    with_sign_of,
)

HALF_TURN = QUARTER * 2
CREEP = Exact(Fraction(1, 10**5))  # m/s: thirty times what a float resolves of a pivot that stands at 3 m/s
_LEAST = Exact(Fraction(1, 10**20))  # m/s: a wheel that is out of its cone holds the twist
_ZERO = sympy.S.Zero


class Unit(NamedTuple):
    """Wheels that one motor steers, whose pivots move alike. ``rate`` and ``stops``: limits of steering."""

    lead: Wheel
    members: list[Wheel]
    rate: Interval | None
    stops: Interval | None


def named_pivot(w: Wheel, twist: Row, when: str, names: Locals) -> Velocity:
    """The velocity of a wheel's pivot at a twist, in names that end in ``when``."""
    x, y = pivot(w, twist)
    return names.short(f"{w.name}_x_{when}", x), names.short(f"{w.name}_y_{when}", y)


class Blocked(NamedTuple):
    """A steering stop is between the present and the wanted direction: of a wheel that moves where ``brakes`` > 0, of
    one that stands, and may turn the other way, where ``waits`` > 0."""

    brakes: Expr
    waits: Expr


def blocked_by_stops(unit: Unit, last: Row, asked: Row, names: Locals) -> Blocked:
    """Whether a wheel that turns from where it rolls to where it shall roll meets a stop.

    It turns to the left where e x w > 0, w the wanted velocity of the pivot seen from the way that it rolls. It comes
    past the stop there if the direction d of the stop has d x w > 0, and is less than half a turn away.
    """
    w, stops = unit.lead, unit.stops
    assert stops is not None
    velocity = named_pivot(w, asked, "asked", names)
    a, _ = seen_from(w, named_pivot(w, last, "last", names), names)
    b, d = seen_from(w, velocity, names)
    moves = subtract(absolute(a), number(CREEP * 2))
    sense = names.define(f"{w.name}_onward", select(moves, _ZERO, b, a))
    now, sides = signal(f"{w.name}.steer"), list[Expr]()
    for way, stop in ((1, stops.high), (-1, stops.low)):
        passed = times(way, with_sign_of(_across(w, stop, velocity), sense))
        side = minimum(times(way, with_sign_of(d, sense)), subtract(passed, number(CREEP)))
        if stops.high - stops.low > HALF_TURN:
            side = minimum(side, subtract(times(way, now), number(way * stop - HALF_TURN)))
        sides.append(side)
    met = names.define(f"{w.name}_blocked", maximum(*sides))
    return Blocked(minimum(met, moves), minimum(met, times(-1, moves)))


def _across(w: Wheel, angle: Exact, velocity: Velocity) -> Expr:
    """The velocity across the wheel at a joint angle."""
    g, (c, s) = working_view(w), circle_point(angle.rational())
    x, y = add_angles((g.ch, g.sh), (Poly.of(c), Poly.of(s)))
    return expression(x * velocity[1] - y * velocity[0])


def share_in_cone(
    unit: Unit, motion: tuple[Row, Row], step: Expr, blocked: Blocked | None, names: Locals
) -> Expr:
    """The share that keeps the pivot of a steered wheel in the cone that it reaches in a step."""
    w, rate = unit.lead, unit.rate
    assert rate is not None
    delta = names.define(f"{w.name}_delta", times(number(min(rate.high, -rate.low)), step))
    (a, c), (b, d) = (
        seen_from(w, named_pivot(w, twist, when, names), names)
        for twist, when in zip(motion, ("last", "change"), strict=True)
    )
    rolls = names.define(f"{w.name}_rolls", absolute(a))
    gains = select(rolls, number(CREEP), absolute(b), with_sign_of(b, a))
    within = add(number(CREEP), subtract(times(delta, rolls), absolute(c)))
    within = names.define(f"{w.name}_within", maximum(within, number(_LEAST)))
    out = subtract(absolute(d), times(delta, gains))
    if blocked is not None:
        out = select(_ZERO, blocked.waits, add(absolute(b), absolute(d)), out)
    return within / names.define(f"{w.name}_below", maximum(within, out))
