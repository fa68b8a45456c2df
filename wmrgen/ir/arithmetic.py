"""The three arithmetics of the interpreter: exact, float64 and float32.

Exact values are elements of Q(sqrt2, sqrt3). A square root that leaves the field, a sine, a
cosine and an arctangent are rational numbers good to 60 digits; everything else is exact.
The float arithmetics follow IEEE 754 and C99: a quotient by zero is an infinity or NaN, never an
exception. float32 operations are float64 operations rounded once more, which for + - * / and
sqrt is the correctly rounded float32 result (Figueroa 1995: 53 >= 2 * 24 + 2).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

from wmrgen.exact.number import ZERO, Exact, exact_sqrt
from wmrgen.ir.kernels import integer
from wmrgen.ir.kernels.integer import SOFT
from wmrgen.ir.nodes import Op
from wmrgen.ir.rounding import nearest_float32, to_float32, to_float64

Number = Exact | Fraction | int | float
DIGITS = 60
_LONGEST = 30_000  # bits
_BITS = 240  # working precision of exact functions: 60 digits and a margin


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """How to compute: ``enter`` takes a number in, ``apply`` holds the operations by name."""

    name: str
    enter: Callable[[Number], Any]
    apply: Mapping[Op, Callable[..., Any]]


# ---- exact


def _exact(value: Number) -> Exact:
    return Exact(Fraction(value)) if isinstance(value, float) else Exact.of(value)


def _div_exact(a: Exact, b: Exact) -> Exact:
    if not b:
        raise ZeroDivisionError("division by zero")
    return a / b


def _short(a: Exact) -> Exact:
    """``a``, or 9,000 digits of it where it has twice as many: sines have 60, and what is made of them grows."""
    if a.den.bit_length() < 2 * _LONGEST or not a.is_rational:
        return a
    places = _LONGEST - a.num[0].bit_length() + a.den.bit_length()
    return Exact(Fraction((a.num[0] << places) // a.den, 1 << places)) if places > 0 else a


def _sqrt_exact(a: Exact) -> Exact:
    root = exact_sqrt(a)
    if root is not None:
        return root
    if a.sign < 0:
        raise ValueError("square root of a negative number")
    q = a.rational()
    scale = 10 ** (DIGITS + 3) * max(1, isqrt(q.denominator // q.numerator))
    return Exact(Fraction(isqrt(q.numerator * scale * scale // q.denominator), scale))


def _bits(q: Fraction) -> int:
    """Bits that hold q to 60 digits and, however large it is, its remainder modulo pi."""
    return _BITS + max(0, abs(q.numerator).bit_length() - q.denominator.bit_length())


def _dyadic(quotient: tuple[int, int]) -> Exact:
    return Exact(Fraction(int(quotient[0]), int(quotient[1])))


def _trigonometric(name: str, q: Fraction) -> Exact:
    from mpmath import libmp  # a slow import that only exact sines need

    bits = _bits(q)
    x = libmp.from_rational(q.numerator, q.denominator, bits)
    return _dyadic(libmp.to_rational(getattr(libmp, name)(x, bits)))


def _sin_exact(a: Exact) -> Exact:
    return _trigonometric("mpf_sin", a.rational()) if a else ZERO


def _cos_exact(a: Exact) -> Exact:
    return _trigonometric("mpf_cos", a.rational()) if a else Exact(1)


def _atan_exact(a: Exact) -> Exact:
    return _trigonometric("mpf_atan", a.rational()) if a else ZERO


def _rint_exact(a: Exact) -> Exact:
    return Exact(round(a.rational()))


def _flip_exact(a: Exact, n: Exact) -> Exact:
    return -a if n.rational() % 2 else a


def _atan2_exact(y: Exact, x: Exact) -> Exact:
    from mpmath import libmp

    if not y and x.sign >= 0:
        return ZERO
    p, q = (libmp.from_rational(v.numerator, v.denominator, _BITS) for v in (y.rational(), x.rational()))
    return _dyadic(libmp.to_rational(libmp.mpf_atan2(p, q, _BITS)))


EXACT = Arithmetic(
    "exact",
    _exact,
    {
        Op.ADD: lambda a, b: _short(a + b), Op.SUB: lambda a, b: _short(a - b), Op.MUL: lambda a, b: _short(a * b),
        Op.DIV: lambda a, b: _short(_div_exact(a, b)), Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: _sqrt_exact,
        Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
        Op.SIN: _sin_exact, Op.COS: _cos_exact, Op.ATAN: _atan_exact, Op.ATAN2: _atan2_exact,
        Op.RINT: _rint_exact, Op.FLIP: _flip_exact,
        Op.FMA: lambda a, b, c: a * b + c,
        Op.SELECT: lambda a, b, x, y: x if a < b else y,
    },
)  # fmt: skip


# ---- floating point


def _div(a: float, b: float) -> float:
    if b:
        return a / b
    if not a or a != a or b != b:
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def _sqrt(a: float) -> float:
    return math.sqrt(a) if a >= 0 else math.nan


def _sin(a: float) -> float:
    return math.sin(a) if math.isfinite(a) else math.nan


def _cos(a: float) -> float:
    return math.cos(a) if math.isfinite(a) else math.nan


def _enter64(value: Number) -> float:
    return value if isinstance(value, float) else to_float64(Exact.of(value))


def _enter32(value: Number) -> float:
    return nearest_float32(value) if isinstance(value, float) else to_float32(Exact.of(value))


def _rint(a: float) -> float:
    return float(round(a)) if abs(a) < 2.0**52 else a


def _flip(a: float, n: float) -> float:
    return -a if math.isfinite(n) and n % 2 == 1 else a


def _within(a: float, m: float) -> float:
    if a != a:
        return m
    return math.copysign(m, a) if abs(a) > m else a


def _fma64(a: float, b: float, c: float) -> float:
    if not (math.isfinite(a) and math.isfinite(b) and math.isfinite(c)):
        return a * b + c
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    return to_float64(Exact(exact)) if exact else a * b + c


def _fma32(a: float, b: float, c: float) -> float:
    """The product of two float32 is a double; the sum is rounded to odd, so the second rounding is the only one."""
    product = a * b
    total = product + c
    if not math.isfinite(total):
        return nearest_float32(total)
    back = total - product
    lost = (product - (total - back)) + (c - back)
    if lost and not _last_bit64(total):
        total = math.nextafter(total, math.copysign(math.inf, lost))
    return nearest_float32(total)


def _last_bit64(b: float) -> bool:
    return bool(struct.unpack("<Q", struct.pack("<d", b))[0] & 1)


def _last_bit32(b: float) -> bool:
    return bool(struct.unpack("<I", struct.pack("<f", b))[0] & 1)


_DOUBLE: dict[Op, Callable[..., float]] = {
    Op.ADD: lambda a, b: a + b, Op.SUB: lambda a, b: a - b, Op.MUL: lambda a, b: a * b,
    Op.DIV: _div, Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: _sqrt,
    Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
    Op.SIN: _sin, Op.COS: _cos, Op.ATAN: math.atan, Op.ATAN2: math.atan2, Op.RINT: _rint, Op.FLIP: _flip,
    Op.FMA: _fma64, Op.NEGATE_IF_ODD: lambda a, b: -a if _last_bit64(b) else a,
    Op.CLAMP: _within,
    Op.AT_LEAST: lambda a, m: math.copysign(m, a) if abs(a) < m else a,
    Op.WITH_SIGN_OF: lambda a, b: -a if math.copysign(1.0, b) < 0 else a,
    Op.SELECT: lambda a, b, x, y: x if a < b else y,
}  # fmt: skip

_ROUNDING = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.SQRT, Op.SIN, Op.COS, Op.ATAN, Op.ATAN2)


def _rounded(operation: Callable[..., float]) -> Callable[..., float]:
    return lambda *args: nearest_float32(operation(*args))


FLOAT64 = Arithmetic("float64", _enter64, _DOUBLE)


def _flip_bit32(a: float, b: float) -> float:
    return -a if _last_bit32(b) else a


_SINGLE: dict[Op, Callable[..., float]] = {**_DOUBLE, **{op: _rounded(_DOUBLE[op]) for op in _ROUNDING}}
_SINGLE |= {Op.FMA: _fma32, Op.NEGATE_IF_ODD: _flip_bit32}
_SINGLE |= {Op.ISIN: integer.sine, Op.ICOS: integer.cosine, Op.IATAN: integer.arctangent}
_SINGLE |= {op: _SINGLE[plain] for plain, op in SOFT.items()}
FLOAT32 = Arithmetic("float32", _enter32, _SINGLE)
