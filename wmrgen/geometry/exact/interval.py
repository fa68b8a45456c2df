"""Interval arithmetic over arrays of boxes, rounded outward: an interval always contains the exact result.

An interval is a pair (lo, hi) of float64 arrays of one shape; entry k is the interval on box k. Each bound is
rounded to nearest and then moved outward by one unit in the last place, or by `_WIDE` for library functions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Interval: TypeAlias = tuple[Array, Array]

GROW = 1 + 1e-9  # factor that covers the rounding of sums of bounds
_WIDE = 1e-15  # larger than the error of NumPy's sines, cosines and arctangents [rad or 1]
_MANY = 128  # boxes: above this number, products are faster than nextafter
_ULP, _TINY, _HUGE = 2.0**-52, 1e-300, 1e300  # a unit in the last place of x is at most _ULP |x| + _TINY
_HALF_PI = np.pi / 2
_SLACK = 1e-9  # relative: an extremum of a sine this close to an end is treated as inside


def outward(lo: Array, hi: Array) -> Interval:
    """Return the interval widened by one unit in the last place on either side, or slightly more for many boxes."""
    if lo.size > _MANY:
        below, above = np.minimum(np.abs(lo), _HUGE), np.minimum(np.abs(hi), _HUGE)
        return lo - (below * _ULP + _TINY), hi + (above * _ULP + _TINY)
    return np.nextafter(lo, -np.inf), np.nextafter(hi, np.inf)


def widened(a: Interval, by: Array) -> Interval:
    """Return ``a`` widened by ``by`` >= 0 on either side."""
    return outward(a[0] - by, a[1] + by)


def magnitude(a: Interval) -> Array:
    """Return the largest absolute value."""
    return np.maximum(-a[0], a[1])


def smallest(a: Interval) -> Array:
    """Return the least absolute value, which is 0 if the interval contains 0."""
    return np.maximum(np.maximum(a[0], -a[1]), 0.0)


def negative(a: Interval) -> Interval:
    return -a[1], -a[0]


def hull(a: Interval, b: Interval) -> Interval:
    return np.minimum(a[0], b[0]), np.maximum(a[1], b[1])


def either_sign(a: Interval, _: Interval) -> Interval:
    """Return an interval that contains ``a`` and -``a``, whatever decides the sign."""
    return hull(a, negative(a))


def meet(a: Interval, b: Interval) -> Interval:
    """Return the intersection; if it is empty, which should not occur, the nearer end of ``a``."""
    lo, hi = np.maximum(a[0], b[0]), np.minimum(a[1], b[1])
    empty = lo > hi
    return np.where(empty, np.minimum(lo, a[1]), lo), np.where(empty, np.minimum(lo, a[1]), hi)


def absolute(a: Interval) -> Interval:
    return smallest(a), magnitude(a)


def plus(a: Interval, b: Interval) -> Interval:
    return outward(a[0] + b[0], a[1] + b[1])


def minus(a: Interval, b: Interval) -> Interval:
    return outward(a[0] - b[1], a[1] - b[0])


def times(a: Interval, b: Interval) -> Interval:
    """Return the product. ``a`` may have one more leading axis than ``b``; 0 times infinity is 0."""
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return outward(np.fmin(np.fmin(p, q), np.fmin(r, s)), np.fmax(np.fmax(p, q), np.fmax(r, s)))


def square(a: Interval) -> Interval:
    least, most = smallest(a), magnitude(a)
    lo, hi = outward(least * least, most * most)
    return np.maximum(lo, 0.0), hi


def reciprocal(b: Interval) -> Interval:
    """Return 1/b; all numbers if ``b`` contains 0."""
    bad = (b[0] <= 0) & (b[1] >= 0)
    safe_lo, safe_hi = np.where(bad, 1.0, b[0]), np.where(bad, 1.0, b[1])
    lo, hi = outward(1.0 / safe_hi, 1.0 / safe_lo)
    return np.where(bad, -np.inf, lo), np.where(bad, np.inf, hi)


def quotient(a: Interval, b: Interval) -> Interval:
    """Return a/b; all numbers if ``b`` contains 0."""
    value = times(a, reciprocal(b))
    bad = (b[0] <= 0) & (b[1] >= 0)
    return np.where(bad, -np.inf, value[0]), np.where(bad, np.inf, value[1])


def smaller(a: Interval, b: Interval) -> Interval:
    return np.minimum(a[0], b[0]), np.minimum(a[1], b[1])


def larger(a: Interval, b: Interval) -> Interval:
    return np.maximum(a[0], b[0]), np.maximum(a[1], b[1])


def chosen(small: Interval, large: Interval, first: Interval, second: Interval) -> Interval:
    """Return the interval of "``first`` if small < large, else ``second``".

    Args:
        small: The left side of the comparison, shape (boxes,).
        large: The right side of the comparison, shape (boxes,).
        first: The value if the comparison holds.
        second: The value if it does not.

    Returns:
        ``first`` or ``second`` on boxes where the comparison is decided, else the hull of both.
    """
    always, never = small[1] < large[0], small[0] >= large[1]
    lo, hi = hull(first, second)
    return (
        np.where(always, first[0], np.where(never, second[0], lo)),
        np.where(always, first[1], np.where(never, second[1], hi)),
    )


def root(a: Interval) -> Interval:
    """Return the square root, with negative parts of ``a`` treated as 0."""
    lo, hi = outward(np.sqrt(np.maximum(a[0], 0.0)), np.sqrt(np.maximum(a[1], 0.0)))
    return np.maximum(lo, 0.0), hi


def _holds(a: Interval, point: float) -> NDArray[np.bool_]:
    """Return whether ``a`` contains point + 2 pi k for an integer k; true in doubt."""
    slack = _SLACK * (1.0 + magnitude(a))
    turns = np.ceil((a[0] - slack - point) / (2 * np.pi))
    return np.asarray(point + 2 * np.pi * turns <= a[1] + slack)


def _wave(a: Interval, function: Callable[[Array], Array], top: float) -> Interval:
    """Return the interval of a sine or cosine, whose maximum is at ``top`` [rad]."""
    finite = np.isfinite(a[0]) & np.isfinite(a[1])
    p, q = function(np.where(finite, a[0], 0.0)), function(np.where(finite, a[1], 0.0))
    hi = np.where(_holds(a, top) | ~finite, 1.0, np.minimum(np.maximum(p, q) + _WIDE, 1.0))
    lo = np.where(_holds(a, top - np.pi) | ~finite, -1.0, np.maximum(np.minimum(p, q) - _WIDE, -1.0))
    return lo, hi


def sine(a: Interval) -> Interval:
    return _wave(a, np.sin, _HALF_PI)


def cosine(a: Interval) -> Interval:
    return _wave(a, np.cos, 0.0)


def slope_angle(a: Interval) -> Interval:
    """Return the arctangent of a slope [rad]."""
    return widened((np.arctan(a[0]), np.arctan(a[1])), np.full_like(a[0], _WIDE))


def whole(a: Interval) -> Interval:
    """Return the interval rounded to the nearest integers."""
    return np.rint(a[0]), np.rint(a[1])


def arctangent(y: Interval, x: Interval) -> Interval:
    """Return the angle atan2(y, x) [rad]; every angle on boxes where x may be negative."""
    x = x[0] + 0.0, x[1] + 0.0  # turns -0.0 into 0.0, because atan2 distinguishes them
    right = x[0] >= 0
    above = np.arctan2(y[1], np.where(y[1] > 0, x[0], x[1]))
    below = np.arctan2(y[0], np.where(y[0] < 0, x[0], x[1]))
    far = 4 * _WIDE
    return np.where(right, below, -np.pi) - far, np.where(right, above, np.pi) + far


# ---- intervals of float32 numbers


def inside(low: float, high: float) -> tuple[float, float]:
    """Return the float32 numbers next to the ends of an interval, inside it if there are any."""
    a, b = np.float32(low), np.float32(high)
    a = np.nextafter(a, np.float32(np.inf)) if float(a) < low else a
    b = np.nextafter(b, np.float32(-np.inf)) if float(b) > high else b
    return (float(a), float(b)) if a <= b else (low, high)


def outside(low: float, high: float) -> tuple[float, float]:
    """Return float32 numbers below and above an interval."""
    a, b = (
        np.nextafter(np.float32(low), np.float32(-np.inf)),
        np.nextafter(np.float32(high), np.float32(np.inf)),
    )
    return float(a), float(b)
