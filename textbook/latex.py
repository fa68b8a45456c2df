"""Expressions as LaTeX that GitHub renders: no \\operatorname, names as a reader would write them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import sympy
from sympy.printing.latex import LatexPrinter

from textbook.plain import unguarded
from wmrgen.kinematics.records import Formula
from wmrgen.ports import Port
from wmrgen.symbolic import Expr, local, signal, substituted

_GREEK = frozenset("alpha beta gamma epsilon zeta theta xi rho phi psi omega".split())
_SHORT = {"vx": "v_{x}", "vy": "v_{y}", "dx": "d_{x}", "dy": "d_{y}"}
_NUMBERED = re.compile(r"([a-z]+)(\d+)")
_ENTRY = re.compile(r"([a-z]+)(\d)(\d)")
WIDE = 180  # characters of LaTeX in a line before a sum is broken


class _Printer(LatexPrinter):  # type: ignore[misc]
    """sympy's LaTeX, with atan2 and sign upright."""

    def _called(self, head: str, expr: Expr, exp: str | None) -> str:
        text = rf"{head}\left({', '.join(self._print(a) for a in expr.args)}\right)"
        return text if exp is None else rf"{text}^{{{exp}}}"

    def _print_atan2(self, expr: Expr, exp: str | None = None) -> str:
        return self._called(r"\mathrm{atan2}", expr, exp)

    def _print_sign(self, expr: Expr, exp: str | None = None) -> str:
        return self._called(r"\mathrm{sign}", expr, exp)

    def _print_atan(self, expr: Expr, exp: str | None = None) -> str:
        return self._called(r"\arctan", expr, exp)

    def _print_Symbol(self, expr: Expr, style: str = "plain") -> str:
        del style  # the name of a symbol is its LaTeX
        return str(expr.name)


_PRINTER = _Printer({"mat_str": "bmatrix", "mat_delim": "", "mul_symbol": r" \, "})


def latex(value: Any) -> str:
    """A sympy expression or matrix."""
    return str(_PRINTER.doprint(value))


def name(port: str) -> str:
    """A port or intermediate result: ``x_rate``, ``v_m.x``, ``k_rho``, ``m12``."""
    base, _, axis = port.partition(".")
    dots = 0
    while base.endswith("_rate"):
        base, dots = base.removesuffix("_rate"), dots + 1
    head, _, index = base.partition("_")
    numbered = _NUMBERED.fullmatch(head)
    if numbered:
        head, index = numbered[1], numbered[2] + (f",{index}" if index else "")
    if axis and axis not in ("x", "y", "z"):  # right.spin
        head, index, axis = axis, base, ""
    text = rf"\{head}" if head in _GREEK else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    if head in _SHORT and not (index or axis):
        text = _SHORT[head]
    if dots:
        text = rf"\{'d' * dots}ot{{{text}}}"
    indices = [i if re.fullmatch(r"[\d,]+|[a-z]", i) else _word(i) for i in (index, axis) if i]
    return rf"{text}_{{{','.join(indices)}}}" if indices else text


def _word(text: str) -> str:
    return rf"\{text}" if text in _GREEK else rf"\mathrm{{{_spaced(text)}}}"


def _spaced(text: str) -> str:
    return text.replace("_", r"\;")


def equations(formula: Formula) -> list[str]:
    """One line ``name &= expression`` per intermediate result worth a name, per output and per output matrix."""
    uses = _uses(formula)
    values: dict[Expr, Expr] = {
        signal(port.name): sympy.Symbol(name(port.name), real=True) for port in formula.inputs
    }
    memo: dict[Expr, Expr] = {}
    lines = []
    for symbol, expr in formula.locals:
        value = substituted(unguarded(expr), values, memo)
        if symbol.name.endswith("_exp"):
            value = sympy.exp(values[local(f"{symbol.name}_of")])
        if "_exp_" in symbol.name or uses[symbol] <= 1 or value.count_ops() <= 3:
            values[symbol] = value
            continue
        values[symbol] = sympy.Symbol(rf"\mathit{{{_spaced(symbol.name)}}}", real=True)
        lines.append(_equation(latex(values[symbol]), value))
    taken = {port.name for port in formula.inputs}
    outputs = [(port, substituted(unguarded(expr), values, memo)) for port, expr in formula.outputs]
    matrix = [(port, value) for port, value in outputs if _ENTRY.fullmatch(port.name)]
    if matrix:
        lines.append(_matrix(matrix))
    for port, value in outputs:
        if not _ENTRY.fullmatch(port.name):
            prime = "^{+}" if port.name in taken else ""  # an output that is the new value of an input
            lines.append(_equation(name(port.name) + prime, value))
    return lines


def _matrix(entries: list[tuple[Port, Expr]]) -> str:
    places = [m for port, _ in entries if (m := _ENTRY.fullmatch(port.name))]
    rows, columns = (max(int(m[k]) for m in places) for k in (2, 3))
    matrix = sympy.Matrix(rows, columns, [value for _, value in entries])
    return rf"{places[0][1].upper()} &= {latex(matrix)}"


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
