"""Numbers and functions as people write them for other generators."""

from __future__ import annotations

import sympy

from wmrgen.geometry.symbolic import AtLeast, Clamp, WithSignOf


def decimals(expressions: list[sympy.Expr]) -> dict[sympy.Expr, sympy.Expr]:
    """Long fractions, which float literals cannot hold, and pi (M_PI is a double) -> nine significant digits."""
    long = {number for value in expressions for number in value.atoms(sympy.Rational) if number.q > 10**6}
    return {number: sympy.Float(number, 9) for number in sorted(long)} | {sympy.pi: sympy.Float(sympy.pi, 9)}


def with_plain_functions(value: sympy.Expr) -> sympy.Expr:
    """Return ``value`` without operations that only wmrgen has."""

    def with_sign_of(a: sympy.Expr, b: sympy.Expr) -> sympy.Expr:
        return sympy.Piecewise((-a, b < 0), (a, True))

    value = value.replace(Clamp, lambda a, m: sympy.Max(-m, sympy.Min(m, a)))
    value = value.replace(AtLeast, lambda a, m: with_sign_of(sympy.Max(abs(a), m), a))
    return value.replace(WithSignOf, with_sign_of)
