"""Rounding errors backwards: one walk from the results to all sources of noise, many boxes at a time.

The model is that of `wmrgen.bounds.analysis`: a result moves by at most sum_i |d_i| sup |dv/dd_i|. Here derivatives
are enclosed from the results down (reverse differentiation), at the cost of one walk for all sources. Ranges and
derivatives are kept as multiples of spins and rates (`wmrgen.bounds.multiples`), so that only angles need small boxes.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from wmrgen.bounds import interval as iv
from wmrgen.bounds import multiples as mu
from wmrgen.bounds import slopes as sl
from wmrgen.bounds import tangents as ta
from wmrgen.bounds.analysis import Pass
from wmrgen.bounds.boxes import MOST_ANGLES
from wmrgen.bounds.interval import GROW, Array, Interval
from wmrgen.bounds.multiples import Multiple
from wmrgen.bounds.patterns import Term
from wmrgen.bounds.precision import Format, Library
from wmrgen.bounds.records import Value
from wmrgen.bounds.slopes import Slope
from wmrgen.bounds.tangents import Tangent
from wmrgen.ir.nodes import Function, Node, Op

Partial: TypeAlias = Multiple | int  # 1 or -1 of sums

_MOST = 4  # inputs of which multiples are kept


class Adjoint(Pass):
    """A walk in which every node keeps its derivatives in its arguments; for functions without directions."""

    def __init__(
        self,
        function: Function,
        inputs: Mapping[str, Interval],
        form: Format,
        library: Library,
        twice: Collection[int] = (),
    ) -> None:
        super().__init__(function, inputs, form, library, twice)
        waves = {k for n in self.nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
        free = [i for i, n in enumerate(self.nodes) if n.op is Op.INPUT and i not in waves]
        self.free = {i: j for j, i in enumerate(free)} if len(free) <= _MOST else {}
        ranges = [inputs[self.nodes[i].name or ""] for i in self.free]
        empty = np.zeros((0, self.boxes))
        self.scales = (
            np.stack([lo for lo, _ in ranges]) if ranges else empty,
            np.stack([hi for _, hi in ranges]) if ranges else empty,
        )
        turning = [i for i, n in enumerate(self.nodes) if n.op is Op.INPUT and i in waves]
        self.turning = {i: j for j, i in enumerate(turning)} if len(turning) <= MOST_ANGLES else {}
        self.tangents: list[Tangent | None] = []
        self.tangent: Tangent | None = None
        self.multiples: list[Multiple] = []
        self.partials: list[list[tuple[int, Partial]]] = []
        self.noisy: list[bool] = []  # whether a node has noise, or depends on any
        self.units: dict[int, Interval] = {}
        self.local: dict[int, int] = {}
        self.made: Multiple | None = None
        self.exactly: list[tuple[int, Partial]] = []

    def slope(self, i: int) -> Slope:
        """Slope of an argument in itself: what a rule makes of it are the derivatives of the node."""
        if not self.noisy[i]:
            return None
        row = self.local.setdefault(i, len(self.local))
        if row not in self.units:
            self.units[row] = sl.with_source(None, row, self.boxes)
        return self.units[row]

    def sourced(self, slope: Slope, row: int) -> Slope:
        return None

    def sum_slope(self, a: int, b: int, sign: int) -> Slope:
        return None  # `cut` knows it

    def product_slope(self, a: int, b: int) -> Slope:
        return None

    def shared(self, a: int, b: int) -> bool:
        return False

    def error(self, i: int) -> Array:
        return np.asarray(self.errors([i])[0])

    def lengthened(self, terms: Sequence[Term]) -> tuple[Slope, Array]:
        errors = self.errors([t.base for t in terms])
        factors = np.array([[float(t.factor)] for t in terms])
        return None, np.asarray(np.sqrt((factors * errors * errors).sum(axis=0)) * GROW)

    def cut(self, value: Interval, op: Op, a: int, b: int, inverse: Interval | None = None) -> Interval:
        value = super().cut(value, op, a, b, inverse)
        self.tangent = self._tangent(op, (a, b)) if self.turning and inverse is None else None
        if self.tangent is not None:
            value = iv.meet(value, self.tangent.range())
        x, y = self.multiples[a], self.multiples[b]
        if op in (Op.ADD, Op.SUB):
            made = mu.plus(x, y, 1 if op is Op.ADD else -1)
            self.exactly = [(a, 1), (b, 1 if op is Op.ADD else -1)]
        elif inverse is None:
            made = mu.times(x, y, self.scales)
            self.exactly = [(a, y), (b, x)]
        else:
            below = mu.plain(inverse)
            made = mu.times(x, below, self.scales)
            self.exactly = [(a, below), (b, mu.times(iv.negative(made), below, self.scales))]
        self.made = made
        return value if mu.rows(made) == 1 else iv.meet(value, mu.hull(made, self.scales))

    def record(self, i: int, node: Node, value: Value) -> None:
        found = self.exactly
        if not found and value.slope is not None:
            lo, hi = value.slope
            found = [(k, mu.plain((lo[r], hi[r]))) for k, r in self.local.items() if r < len(lo)]
        noise = value.noise
        super().record(i, node, Value(value.range, None, noise, value.away))
        self.partials.append([(k, partial) for k, partial in found if self.noisy[k]])
        self.noisy.append(bool(self.partials[i]) or (noise is not None and bool(noise.any())))
        made = self.made
        if i in self.free:
            made = mu.unit(self.free[i], len(self.free), self.boxes)
        elif made is None or mu.rows(made) == 1:
            made = mu.plain(self.result.ranges[i])
        elif noise is not None:
            made = mu.widened(made, noise)
        self.multiples.append(made)
        self.tangents.append(self._touching(i, node))
        self.local, self.made, self.exactly, self.tangent = {}, None, [], None

    def _tangent(self, op: Op, args: Sequence[int]) -> Tangent | None:
        """What an operation makes of tangents."""
        found = [t for k in args if (t := self.tangents[k]) is not None]
        if len(found) < len(args):
            return None
        if op in (Op.ADD, Op.SUB):
            return ta.plus(found[0], found[1], 1 if op is Op.ADD else -1)
        if op in (Op.SIN, Op.COS):
            return ta.wave(op, found[0])
        if op is Op.NEG:
            return ta.negative(found[0])
        return ta.times(found[0], found[1]) if op is Op.MUL else None

    def _touching(self, i: int, node: Node) -> Tangent | None:
        """The tangent of node ``i``, its rounding included."""
        if not self.turning:
            return None
        if i in self.turning:
            return ta.angle(self.turning[i], len(self.turning), self.result.ranges[i])
        if node.value is not None:
            return ta.constant(self.result.ranges[i], len(self.turning))
        found = self.tangent or (self._tangent(node.op, node.args) if len(node.args) == 1 else None)
        if found is None or i not in self.sources:
            return found
        return found.widened(self.result.noise[self.sources[i]])

    def errors(self, roots: Sequence[int]) -> Array:
        """How far the nodes ``roots`` may be off: roots x boxes."""
        with np.errstate(all="ignore"):
            return self._errors(roots)

    def _errors(self, roots: Sequence[int]) -> Array:
        count, last = len(roots), max(roots)
        derivative: list[Multiple | None] = [None] * (last + 1)
        apart: dict[int, Array] = {}  # what may be contracted: a rounding per use
        total = np.zeros((count, self.boxes))
        for r, k in enumerate(roots):
            one = np.zeros((count, 1, self.boxes))
            one[r] = 1.0
            self._reached(derivative, apart, k, (one, one))
        for i in range(last, -1, -1):
            found = derivative[i]
            if found is None:
                continue
            if i in self.sources:
                size = apart[i] if i in apart else mu.size(found, self.scales)
                noise = self.result.noise[self.sources[i]]
                total += np.where(noise > 0, size * noise, 0.0)
            for k, partial in self.partials[i]:
                if isinstance(partial, int):
                    by = found if partial > 0 else iv.negative(found)
                else:
                    by = mu.times(found, partial, self.scales)
                self._reached(derivative, apart, k, by)
            derivative[i] = None
        return np.nan_to_num(total * GROW, nan=np.inf, posinf=np.inf)

    def _reached(
        self, derivative: list[Multiple | None], apart: dict[int, Array], k: int, by: Multiple
    ) -> None:
        """One more way from the roots to node ``k``."""
        before = derivative[k]
        derivative[k] = by if before is None else mu.plus(before, by)
        if k in self.uses:
            apart[k] = apart.get(k, np.zeros(())) + mu.size(by, self.scales)
