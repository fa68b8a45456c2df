"""Formulas as they stand on a page: expressions and matrices with the signs between them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeAlias

import sympy

from textbook.latex import latex
from wmrgen.geometry.symbolic import Expr

Value: TypeAlias = Any  # sympy expression, matrix or relation


class Sign(StrEnum):
    """What stands between two values."""

    EQ = "="
    PLUS = "+"
    BAR = r"\mid"
    TIMES = r"\cdot"
    THEN = r"\Rightarrow"
    AND = r",\qquad"


EQ, PLUS, BAR, TIMES, THEN, AND = Sign


@dataclass(frozen=True, slots=True)
class Form:
    """Lines of a display. ``values``: what stands in them, the signs left out."""

    lines: tuple[tuple[Value, ...], ...]

    @property
    def values(self) -> tuple[Value, ...]:
        """Every value, line by line."""
        return tuple(v for line in self.lines for v in line if not isinstance(v, Sign))

    @property
    def rights(self) -> tuple[Value, ...]:
        """The last value of each line."""
        return tuple(line[-1] for line in self.lines)

    @property
    def names(self) -> frozenset[Expr]:
        """Every symbol of the display."""
        return frozenset(s for v in self.values for s in v.free_symbols)

    def latex(self) -> list[str]:
        """One LaTeX line per line."""
        return [" ".join(v.value if isinstance(v, Sign) else latex(v) for v in line) for line in self.lines]


def form(*pieces: Value) -> Form:
    """A display of one line."""
    return Form((pieces,))


def forms(*lines: tuple[Value, ...]) -> Form:
    """A display of several lines."""
    return Form(lines)


def symbol(name: str) -> Expr:
    """A real symbol; its name is LaTeX."""
    return sympy.Symbol(name, real=True)
