"""Exact numbers as a reader wants them: short fractions, roots and decimals stay exact, the rest is rounded.

A magnitude is numerator and denominator in LaTeX; "" stands for 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import degrees
from typing import SupportsFloat

from wmrgen.exact.number import Exact
from wmrgen.notation import decimal

_ROOTS = ("", r"\sqrt{2}", r"\sqrt{3}", r"\sqrt{6}")
_READABLE = (2, 3, 4, 6, 7, 8, 9, 11, 12)


@dataclass(frozen=True, slots=True)
class Magnitude:
    """|value| as above / below; ``compound``: above is a sum."""

    above: str
    below: str = ""
    compound: bool = False


def magnitude(value: Exact) -> Magnitude:
    """The absolute value of a number that is not 0."""
    value = abs(value)
    parts = [(p, root) for p, root in zip(value.parts, _ROOTS, strict=True) if p]
    if len(parts) == 1:
        p, root = parts[0]
        short = _fraction(abs(p), bool(root))
        if root and short is None:
            return Magnitude(decimal(float(value)))
        above, below = short or (decimal(float(value)), "")
        return (
            Magnitude(f"{above}{root}" if above != "1" or not root else root, below)
            if root
            else _one(above, below)
        )
    if value.den < 1000 and max(abs(n) for n in value.num) < 1000:
        pairs = zip(value.num, _ROOTS, strict=True)
        terms = [f"{'-' if n < 0 else '+'}{_times(abs(n), root)}" for n, root in pairs if n]
        return Magnitude("".join(terms).removeprefix("+"), "" if value.den == 1 else str(value.den), True)
    return Magnitude(decimal(float(value)))


def _one(above: str, below: str) -> Magnitude:
    return Magnitude("" if above == "1" else above, below)


def _times(n: int, root: str) -> str:
    return root if root and n == 1 else f"{n}{root}"


def _fraction(f: Fraction, root: bool = False) -> tuple[str, str] | None:
    """Numerator and denominator, or an exact decimal and "", or None when neither is short."""
    if f.denominator == 1:
        return (str(f.numerator), "") if f.numerator < 10**7 else None
    if f.denominator in _READABLE and f.numerator < (2 if f.denominator in (2, 4, 8) and not root else 100):
        return str(f.numerator), str(f.denominator)
    exact = _terminating(f)
    if exact is not None:
        return exact, ""
    return (str(f.numerator), str(f.denominator)) if max(f.numerator, f.denominator) < 10**4 else None


def _terminating(f: Fraction) -> str | None:
    """``0.165`` when at most eight decimals say all, else None."""
    scaled = f * 10**8
    if scaled.denominator != 1 or len(str(scaled.numerator).rstrip("0")) > 7:
        return None
    whole, rest = divmod(scaled.numerator, 10**8)
    return f"{whole}.{rest:08d}".rstrip("0").rstrip(".")


def rounded(value: float) -> str:
    """Six significant digits for a table, dust of 1e-12 gone."""
    return f"{round(value, 12) + 0.0:.6g}".replace("-", "−")


def in_degrees(angle: SupportsFloat) -> str:
    """An angle [rad] in degrees."""
    return f"{round(degrees(float(angle)), 9) + 0.0:.6g}°".replace("-", "−")


def plain(value: Exact) -> str:
    """A number for a table: exact when short, else six significant digits."""
    sign = "−" if value.sign < 0 else ""
    if value.is_rational:
        f = abs(value.parts[0])
        exact = str(f.numerator) if f.denominator == 1 and f.numerator < 10**7 else _terminating(f)
        if exact is not None:
            return sign + exact
    return f"{float(value):.6g}".replace("-", "−")
