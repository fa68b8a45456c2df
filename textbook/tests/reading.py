"""The forms of the errata as numbers, for simulations that share nothing else with the page."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy

from textbook.errata.forms import Form
from textbook.errata.texts import ENTRIES, HOLDS

EVERY = {(r.text, r.equation): r for r in (*ENTRIES, *HOLDS)}


def forms(text: str, equation: str) -> tuple[Form, Form]:
    """What the copy has and what the page puts in its place."""
    corrected = EVERY[text, equation].corrected
    assert corrected is not None
    return copied(text, equation), corrected


def copied(text: str, equation: str) -> Form:
    """What the copy has."""
    printed = EVERY[text, equation].printed
    assert printed is not None
    return printed


def value(expr: Any, **at: float) -> Any:
    """The number, or array of numbers, of a form's part; symbols by the LaTeX of their names, backslashes left out."""
    names = {s: at[s.name.translate({92: None, 123: None, 125: None})] for s in expr.free_symbols}
    number = expr.subs(names)
    if isinstance(number, sympy.MatrixBase):
        return np.array(number.evalf().tolist(), dtype=float)
    return float(number)


def slope(path: Any, h: float = 1e-5) -> Any:
    """The derivative of a function of time at 0."""
    return (np.asarray(path(h)) - np.asarray(path(-h))) / (2 * h)
