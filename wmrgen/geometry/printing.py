"""Print expressions as LaTeX and as text, with sympy's printers and the contract names of inputs and outputs.

`readable` replaces numbers that are too long to read by decimals. Data such as JSON keep the exact fraction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import sympy
from sympy.printing.latex import LatexPrinter
from sympy.printing.str import StrPrinter

from wmrgen.geometry import notation
from wmrgen.geometry.ports import Port
from wmrgen.geometry.symbolic import Expr, Operation

DIGITS = 12  # significant digits: a fraction with a longer numerator or denominator is rounded for reading
Writer = Callable[[Expr], str]


def symbol_names(ports: Iterable[Port]) -> dict[str, str]:
    """Return a mapping from symbol names to contract names: ``left_spin`` -> ``left.spin``."""
    return {p.name.replace(".", "_"): p.name for p in ports}


class Latex(LatexPrinter):  # type: ignore[misc]
    """A printer of LaTeX that GitHub renders (no \\operatorname), with terms in their given order.

    The name of a plain `sympy.Symbol` is its LaTeX.
    """

    printmethod = ""  # do not call the symbols' own _latex

    def __init__(self, ports: Iterable[Port] = (), **settings: Any) -> None:
        super().__init__({"order": "none", **settings})
        self.names = symbol_names(ports)

    def _print_Symbol(self, expr: Expr, style: str = "plain") -> str:
        del style
        return str(expr.name)

    def _print_Quantity(self, expr: Expr, style: str = "plain") -> str:
        del style
        name = self.names.get(expr.name)
        return notation.port(name) if name else str(expr._latex(self))

    _print_Input = _print_Local = _print_Quantity

    def _print_Parameter(self, expr: Expr, style: str = "plain") -> str:
        del style
        return notation.parameter(expr.name)

    def _print_Pi(self, expr: Expr, exp: str | None = None) -> str:
        del expr  # sympy prints pi by a method of the number, which `printmethod` turns off
        return r"\pi" if exp is None else rf"\pi^{{{exp}}}"

    def _print_Max(self, expr: Expr, exp: str | None = None) -> str:
        text = ", ".join(self._print(a) for a in _flat_arguments(expr))
        text = rf"\{expr.func.__name__.lower()}\left({text}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    _print_Min = _print_Max

    def _upright(self, name: str, expr: Expr, exponent: str | None) -> str:
        arguments = r",\, ".join(self._print(a) for a in expr.args)
        text = rf"{name}\left({arguments}\right)"
        return text if exponent is None else f"{text}^{{{exponent}}}"

    def _print_atan2(self, expr: Expr, exp: str | None = None) -> str:
        return self._upright(r"\mathrm{atan2}", expr, exp)

    def _print_atan(self, expr: Expr, exp: str | None = None) -> str:
        return self._upright(r"\arctan", expr, exp)

    def _print_sign(self, expr: Expr, exp: str | None = None) -> str:
        return self._upright(r"\mathrm{sign}", expr, exp)

    def _print_Function(self, expr: Expr, exp: str | None = None) -> str:
        if not isinstance(expr, Operation):
            return str(super()._print_Function(expr, exp))
        name = str(expr.op).replace("_", r"\ ")
        return self._upright(rf"\mathrm{{{name}}}", expr, exp)

    def _print_Add(self, expr: Expr, order: str | None = None) -> str:
        # sympy prints two signs before an unevaluated product with a negative factor.
        text = str(super()._print_Add(expr, order))
        return text.replace("- - ", "+ ").replace("+ - ", "- ")

    def summand(self, expr: Expr) -> str:
        """Return the LaTeX of a term of a sum, with its sign."""
        text = str(self.doprint(expr))
        text = rf"\left({text}\right)" if self._needs_add_brackets(expr) else text
        return text if text.startswith("-") else f"+ {text}"

    def parts(self, expr: Expr) -> list[str]:
        """Return the LaTeX of an expression in parts between which a line may break.

        Sums break between terms, max and min between arguments; any other expression is one part.
        """
        if expr.is_Add:
            first, *rest = map(self.summand, expr.args)
            return [first.removeprefix("+ "), *rest]
        if not isinstance(expr, sympy.Max | sympy.Min):
            return [str(self.doprint(expr))]
        texts: list[str] = []
        for argument in _flat_arguments(expr):
            *before, last = self.parts(argument)
            texts += (*before, f"{last},")
        texts[0] = rf"\{expr.func.__name__.lower()}\Bigl({texts[0]}"
        texts[-1] = rf"{texts[-1].removesuffix(',')}\Bigr)"
        return texts

    def _print_Piecewise(self, expr: Expr) -> str:
        (then, condition), (otherwise, _) = expr.args
        then, condition, otherwise = (self._print(e) for e in (then, condition, otherwise))
        return rf"\begin{{cases}} {then} & {condition} \\ {otherwise} & \mathrm{{else}} \end{{cases}}"

    def _print_Rational(self, expr: Expr) -> str:
        if len(str(expr.q)) < 7 and len(str(expr.p)) < 10:
            return str(super()._print_Rational(expr))
        power = len(str(expr.q)) - 1
        return f"10^{{-{power}}}" if expr.q == 10**power and expr.p == 1 else notation.decimal(float(expr))


def _flat_arguments(expr: Expr) -> list[Expr]:
    """Return the arguments of a nested max or min: a, b and c for max(a, max(b, c))."""
    arguments: list[Expr] = []
    for a in expr.args:
        arguments += _flat_arguments(a) if a.func is expr.func else [a]
    return arguments


class Text(StrPrinter):  # type: ignore[misc]
    """A printer of Python syntax: ``front.steer`` for the given ports, else the identifier ``front_steer``."""

    def __init__(self, ports: Iterable[Port] = ()) -> None:
        super().__init__()
        self.names = symbol_names(ports)

    def _print_Symbol(self, expr: Expr) -> str:
        return self.names.get(expr.name, str(expr.name))

    _print_Quantity = _print_Parameter = _print_Input = _print_Local = _print_Symbol


def size(expr: Expr, memo: dict[Expr, int] | None = None) -> int:
    """Return the number of nodes of the expression, repeated subexpressions counted each time."""
    sizes = {} if memo is None else memo
    if expr not in sizes:
        sizes[expr] = 1 + sum(size(a, sizes) for a in expr.args)
    return sizes[expr]


def exact(expr: Expr) -> str:
    """Return the expression in Python syntax over identifiers, with exact numbers."""
    return str(sympy.sstr(expr))


class Reader:
    """A function that writes expressions with `readable` numbers."""

    def __init__(self, write: Writer = exact) -> None:
        self.write = write
        self.note = ""  # a sentence for the user, set once a number was rounded

    def __call__(self, expr: Expr) -> str:
        short = readable(expr)
        if short is not expr:
            self.note = f"Numbers of {DIGITS} digits are rounded for reading; --json gives the exact ones."
        return self.write(short)


def readable(expr: Expr) -> Expr:
    """Return the expression with decimals for fractions that have more than `DIGITS` digits in either part."""
    if isinstance(expr, sympy.Rational):
        return _rounded(expr) if max(abs(expr.p), expr.q) >= 10**DIGITS else expr
    if not expr.args:
        return expr
    args = [readable(a) for a in expr.args]
    return expr if all(a is b for a, b in zip(args, expr.args, strict=True)) else expr.func(*args)


def by_hand(symbols: Iterable[Expr], exprs: Iterable[Expr]) -> dict[Expr, Expr]:
    """Return replacements for LaTeX: upright words for ``symbols``, decimals for long numbers in ``exprs``.

    A number is long if its numerator or denominator has more than seven digits. Powers of ten remain, because they
    are printed as such.
    """
    replacements: dict[Expr, Expr] = {}
    for s in symbols:
        words = s.name.replace("_", r"\;")
        replacements[s] = sympy.Symbol(rf"\mathrm{{{words}}}")
    for e in exprs:
        for n in e.atoms(sympy.Rational):
            power_of_ten = abs(n.p) == 1 and n.q == 10 ** (len(str(n.q)) - 1)
            if max(abs(n.p), n.q) >= 10**7 and not power_of_ten:
                replacements[n] = sympy.Mul(sympy.sign(n), sympy.Symbol(notation.decimal(abs(float(n)))))
    return replacements


def _rounded(value: Expr) -> Expr:
    """Return the sign times a symbol that prints as the decimal, because sympy cannot fix how a number is printed."""
    sign = -1 if value < 0 else 1
    return sympy.Mul(sign, sympy.Symbol(f"{float(abs(value)):.{DIGITS}g}"))
