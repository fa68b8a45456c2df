"""Angles to a heading that limits allow: x - h, where x is h, h and half a turn, or a limit.

Intervals lose that x and h are decided together. Here every way through the decisions is followed, each over the h for
which it is taken: there x, made of h and numbers by sums, minima, maxima and choices alone, is a h + b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wmrgen.bounds.interval import Interval
from wmrgen.ir.nodes import Op

if TYPE_CHECKING:
    from wmrgen.bounds.analysis import Pass

_MOST = 24  # pieces of one node
_SUMS = 20  # on the way
_LARGE = 8.0  # numbers on the way are no larger than so many times 1 + |h|
_ROOM = 2e-5  # of 1 + |h|: so many roundings to float32 of such numbers, and of constants among them


@dataclass(frozen=True, slots=True)
class _Piece:
    """slope h + offset where low <= h <= high."""

    low: float
    high: float
    slope: float
    offset: float

    def ends(self) -> tuple[float, float]:
        """The least and the largest value."""
        values = (self.slope * self.low + self.offset, self.slope * self.high + self.offset)
        return min(values), max(values)

    def within(self, other: _Piece) -> _Piece:
        """This piece, where the other one is taken as well."""
        return _Piece(max(self.low, other.low), min(self.high, other.high), self.slope, self.offset)

    def plus(self, other: _Piece, sign: float) -> _Piece:
        """The sum, ``sign`` times the other one, where both are taken."""
        both = self.within(other)
        return _Piece(both.low, both.high, self.slope + sign * other.slope, self.offset + sign * other.offset)

    def less(self, other: _Piece, room: float) -> _Piece:
        """This piece, where it may be below the other one."""
        both, apart = self.within(other), self.plus(other, -1.0)
        if apart.slope == 0:
            return both if apart.offset < room else _NOWHERE
        end = (room - apart.offset) / apart.slope
        low, high = (both.low, min(both.high, end)) if apart.slope > 0 else (max(both.low, end), both.high)
        return _Piece(low, high, self.slope, self.offset)


_NOWHERE = _Piece(1.0, 0.0, 0.0, 0.0)


def turns(p: Pass, i: int) -> list[Interval] | None:
    """Where the angle of node ``i`` lies as computed, piece by piece; None where it is no such angle."""
    node = p.nodes[i]
    if p.boxes != 1 or node.op is not Op.SUB:
        return None
    x, h = node.args
    low, high = (float(end[0]) for end in p.range(h))
    if not (np.isfinite(low) and np.isfinite(high)):
        return None
    walk = _Walk(p, h, _Piece(low, high, 1.0, 0.0))
    found = walk.of(x)
    if found is None or len(found) < 2:
        return None
    ends = [f.plus(walk.whole, -1.0).ends() for f in found]
    return [(np.array([a - walk.room]), np.array([b + walk.room])) for a, b in ends]


class _Walk:
    """Nodes as pieces of h."""

    def __init__(self, p: Pass, h: int, whole: _Piece) -> None:
        self.p, self.whole, self.sums = p, whole, 0
        self.known: dict[int, list[_Piece] | None] = {h: [whole]}
        self.size = 1 + max(-whole.low, whole.high)
        self.room = _ROOM * self.size

    def of(self, i: int) -> list[_Piece] | None:
        """The pieces of node ``i``, None where it has none or too many, or where numbers are too large."""
        if i not in self.known:
            found = self._made(i)
            if found is not None and len(found) > _MOST:
                found = None
            if found is not None and any(max(map(abs, f.ends())) > _LARGE * self.size for f in found):
                found = None
            self.known[i] = found
        return self.known[i]

    def _made(self, i: int) -> list[_Piece] | None:
        node = self.p.nodes[i]
        if node.value is not None:
            return [_Piece(self.whole.low, self.whole.high, 0.0, float(node.value))]
        if node.op not in (Op.ADD, Op.SUB, Op.MIN, Op.MAX, Op.SELECT):
            return None
        args = []
        for k in node.args:
            pieces = self.of(k)
            if pieces is None:
                return None
            args.append(pieces)
        a, b = args[:2]
        if node.op in (Op.ADD, Op.SUB):
            self.sums += 1
            found = [u.plus(v, 1.0 if node.op is Op.ADD else -1.0) for u in a for v in b]
        else:
            # Taken where a < b, and where b < a.
            first, second = {Op.MIN: (a, b), Op.MAX: (b, a)}.get(node.op) or args[2:]
            found = self._chosen(a, b, first) + self._chosen(b, a, second)
        kept = list(dict.fromkeys(f for f in found if f.low <= f.high))
        return kept if self.sums <= _SUMS else None

    def _chosen(self, small: list[_Piece], large: list[_Piece], value: list[_Piece]) -> list[_Piece]:
        """The pieces of ``value`` where ``small`` is below ``large``."""
        return [v.within(u.less(w, self.room)) for u in small for w in large for v in value]
