"""Sums of multiples of inputs whose coefficients are intervals: c0 + c1 x1 + ... on every box.

Arrays of (..., rows, boxes): row 0 is c0; with one row there are no multiples. What is linear in the wheels' rates
keeps its coefficients, functions of the angles alone, so that a rate that stands twice counts once.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from wmrgen.bounds import interval as iv
from wmrgen.bounds.interval import Array, Interval

Multiple: TypeAlias = Interval  # arrays of (..., rows, boxes)

_ROOM = 1e-14  # covers the rounding of a sum of a few products
_UNIT, _LEAST = 2.0**-51, 1e-290


def plain(a: Interval) -> Multiple:
    """A value that counts as no multiple."""
    return a[0][np.newaxis], a[1][np.newaxis]


def unit(j: int, count: int, boxes: int) -> Multiple:
    """Input ``j`` of ``count``."""
    rows = np.zeros((1 + count, boxes))
    rows[1 + j] = 1.0
    return rows, rows


def rows(a: Multiple) -> int:
    return int(a[0].shape[-2])


def hull(a: Multiple, scales: Interval) -> Interval:
    """The range, given those of the inputs (arrays of inputs x boxes)."""
    if rows(a) == 1:
        return a[0][..., 0, :], a[1][..., 0, :]
    each = iv.times((a[0][..., 1:, :], a[1][..., 1:, :]), scales)
    lo, hi = a[0][..., 0, :] + each[0].sum(axis=-2), a[1][..., 0, :] + each[1].sum(axis=-2)
    room = _ROOM * (iv.magnitude(each).sum(axis=-2) + np.abs(a[0][..., 0, :]) + np.abs(a[1][..., 0, :]))
    return lo - room, hi + room


def plus(a: Multiple, b: Multiple, sign: int = 1) -> Multiple:
    """a + sign b."""
    if sign < 0:
        b = iv.negative(b)
    if rows(a) == rows(b):
        return _sum(a, b)
    long, short = (a, b) if rows(a) > rows(b) else (b, a)
    shape = np.broadcast_shapes(long[0].shape, (*short[0].shape[:-2], 1, short[0].shape[-1]))
    lo, hi = np.array(np.broadcast_to(long[0], shape)), np.array(np.broadcast_to(long[1], shape))
    first = _sum((lo[..., :1, :], hi[..., :1, :]), short)
    lo[..., :1, :], hi[..., :1, :] = first
    return lo, hi


def _sum(a: Multiple, b: Multiple) -> Multiple:
    return _outward(a[0] + b[0], a[1] + b[1])


def times(a: Multiple, b: Multiple, scales: Interval) -> Multiple:
    """a b; of two that have multiples, ``b`` counts with its range."""
    if rows(a) > 1 and rows(b) > 1:
        b = plain(hull(b, scales))
    p, q = a[0] * b[0], a[0] * b[1]  # arrays are used again: those of many boxes are dear to allocate
    lo, hi = np.fmin(p, q), np.fmax(p, q, out=p)  # 0 times infinity is 0
    r, s = np.multiply(a[1], b[0], out=q), a[1] * b[1]
    low = np.fmin(r, s)
    return _outward(np.fmin(lo, low, out=lo), np.fmax(hi, np.fmax(r, s, out=r), out=hi))


def _outward(lo: Array, hi: Array) -> Multiple:
    """Both, wider by more than a rounding: cheaper than the next number, and never subnormal."""
    room = np.abs(lo)
    lo -= _room(room)
    hi += _room(np.abs(hi, out=room))
    return lo, hi


def _room(size: Array) -> Array:
    size *= _UNIT
    size += _LEAST
    return size


def size(a: Multiple, scales: Interval) -> Array:
    """Largest absolute value, given the ranges of the inputs."""
    if rows(a) == 1:
        return np.asarray(iv.magnitude(a)[..., 0, :])
    if not np.array_equal(-scales[0], scales[1]):
        return iv.magnitude(hull(a, scales))
    each = iv.magnitude(a)  # for inputs of either sign this is as good and cheaper
    return np.asarray((each[..., 0, :] + (each[..., 1:, :] * scales[1]).sum(axis=-2)) * (1 + _ROOM))


def widened(a: Multiple, by: Array) -> Multiple:
    """``a`` with ``by`` >= 0 more on either side."""
    lo, hi = a[0].copy(), a[1].copy()
    lo[..., 0, :], hi[..., 0, :] = iv.widened((lo[..., 0, :], hi[..., 0, :]), by)
    return lo, hi
