"""The checks: identities with an exact counterexample, points, shapes, units and names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import sympy

from textbook.errata.forms import Form, Value
from textbook.errata.records import Check, Finding, Slip
from textbook.errata.zero import Point, counterexample, is_zero
from textbook.latex import latex
from wmrgen.geometry.symbolic import Expr

Residual = Callable[..., Value]


def flat(value: Value) -> list[Expr]:
    """The entries of an expression, a matrix, or a sequence of them."""
    if isinstance(value, sympy.MatrixBase):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [e for v in value for e in flat(v)]
    return [value]


def number(value: Expr) -> str:
    """Six significant digits."""
    return f"{float(value) + 0.0:.6g}".replace("-", "−")


def place(point: Point) -> str:
    """``$\\phi$ = 0.3, $r$ = 0.7``"""
    return ", ".join(f"${latex(s)}$ = {number(v)}" for s, v in point.values)


def vanishes(value: Value, says: str) -> Finding:
    """All entries are 0 identically, or a rational point where one is not."""
    entries = flat(value)
    for entry in entries:
        if not is_zero(entry):
            point = counterexample(entry)
            if point is None:
                raise ValueError(f"no point where {entry} is not 0")
            where = f"at {place(point)} " if point.values else ""
            return Finding(False, f"{says}: {where}the difference is {number(point.value)}")
    return Finding(True, f"{says}: the difference is 0 identically")


Values = Mapping[Expr, Expr]
NOTHING: Values = {}


def identity(residual: Residual, says: str, at: Values = NOTHING) -> Check:
    """``residual(*values)`` is 0 identically; ``at``: symbols that are fixed first."""
    return lambda form: vanishes(fixed(residual(*form.values), at), says)


def rights(residual: Residual, says: str, at: Values = NOTHING) -> Check:
    """``residual(*right-hand sides)`` is 0 identically; ``at``: symbols that are fixed first."""
    return lambda form: vanishes(fixed(residual(*form.rights), at), says)


def fixed(value: Value, at: Values) -> list[Expr]:
    """The entries with some symbols fixed."""
    return [e.xreplace(dict(at)) for e in flat(value)]


def equals(truth: Value, says: str) -> Check:
    """The right-hand sides are ``truth``."""

    def check(form: Form) -> Finding:
        shapes = shape_of(list(form.rights)), shape_of(truth)
        if shapes[0] != shapes[1]:
            return Finding(False, f"{says}: its shape is {shapes[0]}, not {shapes[1]}")
        pairs = zip(flat(list(form.rights)), flat(truth), strict=True)
        return vanishes([a - b for a, b in pairs], says)

    return check


def shape_of(value: Value) -> str:
    """``4×2`` of a matrix, ``1`` of an expression; several joined."""
    if isinstance(value, sympy.MatrixBase):
        return "×".join(map(str, value.shape))
    if isinstance(value, (list, tuple)):
        return ", ".join(shape_of(v) for v in value)
    return "1"


def at_points(
    residual: Residual, symbols: Sequence[Expr], points: Iterable[Sequence[Expr]], says: str
) -> Check:
    """``residual(*right-hand sides)`` is 0 at each of the points; numbers to 30 digits."""
    listed = [tuple(p) for p in points]

    def check(form: Form) -> Finding:
        for p in listed:
            at = dict(zip(symbols, p, strict=True))
            for entry in flat(residual(*form.rights)):
                value = sympy.N(entry.xreplace(at), 30)
                if abs(value) > sympy.Rational(1, 10**20):
                    point = Point(tuple(at.items()), value)
                    return Finding(False, f"{says}: at {place(point)} the difference is {number(value)}")
        return Finding(True, f"{says}: 0 at the {len(listed)} points tried, to 30 digits")

    return check


def undefined(*defined: Expr) -> Slip:
    """A name that the text has not defined makes a line no statement."""
    letters = frozenset(defined)

    def slip(form: Form) -> str:
        strangers = sorted(form.names - letters, key=lambda s: str(s.name))
        return f"nothing defines {', '.join(f'${latex(s)}$' for s in strangers)}" if strangers else ""

    return slip


def units(table: Mapping[Expr, tuple[int, int]]) -> Slip:
    """Both sides and all terms have one unit; ``table``: exponents of metre and second by symbol."""

    def slip(form: Form) -> str:
        for line in form.lines:
            term_units = [
                unit_of(term, table)
                for v in line
                if hasattr(v, "free_symbols")
                for entry in flat(v)
                if entry != 0
                for term in sympy.Add.make_args(entry)
            ]
            distinct = list(dict.fromkeys(term_units))
            if len(distinct) > 1:
                return f"units do not agree: {' against '.join(unit_name(u) for u in distinct)}"
        return ""

    return slip


def unit_of(expr: Expr, table: Mapping[Expr, tuple[int, int]]) -> tuple[int, int]:
    """The unit of a product."""
    if isinstance(expr, sympy.Mul):
        parts = [unit_of(a, table) for a in expr.args]
        return sum(p[0] for p in parts), sum(p[1] for p in parts)
    if isinstance(expr, sympy.Pow):
        m, s = unit_of(expr.base, table)
        return int(m * expr.exp), int(s * expr.exp)
    if isinstance(expr, (sympy.Abs, sympy.Add)):
        return unit_of(expr.args[0], table)
    return table.get(expr, (0, 0))


def unit_name(unit: tuple[int, int]) -> str:
    """``m/s``, ``m²/s``, ``1``"""
    raised = {1: "", 2: "²", 3: "³"}
    above = "".join(f"{n}{raised[e]}" for n, e in zip("ms", unit, strict=True) if e > 0) or "1"
    below = "".join(f"{n}{raised[-e]}" for n, e in zip("ms", unit, strict=True) if e < 0)
    return f"{above}/{below}" if below else above


def each(says: str, cases: Sequence[tuple[bool, str]]) -> Finding:
    """Every case is right: (whether, in words) each. What is wrong is told, or else every case."""
    wrong = [text for right, text in cases if not right]
    return Finding(not wrong, says + "; ".join(wrong or [text for _, text in cases]))
