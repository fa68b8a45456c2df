"""Numbers as people write them for a float."""

from __future__ import annotations

import sympy


def decimals(expressions: list[sympy.Expr]) -> dict[sympy.Expr, sympy.Expr]:
    """Long fractions, which float literals cannot hold, and pi (M_PI is a double) -> nine significant digits."""
    found = {number for value in expressions for number in value.atoms(sympy.Rational) if number.q > 10**6}
    return {number: sympy.Float(number, 9) for number in sorted(found)} | {sympy.pi: sympy.Float(sympy.pi, 9)}
