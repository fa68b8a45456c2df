"""Rounding of exact numbers to binary floating point: once, to nearest, ties to even."""

from __future__ import annotations

import ctypes
from fractions import Fraction
from functools import lru_cache
from math import inf, isinf, ldexp

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.ports import Port, default_range


def round_rational(value: Fraction, precision: int, lowest: int, highest: int) -> float:
    """Round a rational number to a binary format.

    Args:
        value: the number.
        precision: bits of precision (float32: 24, float64: 53).
        lowest: exponent of the least subnormal number (-149, -1074).
        highest: exponent of the first power of two beyond the range (128, 1024).

    Returns:
        The nearest number of the format as a float64; infinity beyond the range.
    """
    n, d = abs(value.numerator), value.denominator
    if not n:
        return 0.0
    exponent = n.bit_length() - d.bit_length()  # 2**(e-1) < |value| < 2**(e+1)
    if (n << -exponent if exponent < 0 else n) < (d << exponent if exponent > 0 else d):
        exponent -= 1
    unit = max(exponent - precision + 1, lowest)  # exponent of the last bit kept
    quotient, rest = divmod(n << -unit if unit < 0 else n, d << unit if unit > 0 else d)
    half = 2 * rest - (d << unit if unit > 0 else d)
    if half > 0 or (half == 0 and quotient & 1):
        quotient += 1
    size = inf if quotient.bit_length() + unit > highest else ldexp(float(quotient), unit)
    return -size if value < 0 else size


@lru_cache(maxsize=4096)  # every pass rounds the same constants
def _round(value: Exact, precision: int, lowest: int, highest: int) -> float:
    if value.is_rational:
        return round_rational(value.rational(), precision, lowest, highest)
    digits = 40
    while (
        True
    ):  # ends, because an irrational number is no tie: bounds that are close enough round to the same float
        middle = value.rational(digits)
        slack = abs(middle) * Fraction(1, 10 ** (digits // 2 - 3))
        low = round_rational(middle - slack, precision, lowest, highest)
        if low == round_rational(middle + slack, precision, lowest, highest):
            return low
        digits *= 2


def to_float32(value: Exact) -> float:
    """Return the float32 nearest to ``value``, as a float64."""
    return _round(value, 24, -149, 128)


def to_float64(value: Exact) -> float:
    """Return the float64 nearest to ``value``."""
    return _round(value, 53, -1074, 1024)


@lru_cache(maxsize=4096)
def constant(value: Exact, single: bool) -> float:
    """Return ``value`` as a float32 or float64; raise NotDerivableError if it is outside the range of the type."""
    rounded = to_float32(value) if single else to_float64(value)
    if isinf(rounded) or (rounded == 0.0 and value):
        why = "does not fit float; use --scalar double" if single else "does not fit double"
        raise NotDerivableError(f"the constant {value} {why}")
    return rounded


def nearest_float32(value: float) -> float:
    """Return a float64 rounded to float32, as a float64; overflow gives infinity."""
    return ctypes.c_float(value).value


def tuned(port: Port, scalar: str = "float") -> tuple[float, float]:
    """Return the range of a tunable parameter, which bounds assume and checked code accepts.

    Its ends are rounded to nearest, so that code accepts them as they are written in the robot file.
    """
    low, high = port.range or default_range(port.default or ZERO)
    rounded = to_float32 if scalar == "float" else to_float64
    return rounded(low), rounded(high)
