"""Sines, cosines and arctangents."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, Interval
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.ir.ops import integer
from wmrgen.ir.ops.analysis import Bounded, Noise, Partial, Value, Walk
from wmrgen.ir.ops.record import Op

# Errors that self-tests allow, larger than those of our kernels and of any libm in use.
CIRCLE = 4.0  # sines and cosines [rounding units]
LIBRARY = 6.0  # arctangents [ulp]
_BITS = 240  # working precision of exact functions: 60 decimal digits (200 bits) and a margin


def _bits(q: Fraction) -> int:
    """Return how many bits represent q to 60 digits, and its remainder modulo pi as well if q is large."""
    return _BITS + max(0, abs(q.numerator).bit_length() - q.denominator.bit_length())


def _exactly(name: str, a: Exact) -> Exact:
    """Return a function of mpmath to 60 digits; exact if the argument or the result is a multiple of pi/12."""
    from mpmath import libmp  # a slow import that only exact sines need

    from wmrgen.geometry.exact.evaluate import direction_over_pi, over_pi, twelfths

    if name == "mpf_atan":
        if (half_turns := direction_over_pi(a, ONE)) is not None:
            return _of_pi(half_turns)
    elif (half_turns := over_pi(a)) is not None and (12 * half_turns).denominator == 1:
        return twelfths(int(12 * half_turns))[name == "mpf_sin"]
    q = a.rational()
    bits = _bits(q)
    x = libmp.from_rational(q.numerator, q.denominator, bits)
    return _dyadic(libmp.to_rational(getattr(libmp, name)(x, bits)))


def _of_pi(half_turns: Fraction) -> Exact:
    from wmrgen.geometry.exact.evaluate import pi_rational

    return Exact(pi_rational() * half_turns)


def _dyadic(quotient: tuple[int, int]) -> Exact:
    return Exact(Fraction(int(quotient[0]), int(quotient[1])))


# ---- sine and cosine


def _wave(op: Op, value: Interval, steep: Interval, w: Walk, i: int, a: int) -> Value:
    reach = w.library.reach
    w.alarm(i, f"its argument may exceed {reach:g} rad", iv.magnitude(w.ranges[a]) > reach)
    return Value(value, (Partial(a, steep),), w.library_noise(op, value))


def _sine(w: Walk, i: int, a: int) -> Value:
    """Bound sin x: d sin x = cos x dx."""
    x = w.ranges[a]
    return _wave(Op.SIN, iv.sine(x), iv.cosine(x), w, i, a)


def _cosine(w: Walk, i: int, a: int) -> Value:
    """Bound cos x: d cos x = -sin x dx."""
    x = w.ranges[a]
    return _wave(Op.COS, iv.cosine(x), iv.negative(iv.sine(x)), w, i, a)


def _wave_error(unit: Array, a: Bounded, value: Array, slope: Array) -> Bounded:
    error = np.minimum(np.abs(slope) * a.error + a.error**2 / 2, 2.0)
    at_zero = (a.value == 0) & (a.error == 0)
    return Bounded(value, np.where(at_zero, 0.0, error + CIRCLE * unit))


Op.SIN = Op(
    "sin", 1, lambda a: _exactly("mpf_sin", a) if a else ZERO,
    lambda a: math.sin(a) if math.isfinite(a) else math.nan, rounds=True, many=np.sin,
    opaque=True, parity=-1, fold=lambda a: None if a else ZERO, cost="sines", ulps=1.0,
    c="sin{f}({0})", includes=("<math.h>",), arrays="xp.sin({0})", casadi="OP_SIN",
    interval=iv.sine, lemma=_sine,
    running=lambda unit, a: _wave_error(unit, a, np.sin(a.value), np.cos(a.value)),
)  # fmt: skip
Op.COS = Op(
    "cos", 1, lambda a: _exactly("mpf_cos", a) if a else ONE,
    lambda a: math.cos(a) if math.isfinite(a) else math.nan, rounds=True, many=np.cos,
    opaque=True, parity=1, fold=lambda a: None if a else ONE, cost="sines", ulps=1.0,
    c="cos{f}({0})", includes=("<math.h>",), arrays="xp.cos({0})", casadi="OP_COS",
    interval=iv.cosine, lemma=_cosine,
    running=lambda unit, a: _wave_error(unit, a, np.cos(a.value), np.sin(a.value)),
)  # fmt: skip
Op.ISIN = Op("isin", 1, float32=integer.sine, many=np.sin, c="wmrgen_sin({0})", includes=("<stdint.h>",))
Op.ICOS = Op("icos", 1, float32=integer.cosine, many=np.cos, c="wmrgen_cos({0})", includes=("<stdint.h>",))


# ---- arctangent of a slope


def _slope(w: Walk, i: int, a: int) -> Value:
    """Bound atan x: d atan x = dx / (1 + x x)."""
    x = w.ranges[a]
    if a not in w.lengths:  # the slope of a line is at most 1
        most = w.library.slope
        w.alarm(i, f"its argument may exceed {most:g}", iv.magnitude(x) > most)
    value, square = iv.slope_angle(x), iv.square(x)
    steep = iv.reciprocal((1 + square[0], 1 + square[1]))
    return Value(value, (Partial(a, steep),), w.library_noise(Op.ATAN, value))


def _slope_error(unit: Array, a: Bounded) -> Bounded:
    value = np.arctan(a.value)
    return Bounded(value, a.error + 2 * LIBRARY * unit * np.abs(value))


Op.ATAN = Op(
    "atan", 1, lambda a: _exactly("mpf_atan", a) if a else ZERO, math.atan, rounds=True, many=np.arctan,
    opaque=True, parity=-1, fold=lambda a: None if a else ZERO, cost="arctangents", ulps=1.0,
    c="atan{f}({0})", includes=("<math.h>",), arrays="xp.atan({0})", casadi="OP_ATAN",
    interval=iv.slope_angle, lemma=_slope, running=_slope_error,
)  # fmt: skip
Op.IATAN = Op(
    "iatan", 1, float32=integer.arctangent, many=np.arctan, c="wmrgen_atan({0})", includes=("<stdint.h>",)
)


# ---- direction of a vector


def _exact_direction(y: Exact, x: Exact) -> Exact:
    from mpmath import libmp

    from wmrgen.geometry.exact.evaluate import direction_over_pi

    if not y and x.sign >= 0:
        return ZERO
    if (half_turns := direction_over_pi(y, x)) is not None:
        return _of_pi(half_turns)
    p, q = (libmp.from_rational(v.numerator, v.denominator, _BITS) for v in (y.rational(), x.rational()))
    return _dyadic(libmp.to_rational(libmp.mpf_atan2(p, q, _BITS)))


def _direction(w: Walk, i: int, b: int, a: int) -> Value:
    """Bound atan2: an error e of a vector of length h turns it by at most about e / h."""
    steep = w.direction_slope(i)
    y, x = w.ranges[b], w.ranges[a]
    value = iv.arctangent(y, x)
    noise = w.library_noise(Op.ATAN2, value)
    wraps = (x[0] <= 0) & (w.nodes[a].op is not Op.ABS)  # a zero that is not an absolute value may be -0
    if np.any(wraps):  # pi and -pi are the same angle, but not the same number
        value = iv.hull(value, (np.full(w.boxes, -np.pi - 1e-9), np.full(w.boxes, np.pi + 1e-9)))
        noise = Noise(noise.size + 2 * np.pi)
    return Value(value, tuple(Partial(k, value, length=i, steep=steep) for k in (b, a)), noise)


def _direction_error(unit: Array, y: Bounded, x: Bounded) -> Bounded:
    value = np.arctan2(y.value + 0.0, x.value + 0.0)  # exact zeros have no sign
    radius = np.hypot(x.value, y.value)
    shift = np.hypot(x.error, y.error)
    first = np.abs(x.value) * y.error + np.abs(y.value) * x.error
    error = np.where(shift < radius / 64, 1.05 * first / np.maximum(radius**2, 1e-300), np.pi)
    error = np.where((shift == 0) & (radius == 0), 0.0, error)
    behind = (x.value - x.error < 0) | np.signbit(x.value)  # a libm treats -0 as negative
    cut = behind & (np.abs(y.value) <= y.error)  # the sign of y decides between +pi and -pi
    return Bounded(value, np.where(cut, 2 * np.pi, error) + 2 * LIBRARY * unit * np.abs(value))


def _casadi_direction(ca: Any, y: Any, x: Any) -> Any:
    """Return atan2(y, x); 0 with derivative 0 if x*x + y*y is 0 in float64 (both below 1e-162)."""
    binary = ca.SX.binary
    square = binary(ca.OP_ADD, binary(ca.OP_MUL, x, x), binary(ca.OP_MUL, y, y))
    away = binary(ca.OP_LT, ca.SX(0.0), square)
    safe = binary(ca.OP_ADD, x, ca.SX.unary(ca.OP_NOT, away))
    return binary(ca.OP_MUL, binary(ca.OP_ATAN2, y, safe), away)


Op.ATAN2 = Op(
    "atan2", 2, _exact_direction, math.atan2, rounds=True, many=np.arctan2,
    opaque=True, fold=lambda y, x: ZERO if not y and x.sign >= 0 else None, cost="arctangents", ulps=2.0,
    c="atan2{f}({0}, {1})", includes=("<math.h>",), arrays="_atan2(xp, {0}, {1})", casadi=_casadi_direction,
    interval=iv.arctangent, lemma=_direction,
    running=_direction_error,
)  # fmt: skip
