"""Rounding to whole numbers, and signs that depend on whether a whole number is odd."""

from __future__ import annotations

import math
from struct import pack, unpack
from typing import Any

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.ops.analysis import Bounded, Partial, Value, Walk
from wmrgen.ir.ops.record import Conditional, Op

# ---- the nearest whole number


def _nearest(w: Walk, i: int, a: int) -> Value:
    """Bound the nearest whole number; the float program decides which one it is."""
    x = w.ranges[a]
    # Adding 1.5 * 2**(bits - 1) rounds correctly up to this size.
    w.alarm(i, "too large to be rounded to a whole number", iv.magnitude(x) > 2.0 ** (w.form.bits - 2))
    return Value(iv.whole(x), decided=w.decision_error(a))


def _nearest_error(unit: Array, a: Bounded) -> Bounded:
    value = np.rint(a.value)
    sure = (np.abs(a.value - value) + a.error < 0.5) | (a.error == 0)
    return Bounded(value, np.where(sure, 0.0, 1.0 + a.error))


def _casadi_nearest(ca: Any, x: Any) -> Any:
    """Return the nearest whole number, with derivative 0. Ties go to the larger one; the IR has ties to even."""
    return ca.SX.unary(ca.OP_FLOOR, ca.SX.binary(ca.OP_ADD, x, ca.SX(0.5)))


Op.RINT = Op(
    "rint", 1, lambda a: Exact(round(a.rational())),
    lambda a: float(round(a)) if abs(a) < 2.0**52 else a, many=np.rint, modular=False, parity=-1,
    fold=lambda a: Exact(round(a.parts[0])) if a.is_rational else None, cost="roundings",
    javascript="_rint({0})", arrays="xp.round({0})", casadi=_casadi_nearest,
    interval=iv.whole, lemma=_nearest, running=_nearest_error,
)  # fmt: skip


# ---- signs by parity


def _flip(w: Walk, i: int, a: int, n: int) -> Value:
    """Bound a or -a; the whole number n decides."""
    one = np.ones(w.boxes)
    return Value(iv.either_sign(w.ranges[a], w.ranges[n]), (Partial(a, (-one, one)),), away=w.away[a])


def _flip_error(unit: Array, a: Bounded, n: Bounded) -> Bounded:
    value = np.where(n.value % 2 == 1, -a.value, a.value)
    return Bounded(value, np.where(n.error < 1, a.error, 2 * np.abs(a.value) + a.error))


def _casadi_flip(ca: Any, a: Any, n: Any) -> Any:
    """Return a, or -a if n is odd: a (1 - 2 |n - 2 floor(n/2 + 1/2)|)."""
    binary = ca.SX.binary
    half = binary(ca.OP_ADD, binary(ca.OP_MUL, n, ca.SX(0.5)), ca.SX(0.5))
    even = binary(ca.OP_MUL, ca.SX(2.0), ca.SX.unary(ca.OP_FLOOR, half))
    odd = ca.SX.unary(ca.OP_FABS, binary(ca.OP_SUB, n, even))
    return binary(ca.OP_MUL, a, binary(ca.OP_SUB, ca.SX(1.0), binary(ca.OP_MUL, ca.SX(2.0), odd)))


Op.FLIP = Op(
    "flip", 2, lambda a, n: -a if n.rational() % 2 else a,
    lambda a, n: -a if math.isfinite(n) and n % 2 == 1 else a,
    many=lambda a, n: np.where(n % 2 == 1, -a, a), cost="signs",
    javascript=Conditional("({1}) % 2 ? -({0}) : {0}"),
    arrays=Conditional("_flip(xp, {0}, {1})"), casadi=_casadi_flip,
    interval=iv.either_sign, lemma=_flip, running=_flip_error,
)  # fmt: skip
Op.NEGATE_IF_ODD = Op(
    "negate_if_odd", 2,
    float64=lambda a, b: -a if unpack("<Q", pack("<d", b))[0] & 1 else a,
    float32=lambda a, b: -a if unpack("<I", pack("<f", b))[0] & 1 else a,
    many=lambda a, n: np.where(np.asarray(n, np.float32).view(np.uint32) & 1, -a, a),
    c="wmrgen_negate_if_odd({0}, {1})", includes=("<stdint.h>",),
)  # fmt: skip
