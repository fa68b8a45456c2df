"""Which twists the steering stops let a robot without a fixed axle drive: what `limit_twist` keeps.

The velocity of a pivot is p, m the direction of the wheel in the middle of its stops, n = z x m, and h half the angle
between the stops. The wheel can roll along p, forwards or backwards, if

    |n . p| <= tan h |m . p|

A twist for which this holds at all wheels is kept. For any other, let u be a direction that is inside all stops, so
that all wheels can roll straight along it, and a = u . (vx, vy) the speed along u. Then a is kept, and of the rest of
the twist the largest share s for which the wheels roll in the sense of a. With p = a u + q, q of the rest, for a > 0

    s (n . q - tan h m . q) <= a K1,  K1 = tan h m . u - n . u > 0
    s (-n . q - tan h m . q) <= a K2,  K2 = tan h m . u + n . u > 0

so that s = a / max(a, the largest left side / K at s = 1). For a < 0 all signs change. If a is 0, the robot stands
still. Stops more than 170 degrees apart are left to `inverse`, which slides there by at most sin(5 degrees) of the
speed of the pivot and reports it.
"""

from __future__ import annotations

from cmath import phase
from fractions import Fraction
from functools import reduce
from math import inf, pi
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.steer import HYSTERESIS, QUARTER, STILL, turned_by
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.exact.evaluate import circle_point
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    expression,
    maximum,
    number,
    select,
    subtract,
    times,
    with_sign_of,
)

Direction = tuple[Exact, Exact]


class Cone(NamedTuple):
    """A wheel between its stops; m is chosen so that m . u > 0."""

    across: Poly  # n . p [m/s]
    along: Poly  # m . p [m/s]
    slope: Exact  # tan h
    left: Exact  # K1
    right: Exact  # K2


class Stops(NamedTuple):
    """``direction``: u. ``cones``: one for each wheel with narrow stops."""

    direction: Direction
    cones: tuple[Cone, ...]

    def cut(self, names: Locals) -> tuple[Expr, Expr, Expr]:
        """vx, vy and omega of the input twist inside the stops."""
        ux, uy = self.direction
        ahead = names.define("ahead", expression(_VX.scale(ux) + _VY.scale(uy)))
        outside, sides = list[Expr](), list[Expr]()
        for k, cone in enumerate(self.cones, 1):
            across = names.define(f"across_{k}", expression(cone.across))
            reach = names.define(f"reach_{k}", times(number(cone.slope), expression(cone.along)))
            outside.append(subtract(absolute(across), absolute(reach)))
            for side, constant in ((across, cone.left), (times(-1, across), cone.right)):
                left = times(number(constant.inverse()), subtract(side, reach))
                sides.append(with_sign_of(add(left, ahead), ahead))
        speed = names.define("ahead_size", absolute(ahead))
        most = names.define("most", reduce(maximum, sides, maximum(speed, number(STILL))))
        worst = names.define("outside", reduce(maximum, outside))
        share = names.define("share_of_rest", select(_NOTHING, worst, speed / most, _WHOLE))
        kept = []
        for asked, u in zip((_VX, _VY, _OMEGA), (ux, uy, ZERO), strict=True):
            straight = times(number(u), ahead)
            kept.append(add(straight, times(share, subtract(expression(asked), straight))))
        return kept[0], kept[1], kept[2]


_NOTHING, _WHOLE = sympy.S.Zero, sympy.S.One
_VX, _VY, _OMEGA = (Poly.gen("input", name) for name in ("vx", "vy", "omega"))


def steering_stops(robot: Robot, mobility: Mobility) -> Stops | None:
    """What the steering stops allow; None where they bound nothing, or no direction is inside all of them."""
    steered = [w for w in robot.wheels if w.kind.steers]
    stops = {w.index: limit for w in steered if (limit := robot.limit(w, "steer")) and _narrow(limit)}
    alone = all(len(members) == 1 for members in robot.together("steer", steered))
    if not stops or not alone or any(w.kind.fixed_axle for w in robot.wheels):
        return None
    limited = [(w, stops[w.index]) for w in steered if w.index in stops]
    along = _common_direction(limited)
    if along is None:
        return None
    twist = project(robot, mobility).twist
    cones = [_cone(w, limit, along, pivot(w, twist)) for w, limit in limited]
    found = tuple(cone for cone in cones if cone is not None)
    return Stops(along, found) if len(found) == len(cones) else None


def _narrow(limit: Interval) -> bool:
    """Whether the stops leave out more directions than the `hysteresis` of `inverse` does: more than 10 degrees."""
    return limit.high - limit.low <= (QUARTER - HYSTERESIS) * 2


def _common_direction(limited: list[tuple[Wheel, Interval]]) -> Direction | None:
    """A direction inside all stops, forwards or backwards: x if it is inside, else the middle of those that are."""
    low, high = -inf, inf
    reference = _middle(*limited[0])
    for w, limit in limited:
        middle = _middle(w, limit)
        middle -= pi * round((middle - reference) / pi)
        half = float(limit.high - limit.low) / 2
        low, high = max(low, middle - half), min(high, middle + half)
    if low >= high:
        return None
    if low < pi * round((low + high) / 2 / pi) < high:
        return ONE, ZERO
    cosine, sine = circle_point(Fraction((low + high) / 2).limit_denominator(1000))
    return cosine, sine


def _middle(w: Wheel, limit: Interval) -> float:
    """The heading [rad] of the wheel in the middle of its stops, robot frame."""
    return phase(w.zero_heading) + float(limit.low + limit.high) / 2


def _cone(w: Wheel, limit: Interval, along: Direction, velocity: Velocity) -> Cone | None:
    """The cone of a wheel whose pivot moves at ``velocity``; None if the heading of the wheel is tunable."""
    middle, half = (limit.low + limit.high) / 2, (limit.high - limit.low) / 2
    cosine, sine = circle_point(half.rational())
    slope = sine / cosine
    mu, nu = (p.constant for p in turned_by(w, (Poly.of(along[0]), Poly.of(along[1])), middle))
    if mu is None or nu is None:
        return None
    m, n = turned_by(w, velocity, middle)
    if mu.sign < 0:
        m, n, mu, nu = -m, -n, -mu, -nu
    left, right = slope * mu - nu, slope * mu + nu
    return Cone(n, m, slope, left, right) if left.sign > 0 and right.sign > 0 else None
