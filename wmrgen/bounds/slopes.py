"""Enclosures of derivatives: rows for sources of noise, columns for boxes. None is zero."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import interval as iv
from wmrgen.bounds.interval import GROW, Array, Interval

Slope: TypeAlias = Interval | None  # arrays of (rows so far) x boxes


def _grown(slope: Slope, rows: int, boxes: int) -> Interval:
    """A copy with at least ``rows`` rows."""
    have = 0 if slope is None else slope[0].shape[0]
    lo, hi = np.zeros((max(rows, have), boxes)), np.zeros((max(rows, have), boxes))
    if slope is not None:
        lo[:have], hi[:have] = slope
    return lo, hi


def _alike(a: Interval, b: Interval) -> tuple[Interval, Interval]:
    """Both with as many rows."""
    rows, boxes = max(a[0].shape[0], b[0].shape[0]), a[0].shape[1]
    p = a if a[0].shape[0] == rows else _grown(a, rows, boxes)
    q = b if b[0].shape[0] == rows else _grown(b, rows, boxes)
    return p, q


def with_source(slope: Slope, row: int, boxes: int) -> Interval:
    """``slope`` of a value that has source ``row`` added to it."""
    lo, hi = _grown(slope, row + 1, boxes)
    lo[row] = hi[row] = 1.0
    return lo, hi


def plus(a: Slope, b: Slope, sign: int = 1) -> Slope:
    """a + sign b."""
    if b is None:
        return a
    if a is None:
        return b if sign > 0 else iv.negative(b)
    p, q = _alike(a, b)
    lo, hi = (iv.plus if sign > 0 else iv.minus)(p, q)
    zero = (p[0] == 0) & (p[1] == 0) & (q[0] == 0) & (q[1] == 0)
    return np.where(zero, 0.0, lo), np.where(zero, 0.0, hi)


def negative(a: Slope) -> Slope:
    return None if a is None else iv.negative(a)


def times(a: Slope, by: Interval) -> Slope:
    """Product with a range, box by box. What does not depend on a source still does not."""
    if a is None:
        return None
    if np.all(by[0] == by[1]):
        p, q = a[0] * by[0], a[1] * by[0]
        lo, hi = iv.outward(np.minimum(p, q), np.maximum(p, q))
    else:
        lo, hi = iv.times(a, by)
    zero = (a[0] == 0) & (a[1] == 0)
    return np.where(zero, 0.0, lo), np.where(zero, 0.0, hi)


def chosen(
    always: NDArray[np.bool_], never: NDArray[np.bool_], first: Array, second: Array, either: Array
) -> Array:
    """``first`` where always, ``second`` where never, else ``either``."""
    return np.where(always, first, np.where(never, second, either))


def choice(small: Interval, large: Interval, a: Slope, b: Slope) -> Slope:
    """Slope of what is ``a`` where small < large and ``b`` elsewhere."""
    if a is None and b is None:
        return None
    rows = max(0 if s is None else s[0].shape[0] for s in (a, b))
    boxes = len(small[0])
    p, q = _grown(a, rows, boxes), _grown(b, rows, boxes)
    always, never = small[1] < large[0], small[0] > large[1]
    lo = chosen(always, never, p[0], q[0], np.minimum(p[0], q[0]))
    hi = chosen(always, never, p[1], q[1], np.maximum(p[1], q[1]))
    return lo, hi


def norm(squares: Sequence[tuple[float, Slope]]) -> Slope:
    """Slope of sqrt(sum f x x), which is at most sqrt(sum f x' x') (Cauchy and Schwarz)."""
    sizes = [(factor, iv.magnitude(slope)) for factor, slope in squares if slope is not None]
    if not sizes:
        return None
    total = np.zeros((max(s.shape[0] for _, s in sizes), sizes[0][1].shape[1]))
    for factor, size in sizes:
        total[: size.shape[0]] += factor * size * size
    most = np.sqrt(total) * GROW
    return -most, most


def weighed(slope: Slope, noise: Array, boxes: int) -> Array:
    """sum |slope| noise: how much all sources may change the value, per box."""
    if slope is None:
        return np.zeros(boxes)
    size = iv.magnitude(slope)
    amount = noise[: size.shape[0]]
    return np.asarray(np.where(amount > 0, size * amount, 0.0).sum(axis=0) * GROW)


def without(slope: Slope, row: int) -> Slope:
    """``slope`` with nothing in one row."""
    if slope is None or slope[0].shape[0] <= row:
        return slope
    lo, hi = slope[0].copy(), slope[1].copy()
    lo[row] = hi[row] = 0.0
    return lo, hi


def added(slope: Slope, row: int, size: Array, boxes: int) -> Interval:
    """``slope`` with up to ``size`` more, of either sign, in one row."""
    lo, hi = _grown(slope, row + 1, boxes)
    lo[row] -= size
    hi[row] += size
    return lo, hi
