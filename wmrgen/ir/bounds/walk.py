"""Ranges and rounding errors of straight-line code over boxes of inputs.

Model: the float program computes v_i = op_i(v) + d_i with |d_i| at most half a unit in the last place of the largest
result (library functions: as many units as are assumed of them; constants: their own rounding). Call the program with
noise t d, 0 <= t <= 1: t = 1 is the float program, t = 0 the exact formula. By the mean value theorem an output
differs by at most sum_i |d_i| sup |dv/dd_i|, and intervals bound the derivatives over every t and every input of the
box, from the outputs back (`Walk.errors`). A comparison is taken as the float program decides it, a rounding to a whole
number likewise: beside a tie (two headings equally near, a wheel about to turn back at its stop) it may take another
branch than exact numbers would; either is right, and the error is that of the branch taken. What each operation does to
ranges and derivatives stands in its record, `wmrgen.ir.ops`.

Where a vector may vanish, derivatives are bounded in terms of its length h (`wmrgen.ir.bounds.lengths`): errors are
claimed where h is 64 times its own error or more, so that h changes by at most 1/64 while t runs from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import GROW, Array, Interval
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.bounds import lengths as by_length
from wmrgen.ir.bounds.assumptions import Format, Library, constant
from wmrgen.ir.bounds.forms import Forms, combined
from wmrgen.ir.bounds.lengths import MOVED, SHORT, SMALL_ANGLE, Length, lengths
from wmrgen.ir.bounds.shapes import contracted, effective
from wmrgen.ir.bounds.slopes import Slope
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.ops.analysis import Noise, Partial, Value

_SINGULAR = 1e-6  # of its largest value: a divisor below that may as well be zero
_TURN = SMALL_ANGLE / (SMALL_ANGLE - 1) * (1 + 1e-4)


class Errors(NamedTuple):
    """Of some nodes (rows) on every box: off by at most ``plain`` + sum of ``over`` / h.

    ``divisions``: those by lengths, and by what comes close to zero, on which they depend.
    """

    plain: Array
    over: Mapping[int, Array]
    divisions: tuple[frozenset[int], ...]

    @property
    def total(self) -> Array:
        """Without lengths; infinite where there are some."""
        if not self.over:
            return self.plain
        return np.where(sum(self.over.values()) > 0, np.inf, self.plain)


class Walk:
    """One walk through the node list. ``inputs``: (lo, hi) arrays by input name, one entry per box.

    ``upper``: bounds of errors from elsewhere, by node.
    """

    def __init__(
        self,
        function: Function,
        inputs: Mapping[str, Interval],
        form: Format,
        library: Library,
        upper: Mapping[int, Array] | None = None,
    ) -> None:
        self.nodes, self.inputs = function.nodes, inputs
        self.form, self.library = form, library
        self.upper = upper or {}
        self.boxes = max((len(lo) for lo, _ in inputs.values()), default=1)
        self.lengths: dict[int, Length] = lengths(self.nodes)
        self.effective: Mapping[int, tuple[float, float]] = effective(function)
        self.contracted = contracted(self.nodes)
        self.forms = Forms(self.nodes, self.boxes, 16 * library.ulps(Op.SIN) * form.unit)
        self.ranges: list[Interval] = []
        self.away: list[Array] = []
        self.noise: list[Noise | None] = []
        self.partials: list[tuple[Partial, ...]] = []
        self.noisy: list[bool] = []  # whether a node has noise, or depends on any
        # The lengths by which a node, or what it depends on, is divided.
        self.behind: list[frozenset[int]] = []
        self.alarms: list[tuple[int, str, NDArray[np.bool_]]] = []
        self.singular: set[int] = set()  # divisions by what comes close to zero, and guards against it

    def run(self, count: int | None = None) -> Walk:
        """The walk by the lemmas of the operations, of the first ``count`` nodes alone if that is given."""
        with np.errstate(all="ignore"):
            for i, node in enumerate(self.nodes[:count]):
                op, args = node.meaning
                if op.lemma is None:
                    raise ValueError(
                        f"nothing is said of the bounds of {op}: its record needs interval and slopes"
                    )
                self._record(i, op.lemma(self, i, *args))
        return self

    def _record(self, i: int, value: Value) -> None:
        """A result with its rounding."""
        interval, away, noise = value.range, value.away, value.noise
        size = np.zeros(()) if noise is None else noise.size
        if noise is not None and value.widen:
            interval = iv.widened(interval, size)
            away = None if away is None else away - size
        fits = iv.magnitude(interval) <= self.form.largest
        if not np.all(fits):
            self.alarm(i, "may overflow", ~fits)
            interval = np.nan_to_num(interval[0], nan=-np.inf), np.nan_to_num(interval[1], nan=np.inf)
        least = iv.smallest(interval)
        self.forms.add(i, self.ranges, size + value.decided)
        self.ranges.append(interval)
        self.away.append(least if away is None else np.maximum(least, away))
        self.noise.append(noise)
        behind = frozenset((i,)) if i in self.lengths else frozenset[int]()
        behind |= frozenset() if noise is None else noise.divisions & self.lengths.keys()
        self.behind.append(behind.union(*(self.behind[p.arg] for p in value.partials)))
        self.partials.append(value.partials)
        self.noisy.append(noise is not None or any(self.noisy[p.arg] for p in value.partials))

    # ---- what lemmas ask for

    def alarm(self, i: int, what: str, where: NDArray[np.bool_]) -> None:
        """An alarm on the boxes ``where``, if any."""
        if np.any(where):
            self.alarms.append((i, what, where))

    def rounded(self, value: Interval, i: int) -> Noise:
        """The error of a rounding of results of node ``i`` in ``value``, as far as they count (`effective`)."""
        size = iv.magnitude(value)
        if i in self.effective:
            size = np.minimum(size, max(map(abs, self.effective[i])))
        return Noise(self.form.half_ulp(size))

    def constant(self, value: Exact) -> tuple[float, float, float, bool]:
        """See `wmrgen.ir.bounds.assumptions.constant`."""
        return constant(value)

    def decided(self, k: int) -> Array:
        """How far node ``k`` may be off where the float program decides by it."""
        return np.asarray(self.claimed(self.errors((k,)))[0])

    def cancelled(self, a: int, b: int, sign: int, value: Interval) -> Interval:
        """a + b or a - b, within ``value``: terms that both have count together."""
        if not self.forms.overlap(a, b):
            return value
        form = combined(self.forms.list[a], self.forms.list[b], sign)
        return value if form is None else iv.meet(value, self.forms.range(form, self.ranges))

    def near_zero(self, i: int, divisor: int) -> None:
        """Notes the division ``i`` where its divisor comes close to zero."""
        if np.any(self.away[divisor] < _SINGULAR * iv.magnitude(self.ranges[divisor]).max()):
            self.singular.add(i)

    def vanishes(self, i: int, divisor: int) -> bool:
        """Whether the length by which node ``i`` divides may vanish; not where nothing needs the guard of it."""
        guard = self.nodes[divisor]
        if guard.op is Op.AT_LEAST and np.all(self.away[guard.args[0]] > self.away[divisor] / 2):
            del self.lengths[i]
            return False
        return True

    def counting(self, k: int) -> Interval:
        """The range of node ``k`` as far as it counts (`effective`)."""
        ends = self.effective.get(k, (-np.inf, np.inf))
        return np.clip(self.ranges[k][0], *ends), np.clip(self.ranges[k][1], *ends)

    def library_noise(self, op: Op, value: Interval) -> Noise:
        """The error of a library function whose results lie in ``value``."""
        if self.library.circle and op in (Op.SIN, Op.COS):
            value = -np.ones(self.boxes), np.ones(self.boxes)
        return Noise(2 * self.library.ulps(op) * self.form.half_ulp(iv.magnitude(value)) + self.form.tiny)

    def share(self, j: int, i: int) -> float | None:
        """s where |node i| is at most s h, h the length of ``j``, wherever errors are claimed."""
        length = self.lengths[j]
        bound = by_length.share(self, length, i)
        return None if bound is None else MOVED * (bound[0] + bound[1] / (SMALL_ANGLE * length.rho))

    def claimed(self, errors: Errors) -> Array:
        """The errors where they are largest of all that is claimed: where lengths are short."""
        parts = (over / (SMALL_ANGLE * self.lengths[j].rho) for j, over in errors.over.items())
        return np.asarray(sum(parts, errors.plain))

    def measured(self, j: int) -> Length:
        """The length by which node ``j`` divides, and how far it is off."""
        length = self.lengths[j]
        errors = self.errors([x for _, x in length.parts])
        squares = [(f * e) ** 2 for (f, _), e in zip(length.parts, errors.total, strict=True)]
        length.rho = float(np.sqrt(sum(squares)).max()) * GROW + SHORT
        return length

    def direction(self, i: int) -> Array:
        """How far an error across the vector of node ``i`` turns it, times its length."""
        self.measured(i)
        return np.full(self.boxes, MOVED)

    quotient_by_length = by_length.quotient_by_length
    root_of_squares = by_length.root_of_squares
    branch = by_length.branch

    # ---- errors

    def errors(self, roots: Sequence[int]) -> Errors:
        """How far the nodes ``roots`` may be off."""
        if not self.singular and all(k in self.upper for k in roots):
            return Errors(np.array([self.upper[k] for k in roots]), {}, (frozenset(),) * len(roots))
        with np.errstate(all="ignore"):
            return self._errors(roots)

    def _errors(self, roots: Sequence[int]) -> Errors:
        slopes: dict[int, Slope] = {}
        apart: dict[int, Slope] = {}  # what may be contracted: a rounding per use
        for row, k in enumerate(roots):
            self._reached(slopes, apart, k, Slope.unit(row, len(roots), self.boxes))
        plain = np.zeros((len(roots), self.boxes))
        over: dict[int, Array] = {}
        touched: list[set[int]] = [set() for _ in roots]
        for i in range(max(roots, default=-1), -1, -1):
            slope = slopes.pop(i, None)
            if slope is None:
                continue
            noise = self.noise[i]
            if noise is not None:
                plain = plain + self._effect_of_noise(apart.get(i, slope), noise, over)
            counts = {i} & (self.lengths.keys() | self.singular) | (
                noise.divisions if noise is not None else set()
            )
            for dependent in np.flatnonzero(slope.any()) if counts else ():
                touched[int(dependent)] |= counts
            for p in self.partials[i]:
                self._reached(slopes, apart, p.arg, slope.times(p, self))
        plain = np.nan_to_num(plain * GROW, nan=np.inf, posinf=np.inf)
        for row, k in enumerate(roots):
            if k in self.upper:
                plain[row] = np.minimum(plain[row], self.upper[k])
        over = {
            j: np.nan_to_num(v * GROW * _TURN, nan=np.inf, posinf=np.inf) for j, v in over.items() if v.any()
        }
        return Errors(plain, over, tuple(map(frozenset, touched)))

    def _reached(self, slopes: dict[int, Slope], apart: dict[int, Slope], k: int, more: Slope) -> None:
        """One more way from the roots to node ``k``."""
        slopes[k] = slopes[k].plus(more) if k in slopes else more
        if k in self.contracted:
            more = more.absolute()
            apart[k] = apart[k].plus(more) if k in apart else more

    def _effect_of_noise(self, slope: Slope, noise: Noise, over: dict[int, Array]) -> Array:
        """What the rounding of a node does to the roots, but for what is added to ``over``."""
        total = _product(slope.size, noise.size)
        for j, more in noise.over.items():
            a, b = slope.of(j)
            over[j] = over.get(j, 0.0) + _product(a, more)
            total = total + _product(b, more)  # h_j cancels
        for j, steep in slope.over.items():
            over[j] = over.get(j, 0.0) + _product(steep, noise.size)
            if noise.over:  # 1 / h twice: nothing is claimed
                total = np.where(steep != 0, np.inf, total)
        return total


def _product(size: Array, noise: Array) -> Array:
    return np.where((noise != 0) & (size != 0), size * noise, 0.0)
