"""Ranges of geometry over all values that tunable parameters may have."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import reduce

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Interval
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly
from wmrgen.geometry.layout.records import Robot, Wheel

Ranges = Mapping[str, Interval]


def ranges_of(robot: Robot) -> Ranges:
    """Return the range of each tunable parameter, by name [m or rad]."""
    return {p.name: iv.hull(_point(p.low), _point(p.high)) for p in robot.tunable}


def range_of(poly: Poly, ranges: Ranges) -> Interval:
    """Return an interval that contains every value of a polynomial, rounded outward.

    Repeated parameters are treated as independent, so the interval may be wider than necessary.
    """
    total = _point(Exact(0))
    for monomial, coefficient in poly.terms.items():
        factors = [_power(_generator(g, ranges), e) for g, e in monomial]
        total = iv.plus(total, reduce(iv.times, factors, _point(coefficient)))
    return total


def steering_spin(robot: Robot, w: Wheel) -> Exact | None:
    """Return the largest spin [rad/s] that steering alone causes; None if the steer_rate has no limit."""
    limit, g = robot.limit(w, "steer_rate"), w.working
    if limit is None:
        return None
    share = g.steer_arm * g.rolling_radius.inverse()
    if share.constant is not None:
        most = abs(share.constant)
    else:
        most = Exact(Fraction(float(max(abs(end[0]) for end in range_of(share, ranges_of(robot))))))
    return most * max(abs(limit.low), abs(limit.high))


def _point(value: Exact) -> Interval:
    near = np.array([float(value)])
    return iv.outward(near, near)


def _power(base: Interval, exponent: int) -> Interval:
    if exponent < 0:
        return iv.reciprocal(_power(base, -exponent))
    squared = [iv.square(base)] * (exponent // 2)
    return reduce(iv.times, squared[1:] + [base] * (exponent % 2), squared[0]) if squared else base


def _generator(g: Gen, ranges: Ranges) -> Interval:
    args = [range_of(a, ranges) for a in g.args]
    match g.kind:
        case "param":
            return ranges[g.name]
        case "pi":
            return iv.outward(np.array([np.pi]), np.array([np.pi]))
        case "sqrt":
            return iv.root(args[0])
        case "inv":
            return iv.reciprocal(args[0])
        case "tan":
            return iv.quotient(iv.sine(args[0]), iv.cosine(args[0]))
        case "cosf":
            return iv.cosine(args[0])
        case "sinf":
            return iv.sine(args[0])
        case "atan2":
            return iv.arctangent(args[0], args[1])
    raise ValueError(f"{g.kind} is not a function of geometry")
