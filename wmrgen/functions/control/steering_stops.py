"""Twists that the steering stops allow: used by `limit_twist`.

**A car.** A wheel at (a, b) from the centre Q of the fixed axle, ahead and to the left, moves at (v - b omega, a
omega) while Q drives at v. At its stop the wheel points along (c, s), seen from the axle. There it rolls at the
curvature

    omega / v = s / (a c + b s)

The wheel can drive the curvatures between both stops. The robot can drive those that all of its wheels can drive. A
stop is no bound if it is beyond the direction at which Q is at rest, a c + b s = 0: then the wheel can turn about
every point on that side. Without a fixed axle the steering has more than one freedom, and curvature alone does not
describe what it can do.

**A robot without a fixed axle.** The velocity of a pivot is p, and m is the direction of the wheel in the middle of
its stops. n = z x m, and h is half the angle between the stops. The wheel can roll along p, forwards or backwards, if

    |n . p| <= tan h |m . p|

A twist that satisfies this at all wheels is unchanged. For any other twist, let u be a direction inside all stops, so
that all wheels can roll straight along it. The speed along u is a = u . (vx, vy). It is unchanged, and the rest of the
twist is scaled by the largest share s for which the wheels roll in the sense of a. With p = a u + q, where q belongs
to the rest, the conditions for a > 0 are

    s (n . q - tan h m . q) <= a K1,  K1 = tan h m . u - n . u > 0
    s (-n . q - tan h m . q) <= a K2,  K2 = tan h m . u + n . u > 0

Hence s = a / max(a, the largest left side / K at s = 1). For a < 0 all signs change. If a is 0, the robot stands
still. Stops more than 170 degrees apart are not treated here: `inverse` slides there by at most sin(5 degrees) of the
speed of the pivot, and reports it.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import reduce
from math import cos, inf, pi, sin
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.steer import HYSTERESIS, QUARTER, STILL, turned_by
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.unicycle import drives
from wmrgen.functions.models.axle import Axle, fixed_axle
from wmrgen.geometry.constraints import nominal_view, working_view
from wmrgen.geometry.exact.evaluate import add_angles, circle_point
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    clamp_between,
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

_ON_AXLE = 1e-9  # m: a wheel nearer to the axle line is on it and cannot steer


class CurvatureRange(NamedTuple):
    """The range of curvatures that every steering stop allows: ``right`` <= omega / v <= ``left``."""

    axle: Axle  # v is the speed of its centre
    right: Expr | None  # 1/m; None: no bound on this side
    left: Expr | None  # 1/m; None: no bound on this side

    def cut(self, names: Locals) -> tuple[Expr, Expr, Expr]:
        """Return vx, vy and omega with the speed of the axle of the input twist and a yaw rate in the range."""
        (ex, ey), (x, y) = self.axle.direction, self.axle.centre
        vx, vy, omega = map(signal, ("vx", "vy", "omega"))
        ahead, aside = subtract(vx, times(y, omega)), add(vy, times(x, omega))
        v = names.define("v", add(times(ex, ahead), times(ey, aside)))
        turn = names.define("turn", self._inside(v, omega))
        px, py = self.axle.velocity_of_p(v, turn)
        return px, py, turn

    def _inside(self, v: Expr, omega: Expr) -> Expr:
        """Return the yaw rate nearest to ``omega`` that is allowed at the speed ``v``."""
        if self.left is not None and self.right == -self.left:
            most = times(self.left, absolute(v))
            return clamp_between(times(-1, most), omega, most)
        for bound, forwards, backwards in ((self.left, minimum, maximum), (self.right, maximum, minimum)):
            if bound is not None:
                end = times(bound, v)
                omega = select(v, sympy.S.Zero, backwards(omega, end), forwards(omega, end))
        return omega


def curvature_range(robot: Robot, mobility: Mobility, names: Locals) -> CurvatureRange | None:
    """Return the curvatures that the steering stops allow.

    Args:
        robot: The robot.
        mobility: Its mobility.
        names: Takes the intermediate results.

    Returns:
        The range of curvatures; None if stops do not bound it, or if the robot is not steered as a car.
    """
    axle, nominal = (fixed_axle(robot, mobility, view) for view in (working_view, nominal_view))
    if axle is None or nominal is None or not drives(robot, mobility, axle):
        return None
    left, right = list[Curvature](), list[Curvature]()
    for w in robot.wheels:
        limit = robot.limit(w, "steer")
        if limit is None or not w.kind.steers:
            continue
        for stop in limit if _stops_bound_curvature(w, limit, nominal) else ():
            side = _turning_side(w, limit, stop, nominal)
            if side:
                (left if side > 0 else right).append(_curvature(w, stop, axle))
    if not (left or right):
        return None
    return CurvatureRange(
        axle,
        _tightest_bound(right, max, maximum, names, "right"),
        _tightest_bound(left, min, minimum, names, "left"),
    )


Curvature = tuple[Poly, Poly]  # numerator s and divisor a c + b s


def _curvature(w: Wheel, stop: Exact, axle: Axle) -> Curvature:
    """Return the curvature omega / v of a wheel at a stop, as numerator and divisor."""
    g, (cosine, sine) = working_view(w), circle_point(stop.rational())
    dx, dy = add_angles((g.ch, g.sh), (Poly.of(cosine), Poly.of(sine)))
    c, s = axle.ex * dx + axle.ey * dy, axle.ex * dy - axle.ey * dx
    a, b = axle.seen(g)
    return s, a * c + b * s


def _straight_ahead(w: Wheel, limit: Interval, nominal: Axle) -> float:
    """Return the joint angle [rad] at which the wheel rolls straight on, the nearest to the middle of its stops."""
    ex, ey, *_ = nominal.nominal
    turn = phase(complex(ex, ey) / w.zero_heading)
    middle = float(limit.low + limit.high) / 2
    return turn - pi * round((turn - middle) / pi)


def _stops_bound_curvature(w: Wheel, limit: Interval, nominal: Axle) -> bool:
    """Return whether stops bound the curvature: the wheel is off the axle line and may point straight on."""
    a = float(nominal.seen(w.nominal.mapped(Poly.of))[0].constant or 0)
    straight = _straight_ahead(w, limit, nominal)
    inside = float(limit.low) < straight < float(limit.high)
    return abs(a) > _ON_AXLE and inside and float(limit.high - limit.low) < pi


def _turning_side(w: Wheel, limit: Interval, stop: Exact, nominal: Axle) -> int:
    """Return 1 for a stop that bounds turning left, -1 for turning right, 0 for a stop that is no bound."""
    a, b = (float(p.constant or 0) for p in nominal.seen(w.nominal.mapped(Poly.of)))
    swing = float(stop) - _straight_ahead(w, limit, nominal)
    if a * (a * cos(swing) + b * sin(swing)) <= 0:
        return 0
    return 1 if a * sin(swing) > 0 else -1


def _tightest_bound(
    curvatures: list[Curvature],
    exact: Callable[[Iterable[Exact]], Exact],
    larger: Callable[[Expr, Expr], Expr],
    names: Locals,
    name: str,
) -> Expr | None:
    """Return the tightest bound. Numbers are compared here; tunable bounds are compared on the robot."""
    numbers, others = list[Exact](), list[Expr]()
    for s, below in curvatures:
        if s.constant is not None and below.constant is not None:
            numbers.append(s.constant / below.constant)
        else:
            others.append(names.define(f"{name}most", expression(s) / expression(below)))
    known = [number(exact(numbers))] if numbers else []
    return reduce(larger, [*others, *known]) if curvatures else None


Direction = tuple[Exact, Exact]


class Cone(NamedTuple):
    """The directions of a wheel between its stops; the sign of m makes m . u > 0."""

    across: Poly  # n . p [m/s]
    along: Poly  # m . p [m/s]
    slope: Exact  # tan h
    left: Exact  # K1
    right: Exact  # K2


class Stops(NamedTuple):
    """The narrow steering stops of a robot."""

    direction: Direction  # u
    cones: tuple[Cone, ...]  # one for each wheel with narrow stops

    def cut(self, names: Locals) -> tuple[Expr, Expr, Expr]:
        """Return vx, vy and omega of the input twist, limited by the stops."""
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
    """Return the stops; None if no stop is narrow, or if no direction is inside all of them."""
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
    """Return whether the stops exclude more than the `hysteresis` of `inverse` does: more than 10 degrees."""
    return limit.high - limit.low <= (QUARTER - HYSTERESIS) * 2


def _common_direction(limited: list[tuple[Wheel, Interval]]) -> Direction | None:
    """Return a direction inside all stops, forwards or backwards: x if it is inside, else the middle."""
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
    """Return the heading [rad] of the wheel in the middle of its stops, robot frame."""
    return phase(w.zero_heading) + float(limit.low + limit.high) / 2


def _cone(w: Wheel, limit: Interval, along: Direction, velocity: Velocity) -> Cone | None:
    """Return the cone of a wheel whose pivot moves at ``velocity``; None if the wheel's heading is tunable."""
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
