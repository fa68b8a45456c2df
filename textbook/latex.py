"""Expressions as LaTeX that GitHub renders: no \\operatorname, names as a reader would write them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import sympy

from textbook.plain import unguarded
from wmrgen.analysis.kinematics.records import Formula, substituted
from wmrgen.geometry.notation import port as port_name
from wmrgen.geometry.ports import Port
from wmrgen.geometry.printing import Latex
from wmrgen.geometry.symbolic import Expr, local, signal

_ENTRY = re.compile(r"([a-z]+)(\d)(\d)")
WIDE = 180  # characters of LaTeX in a line before a sum is broken
FEW = 3  # so often a short result is written out


_PRINTER = Latex(order=None, mat_str="bmatrix", mat_delim="", mul_symbol=r" \, ")


def latex(value: Any) -> str:
    """A sympy expression or matrix."""
    return str(_PRINTER.doprint(value))


def equations(formula: Formula) -> list[str]:
    """One line ``name &= expression`` per intermediate result worth a name (an output's, if it is one), per other
    output and per output matrix."""
    uses = _uses(formula)
    values: dict[Expr, Expr] = {
        signal(port.name): sympy.Symbol(port_name(port.name), real=True) for port in formula.inputs
    }
    memo: dict[Expr, Expr] = {}
    taken = {port.name for port in formula.inputs}
    given = {
        e: port_name(p.name)
        for p, e in formula.outputs
        if p.name not in taken and not _ENTRY.fullmatch(p.name)
    }
    shown: set[Expr] = set()
    lines = []
    for symbol, expr in formula.locals:
        value = substituted(unguarded(expr), values, memo)
        if symbol.name.endswith("_exp"):
            value = sympy.exp(values[local(f"{symbol.name}_of")])
        short = value.count_ops() <= (3 if uses[symbol] <= FEW else 2)
        if "_exp_" in symbol.name or uses[symbol] <= 1 or short or (value.is_Pow and value.exp == -1):
            values[symbol] = value
            continue
        values[symbol] = sympy.Symbol(given.get(symbol) or _name(symbol.name), real=True)
        shown.add(symbol)
        lines.append(_equation(latex(values[symbol]), value))
    outputs = [
        (port, substituted(unguarded(expr), values, memo))
        for port, expr in formula.outputs
        if expr not in shown or given.get(expr) != port_name(port.name)
    ]
    matrix = [(port, value) for port, value in outputs if _ENTRY.fullmatch(port.name)]
    if matrix:
        lines.append(_matrix(matrix))
    for port, value in outputs:
        if not _ENTRY.fullmatch(port.name):
            prime = "^{+}" if port.name in taken else ""  # an output that is the new value of an input
            lines.append(_equation(port_name(port.name) + prime, value))
    return lines


def _name(name: str) -> str:
    """Of an intermediate result: g_{01} of g01, words as words."""
    entry = re.fullmatch(r"([a-z])(\d+)", name)
    return rf"{entry[1]}_{{{entry[2]}}}" if entry else rf"\mathit{{{name.replace('_', chr(92) + ';')}}}"


def _matrix(entries: list[tuple[Port, Expr]]) -> str:
    places = [m for port, _ in entries if (m := _ENTRY.fullmatch(port.name))]
    rows, columns = (max(int(m[k]) for m in places) for k in (2, 3))
    above, below = zip(*(sympy.fraction(sympy.together(value)) for _, value in entries), strict=True)
    shared = set(below) - {1}
    if len(shared) == 1 and all(b != 1 or a == 0 for a, b in zip(above, below, strict=True)):
        factor, values = rf"\frac{{1}}{{{latex(shared.pop())}}} ", above
    else:
        factor, values = "", tuple(value for _, value in entries)
    return rf"{places[0][1].upper()} &= {factor}{latex(sympy.Matrix(rows, columns, values))}"


def _uses(formula: Formula) -> dict[Expr, int]:
    uses = {symbol: 0 for symbol, _ in formula.locals}
    for expr in (*(e for _, e in formula.locals), *(e for _, e in formula.outputs)):
        for node in sympy.preorder_traversal(unguarded(expr)):
            if node in uses:
                uses[node] += 1
    return uses


def _equation(left: str, value: Expr) -> str:
    """``left &= value``, a long sum broken into lines."""
    whole = latex(value)
    if len(whole) <= WIDE or not isinstance(value, sympy.Add):
        return f"{left} &= {whole}"
    return f"{left} &= " + " \\\\\n&\\quad ".join(_lines(value.as_ordered_terms()))


def _lines(terms: Iterable[Expr]) -> list[str]:
    lines: list[str] = [""]
    for k, term in enumerate(terms):
        text = latex(term)
        signed = text if k == 0 or text.startswith("-") else f"+ {text}"
        if lines[-1] and len(lines[-1]) + len(signed) > WIDE:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + signed
    return lines
