"""Arithmetic modulo a prime, for checks that must stay quick on large functions.

A value is its residue modulo a 61-bit prime in which 2 and 3 are squares, so that all of Q(sqrt2, sqrt3)
embeds, beside a float that decides comparisons only. Unequal exact values have equal residues with
probability about 2**-61. Functions are opaque: decided by the residues of their arguments.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from wmrgen.exact.number import Exact
from wmrgen.ir.arithmetic import Arithmetic, Number
from wmrgen.ir.nodes import Op

PRIME = 2**61 - 465  # = 23 modulo 24
_ROOT2 = pow(2, (PRIME + 1) // 4, PRIME)
_ROOT3 = pow(3, (PRIME + 1) // 4, PRIME)
_ROOTS = (1, _ROOT2, _ROOT3, _ROOT2 * _ROOT3 % PRIME)


class Residue(NamedTuple):
    """``r`` modulo PRIME, and about how large the number is."""

    r: int
    size: float


def _enter(value: Number | Residue) -> Residue:
    if isinstance(value, Residue):  # an output of prepare()
        return value
    e = Exact.of(Fraction(value)) if isinstance(value, float) else Exact.of(value)
    numerator = sum(n * root for n, root in zip(e.num, _ROOTS, strict=True) if n)
    return Residue(numerator * pow(e.den, -1, PRIME) % PRIME, float(e))


def _less(a: Residue, b: Residue) -> bool:
    return a.r != b.r and a.size < b.size


def _neg(a: Residue) -> Residue:
    return Residue(-a.r % PRIME, -a.size)


def _div(a: Residue, b: Residue) -> Residue:
    if not b.r:
        raise ZeroDivisionError("division by zero")
    return Residue(a.r * pow(b.r, -1, PRIME) % PRIME, a.size / b.size if b.size else 0.0)


def _opaque(salt: int) -> Callable[..., Residue]:
    def value(*args: Residue) -> Residue:
        state = salt
        for a in args:
            state = (state * 6364136223846793005 + a.r + 1442695040888963407) % 2**64
            state ^= state >> 29
        return _enter(Fraction(state % 255 + 1, 64))

    return value


_SQRT, _SIN, _COS, _ATAN2, _ATAN, _RINT = (_opaque(salt) for salt in (1, 2, 3, 4, 5, 6))


def _odd(function: Callable[..., Residue]) -> Callable[..., Residue]:
    def value(a: Residue) -> Residue:
        if not a.r:
            return a
        return function(a) if a.size > 0 else _neg(function(_neg(a)))

    return value


def _flip(a: Residue, n: Residue) -> Residue:
    return _neg(a) if (n.r if n.size > 0 else -n.r % PRIME) % 2 else a


def _cos(a: Residue) -> Residue:
    if not a.r:
        return Residue(1, 1.0)
    return _COS(a if a.size > 0 else _neg(a))


def _atan2(y: Residue, x: Residue) -> Residue:
    return y if not y.r and (not x.r or x.size > 0) else _ATAN2(y, x)


RESIDUES = Arithmetic(
    "residues",
    _enter,
    {
        Op.ADD: lambda a, b: Residue((a.r + b.r) % PRIME, a.size + b.size),
        Op.SUB: lambda a, b: Residue((a.r - b.r) % PRIME, a.size - b.size),
        Op.MUL: lambda a, b: Residue(a.r * b.r % PRIME, a.size * b.size),
        Op.DIV: _div,
        Op.NEG: _neg,
        Op.ABS: lambda a: _neg(a) if a.r and a.size < 0 else a,
        Op.MIN: lambda a, b: a if _less(a, b) else b,
        Op.MAX: lambda a, b: b if _less(a, b) else a,
        Op.SQRT: _SQRT,
        Op.SIN: _odd(_SIN),
        Op.COS: _cos,
        Op.ATAN: _odd(_ATAN),
        Op.ATAN2: _atan2,
        Op.RINT: _odd(_RINT),
        Op.FLIP: _flip,
        Op.SELECT: lambda a, b, x, y: x if _less(a, b) else y,
    },
)
