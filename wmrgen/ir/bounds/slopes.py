"""Enclosures of derivatives of some results (rows) in one node, on every box.

A slope d is an interval, plus what is bounded by a length: |d| is at most |plain| + sum of over_j / h_j. Where a node
depends on a division by h_j, the first part has a second bound, a + b h_j, so that h_j cancels there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, Interval
from wmrgen.ir.ops.analysis import Partial, Walk


@dataclass(frozen=True, slots=True)
class Slope:
    """``plain``: (lo, hi), rows x boxes. ``over``: by length. ``shared``: by length, (a, b). See above."""

    plain: Interval
    over: Mapping[int, Array] = field(default_factory=dict)
    shared: Mapping[int, tuple[Array, Array]] = field(default_factory=dict)

    @classmethod
    def unit(cls, row: int, rows: int, boxes: int) -> Slope:
        """1 in one row."""
        derivative = np.zeros((rows, boxes))
        derivative[row] = 1.0
        return cls((derivative, derivative))

    @property
    def size(self) -> Array:
        """The largest absolute value of the plain part."""
        return iv.magnitude(self.plain)

    def any(self) -> Array:
        """The rows that are not zero."""
        return np.asarray(sum(self.over.values(), self.size).any(axis=1))

    def absolute(self) -> Slope:
        return Slope((np.zeros_like(self.plain[0]), self.size), self.over)

    def of(self, j: int) -> tuple[Array, Array]:
        """(a, b): the first part is at most a + b h_j."""
        return self.shared.get(j) or (self.size, np.zeros(()))

    def plus(self, other: Slope) -> Slope:
        zeros = np.zeros(())
        over = {j: self.over.get(j, zeros) + other.over.get(j, zeros) for j in {**self.over, **other.over}}
        shared = {}
        for j in {**self.shared, **other.shared}:
            (a, b), (c, d) = self.of(j), other.of(j)
            shared[j] = a + c, b + d
        zero = _zero(self.plain) & _zero(other.plain)
        return Slope(_kept(zero, iv.plus(self.plain, other.plain)), over, shared)

    def times(self, p: Partial, w: Walk) -> Slope:
        """The derivative in the argument of ``p``, for this one in the node: the chain rule."""
        if isinstance(p.by, int):
            return Slope(self.plain if p.by > 0 else iv.negative(self.plain), self.over, self.shared)
        if p.length is not None and p.steep is not None:
            return self._divided(p.length, p.steep)
        zero = _zero(self.plain) | _zero(p.by)
        plain = _kept(zero, iv.times(self.plain, p.by))
        behind = w.behind[p.arg]
        if not behind and not self.over:
            return Slope(plain)
        size, cancelled, over = iv.magnitude(p.by), np.zeros(()), {}
        shares = {j: _share(p, w, j) for j in behind | self.over.keys()}
        for j, c in self.over.items():
            s = shares[j]
            if s is None:
                over[j] = c * size
            else:
                cancelled = cancelled + c * s  # h_j cancels
        shared = {}
        for j in behind:
            (a, b), s = self.of(j), shares[j]
            if s is not None:
                shared[j] = cancelled, a * s + b * size
            elif j in self.shared:
                shared[j] = a * size + cancelled, b * size
        return Slope((plain[0] - cancelled, plain[1] + cancelled), over, shared)

    def _divided(self, j: int, steep: Array) -> Slope:
        """Times what is at most ``steep`` / h_j of either sign."""
        a, b = self.of(j)
        twice = sum(self.over.values(), np.zeros(())) != 0  # 1 / h twice: nothing is claimed
        bound = np.where(twice, np.inf, b * steep) + np.zeros_like(a)
        return Slope((-bound, bound), {j: np.where(a != 0, a * steep, 0.0)})


def _share(p: Partial, w: Walk, j: int) -> float | None:
    """s where the derivative is at most s h_j."""
    s = None if p.like is None else w.share(j, p.like)
    return None if s is None else s * abs(p.times)


def _zero(a: Interval) -> NDArray[np.bool_]:
    return np.asarray((a[0] == 0) & (a[1] == 0))


def _kept(zero: NDArray[np.bool_], value: Interval) -> Interval:
    """``value``, zero where it is exactly that."""
    if not zero.any():
        return value
    return np.where(zero, 0.0, value[0]), np.where(zero, 0.0, value[1])
