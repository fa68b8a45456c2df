"""Divisions that hold for every finite input: code never divides by zero where a model is singular."""

from __future__ import annotations

import sympy

from wmrgen.kinematics.records import Locals
from wmrgen.symbolic import Expr, Parameter, absolute, add, select, times

SMALLEST = sympy.Rational(1, 10**9)  # a divisor nearer to zero than this counts as zero


def guarded(expr: Expr, names: Locals, memo: dict[Expr, Expr]) -> Expr:
    """``expr`` with every 1/d, d not of geometry alone, replaced by a local that is 0 where d is.

    The divisor itself is kept off zero, so that neither the value nor a derivative is NaN there.
    ``memo`` keeps what shared parts became.
    """
    if not expr.args:
        return expr
    if expr in memo:
        return memo[expr]
    if _divides(expr):
        base = guarded(expr.base, names, memo)
        number = sum(symbol.name.startswith("divisor") for symbol, _ in names.items)
        safe = names.define(f"divisor{number + 1}", select(absolute(base), SMALLEST, sympy.S.One, base))
        power = sympy.Pow(safe, expr.exp, evaluate=False)
        result = names.define(f"over{number + 1}", select(absolute(base), SMALLEST, sympy.S.Zero, power))
    else:
        args = [guarded(a, names, memo) for a in expr.args]
        result = _rebuilt(expr, args)
    memo[expr] = result
    return result


def _divides(expr: Expr) -> bool:
    if not isinstance(expr, sympy.Pow) or not expr.exp.is_Rational or expr.exp >= 0:
        return False
    return any(not isinstance(s, Parameter) for s in expr.base.free_symbols)


def _rebuilt(expr: Expr, args: list[Expr]) -> Expr:
    if all(a is b for a, b in zip(args, expr.args, strict=True)):
        return expr
    if isinstance(expr, sympy.Add):
        return add(*args)
    if isinstance(expr, sympy.Mul):
        return times(*args)
    if isinstance(expr, sympy.Pow):
        return sympy.Pow(*args, evaluate=False)
    return expr.func(*args)
