"""Linear forms: ranges of sums in which the same quantity stands twice.

A node that is a sum of multiples of others keeps the multiples; the others are its atoms. Coefficients do not depend
on the box. ``slack`` bounds what rounding adds to the form along the way, per box.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wmrgen.bounds.arms import Arm, reach
from wmrgen.bounds.interval import Array, Interval, magnitude

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

    def range(self, ranges: Sequence[Interval], arms: Mapping[int, Arm]) -> Interval:
        """Where the form lies when its atoms lie in ``ranges``; those that are ``arms`` of one angle together."""
        lo = hi = np.full_like(self.slack, self.constant)
        size = np.full_like(self.slack, abs(self.constant))
        turning: dict[int, list[int]] = {}
        for k in self.terms:
            turning.setdefault(arms[k].angle if k in arms else -1 - k, []).append(k)  # -1 - k: by itself
        for together in turning.values():
            low = high = np.zeros_like(self.slack)
            for k in together:
                c, (a, b) = self.terms[k], ranges[k]
                low, high = (low + c * a, high + c * b) if c > 0 else (low + c * b, high + c * a)
                size = size + abs(c) * magnitude(ranges[k])
            most = reach([(arms[k], self.terms[k]) for k in together], ranges) if len(together) > 1 else None
            if most is not None:
                low, high = np.maximum(low, -most), np.minimum(high, most)
            lo, hi = lo + low, hi + high
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


def overlap(a: Affine, b: Affine, arms: Mapping[int, Arm]) -> bool:
    """Whether the two have an atom in common, or arms of one angle: then their sum knows more than their ranges."""
    if not a.terms.keys().isdisjoint(b.terms):
        return True
    angles = {arms[k].angle for k in a.terms if k in arms}
    return any(k in arms and arms[k].angle in angles for k in b.terms)
