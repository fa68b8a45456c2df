"""The three arithmetics of the interpreter: exact, float64 and float32.

Exact values are elements of Q(sqrt2, sqrt3). A square root that leaves the field, a sine, a
cosine and an arctangent are rational numbers good to 60 digits; everything else is exact.
The float arithmetics follow IEEE 754 and C99: a quotient by zero is an infinity or NaN, never an
exception. float32 operations are float64 operations rounded once more, which for + - * / and
sqrt is the correctly rounded float32 result (Figueroa 1995: 53 >= 2 * 24 + 2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

from wmrgen.exact.number import ZERO, Exact, exact_sqrt
from wmrgen.ir.nodes import Op
from wmrgen.ir.rounding import nearest_float32, to_float32, to_float64

Number = Exact | Fraction | int | float
DIGITS = 60
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
        Op.ADD: lambda a, b: a + b, Op.SUB: lambda a, b: a - b, Op.MUL: lambda a, b: a * b,
        Op.DIV: _div_exact, Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: _sqrt_exact,
        Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
        Op.SIN: _sin_exact, Op.COS: _cos_exact, Op.ATAN2: _atan2_exact,
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


_DOUBLE: dict[Op, Callable[..., float]] = {
    Op.ADD: lambda a, b: a + b, Op.SUB: lambda a, b: a - b, Op.MUL: lambda a, b: a * b,
    Op.DIV: _div, Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: _sqrt,
    Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
    Op.SIN: _sin, Op.COS: _cos, Op.ATAN2: math.atan2,
    Op.SELECT: lambda a, b, x, y: x if a < b else y,
}  # fmt: skip

_ROUNDING = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.SQRT, Op.SIN, Op.COS, Op.ATAN2)


def _rounded(operation: Callable[..., float]) -> Callable[..., float]:
    return lambda *args: nearest_float32(operation(*args))


FLOAT64 = Arithmetic("float64", _enter64, _DOUBLE)
FLOAT32 = Arithmetic("float32", _enter32, {**_DOUBLE, **{op: _rounded(_DOUBLE[op]) for op in _ROUNDING}})
