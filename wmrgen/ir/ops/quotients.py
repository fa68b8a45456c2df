"""Quotients and square roots."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from math import isqrt
from typing import Any

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array
from wmrgen.geometry.exact.number import Exact, exact_sqrt
from wmrgen.ir.ops.analysis import Bounded, Noise, Partial, Value, Walk, rounded
from wmrgen.ir.ops.record import Op

DIGITS = 60  # decimal digits of exact numbers that are not in the field: far more than any float has


# ---- quotients


def _divided(a: float, b: float) -> float:
    """Return a / b as IEEE 754 does: a quotient by zero is an infinity or NaN."""
    if b:
        return a / b
    if not a or a != a or b != b:
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def _quotient(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound a / b: d(a / b) = (da - (a / b) db) / b, and one rounding; lengths that may vanish have their own bound."""
    if i in w.lengths and w.length_may_vanish(i, b):
        return w.quotient_by_length(i, a, b)
    away, below = w.away[b], w.ranges[b]
    holds = (below[0] <= 0) & (below[1] >= 0)
    w.alarm(i, "the divisor may be zero", holds & (away <= 0))
    w.note_near_zero(i, b)
    inverse, most = iv.reciprocal(below), np.nextafter(1.0 / away, np.inf)
    inverse = np.where(holds, -most, inverse[0]), np.where(holds, most, inverse[1])
    value = iv.times(w.ranges[a], inverse)
    partials = Partial(a, inverse), Partial(b, iv.negative(iv.times(value, inverse)))
    return Value(value, partials, Noise(w.rounded(value, i).size + w.form.tiny))


def _quotient_error(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    value = a.value / b.value
    least = np.abs(b.value) - b.error
    error = np.where(least > 0, (a.error + np.abs(value) * b.error) / least, np.inf)
    return rounded(value, error, unit)


Op.DIV = Op(
    "div", 2, operator.truediv, _divided, rounds=True, many=np.divide, cost="divisions",
    infix="/", casadi="OP_DIV",
    interval=iv.quotient, lemma=_quotient, running=_quotient_error,
)  # fmt: skip
Op.IDIV = Op(
    "idiv", 2, float32=Op.DIV.float32, many=np.divide, c="wmrgen_div({0}, {1})", includes=("<stdint.h>",)
)


# ---- roots


def _exact_root(a: Exact) -> Exact:
    """Return the square root; to 60 digits if it is not in the field."""
    root = exact_sqrt(a)
    if root is not None:
        return root
    if a.sign < 0:
        raise ValueError("square root of a negative number")
    q = a.rational()
    scale = 10 ** (DIGITS + 3) * max(1, isqrt(q.denominator // q.numerator))
    return Exact(Fraction(isqrt(q.numerator * scale * scale // q.denominator), scale))


def _root(w: Walk, i: int, a: int) -> Value:
    """Bound sqrt a: d sqrt a = da / (2 sqrt a), and one rounding; a root of squares is bounded as a length."""
    length = w.root_of_squares(i, a)
    if length is not None:
        return length
    below = w.ranges[a]
    value = iv.root(below)
    w.alarm(i, "the root's argument may be negative", below[0] < 0)
    steep = iv.reciprocal((2 * value[0], 2 * value[1]))
    return Value(value, (Partial(a, (np.maximum(steep[0], 0.0), steep[1])),), w.rounded(value, i))


def _root_error(unit: Array, a: Bounded) -> Bounded:
    value = np.sqrt(a.value)
    lower = np.sqrt(np.maximum(a.value - a.error, 0.0))
    error = np.where(a.error > 0, a.error / np.maximum(value + lower, 1e-300), 0.0)
    return rounded(value, np.minimum(error, np.sqrt(a.value + a.error)), unit)


def _casadi_root(ca: Any, x: Any) -> Any:
    """Return sqrt(x) for x >= 0, with derivative 0 at 0."""
    positive = ca.SX.binary(ca.OP_LT, ca.SX(0.0), x)
    safe = ca.SX.binary(ca.OP_ADD, x, ca.SX.unary(ca.OP_NOT, positive))
    return ca.SX.binary(ca.OP_MUL, ca.SX.unary(ca.OP_SQRT, safe), positive)


Op.SQRT = Op(
    "sqrt", 1, _exact_root, lambda a: math.sqrt(a) if a >= 0 else math.nan, rounds=True, many=np.sqrt,
    opaque=True, modular=False, fold=exact_sqrt, cost="roots",
    c="sqrt{f}({0})", includes=("<math.h>",), arrays="_sqrt(xp, {0})", casadi=_casadi_root,
    interval=iv.root, lemma=_root, running=_root_error,
)  # fmt: skip
Op.ISQRT = Op(
    "isqrt",
    1,
    float32=Op.SQRT.float32,
    many=np.sqrt,
    c="wmrgen_sqrt({0})",
    includes=("<math.h>", "<stdint.h>"),
)
