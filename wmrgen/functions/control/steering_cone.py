"""How far a twist may go in one step so that steered wheels can follow: the cone of `setpoint`.

See `wmrgen.functions.control.setpoint` for the inequality. If a steering stop is in the way of a wheel, the robot
brakes until the pivot of the wheel is no faster than `CREEP`, and waits until the wheel has turned in the other
direction.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.steer import QUARTER, turned_by
from wmrgen.analysis.kinematics.steer_groups import seen_from
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Row
from wmrgen.geometry.layout.records import Interval, Wheel
from wmrgen.geometry.symbolic import (
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
    """A steering stop is between the present and the wanted direction of a wheel."""

    brakes: Expr  # above 0 if the wheel moves
    waits: Expr  # above 0 if it stands, and may turn in the other direction


def blocked_by_stops(unit: Unit, last: Row, asked: Row, names: Locals) -> Blocked:
    """Return whether a wheel meets a stop when it turns from the direction of its motion to the wanted one.

    Let e be the direction in which it rolls and w the wanted velocity of its pivot. It turns to the left if e x w > 0.
    It passes the left stop, whose direction is d, if d x w > 0 and if the stop is less than half a turn away.
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
        passed = times(way, with_sign_of(expression(turned_by(w, velocity, stop)[1]), sense))
        side = minimum(times(way, with_sign_of(d, sense)), subtract(passed, number(CREEP)))
        if stops.high - stops.low > HALF_TURN:
            side = minimum(side, subtract(times(way, now), number(way * stop - HALF_TURN)))
        sides.append(side)
    met = names.define(f"{w.name}_blocked", maximum(*sides))
    return Blocked(minimum(met, moves), minimum(met, times(-1, moves)))


def share_in_cone(
    unit: Unit, motion: tuple[Row, Row], step: Expr, blocked: Blocked | None, names: Locals
) -> Expr:
    """Return the largest share of the motion for which a steered wheel stays in the cone that a step can reach."""
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
