"""Absolute values, comparisons and choices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, Interval
from wmrgen.ir.ops.analysis import Bounded, Noise, Partial, Value, Walk
from wmrgen.ir.ops.record import Conditional, Op

# ---- absolute values


def _size(w: Walk, i: int, a: int) -> Value:
    x, away = w.ranges[a], w.away[a]
    sign = np.where(x[0] >= 0, 1.0, -1.0), np.where(x[1] <= 0, -1.0, 1.0)
    least, most = iv.absolute(x)
    return Value((np.maximum(least, away), most), (Partial(a, sign),), away=away)


Op.ABS = Op(
    "abs", 1, abs, many=np.abs, parity=1, cost="signs",
    c="fabs{f}({0})", rust="wmrgen_abs({0})", javascript="Math.abs({0})", includes=("<math.h>",), arrays="xp.abs({0})",
    casadi="OP_FABS",
    interval=iv.absolute, lemma=_size,
    running=lambda unit, a: Bounded(np.abs(a.value), a.error),
)  # fmt: skip


# ---- the smaller and the larger


def _smaller(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound min(a, b): it changes as one of the two arguments does."""
    x, y = w.ranges[a], w.ranges[b]
    away = np.minimum(w.away[a], w.away[b])
    return _one_of_two(w, iv.smaller(x, y), away, {a: _derivative(x, y), b: _derivative(y, x)})


def _larger(w: Walk, i: int, a: int, b: int) -> Value:
    x, y = w.ranges[a], w.ranges[b]
    away = np.minimum(w.away[a], w.away[b])
    return _one_of_two(w, iv.larger(x, y), away, {a: _derivative(y, x), b: _derivative(x, y)})


def _less(a: Bounded, b: Bounded) -> Array:
    """Return +1 if a < b and -1 if a >= b is certain, 0 if rounding decides or code may read the sign of a zero."""
    gap, slack = b.value - a.value, a.error + b.error
    zeros = (gap == 0) & (np.signbit(a.value) != np.signbit(b.value))
    sure = (np.abs(gap) > slack) | ((slack == 0) & ~zeros)
    return np.asarray(sure * np.where(gap > 0, 1, -1))


def _extreme_error(a: Bounded, b: Bounded, value: Array) -> Bounded:
    return Bounded(value, np.maximum(a.error, b.error), _less(a, b))


Op.MIN = Op(
    "min", 2, lambda a, b: a if a < b else b, many=np.minimum, commutative=True, cost="comparisons",
    # fminf is a library call on most targets, and does not define the sign of zero.
    c=Conditional("({0} < {1}) ? {0} : {1}"), rust=Conditional("if {0} < {1} {{ {0} }} else {{ {1} }}"),
    arrays="_minimum(xp, {0}, {1})", casadi="OP_FMIN",
    interval=iv.smaller, lemma=_smaller,
    running=lambda unit, a, b: _extreme_error(a, b, np.where(a.value < b.value, a.value, b.value)),
)  # fmt: skip
Op.MAX = Op(
    "max", 2, lambda a, b: b if a < b else a, many=np.maximum, commutative=True, cost="comparisons",
    c=Conditional("({0} < {1}) ? {1} : {0}"), rust=Conditional("if {0} < {1} {{ {1} }} else {{ {0} }}"),
    arrays="_maximum(xp, {0}, {1})", casadi="OP_FMAX",
    interval=iv.larger, lemma=_larger,
    running=lambda unit, a, b: _extreme_error(a, b, np.where(b.value < a.value, a.value, b.value)),
)  # fmt: skip


# ---- choices


def _choice(w: Walk, i: int, a: int, b: int, x: int, y: int) -> Value:
    """Bound a choice, which the float program decides; within each branch its comparison is known to hold."""
    small, large = w.ranges[a], w.ranges[b]
    first, second = w.branch(a, b, x), w.branch(b, a, y)
    always, never = small[1] < large[0], small[0] > large[1]
    lo, hi, away = (
        np.where(always, p, np.where(never, q, choose(p, q)))
        for p, q, choose in zip(first, second, (np.minimum, np.maximum, np.minimum), strict=True)
    )
    slopes = {x: _derivative(small, large), y: _derivative(large, small)}
    if x == y:
        slopes = {x: (np.ones(w.boxes), np.ones(w.boxes))}
    return _one_of_two(w, (lo, hi), away, slopes)


def _one_of_two(w: Walk, value: Interval, away: Array, slopes: Mapping[int, Interval]) -> Value:
    """Bound one of two values: its error is at most the larger of the two. ``slopes`` has the derivatives, by value."""
    counting = [k for k, (_, most) in slopes.items() if np.any(most) and w.noisy[k]]
    if len(counting) < 2:
        return Value(value, tuple(Partial(k, slopes[k]) for k in counting), away=away)
    errors = w.errors(counting)
    steepest = np.array([slopes[k][1] for k in counting])
    per_length = {j: (bound * steepest).max(axis=0) for j, bound in errors.per_length.items()}
    noise = Noise(
        (errors.plain * steepest).max(axis=0), per_length, frozenset[int]().union(*errors.divisions)
    )
    return Value(value, (), noise, away, widen=False)


def _derivative(small: Interval, large: Interval) -> Interval:
    """Return the derivative in the value that is chosen if small < large."""
    always, never = small[1] < large[0], small[0] > large[1]
    return np.where(always, 1.0, 0.0), np.where(never, 0.0, 1.0)


def _choice_error(unit: Array, a: Bounded, b: Bounded, x: Bounded, y: Bounded) -> Bounded:
    outcome = _less(a, b)
    first = a.value < b.value
    value = np.where(first, x.value, y.value)
    apart = np.abs(x.value - y.value)
    either = np.where(first, np.maximum(x.error, apart + y.error), np.maximum(y.error, apart + x.error))
    error = np.where(outcome == 1, x.error, np.where(outcome == -1, y.error, either))
    return Bounded(value, error, outcome)


def _casadi_choice(ca: Any, a: Any, b: Any, x: Any, y: Any) -> Any:
    chosen = ca.SX.binary(ca.OP_LT, a, b)
    first = ca.SX.binary(ca.OP_IF_ELSE_ZERO, chosen, x)
    second = ca.SX.binary(ca.OP_IF_ELSE_ZERO, ca.SX.unary(ca.OP_NOT, chosen), y)
    return ca.SX.binary(ca.OP_ADD, first, second)


Op.SELECT = Op(
    "select", 4, lambda a, b, x, y: x if a < b else y, many=lambda a, b, x, y: np.where(a < b, x, y),
    cost="comparisons",
    c=Conditional("({0} < {1}) ? {2} : {3}"), rust=Conditional("if {0} < {1} {{ {2} }} else {{ {3} }}"),
    arrays=Conditional("_select(xp, {0}, {1}, {2}, {3})"), casadi=_casadi_choice,
    interval=iv.chosen, lemma=_choice, running=_choice_error,
)  # fmt: skip


# ---- limits on sizes, and signs


def _clamped(a: float, m: float) -> float:
    if a != a:
        return m
    return math.copysign(m, a) if abs(a) > m else a


def _clamped_range(x: Interval, m: Interval) -> Interval:
    """Return the range of clamp(x, m), which grows with x and whose absolute value grows with m."""
    low = np.where(x[0] > 0, np.minimum(x[0], m[0]), np.maximum(x[0], -m[1]))
    high = np.where(x[1] > 0, np.minimum(x[1], m[1]), np.maximum(x[1], -m[0]))
    return low, high


def _clamp(w: Walk, i: int, a: int, m: int) -> Value:
    """Bound clamp(a, m): it changes as one of the two arguments does."""
    x, limit = w.ranges[a], w.ranges[m]
    inside, outside = _derivative(iv.absolute(x), limit), _derivative(limit, iv.absolute(x))
    away = np.minimum(w.away[a], limit[0])
    return _one_of_two(w, _clamped_range(x, limit), away, {a: inside, m: (-outside[1], outside[1])})


def _clamp_error(unit: Array, a: Bounded, m: Bounded) -> Bounded:
    return _extreme_error(Bounded(np.abs(a.value), a.error), m, np.clip(a.value, -m.value, m.value))


def _casadi_clamp(ca: Any, a: Any, m: Any) -> Any:
    return ca.SX.binary(ca.OP_FMAX, ca.SX.unary(ca.OP_NEG, m), ca.SX.binary(ca.OP_FMIN, m, a))


Op.CLAMP = Op(
    "clamp", 2, lambda a, m: m if m < a else -m if a < -m else a, _clamped,
    many=lambda a, m: np.clip(a, -m, m), cost="comparisons",
    c="wmrgen_clamp({0}, {1})", javascript="_clamp({0}, {1})", includes=("<stdint.h>",),
    arrays="_clamp(xp, {0}, {1})", casadi=_casadi_clamp,
    interval=_clamped_range, lemma=_clamp, running=_clamp_error,
)  # fmt: skip


def _with_sign(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound a or -a; the float program decides."""
    x, sign = w.ranges[a], w.ranges[b]
    steep = np.where(sign[0] > 0, 1.0, -1.0), np.where(sign[1] < 0, -1.0, 1.0)
    return Value(iv.times(x, steep), (Partial(a, steep),), away=w.away[a])


def _with_sign_error(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    zero = Bounded(np.zeros_like(b.value), np.zeros_like(b.error))
    return _choice_error(unit, b, zero, Bounded(-a.value, a.error), a)


def _casadi_with_sign(ca: Any, a: Any, b: Any) -> Any:
    return _casadi_choice(ca, b, ca.SX(0.0), ca.SX.unary(ca.OP_NEG, a), a)


Op.WITH_SIGN_OF = Op(
    "with_sign_of", 2, lambda a, b: -a if b.sign < 0 else a,
    lambda a, b: -a if math.copysign(1.0, b) < 0 else a,
    many=lambda a, b: np.where(np.signbit(b), -a, a), cost="signs",
    c="wmrgen_with_sign_of({0}, {1})", javascript=Conditional("_is_negative({1}) ? -({0}) : {0}"),
    includes=("<stdint.h>",),
    arrays=Conditional("_with_sign_of(xp, {0}, {1})"), casadi=_casadi_with_sign,
    interval=iv.either_sign, lemma=_with_sign, running=_with_sign_error,
)  # fmt: skip


def _at_least_range(x: Interval, m: Interval) -> Interval:
    """Return the range of at_least(x, m), which grows with x and jumps from -m to m at 0."""
    lo = np.where(x[0] > m[1], x[0], -np.maximum(-x[0], m[1]))
    return lo, np.where(x[1] < -m[1], x[1], np.maximum(x[1], m[1]))


def _at_least(w: Walk, i: int, a: int, m: int) -> Value:
    """Bound at_least(a, m): it changes as one of the two arguments does; the float program decides the sign."""
    x, least = w.ranges[a], w.ranges[m]
    lo = np.where(x[0] > least[1], x[0], np.where(x[0] > 0, least[0], np.minimum(x[0], -least[1])))
    hi = np.where(x[1] < -least[1], x[1], np.where(x[1] < 0, -least[0], np.maximum(x[1], least[1])))
    inside, outside = _derivative(iv.absolute(x), least), _derivative(least, iv.absolute(x))
    away = np.maximum(w.away[a], least[0])
    return _one_of_two(w, (lo, hi), away, {a: outside, m: (-inside[1], inside[1])})


def _at_least_error(unit: Array, a: Bounded, m: Bounded) -> Bounded:
    size = Bounded(np.abs(a.value), a.error)
    kept = _extreme_error(size, m, np.maximum(size.value, m.value))
    return _with_sign_error(unit, kept, a)._replace(outcome=kept.outcome)


def _casadi_at_least(ca: Any, a: Any, m: Any) -> Any:
    return _casadi_choice(ca, ca.SX.unary(ca.OP_FABS, a), m, _casadi_with_sign(ca, m, a), a)


Op.AT_LEAST = Op(
    "at_least", 2, lambda a, m: (-m if a.sign < 0 else m) if abs(a) < m else a,
    lambda a, m: math.copysign(m, a) if abs(a) < m else a,
    many=lambda a, m: np.where(np.abs(a) < m, np.copysign(m, a), a), cost="comparisons",
    c="wmrgen_at_least({0}, {1})", javascript="_at_least({0}, {1})", includes=("<stdint.h>",),
    arrays=Conditional("_at_least(xp, {0}, {1})"), casadi=_casadi_at_least,
    interval=_at_least_range, lemma=_at_least, running=_at_least_error,
)  # fmt: skip
