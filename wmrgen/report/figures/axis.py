"""Write the numbers at the ends of an axis so that they differ and fit into their room."""

from __future__ import annotations

from collections.abc import Callable
from math import floor, log10
from typing import NamedTuple

from wmrgen.report.figures.paper import width

_DIGITS = (3, 4, 5, 6)  # significant digits that are tried until both ends differ; more are hard to read
_ROUNDING = 1e-6  # relative to the larger end: a smaller number at the other end is a rounding error, and 0
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Ends(NamedTuple):
    """The texts at the ends of an axis."""

    low: str
    high: str
    power: int  # the texts are numbers in units of 10^power

    def unit(self, unit: str) -> str:
        """Return what follows the title of the axis: the unit in brackets, with the power of ten."""
        scale = "" if not self.power else f"10{str(self.power).translate(_SUPERSCRIPTS)}"
        inside = " ".join(part for part in (scale, unit) if part)
        return f" [{inside}]" if inside else ""


def ends(low: float, high: float, room: float) -> Ends:
    """Return the numbers at the ends of an axis.

    Args:
        low: the number at the lower end.
        high: the number at the upper end.
        room: the width of a number on paper [px].

    Returns:
        Numbers with three to six significant digits, in units of a power of ten if they are too wide otherwise.
    """
    largest = max(abs(low), abs(high))
    low, high = (0.0 if abs(value) <= _ROUNDING * largest else value for value in (low, high))
    texts = _different(low, high, _full)
    if max(map(width, texts)) <= room:
        return Ends(*texts, 0)
    power = floor(log10(largest))
    return Ends(*_different(low / 10**power, high / 10**power, _fixed), power)


def _different(low: float, high: float, write: Callable[[float, int], str]) -> tuple[str, str]:
    """Return two numbers with as few digits as show a difference."""
    pairs = []
    for digits in _DIGITS:
        pairs.append((write(low, digits), write(high, digits)))
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])


def _full(value: float, digits: int) -> str:
    """Return a number with some significant digits; whole numbers of at most six digits in full."""
    if value == round(value) and abs(value) < 10 ** max(_DIGITS):
        return _minus(f"{value:.0f}")
    return _minus(f"{float(f'{value:.{digits}g}'):.6g}")


def _fixed(value: float, digits: int) -> str:
    """Return a number below 10 with one digit less after its decimal point."""
    text = f"{value:.{digits - 1}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else _minus(text)


def _minus(text: str) -> str:
    return text.replace("-", "−")
