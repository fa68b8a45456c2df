"""Angles to a heading that limits allow: x(h) - h, where x is piecewise h, h plus a turn, or a limit.

Intervals lose that x and h are decided together. Here every way through the decisions is followed, each over the h for
which it is taken: there the angle is a h + b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wmrgen.ir.nodes import Op
from wmrgen.proofs.interval import Interval

if TYPE_CHECKING:
    from wmrgen.proofs.analysis import Pass

_MOST = 64  # pieces
_ROOM = 1e-5  # of the numbers compared: covers their roundings in float32


@dataclass(frozen=True, slots=True)
class _Piece:
    """slope h + offset where low <= h <= high."""

    low: float
    high: float
    slope: float
    offset: float

    def ends(self) -> tuple[float, float]:
        values = (self.slope * self.low + self.offset, self.slope * self.high + self.offset)
        return min(values), max(values)

    def within(self, other: _Piece) -> _Piece:
        """This piece, where the other one is taken as well."""
        return _Piece(max(self.low, other.low), min(self.high, other.high), self.slope, self.offset)

    def plus(self, other: _Piece, sign: float) -> _Piece:
        there = self.within(other)
        return _Piece(
            there.low, there.high, self.slope + sign * other.slope, self.offset + sign * other.offset
        )

    def less(self, other: _Piece, room: float) -> _Piece:
        """This piece, where it may be below the other one."""
        there, apart = self.within(other), self.plus(other, -1.0)
        if apart.slope == 0:
            return there if apart.offset < room else _Piece(1.0, 0.0, 0.0, 0.0)
        end = (room - apart.offset) / apart.slope
        low, high = (
            (there.low, min(there.high, end)) if apart.slope > 0 else (max(there.low, end), there.high)
        )
        return _Piece(low, high, self.slope, self.offset)


def turns(p: Pass, i: int) -> list[Interval] | None:
    """Where the angle of node ``i`` lies, piece by piece; None where it is no such angle."""
    node = p.nodes[i]
    if p.boxes != 1 or node.op is not Op.SUB:
        return None
    x, h = node.args
    low, high = (float(end[0]) for end in p.range(h))
    if not np.isfinite(low) or not np.isfinite(high) or low > high:
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
        self.p, self.whole = p, whole
        self.known: dict[int, list[_Piece] | None] = {h: [whole]}
        self.room = _ROOM * (1 + max(-whole.low, whole.high))

    def of(self, i: int) -> list[_Piece] | None:
        if i not in self.known:
            self.known[i] = self._made(i)
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
        if node.op is Op.SELECT:
            a, b, x, y = args
            found = self._chosen(a, b, x) + self._chosen(b, a, y)
        elif node.op in (Op.MIN, Op.MAX):
            a, b = args if node.op is Op.MIN else args[::-1]
            first, second = (a, b) if node.op is Op.MIN else (b, a)
            found = self._chosen(a, b, first) + self._chosen(b, a, second)
        else:
            sign = 1.0 if node.op is Op.ADD else -1.0
            found = [u.plus(v, sign) for u in args[0] for v in args[1]]
        found = list(dict.fromkeys(f for f in found if f.low <= f.high))
        return found if len(found) <= _MOST else None

    def _chosen(self, small: list[_Piece], large: list[_Piece], value: list[_Piece]) -> list[_Piece]:
        """The pieces of ``value`` where ``small`` is below ``large``."""
        return [v.within(u.less(w, self.room)) for u in small for w in large for v in value]
