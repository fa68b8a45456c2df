"""Which curvature the steering stops let a car drive: what `limit_twist` keeps.

A wheel at (a, b) from the centre Q of the fixed axle, ahead and to the left, moves at (v - b omega, a omega) while Q
drives at v. Along the direction (c, s) of its stop, both seen from the axle, it rolls for the curvature

    omega / v = s / (a c + b s)

The curvatures between both stops are those that it can drive, and a robot drives those that all of its wheels can. A
stop beyond the direction in which Q stands still, a c + b s = 0, is none: the wheel can turn about every point on that
side. Without a fixed axle the steering has more than one freedom, and no two numbers say what it can do.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Iterable
from functools import reduce
from math import cos, pi, sin
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.unicycle import drives
from wmrgen.functions.models.axle import Axle, fixed_axle
from wmrgen.geometry.constraints import nominal_view, working_view
from wmrgen.geometry.exact.evaluate import add_angles, circle_point
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    expression,
    kept_between,
    maximum,
    minimum,
    number,
    select,
    signal,
    subtract,
    times,
)

_LEAST = 1e-9  # m: a wheel as near to the axle line stands on it, and steers nothing


class Reach(NamedTuple):
    """Curvatures [1/m] that every steering stop allows, ``right`` <= omega / v <= ``left``; None: any on that side.

    ``axle``: what v is the speed of.
    """

    axle: Axle
    right: Expr | None
    left: Expr | None

    def cut(self, names: Locals) -> tuple[Expr, Expr, Expr]:
        """vx, vy and omega of the input twist with the speed of the axle kept and the yaw rate inside the reach."""
        (ex, ey), (x, y) = self.axle.direction, self.axle.centre
        vx, vy, omega = map(signal, ("vx", "vy", "omega"))
        ahead, aside = subtract(vx, times(y, omega)), add(vy, times(x, omega))
        v = names.define("v", add(times(ex, ahead), times(ey, aside)))
        turn = names.define("turn", self._inside(v, omega))
        px, py = self.axle.velocity_of_p(v, turn)
        return px, py, turn

    def _inside(self, v: Expr, omega: Expr) -> Expr:
        """The yaw rate nearest to ``omega`` at the speed ``v``."""
        if self.left is not None and self.right == -self.left:
            most = times(self.left, absolute(v))
            return kept_between(times(-1, most), omega, most)
        for bound, forwards, backwards in ((self.left, minimum, maximum), (self.right, maximum, minimum)):
            if bound is not None:
                end = times(bound, v)
                omega = select(v, sympy.S.Zero, backwards(omega, end), forwards(omega, end))
        return omega


def reach(robot: Robot, mobility: Mobility, names: Locals) -> Reach | None:
    """What the steering stops allow; None where they bound nothing, or the robot is not steered as a car."""
    axle, nominal = (fixed_axle(robot, mobility, view) for view in (working_view, nominal_view))
    if axle is None or nominal is None or not drives(robot, mobility, axle):
        return None
    left, right = list[Curvature](), list[Curvature]()
    for w in robot.wheels:
        limit = robot.limit(w, "steer")
        if limit is None or not w.kind.steers:
            continue
        for stop in limit if _bends(w, limit, nominal) else ():
            side = _side(w, limit, stop, nominal)
            if side:
                (left if side > 0 else right).append(_curvature(w, stop, axle))
    if not (left or right):
        return None
    return Reach(
        axle, _tightest(right, max, maximum, names, "right"), _tightest(left, min, minimum, names, "left")
    )


Curvature = tuple[Poly, Poly]  # s and a c + b s


def _curvature(w: Wheel, stop: Exact, axle: Axle) -> Curvature:
    """omega / v of the wheel at a stop, as numerator and divisor."""
    g, (cosine, sine) = working_view(w), circle_point(stop.rational())
    dx, dy = add_angles((g.ch, g.sh), (Poly.of(cosine), Poly.of(sine)))
    c, s = axle.ex * dx + axle.ey * dy, axle.ex * dy - axle.ey * dx
    a, b = axle.seen(g)
    return s, a * c + b * s


def _ahead(w: Wheel, limit: Interval, nominal: Axle) -> float:
    """The joint angle [rad] at which the wheel rolls along the axle's direction, nearest to the middle of its stops."""
    ex, ey, *_ = nominal.nominal
    turn = phase(complex(ex, ey) / w.zero_heading)
    middle = float(limit.low + limit.high) / 2
    return turn - pi * round((turn - middle) / pi)


def _bends(w: Wheel, limit: Interval, nominal: Axle) -> bool:
    """Whether stops bound the curvature: the wheel stands before or behind the axle line, and may point straight on."""
    a = float(nominal.seen(w.nominal.mapped(Poly.of))[0].constant or 0)
    straight = _ahead(w, limit, nominal)
    inside = float(limit.low) < straight < float(limit.high)
    return abs(a) > _LEAST and inside and float(limit.high - limit.low) < pi


def _side(w: Wheel, limit: Interval, stop: Exact, nominal: Axle) -> int:
    """1 for a stop that bounds turning left, -1 for turning right, 0 for one beyond the direction where Q stands."""
    a, b = (float(p.constant or 0) for p in nominal.seen(w.nominal.mapped(Poly.of)))
    swing = float(stop) - _ahead(w, limit, nominal)
    if a * (a * cos(swing) + b * sin(swing)) <= 0:
        return 0
    return 1 if a * sin(swing) > 0 else -1


def _tightest(
    curvatures: list[Curvature],
    exact: Callable[[Iterable[Exact]], Exact],
    larger: Callable[[Expr, Expr], Expr],
    names: Locals,
    name: str,
) -> Expr | None:
    """The bound that keeps all; numbers are compared here, tunable ones on the robot."""
    numbers, others = list[Exact](), list[Expr]()
    for s, below in curvatures:
        if s.constant is not None and below.constant is not None:
            numbers.append(s.constant / below.constant)
        else:
            others.append(names.define(f"{name}most", expression(s) / expression(below)))
    known = [number(exact(numbers))] if numbers else []
    return reduce(larger, [*others, *known]) if curvatures else None
