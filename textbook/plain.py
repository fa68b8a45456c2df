"""Functions of the library as the texts write them: without the guards of their quotients."""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.contacts import TINY
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.geometry.symbolic import AtLeast, Expr


def unguarded(expr: Expr) -> Expr:
    """The expression with every choice about a divisor of at most 1e-12 decided for the quotient."""
    if not expr.args or not expr.has(sympy.Piecewise, AtLeast):
        return expr
    if isinstance(expr, AtLeast) and expr.args[1] == TINY:
        return unguarded(expr.args[0])
    if isinstance(expr, sympy.Piecewise):
        then, condition = expr.args[0]
        if condition.lts == TINY:
            return unguarded(then)
        return expr
    return expr.func(*(unguarded(a) for a in expr.args))


def plain(formula: Formula) -> dict[str, Expr]:
    """Output name -> expression in the inputs alone, without guards."""
    steps = tuple((symbol, unguarded(expr)) for symbol, expr in formula.locals)
    outputs = tuple((port, unguarded(expr)) for port, expr in formula.outputs)
    return replace(formula, locals=steps, outputs=outputs).closed()
