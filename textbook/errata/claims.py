"""Equations that hold as printed: each shown beside what it is held against."""

from __future__ import annotations

from collections.abc import Callable

import sympy

from textbook.errata.checks import equals, vanishes
from textbook.errata.forms import EQ, Value, forms, symbol
from textbook.errata.records import Record
from textbook.library import formula
from textbook.plain import plain
from wmrgen.geometry.symbolic import Expr

Line = tuple[str, Value, Value]  # left-hand side in LaTeX, the printed right-hand side, the truth


def claim(text: str, equation: str, says: str, *lines: Line, remark: str = "") -> Record:
    """The printed right-hand sides are the truths; ``says``: what those are."""
    shown = forms(*((symbol(left), EQ, right) for left, right, _ in lines))
    return Record(text, equation, equals([truth for *_, truth in lines], says), shown, remark=remark)


def residual(
    text: str,
    equation: str,
    says: str,
    left: str,
    right: Value,
    test: Callable[[Value], Value],
    remark: str = "",
) -> Record:
    """``test(right)`` is 0 identically."""
    shown = forms((symbol(left), EQ, right))
    return Record(text, equation, lambda f: vanishes(test(f.rights[0]), says), shown, remark=remark)


def book(function: str, **at: Expr) -> dict[str, Expr]:
    """Outputs of a function of the library, inputs by name replaced (``_`` for the dot)."""
    outputs = plain(formula(function))
    return {name: e.xreplace({s: at[s.name] for s in e.free_symbols}) for name, e in outputs.items()}


def along(value: Expr, flow: dict[Expr, Expr]) -> Expr:
    """The rate of a function of the state along an ode."""
    return sympy.Add(*(sympy.diff(value, s) * rate for s, rate in flow.items()))
