"""Sizes, comparisons and choices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from wmrgen.ir import interval as iv
from wmrgen.ir.interval import Array, Interval
from wmrgen.ir.ops.analysis import Bounded, Fact, Noise, Partial, Value, Walk
from wmrgen.ir.ops.record import Choice, Op

# ---- absolute values


def _size_fact(a: Fact) -> Fact:
    hi = None if a.lo is None or a.hi is None else max(-a.lo, a.hi)
    return Fact.between(a.away, hi, a.away, a.nonzero)


def _size(w: Walk, i: int, a: int) -> Value:
    x, away = w.ranges[a], w.away[a]
    sign = np.where(x[0] >= 0, 1.0, -1.0), np.where(x[1] <= 0, -1.0, 1.0)
    least, most = iv.absolute(x)
    return Value((np.maximum(least, away), most), (Partial(a, sign),), away=away)


Op.ABS = Op(
    "abs", 1, abs, many=np.abs, parity=1, cost="signs",
    c="fabs{f}({0})", includes=("<math.h>",), numpy="np.abs({0})", casadi="OP_FABS",
    fact=_size_fact, interval=iv.absolute, lemma=_size,
    running=lambda unit, a: Bounded(np.abs(a.value), a.error),
)  # fmt: skip


# ---- the smaller and the larger


def _larger_fact(a: Fact, b: Fact) -> Fact:
    los = [lo for lo in (a.lo, b.lo) if lo is not None]
    hi = None if a.hi is None or b.hi is None else max(a.hi, b.hi)
    positive = (a.at_least_zero and a.nonzero) or (b.at_least_zero and b.nonzero)
    return Fact.between(
        max(los) if los else None, hi, min(a.away, b.away), positive or (a.nonzero and b.nonzero)
    )


def _smaller(w: Walk, i: int, a: int, b: int) -> Value:
    """The smaller moves with one of the two, and no further than it."""
    x, y = w.ranges[a], w.ranges[b]
    away = np.minimum(w.away[a], w.away[b])
    return _one_of_two(w, iv.smaller(x, y), away, {a: _taken(x, y), b: _taken(y, x)})


def _larger(w: Walk, i: int, a: int, b: int) -> Value:
    x, y = w.ranges[a], w.ranges[b]
    away = np.minimum(w.away[a], w.away[b])
    return _one_of_two(w, iv.larger(x, y), away, {a: _taken(y, x), b: _taken(x, y)})


def _less(a: Bounded, b: Bounded) -> Array:
    """+1 where a < b for sure, -1 where a >= b for sure, 0 where rounding decides or code may read the sign of a 0."""
    gap, slack = b.value - a.value, a.error + b.error
    zeros = (gap == 0) & (np.signbit(a.value) != np.signbit(b.value))
    sure = (np.abs(gap) > slack) | ((slack == 0) & ~zeros)
    return np.asarray(sure * np.where(gap > 0, 1, -1))


def _extreme_error(a: Bounded, b: Bounded, value: Array) -> Bounded:
    return Bounded(value, np.maximum(a.error, b.error), _less(a, b))


Op.MIN = Op(
    "min", 2, lambda a, b: a if a < b else b, many=np.minimum, commutative=True, cost="comparisons",
    # fminf would be a library call on most targets, and leaves the sign of zero open.
    c=Choice("({0} < {1}) ? {0} : {1}"), numpy="np.minimum({0}, {1})", casadi="OP_FMIN",
    fact=lambda a, b: -_larger_fact(-a, -b), interval=iv.smaller, lemma=_smaller,
    running=lambda unit, a, b: _extreme_error(a, b, np.where(a.value < b.value, a.value, b.value)),
)  # fmt: skip
Op.MAX = Op(
    "max", 2, lambda a, b: b if a < b else a, many=np.maximum, commutative=True, cost="comparisons",
    c=Choice("({0} < {1}) ? {1} : {0}"), numpy="np.maximum({0}, {1})", casadi="OP_FMAX",
    fact=_larger_fact, interval=iv.larger, lemma=_larger,
    running=lambda unit, a, b: _extreme_error(a, b, np.where(b.value < a.value, a.value, b.value)),
)  # fmt: skip


# ---- choices


def _choice(w: Walk, i: int, a: int, b: int, x: int, y: int) -> Value:
    """One value or the other, as the float program decides; on either side the comparison is known to hold."""
    limit = w.extremum(i)
    if limit is not None:
        return (_smaller if limit[0] is Op.MIN else _larger)(w, i, limit[1], limit[2])
    small, large = w.ranges[a], w.ranges[b]
    first, second = w.branch(i, a, b, x), w.branch(i, b, a, y)
    always, never = small[1] < large[0], small[0] > large[1]
    lo, hi, away = (
        np.where(always, p, np.where(never, q, choose(p, q)))
        for p, q, choose in zip(first, second, (np.minimum, np.maximum, np.minimum), strict=True)
    )
    taken = {x: _taken(small, large), y: _taken(large, small)}
    if x == y:
        taken = {x: (np.ones(w.boxes), np.ones(w.boxes))}
    return _one_of_two(w, (lo, hi), away, taken)


def _one_of_two(w: Walk, value: Interval, away: Array, taken_by: Mapping[int, Interval]) -> Value:
    """One of two values is off by no more than the one that is off more. ``taken_by``: derivatives, by value."""
    counting = [k for k, (_, most) in taken_by.items() if np.any(most) and w.noisy[k]]
    if len(counting) < 2:
        return Value(value, tuple(Partial(k, taken_by[k]) for k in counting), away=away)
    errors = w.errors(counting)
    taken = np.array([taken_by[k][1] for k in counting])
    over = {j: (o * taken).max(axis=0) for j, o in errors.over.items()}
    noise = Noise((errors.plain * taken).max(axis=0), over, frozenset[int]().union(*errors.divisions))
    return Value(value, (), noise, away, widen=False)


def _taken(small: Interval, large: Interval) -> Interval:
    """The derivative in what is chosen where small < large."""
    always, never = small[1] < large[0], small[0] > large[1]
    return np.where(always, 1.0, 0.0), np.where(never, 0.0, 1.0)


def _choice_error(unit: Array, a: Bounded, b: Bounded, x: Bounded, y: Bounded) -> Bounded:
    taken = _less(a, b)
    first = a.value < b.value
    value = np.where(first, x.value, y.value)
    apart = np.abs(x.value - y.value)
    either = np.where(first, np.maximum(x.error, apart + y.error), np.maximum(y.error, apart + x.error))
    error = np.where(taken == 1, x.error, np.where(taken == -1, y.error, either))
    return Bounded(value, error, taken)


def _casadi_choice(ca: Any, a: Any, b: Any, x: Any, y: Any) -> Any:
    chosen = ca.SX.binary(ca.OP_LT, a, b)
    first = ca.SX.binary(ca.OP_IF_ELSE_ZERO, chosen, x)
    second = ca.SX.binary(ca.OP_IF_ELSE_ZERO, ca.SX.unary(ca.OP_NOT, chosen), y)
    return ca.SX.binary(ca.OP_ADD, first, second)


Op.SELECT = Op(
    "select", 4, lambda a, b, x, y: x if a < b else y, many=lambda a, b, x, y: np.where(a < b, x, y),
    cost="comparisons",
    c=Choice("({0} < {1}) ? {2} : {3}"), numpy=Choice("np.where({0} < {1}, {2}, {3})"), casadi=_casadi_choice,
    fact=lambda a, b, x, y: x | y, interval=iv.chosen, lemma=_choice, running=_choice_error,
)  # fmt: skip


# ---- limits on sizes, in the C of some processors


def _clamped(a: float, m: float) -> float:
    if a != a:
        return m
    return math.copysign(m, a) if abs(a) > m else a


Op.CLAMP = Op(
    "clamp", 2, float64=_clamped, many=lambda a, m: np.clip(a, -m, m),
    c="wmrgen_clamp({0}, {1})", includes=("<stdint.h>",),
)  # fmt: skip
Op.AT_LEAST = Op(
    "at_least", 2, float64=lambda a, m: math.copysign(m, a) if abs(a) < m else a,
    many=lambda a, m: np.where(np.abs(a) < m, np.copysign(m, a), a),
    c="wmrgen_at_least({0}, {1})", includes=("<stdint.h>",),
)  # fmt: skip
Op.WITH_SIGN_OF = Op(
    "with_sign_of", 2, float64=lambda a, b: -a if math.copysign(1.0, b) < 0 else a,
    many=lambda a, b: np.where(np.signbit(b), -a, a),
    c="wmrgen_with_sign_of({0}, {1})", includes=("<stdint.h>",),
)  # fmt: skip
