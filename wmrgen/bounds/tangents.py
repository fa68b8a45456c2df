"""Functions of a few angles as their tangents: on every box a value, a slope in each angle, and what is left.

A value is within ``rest`` of mid + sum of slopes times numbers from -1 to 1, one per angle: what stands twice counts
once, so that the ranges of determinants are nearly sharp on small boxes, where plain intervals are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.bounds.interval import Array, Interval
from wmrgen.ir.nodes import Op

_ROOM = 1e-14  # covers the rounding of an operation


@dataclass(frozen=True, slots=True)
class Tangent:
    """``mid`` and ``rest``: per box; ``slope``: angles x boxes, times half the width of the box."""

    mid: Array
    slope: Array
    rest: Array

    @property
    def reach(self) -> Array:
        """How far values may be from the middle."""
        return np.asarray(np.abs(self.slope).sum(axis=0) + self.rest)

    def range(self) -> Interval:
        reach = self.reach
        return self.mid - reach, self.mid + reach

    def widened(self, by: Array) -> Tangent:
        return Tangent(self.mid, self.slope, self.rest + by)

    def _rounded(self) -> Tangent:
        return self.widened(_ROOM * (np.abs(self.mid) + self.reach))


def angle(j: int, count: int, box: Interval) -> Tangent:
    """Angle ``j`` of ``count``."""
    mid, slope = (box[0] + box[1]) / 2, np.zeros((count, len(box[0])))
    slope[j] = np.maximum(box[1] - mid, mid - box[0])
    return Tangent(mid, slope, np.zeros(len(mid)))._rounded()


def constant(value: Interval, count: int) -> Tangent:
    """A number that is the same on every box."""
    mid = (value[0] + value[1]) / 2
    return Tangent(mid, np.zeros((count, len(mid))), value[1] - value[0])


def wave(op: Op, x: Tangent) -> Tangent:
    """Sine or cosine: a second derivative of at most one."""
    sine, cosine = np.sin(x.mid), np.cos(x.mid)
    mid, steep = (sine, cosine) if op is Op.SIN else (cosine, -sine)
    return Tangent(mid, steep * x.slope, np.abs(steep) * x.rest + x.reach**2 / 2 + _ROOM)._rounded()


def plus(x: Tangent, y: Tangent, sign: int) -> Tangent:
    """x + sign y."""
    return Tangent(x.mid + sign * y.mid, x.slope + sign * y.slope, x.rest + y.rest)._rounded()


def negative(x: Tangent) -> Tangent:
    return Tangent(-x.mid, -x.slope, x.rest)


def times(x: Tangent, y: Tangent) -> Tangent:
    rest = np.abs(x.mid) * y.rest + np.abs(y.mid) * x.rest + x.reach * y.reach
    return Tangent(x.mid * y.mid, x.mid * y.slope + y.mid * x.slope, rest)._rounded()
