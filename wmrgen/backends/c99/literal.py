"""Constants as C99 writes them."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isinf

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.ir.rounding import nearest_float32, to_float32, to_float64


@lru_cache(maxsize=4096)
def rounded(value: Exact, scalar: str) -> float:
    """``value`` in the target type. NotDerivableError when it leaves the type's range."""
    result = to_float32(value) if scalar == "float" else to_float64(value)
    if isinf(result) or (result == 0.0 and value):
        raise NotDerivableError(f"the constant {value} does not fit the C type {scalar}; use --scalar double")
    return result


def _shortest_single(value: float) -> str:
    for digits in range(1, 9):
        text = f"{value:.{digits}g}"
        # The quick test rounds twice, by way of float64; the exact one has the last word.
        if nearest_float32(float(text)) == value and to_float32(Exact(Fraction(text))) == value:
            return text
    return f"{value:.9g}"


def _positional(text: str) -> str:
    """The decimal without an exponent where that is no longer to read: 20 for 2e+01."""
    plain = format(Decimal(text), "f")
    return plain if len(plain.lstrip("-")) <= 10 else text


@lru_cache(maxsize=4096)
def literal(value: Exact, scalar: str) -> str:
    """The shortest decimal that reads back as the correctly rounded value; negative ones in parentheses."""
    number = rounded(value, scalar)
    text = _positional(_shortest_single(number) if scalar == "float" else repr(number))
    if not set(text) & set(".e"):
        text += ".0"
    text += "f" if scalar == "float" else ""
    return f"({text})" if text.startswith("-") else text
