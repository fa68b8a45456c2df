"""Ranges and rounding errors of straight-line code over boxes of inputs.

Model. The float program computes v_i = op_i(v) + d_i. The error |d_i| is at most half a unit in the last place of the
largest result. For library functions it is the number of units that is assumed of them, and for constants their own
rounding. Scale all d_i by t: t = 1 is the float program, t = 0 the exact formula. By the mean value theorem an output
differs from the exact one by at most sum_i |d_i| sup |dv/dd_i|. `Walk.run` bounds the values from the inputs to the
outputs. `Walk.errors` bounds the derivatives from the outputs back to the inputs, over every t and every input of the
box.

Comparisons and roundings to whole numbers are taken as the float program decides them. Next to a tie (two headings
equally near, a wheel about to turn back at its stop) it may take another branch than exact numbers would. Either
branch is right, and the error is that of the branch taken.

Vectors that may vanish. The quotient by the length h of a vector, and an atan2, have derivatives of up to 1/h. Such a
derivative is bounded by c / h with a known c. If it is multiplied later by a value of at most s h, the length cancels
and c s remains. Errors are claimed where h is at least `SMALL_ANGLE` times its own error.

What each operation does to ranges and derivatives is in its record in `wmrgen.ir.ops`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import GROW, Array, Interval, magnitude
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.bounds.assumptions import Format, Library, constant
from wmrgen.ir.bounds.forms import Forms, combined
from wmrgen.ir.bounds.patterns import (
    ROUNDINGS_OF_LENGTH,
    SHORT,
    SMALL_ANGLE,
    Length,
    Share,
    contracted,
    effective,
    facts,
    length_of,
    lengths,
    terms_below_root,
    underflow,
)
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.ops.analysis import Noise, Partial, Value

_SUMS = (Op.ADD, Op.SUB, Op.COMPENSATED)
# A divisor whose least absolute value is below this share of its largest makes the formula singular [1]: one rounding
# of the divisor, 6e-8 of the largest, is then 6 % of the quotient.
_SINGULAR = 1e-6
# Values without 1/h change by at most this factor while rounding errors grow from zero to their full size [1].
_MOVED = 1.05
_SHORTENED = 1.1  # the same for a quotient by a length that underflow may shorten [1]
# 1/h grows by at most this factor while h changes by 1/SMALL_ANGLE, with a margin for second-order terms [1].
_LENGTH_CHANGE = SMALL_ANGLE / (SMALL_ANGLE - 1) * (1 + 1e-4)


class Errors(NamedTuple):
    """Bounds of the errors of some nodes (rows) on every box: plain + sum of per_length[j] / h_j."""

    plain: Array  # rows x boxes
    per_length: Mapping[int, Array]  # by the node that divides by h_j; rows x boxes
    # By row: the divisions by lengths, and by divisors that come close to zero, on which the node depends.
    divisions: tuple[frozenset[int], ...]

    @property
    def total(self) -> Array:
        """Return the bounds without lengths; infinite where the error depends on a length."""
        if not self.per_length:
            return self.plain
        return np.where(sum(self.per_length.values()) > 0, np.inf, self.plain)


@dataclass(frozen=True, slots=True)
class Slope:
    """Bounds of the derivatives of some results (rows) in one node, on every box.

    The derivative is d = p + q with p in ``plain`` and |q| <= sum of per_length[j] / h_j. If the node depends on a
    division by h_j, p may have a second bound: |p| <= a + b h_j.
    """

    plain: Interval  # rows x boxes
    per_length: Mapping[int, Array] = field(default_factory=dict)  # by the node that divides by h_j
    # (a, b), by the node that divides by h_j.
    shared: Mapping[int, tuple[Array, Array]] = field(default_factory=dict)

    @classmethod
    def unit(cls, row: int, rows: int, boxes: int) -> Slope:
        """Return the derivative 1 in one row, 0 in the other rows.

        Args:
            row: the row.
            rows: the number of rows.
            boxes: the number of boxes.
        """
        derivative = np.zeros((rows, boxes))
        derivative[row] = 1.0
        return cls((derivative, derivative))

    @property
    def size(self) -> Array:
        """Return the largest absolute value of the plain part."""
        return magnitude(self.plain)

    def any(self) -> Array:
        """Return by row whether the derivative is not zero on some box."""
        return np.asarray(sum(self.per_length.values(), self.size).any(axis=1))

    def absolute(self) -> Slope:
        """Return bounds of the absolute value of the derivative."""
        return Slope((np.zeros_like(self.plain[0]), self.size), self.per_length)

    def second_bound(self, j: int) -> tuple[Array, Array]:
        """Return (a, b): the plain part is at most a + b h_j."""
        return self.shared.get(j) or (self.size, np.zeros(()))

    def plus(self, other: Slope) -> Slope:
        """Return bounds of the sum of two derivatives."""
        zeros = np.zeros(())
        per_length = {}
        for j in {**self.per_length, **other.per_length}:
            per_length[j] = self.per_length.get(j, zeros) + other.per_length.get(j, zeros)
        shared = {}
        for j in {**self.shared, **other.shared}:
            (a, b), (c, d) = self.second_bound(j), other.second_bound(j)
            shared[j] = a + c, b + d
        both_zero = _is_zero(self.plain) & _is_zero(other.plain)
        return Slope(_zero_where(both_zero, iv.plus(self.plain, other.plain)), per_length, shared)

    def times(self, p: Partial, walk: Walk) -> Slope:
        """Return the derivative in the argument of ``p``. This one is in the node that has ``p`` (chain rule)."""
        if isinstance(p.by, int):  # 1 or -1
            plain = self.plain if p.by > 0 else iv.negative(self.plain)
            return Slope(plain, self.per_length, self.shared)
        if p.length is not None and p.steep is not None:
            return self._times_per_length(p.length, p.steep)
        either_zero = _is_zero(self.plain) | _is_zero(p.by)
        plain = _zero_where(either_zero, iv.times(self.plain, p.by))
        behind = walk.lengths_behind[p.arg]
        if not behind and not self.per_length:
            return Slope(plain)
        size, cancelled = magnitude(p.by), np.zeros(())
        shares = {j: _share_of(p, walk, j) for j in behind | self.per_length.keys()}
        per_length = {}
        for j, c in self.per_length.items():
            s = shares[j]
            if s is None:
                per_length[j] = c * size
            else:
                cancelled = cancelled + c * s  # (c / h_j) (s h_j)
        shared = {}
        for j in behind:
            (a, b), s = self.second_bound(j), shares[j]
            if s is not None:
                shared[j] = cancelled, a * s + b * size
            elif j in self.shared:
                shared[j] = a * size + cancelled, b * size
        return Slope((plain[0] - cancelled, plain[1] + cancelled), per_length, shared)

    def _times_per_length(self, j: int, steep: Array) -> Slope:
        """Return the product with a factor of either sign that is at most ``steep`` / h_j."""
        a, b = self.second_bound(j)
        squared = sum(self.per_length.values(), np.zeros(())) != 0  # 1 / h**2: no bound is claimed
        bound = np.where(squared, np.inf, b * steep) + np.zeros_like(a)
        return Slope((-bound, bound), {j: np.where(a != 0, a * steep, 0.0)})


def _share_of(p: Partial, walk: Walk, j: int) -> float | None:
    """Return s if the derivative ``p`` is known to be at most s h_j, otherwise None."""
    s = None if p.like is None else walk.share(j, p.like)
    return None if s is None else s * abs(p.times)


def _is_zero(a: Interval) -> NDArray[np.bool_]:
    return np.asarray((a[0] == 0) & (a[1] == 0))


def _zero_where(zero: NDArray[np.bool_], value: Interval) -> Interval:
    """Return ``value``, without its outward rounding where it is exactly zero."""
    if not zero.any():
        return value
    return np.where(zero, 0.0, value[0]), np.where(zero, 0.0, value[1])


class Walk:
    """The analysis of one function over boxes of inputs: one pass forward for ranges, one back for errors.

    The lemmas of operations (`wmrgen.ir.ops`) read the results of earlier nodes from it, and call the methods of the
    second part.
    """

    def __init__(
        self,
        function: Function,
        inputs: Mapping[str, Interval],
        form: Format,
        library: Library,
        upper: Mapping[int, Array] | None = None,
    ) -> None:
        """Prepare the analysis; `run` does it.

        Args:
            function: the function, without calls.
            inputs: (low, high) by input name, in the input's unit; one entry per box.
            form: the floating-point format.
            library: the errors of sines and arctangents.
            upper: known bounds of errors, by node; one entry per box.
        """
        self.nodes, self.inputs = function.nodes, inputs
        self.form, self.library = form, library
        self.upper = upper or {}
        self.boxes = max((len(lo) for lo, _ in inputs.values()), default=1)
        self.lengths: dict[int, Length] = lengths(self.nodes)
        self.effective: Mapping[int, tuple[float, float]] = effective(function)
        self.contracted = contracted(self.nodes)
        # c c + s s of a computed cosine and sine differs from 1 by less than 16 errors of one of them.
        self.forms = Forms(self.nodes, self.boxes, 16 * library.ulps(Op.SIN) * form.unit)
        # One entry per node that was reached:
        self.ranges: list[Interval] = []  # of the exact and of the float result
        self.away: list[Array] = []  # lower bound of the absolute value: the distance away from zero
        self.noise: list[Noise | None] = []  # rounding error of the node itself
        self.partials: list[tuple[Partial, ...]] = []  # derivatives in the arguments
        self.noisy: list[bool] = []  # whether the node or a node on which it depends has noise
        # Lengths by which the node, or a node on which it depends, divides.
        self.lengths_behind: list[frozenset[int]] = []
        # (node, what is not shown, on which boxes)
        self.alarms: list[tuple[int, str, NDArray[np.bool_]]] = []
        self.singular: set[int] = set()  # divisions whose divisor comes close to zero

    def run(self, count: int | None = None) -> Walk:
        """Apply the lemma of each operation, to the first ``count`` nodes if that is given; return the walk itself."""
        with np.errstate(all="ignore"):
            for i, node in enumerate(self.nodes[:count]):
                op, args = node.meaning
                if op.lemma is None:
                    raise ValueError(f"operation {op} has no bounds: add interval and slopes to its record")
                self._record(i, op.lemma(self, i, *args))
        return self

    def _record(self, i: int, value: Value) -> None:
        """Record what a lemma says of node ``i``, and widen its range by its rounding."""
        interval, away, noise = value.range, value.away, value.noise
        size = np.zeros(()) if noise is None else noise.size
        if noise is not None and value.widen:
            interval = iv.widened(interval, size)
            away = None if away is None else away - size
        fits = magnitude(interval) <= self.form.largest
        if not np.all(fits):
            self.alarm(i, "may overflow", ~fits)
            interval = np.nan_to_num(interval[0], nan=-np.inf), np.nan_to_num(interval[1], nan=np.inf)
        least = iv.smallest(interval)
        self.forms.add(i, self.ranges, size + value.decided)
        self.ranges.append(interval)
        self.away.append(least if away is None else np.maximum(least, away))
        self.noise.append(noise)
        behind = frozenset((i,)) if i in self.lengths else frozenset[int]()
        if noise is not None:
            behind |= noise.divisions & self.lengths.keys()
        self.lengths_behind.append(behind.union(*(self.lengths_behind[p.arg] for p in value.partials)))
        self.partials.append(value.partials)
        self.noisy.append(noise is not None or any(self.noisy[p.arg] for p in value.partials))

    # ---- errors

    def errors(self, roots: Sequence[int]) -> Errors:
        """Return bounds of the errors of the nodes ``roots``, in their order."""
        if not self.singular and all(k in self.upper for k in roots):
            return Errors(np.array([self.upper[k] for k in roots]), {}, (frozenset(),) * len(roots))
        with np.errstate(all="ignore"):
            return self._errors(roots)

    def _errors(self, roots: Sequence[int]) -> Errors:
        slopes: dict[int, Slope] = {}
        apart: dict[int, Slope] = {}  # of products that may be contracted: each use has a rounding of its own
        for row, k in enumerate(roots):
            self._add_slope(slopes, apart, k, Slope.unit(row, len(roots), self.boxes))
        plain = np.zeros((len(roots), self.boxes))
        per_length: dict[int, Array] = {}
        divisions: list[set[int]] = [set() for _ in roots]
        for i in range(max(roots, default=-1), -1, -1):
            slope = slopes.pop(i, None)
            if slope is None:
                continue
            noise = self.noise[i]
            if noise is not None:
                plain = plain + self._effect_of_noise(apart.get(i, slope), noise, per_length)
            own = {i} & (self.lengths.keys() | self.singular)
            if noise is not None:
                own |= noise.divisions
            if own:
                for dependent in np.flatnonzero(slope.any()):
                    divisions[int(dependent)] |= own
            for p in self.partials[i]:
                self._add_slope(slopes, apart, p.arg, slope.times(p, self))
        plain = np.nan_to_num(plain * GROW, nan=np.inf, posinf=np.inf)
        for row, k in enumerate(roots):
            if k in self.upper:
                plain[row] = np.minimum(plain[row], self.upper[k])
        grown = {}
        for j, bound in per_length.items():
            if bound.any():
                grown[j] = np.nan_to_num(bound * GROW * _LENGTH_CHANGE, nan=np.inf, posinf=np.inf)
        return Errors(plain, grown, tuple(map(frozenset, divisions)))

    def _add_slope(self, slopes: dict[int, Slope], apart: dict[int, Slope], k: int, more: Slope) -> None:
        """Add the derivative along one more path from the roots to node ``k``."""
        slopes[k] = slopes[k].plus(more) if k in slopes else more
        if k in self.contracted:
            more = more.absolute()
            apart[k] = apart[k].plus(more) if k in apart else more

    def _effect_of_noise(self, slope: Slope, noise: Noise, per_length: dict[int, Array]) -> Array:
        """Return the effect of a rounding on the roots; the part that depends on lengths is added to ``per_length``."""
        total = _product(slope.size, noise.size)
        for j, more in noise.per_length.items():
            a, b = slope.second_bound(j)
            per_length[j] = per_length.get(j, 0.0) + _product(a, more)
            total = total + _product(b, more)  # (b h_j) (more / h_j)
        for j, steep in slope.per_length.items():
            per_length[j] = per_length.get(j, 0.0) + _product(steep, noise.size)
            if noise.per_length:  # 1 / h**2: no bound is claimed
                total = np.where(steep != 0, np.inf, total)
        return total

    def claimed(self, errors: Errors) -> Array:
        """Return the largest errors that are claimed: those at the shortest lengths for which there is a claim."""
        total = errors.plain
        for j, bound in errors.per_length.items():
            total = total + bound / (SMALL_ANGLE * self.lengths[j].error)
        return np.asarray(total)

    # ---- for the lemmas of operations (`wmrgen.ir.ops.analysis.Walk`)

    def alarm(self, i: int, what: str, where: NDArray[np.bool_]) -> None:
        """Record an operation that was not shown to be defined.

        Args:
            i: the node.
            what: what may happen.
            where: by box, whether it may happen there; nothing is recorded if it is nowhere true.
        """
        if np.any(where):
            self.alarms.append((i, what, where))

    def rounded(self, value: Interval, i: int) -> Noise:
        """Return the error of one rounding of results of node ``i`` in ``value``, within its effective range."""
        size = magnitude(value)
        if i in self.effective:
            size = np.minimum(size, max(map(abs, self.effective[i])))
        return Noise(self.form.half_ulp(size))

    def library_noise(self, op: Op, value: Interval) -> Noise:
        """Return the error of a library function whose results are in ``value``."""
        if self.library.circle and op in (Op.SIN, Op.COS):
            value = -np.ones(self.boxes), np.ones(self.boxes)
        return Noise(2 * self.library.ulps(op) * self.form.half_ulp(magnitude(value)) + self.form.tiny)

    def constant(self, value: Exact) -> tuple[float, float, float, bool]:
        """Return `wmrgen.ir.bounds.assumptions.constant`."""
        return constant(value)

    def decision_error(self, k: int) -> Array:
        """Return how far node ``k`` may be off when the float program decides by it."""
        return np.asarray(self.claimed(self.errors((k,)))[0])

    def range_of_sum(self, a: int, b: int, sign: int, value: Interval) -> Interval:
        """Return the range of a sum or difference, which is smaller if terms cancel or share an angle.

        Args:
            a: the first node.
            b: the second node.
            sign: 1 for a + b, -1 for a - b.
            value: the sum or difference of the ranges.
        """
        if not self.forms.overlap(a, b):
            return value
        form = combined(self.forms.list[a], self.forms.list[b], sign)
        return value if form is None else iv.meet(value, self.forms.range(form, self.ranges))

    def effective_range(self, k: int) -> Interval:
        """Return the range of node ``k``, cut to the values that can change a result (`effective`)."""
        ends = self.effective.get(k, (-np.inf, np.inf))
        return np.clip(self.ranges[k][0], *ends), np.clip(self.ranges[k][1], *ends)

    def branch(self, small: int, large: int, value: int) -> tuple[Array, Array, Array]:
        """Bound a value in the branch that is taken because small < large.

        Args:
            small: the node on the left of the comparison.
            large: the node on the right.
            value: the node that is chosen; the comparison bounds it if it is one of them.

        Returns:
            (low, high, lower bound of the absolute value). The comparison holds up to the errors of both sides.
        """
        interval, away = self.ranges[value], self.away[value]
        far = np.full(self.boxes, np.inf)
        if value in (small, large):
            slack = self.errors([small, large]).total.sum(axis=0)
            if value == large:
                interval = iv.meet(interval, (self.ranges[small][0] - slack, far))
            else:
                interval = iv.meet(interval, (-far, self.ranges[large][1] + slack))
        return interval[0], interval[1], np.maximum(away, iv.smallest(interval))

    def note_near_zero(self, i: int, divisor: int) -> None:
        """Record division ``i`` as singular if its divisor comes close to zero."""
        if np.any(self.away[divisor] < _SINGULAR * magnitude(self.ranges[divisor]).max()):
            self.singular.add(i)

    # ---- for lemmas: vectors that may vanish

    def length_may_vanish(self, i: int, divisor: int) -> bool:
        """Return whether the length by which node ``i`` divides may vanish; if not, forget that it is a length."""
        guard = self.nodes[divisor]
        if guard.op is Op.AT_LEAST and np.all(self.away[guard.args[0]] > self.away[divisor] / 2):
            del self.lengths[i]
            return False
        return True

    def measure_length(self, j: int) -> Length:
        """Return the length by which node ``j`` divides, after bounding its error."""
        length = self.lengths[j]
        errors = self.errors([x for _, x in length.parts])
        squares = [(f * e) ** 2 for (f, _), e in zip(length.parts, errors.total, strict=True)]
        length.error = float(np.sqrt(sum(squares)).max()) * GROW + SHORT
        return length

    def direction_slope(self, i: int) -> Array:
        """Return c: an error e of the vector whose direction node ``i`` is turns it by at most c e / h."""
        self.measure_length(i)
        return np.full(self.boxes, _MOVED)

    def quotient_by_length(self, i: int, a: int, b: int) -> Value:
        """Bound a quotient n / d by the length h of a vector: d(n / d) is at most (|dn| + |n / d| |dd|) / h.

        Args:
            i: the node of the quotient.
            a: the node n.
            b: the node d, which is at least h.
        """
        length, least = self.measure_length(i), self.away[b]
        reach = magnitude(self.ranges[a]) / least
        ratio = self.share_of_length(length, a)
        if ratio is not None:
            s, rest = ratio
            lost = (s * underflow(length.parts) + rest) / least
            reach = np.minimum(reach, (s + lost) * _SHORTENED)
        value = -reach, reach
        ends = self.effective.get(i, (-np.inf, np.inf))
        most = np.minimum(reach, max(map(abs, ends)))
        if len(length.parts) == 1 and np.isfinite(most).all():
            # If the quotient is within its limit, |n| is no larger than the limit times h. If not, the limit
            # replaces the quotient.
            limit = float(most.max()) * length.parts[0][0] * ROUNDINGS_OF_LENGTH
            length.facts += facts(self.nodes, a, limit)
            length.shares.clear()
        partials = (
            Partial(a, value, length=i, steep=np.full(self.boxes, _MOVED)),
            Partial(b, value, length=i, steep=most * _MOVED),
        )
        return Value(value, partials, Noise(self.rounded(value, i).size + self.form.tiny))

    def root_of_squares(self, i: int, a: int) -> Value | None:
        """Bound node ``i``, the root of node ``a``, if that is a sum of squares; None otherwise.

        The root moves by no more than the length of the vector of the errors of what is squared.
        """
        terms = terms_below_root(self.nodes, a)
        if not all(t.squared for t in terms):
            return None
        factors = np.array([[float(t.factor)] for t in terms])
        bases = [t.base for t in terms]
        squares = [f * magnitude(self.ranges[k]) ** 2 for f, k in zip(factors, bases, strict=True)]
        longest = np.sqrt(sum(squares)) * ROUNDINGS_OF_LENGTH + self.form.tiny**0.5
        value = iv.meet(iv.root(self.ranges[a]), (np.zeros(self.boxes), longest))
        errors = self.errors(bases)
        moved = np.sqrt((factors * errors.plain**2).sum(axis=0)) * GROW
        per_length = {}
        for j, bound in errors.per_length.items():
            per_length[j] = np.sqrt((factors * bound**2).sum(axis=0)) * GROW
        # A term passes this many roundings on its way into the sum, each a relative error of the sum at most.
        most_roundings = max(t.roundings for t in terms)
        below_root = most_roundings * self.form.unit / 2 * ROUNDINGS_OF_LENGTH * value[1]
        rounded = self.rounded(value, i).size + below_root + np.sqrt(2 * len(terms) * self.form.tiny)
        noise = Noise(rounded + moved, per_length, frozenset[int]().union(*errors.divisions))
        widened = iv.widened(value, rounded)
        return Value((np.maximum(widened[0], 0.0), widened[1]), (), noise, widen=False)

    def share(self, j: int, i: int) -> float | None:
        """Return s with |node i| <= s h wherever errors are claimed, h the length of ``j``; None if s is not known."""
        length = self.lengths[j]
        bound = self.share_of_length(length, i)
        if bound is None:
            return None
        s, rest = bound
        return _MOVED * (s + rest / (SMALL_ANGLE * length.error))

    def share_of_length(self, length: Length, i: int) -> Share | None:
        """Return (s, a) with |node i| <= s h + a, roundings included; None if nothing is known of the node."""
        if i not in length.shares:
            length.shares[i] = None  # ends the recursion for nodes that are asked for while they are computed
            known = next(((s * ROUNDINGS_OF_LENGTH, 0.0) for x, s in length.facts if i == x), None)
            length.shares[i] = known or self._computed_share(length, i)
        return length.shares[i]

    def _computed_share(self, length: Length, i: int) -> Share | None:
        """Return the share of a node from the shares of its arguments."""
        node = self.nodes[i]
        if node.value is not None:
            return None if node.value else (0.0, 0.0)
        if node.op in (Op.NEG, Op.ABS, Op.FLIP, Op.WITH_SIGN_OF):
            return self.share_of_length(length, node.args[0])
        if node.op is Op.SQRT:
            if length_of(self.nodes, i) != length.parts:
                return None
            return ROUNDINGS_OF_LENGTH, underflow(length.parts)
        if node.op is Op.MUL:
            for k, other in (node.args, node.args[::-1]):
                inner = self.share_of_length(length, k)
                if inner is not None:
                    most = float(magnitude(self.ranges[other]).max()) * ROUNDINGS_OF_LENGTH
                    return inner[0] * most, inner[1] * most + self.form.tiny
            return None
        if node.op not in _SUMS:
            return None
        shares = [self.share_of_length(length, k) for k in node.args]
        known = [share for share in shares if share is not None]
        if len(known) < len(shares):
            return None
        s, rest = (sum(column) * ROUNDINGS_OF_LENGTH for column in zip(*known, strict=True))
        return s, rest


def _product(size: Array, noise: Array) -> Array:
    """Return size * noise, zero where either is zero and the other infinite."""
    return np.where((noise != 0) & (size != 0), size * noise, 0.0)
