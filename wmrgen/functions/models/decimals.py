"""Numbers for readers: an exact fraction too long to read becomes a decimal. Plain data keep the fraction."""

from __future__ import annotations

from collections.abc import Callable

import sympy

from wmrgen.symbolic import Expr

DIGITS = 12


def exact(expr: Expr) -> str:
    """Python syntax, every number as it is."""
    text: str = sympy.sstr(expr)
    return text


class Reader:
    """Writes expressions for reading; ``note`` says so where a number had to be rounded."""

    def __init__(self, write: Callable[[Expr], str] = exact) -> None:
        self.write, self.note = write, ""

    def __call__(self, expr: Expr) -> str:
        short = readable(expr)
        if short is not expr:
            self.note = f"Numbers of {DIGITS} digits are rounded for reading; --json gives the exact ones."
        return self.write(short)


def readable(expr: Expr) -> Expr:
    """The expression with numbers of more than `DIGITS` digits, above or below the line, as rounded decimals."""
    if isinstance(expr, sympy.Rational):
        return _decimal(expr) if max(abs(expr.p), expr.q) >= 10**DIGITS else expr
    if not expr.args:
        return expr
    args = [readable(a) for a in expr.args]
    return expr if all(a is b for a, b in zip(args, expr.args, strict=True)) else expr.func(*args)


def _decimal(value: Expr) -> Expr:
    """A symbol that prints as the decimal: sympy has no number of a given look. The sign stays outside."""
    sign = -1 if value < 0 else 1
    return sympy.Mul(sign, sympy.Symbol(f"{float(abs(value)):.{DIGITS}g}", positive=True))
