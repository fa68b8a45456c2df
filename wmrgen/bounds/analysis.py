"""Ranges and rounding errors of straight-line code over boxes of inputs.

Model: the float program computes v_i = op_i(v) + d_i with |d_i| at most half a unit in the last place of the largest
result (library functions: as many units as are assumed of them; constants: their own rounding). Call the program with
noise t d, 0 <= t <= 1: t = 1 is the float program, t = 0 the exact formula. By the mean value theorem an output
differs by at most sum_i |d_i| sup |dv/dd_i|, and interval arithmetic bounds the derivatives over every t and every
input of the box: forward differentiation, one row per source of noise. A comparison is taken as the float program
decides it, a rounding to a whole number likewise.

Directions of vectors that may vanish have no such bound: while t runs from 0 to 1, the angle follows the vector, whose
error rho turns it by at most rho/h each moment, h its length at that moment. Errors of what depends on it are claimed
where the exact length is 64 rho or more: 64/63 of rho over the exact length in all. What is multiplied by a value of
at most s h gets no more than s rho: a source of noise of its own (`Angle`). Ranges and alarms hold for every length.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import affine as af
from wmrgen.bounds import interval as iv
from wmrgen.bounds import slopes as sl
from wmrgen.bounds.affine import Affine
from wmrgen.bounds.arms import arm
from wmrgen.bounds.circles import Circles
from wmrgen.bounds.directions import Direction, Shares, directions
from wmrgen.bounds.interval import Array, Interval
from wmrgen.bounds.patterns import Term, contracted, largest_of
from wmrgen.bounds.precision import SMALL_ANGLE, Format, Library
from wmrgen.bounds.records import Analysis, Angle, Value
from wmrgen.bounds.slopes import Slope
from wmrgen.ir.nodes import Function, Node, Op

_EXACT = frozenset({"input", "neg", "abs", "min", "max", "select", "rint", "flip"})
_TURN_GROW = SMALL_ANGLE / (SMALL_ANGLE - 1) * (1 + 1e-4)
_SHORT = 2.0**-60  # below this length squares may underflow
_LINEAR = frozenset({Op.ADD, Op.SUB, Op.NEG, Op.MUL, Op.CONST})

Rule = Callable[["Pass", int, Node], Value]


class Pass:
    """One walk through the node list. The rules of the operations stand in `wmrgen.bounds.rules`.

    ``inputs``: (lo, hi) arrays by input name, one entry per box. ``twice``: sums that the code rounds once more than
    they stand here. ``given``: nodes whose values count as exact.
    """

    def __init__(
        self,
        function: Function,
        inputs: Mapping[str, Interval],
        form: Format,
        library: Library,
        twice: Collection[int] = (),
        given: Collection[int] = (),
    ) -> None:
        self.results = function.results
        self.nodes, self.inputs, self.form, self.library = function.nodes, inputs, form, library
        self.twice, self.given, self.current = frozenset(twice), frozenset(given), 0
        self.boxes = max((len(lo) for lo, _ in inputs.values()), default=1)
        self.result = Analysis(self.boxes)
        self.directions = directions(self.nodes)
        self.quotients = {d.quotient: d for d in self.directions.values() if d.quotient is not None}
        self.shares: dict[int, Shares] = {}
        self.rho: dict[int, Array] = {}
        self.sources: dict[int, int] = {}
        self.forms: list[Affine] = []
        self.arms = {i: found for i in range(len(self.nodes)) if (found := arm(self.nodes, i)) is not None}
        below = {node.args[1] for node in self.nodes if node.op is Op.DIV}
        self.divisors = {largest_of(self.nodes, k) for k in below}
        self.uses = contracted(self.nodes)
        self.rows: dict[int, dict[int, int]] = {i: {} for i in self.uses}
        row = 0
        for i, node in enumerate(self.nodes):
            if node.op not in _EXACT or i in self.directions:
                self.sources[i] = row
                row += 4 if i in self.directions else 1
            row += self.uses.get(i, 0)  # a row per use, beside the one for an output
        self._alternatives()
        self.result.noise = np.zeros((row, self.boxes))

    def _alternatives(self) -> None:
        """Sums between which a choice is made and which nothing else uses have one source: only one of them counts."""
        uses = Counter(k for node in self.nodes for k in node.args)
        uses.update(self.results)
        for node in self.nodes:
            if node.op is Op.SELECT:
                x, y = node.args[2:]
                sums = all(self.nodes[k].op in (Op.ADD, Op.SUB) and uses[k] == 1 for k in (x, y))
                if sums and x != y:
                    self.sources[y] = self.sources[x]

    @cached_property
    def circles(self) -> Circles:
        """What divisors are as polynomials of sines and cosines."""
        return Circles(self)

    def run(self) -> Analysis:
        from wmrgen.bounds.rules import RULES

        with np.errstate(all="ignore"):
            for i, node in enumerate(self.nodes):
                self.current = i
                self.record(i, node, RULES[node.op.value](self, i, node))
        for i in self.rows:
            self.result.slopes[i] = sl.with_source(self.result.slopes[i], self.sources[i], self.boxes)
        return self.result

    def record(self, i: int, node: Node, value: Value) -> None:
        """A result with its rounding."""
        found, slope, away, noise = value.range, value.slope, value.away, value.noise
        if noise is not None:
            row = self.sources[i]
            self.result.noise[row] = np.maximum(self.result.noise[row], noise)
            if i not in self.rows and noise.any():
                slope = self.sourced(slope, row)
            for extra in range(self.uses.get(i, 0)):
                self.result.noise[row + 1 + extra] = noise
            found = iv.widened(found, noise)
            away = None if away is None else away - noise
        if i in self.given:
            slope = None
        form = self._form(i, node)
        if form is None:
            form = af.atom(i, self.boxes)
        elif noise is not None:
            form = form.widened(noise)
        self.forms.append(form)
        fits = iv.magnitude(found) <= self.form.largest
        if not np.all(fits):
            self.alarm(i, "may overflow", ~fits)
            found = np.nan_to_num(found[0], nan=-np.inf), np.nan_to_num(found[1], nan=np.inf)
        least = iv.smallest(found)
        self.result.ranges.append(found)
        self.result.slopes.append(slope)
        self.result.away.append(least if away is None else np.maximum(least, away))

    def sourced(self, slope: Slope, row: int) -> Slope:
        """``slope`` of a result to which source ``row`` is added."""
        return sl.with_source(slope, row, self.boxes)

    def cut(self, value: Interval, op: Op, a: int, b: int, inverse: Interval | None = None) -> Interval:
        """``value``, the range of a op b (a / b with the ``inverse`` of b), as far as linear forms allow it."""
        if op in (Op.ADD, Op.SUB) and af.overlap(self.forms[a], self.forms[b], self.arms):
            form = af.combined(self.forms[a], self.forms[b], 1 if op is Op.ADD else -1)
            if form is not None:
                return iv.meet(value, form.range(self.result.ranges, self.arms))
        return value

    def _form(self, i: int, node: Node) -> Affine | None:
        """The linear form that a node is."""
        if node.op not in _LINEAR:
            return None
        if node.value is not None:
            value = float(node.value)
            return af.constant(value, abs(value) * 2.0**-52, self.boxes)
        forms = [self.forms[k] for k in node.args]
        if node.op is Op.NEG:
            return forms[0].scaled(-1.0)
        if node.op is Op.MUL:
            for c, x in (forms, forms[::-1]):
                if not c.terms:
                    width = c.slack * iv.magnitude(self.result.ranges[node.args[1]])
                    width = np.maximum(width, c.slack * iv.magnitude(self.result.ranges[node.args[0]]))
                    return x.scaled(c.constant).widened(width)
            return None
        return af.combined(forms[0], forms[1], 1 if node.op is Op.ADD else -1)

    # ---- what rules ask for

    def alarm(self, i: int, what: str, where: NDArray[np.bool_]) -> None:
        """An alarm on the boxes ``where``, if any."""
        if np.any(where):
            self.result.alarms.append((i, what, where))

    def range(self, i: int) -> Interval:
        return self.result.ranges[i]

    def slope(self, i: int) -> Slope:
        """Slope of an argument of the current node. What may be contracted has a rounding of its own there."""
        slope = self.result.slopes[i]
        if i not in self.rows:
            return slope
        row = self.sources[i] + 1 + self.rows[i].setdefault(self.current, len(self.rows[i]))
        return sl.with_source(slope, row, self.boxes)

    def error(self, i: int) -> Array:
        """How far an argument of the current node may be off."""
        return sl.weighed(self.slope(i), self.result.noise, self.boxes)

    def away(self, i: int) -> Array:
        return self.result.away[i]

    def rounding(self, value: Interval) -> Array:
        """The error of one rounding of results in ``value``."""
        return self.form.half_ulp(iv.magnitude(value))

    def library_noise(self, op: Op, value: Interval) -> Array:
        """The error of a library function whose results lie in ``value``."""
        if self.library.circle and op in (Op.SIN, Op.COS):
            value = -np.ones(self.boxes), np.ones(self.boxes)
        return 2 * self.library.ulps(op) * self.rounding(value) + self.form.tiny

    def turned(self, i: int, direction: Direction) -> Slope:
        """The slope of a direction: two sources, the angle's and the angle's times the length.

        A third is the rounding of a slope between limits times the length: a share of the slope, so that it has a
        bound as well.
        """
        squares = [(factor * factor, self.slope(k)) for factor, k in direction.parts]
        rho = sl.weighed(sl.norm(squares), self.result.noise, self.boxes) + _SHORT
        row = self.sources[i] + 1
        self.result.angles.append(Angle(i, row, direction.factor, rho * _TURN_GROW))
        self.result.noise[row] = direction.factor * _TURN_GROW / SMALL_ANGLE
        self.result.noise[row + 1] = direction.factor * rho * (1 + 1e-4)
        self.shares[row] = Shares(self.nodes, i, direction, self.result.ranges)
        self.rho[i] = rho
        if direction.kept:
            m, (factor, k) = direction.reach, direction.parts[1]
            most = factor * iv.magnitude(self.range(k))
            share = np.hypot(1.0, m) * most + m * rho
            far = iv.magnitude(self.range(direction.parts[0][1])) + most + rho
            self.result.noise[row + 2] = (
                direction.relative * self.form.unit * share * (1 + 1e-5) + self.form.tiny * far
            )
        return sl.with_source(None, row, self.boxes)

    def sum_slope(self, a: int, b: int, sign: int) -> Slope:
        """Slope of a + sign b."""
        return sl.plus(self.slope(a), self.slope(b), sign)

    def product_slope(self, a: int, b: int) -> Slope:
        """Slope of a b. Where b is at most s h, the slope of ``a`` in a direction counts as s, in that times h."""
        first = sl.times(self._kept(a, b), self.range(b))
        second = sl.times(self._kept(b, a), self.range(a))
        slope = sl.plus(first, second)
        for x, y in ((a, b), (b, a)):
            for row, to, share in self._shared(x, y):
                slope = sl.added(slope, to, self.magnitude(x, row) * share, self.boxes)
        return slope

    def magnitude(self, i: int, row: int) -> Array:
        """Largest slope of node ``i`` in a source."""
        slope = self.slope(i)
        if slope is None or slope[0].shape[0] <= row:
            return np.zeros(self.boxes)
        return np.asarray(np.maximum(-slope[0][row], slope[1][row]))

    def _shared(self, x: int, y: int) -> list[tuple[int, int, float]]:
        """Of directions on which x depends and of whose length y has a share: the source, its multiple, the share."""
        found, noise = [], self.result.noise
        for row, shares in self.shares.items():
            if np.any(self.magnitude(x, row)):
                share = shares.of(y)
                if share is not None:
                    found.append((row, row + 1, share * (1 + 1e-4)))
                    less = share * noise[row + 2] < iv.magnitude(self.range(y)) * noise[row - 1] * 0.999
                    if noise[row + 2].any() and np.all(less):
                        found.append((row - 1, row + 2, share * (1 + 1e-4)))
        return found

    def shared(self, a: int, b: int) -> bool:
        """Whether `product_slope` of the two moves anything."""
        return bool(self._shared(a, b) or self._shared(b, a))

    def lengthened(self, terms: Sequence[Term]) -> tuple[Slope, Array]:
        """Slope and error of the root of a sum of squares, from the errors of what is squared.

        The error of a length is at most the length of the error: its parts are a source of noise of their own. Only
        the directions on which it depends stay slopes.
        """
        squares, total = [], np.zeros(self.boxes)
        for t in terms:
            slope, kept = self.slope(t.base), None
            for row in self.shares:
                size = self.magnitude(t.base, row)
                if np.any(size):
                    slope, kept = sl.without(slope, row), sl.added(kept, row, size, self.boxes)
            squares.append((float(t.factor), kept))
            total = total + float(t.factor) * sl.weighed(slope, self.result.noise, self.boxes) ** 2
        return sl.norm(squares), np.asarray(np.sqrt(total) * iv.GROW)

    def _kept(self, x: int, y: int) -> Slope:
        """The slope of x without the rows that `product_slope` moves."""
        slope = self.slope(x)
        for row, _, _ in self._shared(x, y):
            slope = sl.without(slope, row)
        return slope
