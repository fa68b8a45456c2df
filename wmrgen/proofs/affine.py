"""Linear forms: ranges of sums in which the same quantity stands twice.

A node that is a sum of multiples of others keeps the multiples; the others are its atoms. Coefficients do not depend
on the box. ``slack`` bounds what rounding adds to the form along the way, per box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wmrgen.proofs.interval import Array, Interval, magnitude

_GROW = 1 + 1e-12  # covers the rounding of the coefficients and of the sum
_MOST = 64  # atoms of one form; more are not worth their time


@dataclass(frozen=True, slots=True)
class Affine:
    """sum of coefficient times atom, atoms by node id, plus ``constant``, within ``slack``."""

    terms: dict[int, float]
    constant: float
    slack: Array

    def scaled(self, by: float) -> Affine:
        return Affine({k: c * by for k, c in self.terms.items()}, self.constant * by, self.slack * abs(by))

    def widened(self, by: Array) -> Affine:
        return Affine(self.terms, self.constant, self.slack + by)

    def range(self, ranges: Sequence[Interval]) -> Interval:
        """Where the form lies when its atoms lie in ``ranges``."""
        lo = hi = np.full_like(self.slack, self.constant)
        size = np.full_like(self.slack, abs(self.constant))
        for k, c in self.terms.items():
            a, b = ranges[k]
            lo, hi = (lo + c * a, hi + c * b) if c > 0 else (lo + c * b, hi + c * a)
            size = size + abs(c) * magnitude(ranges[k])
        room = self.slack * _GROW + size * (_GROW - 1)
        return lo - room, hi + room


def atom(i: int, boxes: int) -> Affine:
    """A node that is no sum."""
    return Affine({i: 1.0}, 0.0, np.zeros(boxes))


def constant(value: float, width: float, boxes: int) -> Affine:
    """A number known within ``width``."""
    return Affine({}, value, np.full(boxes, width))


def combined(a: Affine, b: Affine, sign: int) -> Affine | None:
    """a + sign b; None when it grows too long."""
    terms = dict(a.terms)
    for k, c in b.terms.items():
        terms[k] = terms.get(k, 0.0) + sign * c
    if len(terms) > _MOST:
        return None
    return Affine(terms, a.constant + sign * b.constant, a.slack + b.slack)


def overlap(a: Affine, b: Affine) -> bool:
    """Whether a sum of the two cancels something."""
    return not a.terms.keys().isdisjoint(b.terms)
