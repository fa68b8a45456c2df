"""Sine, cosine and arctangent in 32-bit integers, for processors without floating point.

They compute as templates/c99/integer.c.j2 does. An angle becomes a phase of 2**32 per turn, whose overflow removes
whole turns. Products are of 16 bits each, and there is no division. Products, quotients and roots in integers are
rounded as IEEE 754 says, so that they need no model here.
"""

from __future__ import annotations

import struct

from wmrgen.ir.rounding import nearest_float32

TURN = 2734261102  # 2**34 / (2 pi): units of phase per radian, times 4
# sin(pi/2 u) = u (c1 - c3 s + ...), s = u**2 <= 1, in units of 2**-31
SINE = (3373259347, 1387195753, 171129709, 10033533, 323885)
# atan(u) = u (c1 - c3 s + ...), in units of 2**-32
ATAN = (4294967255, 1431649546, 858789081, 610957725, 460575697, 329656701, 191693515, 73899308, 13397159)
# Phases: the mask of a 32-bit word, half a turn, and a quarter of a turn.
_ALL, _TOP, _QUARTER = 2**32 - 1, 2**31, 2**30
# Biased exponents of float32 (127 for numbers from 1 to 2). Below the first three, sin x and atan x round to x, and
# cos x to 1. Exponents above LARGE (angles from 2**15 rad) are taken as LARGE. NAN is that of infinities and NaN.
SINE_IS_X, ATAN_IS_X, COSINE_IS_1, LARGE, NAN = 118, 117, 114, 141, 255


def high(a: int, b: int) -> int:
    """Return the upper half of a product of two 32-bit words; it may be too small by up to 2."""
    return (a >> 16) * (b >> 16) + ((a >> 16) * (b & 65535) >> 16) + ((a & 65535) * (b >> 16) >> 16)


def _split(x: float) -> tuple[bool, int, int]:
    """Return sign, biased exponent and mantissa of a float32."""
    bits = struct.unpack("<I", struct.pack("<f", x))[0]
    return bool(bits >> 31), bits >> 23 & 255, bits & 0x7FFFFF | 0x800000


def _series(v: int, coefficients: tuple[int, ...]) -> int:
    s = high(v, v)
    *rest, total = coefficients
    for c in reversed(rest):
        total = c - high(s, total)
    return high(v, total)


def _scaled(value: int, negative: bool, bits: int) -> float:
    result = nearest_float32(float(value)) * 2.0**-bits
    return -result if negative else result


def _phase(x: float) -> int:
    negative, exponent, mantissa = _split(x)
    phase = mantissa * TURN >> 152 - min(exponent, LARGE) & _ALL
    return -phase & _ALL if negative else phase


def _of_phase(phase: int) -> float:
    a = phase & (_TOP - 1)
    a = _TOP - a if a > _QUARTER else a
    return _scaled(_series(min(a << 2, _ALL), SINE), phase >= _TOP, 31)


def sine(x: float) -> float:
    """Return sin x of a float32."""
    exponent = _split(x)[1]
    if exponent < SINE_IS_X or exponent == NAN:
        return x if exponent != NAN else x - x
    return _of_phase(_phase(x))


def cosine(x: float) -> float:
    """Return cos x of a float32."""
    exponent = _split(x)[1]
    if exponent < COSINE_IS_1 or exponent == NAN:
        return 1.0 if exponent != NAN else x - x
    return _of_phase(_phase(x) + _QUARTER & _ALL)


def arctangent(q: float) -> float:
    """Return atan q of a float32, |q| <= 1."""
    negative, exponent, mantissa = _split(q)
    if exponent < ATAN_IS_X or exponent == NAN:
        return q if exponent != NAN else q - q
    v = (
        _ALL
        if exponent >= 127
        else mantissa << exponent - 118
        if exponent >= 118
        else mantissa >> 118 - exponent
    )
    return _scaled(_series(v, ATAN), negative, 32)
