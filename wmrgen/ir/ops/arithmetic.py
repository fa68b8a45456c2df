"""Constants, inputs, sums, products, and calls of kernels."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from math import copysign, isfinite, nextafter
from struct import pack, unpack

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, Interval
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.ops.analysis import Bounded, Noise, Partial, Value, Walk, rounded
from wmrgen.ir.ops.record import Op
from wmrgen.ir.rounding import nearest_float32, to_float64

# ---- constants and inputs


def _constant(w: Walk, i: int) -> Value:
    """Bound a constant; its error is its own rounding."""
    lo, hi, error, _ = w.constant(w.nodes[i].value)
    value = np.full(w.boxes, lo), np.full(w.boxes, hi)
    return Value(value, noise=Noise(np.full(w.boxes, error)) if error else None)


Op.CONST = Op("const", 0, lemma=_constant)
Op.INPUT = Op("input", 0, lemma=lambda w, i: Value(w.inputs[w.nodes[i].name or ""]))
Op.CALL = Op("call", 0)
Op.RESULT = Op("result", 1)


# ---- sums


def _sum(w: Walk, i: int, a: int, b: int, roundings: float = 1.0) -> Value:
    """Bound a + b: d(a + b) = da + db, and one rounding, or two in a compensated sum. Common terms cancel.

    If both terms are non-negative, the rounded sum is no smaller than the larger of them, up to its relative rounding.
    """
    x, y = w.ranges[a][0], w.ranges[b][0]
    value = w.range_of_sum(a, b, 1, iv.plus(w.ranges[a], w.ranges[b]))
    noise = Noise(w.rounded(value, i).size * roundings)
    low, high = iv.widened(value, noise.size)
    least = np.maximum(low, np.maximum(x, y) * (1 - w.form.unit))
    value = np.where(np.minimum(x, y) >= 0, least, low), high
    return Value(value, (Partial(a, 1), Partial(b, 1)), noise, widen=False)


def _difference(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound a - b: d(a - b) = da - db, and one rounding. Common terms cancel."""
    value = w.range_of_sum(a, b, -1, iv.minus(w.ranges[a], w.ranges[b]))
    return Value(value, (Partial(a, 1), Partial(b, -1)), w.rounded(value, i))


Op.ADD = Op(
    "add", 2, operator.add, rounds=True, many=np.add, commutative=True, cost="additions",
    infix="+", casadi="OP_ADD",
    interval=iv.plus, lemma=_sum,
    running=lambda unit, a, b: rounded(a.value + b.value, a.error + b.error, unit),
)  # fmt: skip
Op.SUB = Op(
    "sub", 2, operator.sub, rounds=True, many=np.subtract, cost="additions",
    infix="-", casadi="OP_SUB",
    interval=iv.minus, lemma=_difference,
    running=lambda unit, a, b: rounded(a.value - b.value, a.error + b.error, unit),
)  # fmt: skip
Op.COMPENSATED = Op(
    "compensated", 2, operator.add, rounds=True, many=np.add, cost="additions",
    infix="+", casadi="OP_ADD",
    interval=iv.plus, lemma=lambda w, i, a, b: _sum(w, i, a, b, 2.0),
    running=lambda unit, a, b: rounded(a.value + b.value, a.error + b.error, 2 * unit),
)  # fmt: skip


def _two_sum(a: float, b: float, rounded_to: Callable[[float], float] = float) -> float:
    """Return the error of the rounding of a + b (Knuth's TwoSum, Higham 4.3)."""
    total = rounded_to(a + b)
    second = rounded_to(total - a)
    return rounded_to(rounded_to(a - rounded_to(total - second)) + rounded_to(b - second))


def _error_within(a: Interval, b: Interval) -> Interval:
    """Return the range of the rounding error of a sum, for floats of any type."""
    most = iv.magnitude(iv.plus(a, b)) * 2.0**-23
    return -most, most


def _error_of_sum(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound what a sum of floats loses when it is rounded; for exact numbers that is 0.

    Its size follows from the size of the sum, wherever limits of the result are (so not by `Walk.rounded`).
    """
    zero = np.zeros(w.boxes)
    lost = w.form.half_ulp(iv.magnitude(iv.plus(w.ranges[a], w.ranges[b])))
    return Value((zero, zero), noise=Noise(lost))


def _error_of_sums(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    size = np.abs(a.value + b.value) + a.error + b.error
    return Bounded(np.zeros_like(a.value + b.value), unit * size)


# For exact numbers it is zero, but a pass must not replace it by zero. So checks take it as an arbitrary function.
Op.ROUNDING_ERROR = Op(
    "rounding_error", 2, lambda a, b: a - a, _two_sum, lambda a, b: _two_sum(a, b, nearest_float32),
    many=lambda a, b: (a - ((a + b) - ((a + b) - a))) + (b - ((a + b) - a)), opaque=True, rounds=True, cost="additions",
    javascript="_rounding_error({0}, {1})",
    arrays="(({0} - (({0} + {1}) - (({0} + {1}) - {0}))) + ({1} - (({0} + {1}) - {0})))",
    casadi=lambda ca, a, b: ca.SX(0.0),
    interval=_error_within, lemma=_error_of_sum, running=_error_of_sums,
)  # fmt: skip
Op.NEG = Op(
    "neg", 1, operator.neg, many=np.negative, parity=-1, cost="signs",
    infix="-", casadi="OP_NEG",
    interval=iv.negative,
    lemma=lambda w, i, a: Value(iv.negative(w.ranges[a]), (Partial(a, -1),), away=w.away[a]),
    running=lambda unit, a: Bounded(-a.value, a.error),
)  # fmt: skip


# ---- products


def _product(w: Walk, i: int, a: int, b: int) -> Value:
    """Bound a b: d(a b) = b da + a db."""
    x, y = w.ranges[a], w.ranges[b]
    partials = Partial(a, w.effective_range(b), like=b), Partial(b, w.effective_range(a), like=a)
    return _multiplied(w, i, a, b, iv.times(x, y), partials)


def _square(w: Walk, i: int, a: int) -> Value:
    x = w.ranges[a]
    return _multiplied(w, i, a, a, iv.square(x), (Partial(a, (2 * x[0], 2 * x[1]), like=a, times=2.0),))


def _multiplied(w: Walk, i: int, a: int, b: int, value: Interval, partials: tuple[Partial, ...]) -> Value:
    """Bound a product; it has one rounding, or none if a factor is a power of two."""
    exact = _exact_factor(w, a) or _exact_factor(w, b)
    size = np.zeros(w.boxes) if exact else w.rounded(value, i).size
    return Value(value, partials, Noise(size + w.form.tiny), w.away[a] * w.away[b] * (1 - 1e-15))


def _exact_factor(w: Walk, k: int) -> bool:
    """Return whether products with node ``k`` are exact: it is a power of two, or a whole number up to two."""
    node = w.nodes[k]
    if node.op is Op.WITH_SIGN_OF:
        return _exact_factor(w, node.args[0])
    if node.value is not None:
        _, _, error, power = w.constant(node.value)
        return power and not error
    return node.op is Op.RINT and bool(np.all(iv.magnitude(w.ranges[k]) <= 2.0))


def _product_error(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    error = np.abs(a.value) * b.error + np.abs(b.value) * a.error + a.error * b.error
    return rounded(a.value * b.value, error, unit)


def _square_error(unit: Array, a: Bounded) -> Bounded:
    return rounded(a.value * a.value, (2 * np.abs(a.value) + a.error) * a.error, unit)


Op.MUL = Op(
    "mul", 2, operator.mul, rounds=True, many=np.multiply, commutative=True, cost="multiplications",
    infix="*", casadi="OP_MUL",
    interval=iv.times, lemma=_product, running=_product_error,
)  # fmt: skip
Op.SQUARE = Op(
    "square", 1, lambda a: a * a, rounds=True,
    interval=iv.square, lemma=_square, running=_square_error,
)  # fmt: skip
Op.IMUL = Op(
    "imul", 2, float32=Op.MUL.float32, many=np.multiply, c="wmrgen_mul({0}, {1})", includes=("<stdint.h>",)
)


# ---- fused multiply-add


def _fused64(a: float, b: float, c: float) -> float:
    if not (isfinite(a) and isfinite(b) and isfinite(c)):
        return a * b + c
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    return to_float64(Exact(exact)) if exact else a * b + c


def _fused32(a: float, b: float, c: float) -> float:
    """Return a b + c, rounded once: the product of two float32 is a float64, and the sum is rounded to odd first."""
    product = a * b
    total = product + c
    if not isfinite(total):
        return nearest_float32(total)
    back = total - product
    lost = (product - (total - back)) + (c - back)
    if lost and not unpack("<Q", pack("<d", total))[0] & 1:
        total = nextafter(total, copysign(float("inf"), lost))
    return nearest_float32(total)


Op.FMA = Op(
    "fma", 3, lambda a, b, c: a * b + c, _fused64, _fused32, many=lambda a, b, c: a * b + c,
    c="wmr_fma({0}, {1}, {2})", rust="fma{f}({0}, {1}, {2})", includes=("<math.h>", "<stdint.h>"),
)  # fmt: skip
