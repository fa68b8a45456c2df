"""Formulas of the program (sympy) as sums of terms: products over named quantities, roots and absolute values."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy

from wmrgen import notation
from wmrgen.backends.report.tex import Factor, Term, total
from wmrgen.exact.number import ONE, Exact, exact_sqrt
from wmrgen.symbolic import Expr, Parameter

_TWIST = {"vx": 0, "vy": 1, "omega": 2}
Ports = Mapping[str, str]


def terms(expr: Expr, ports: Ports) -> list[Term]:
    """The summands of an expression."""
    summands: list[Term] = []
    for arg in sympy.Add.make_args(expr):
        number, factors, inner = ONE, [], None
        for factor in sympy.Mul.make_args(arg):
            value = _number(factor)
            if value is not None:
                number = number * value
            elif isinstance(factor, sympy.Add) and inner is None:
                inner = factor
            else:
                factors.append(_factor(factor, ports))
        if inner is None:
            summands.append(Term(number, tuple(factors)))
        else:
            summands += [Term(t.number * number, (*t.factors, *factors)) for t in terms(inner, ports)]
    return [t for t in summands if t.number]


def _number(expr: Expr) -> Exact | None:
    if isinstance(expr, sympy.Rational):
        return Exact(Fraction(int(expr.p), int(expr.q)))
    if isinstance(expr, sympy.Pow) and isinstance(expr.base, sympy.Rational) and expr.exp == sympy.S.Half:
        return exact_sqrt(Fraction(int(expr.base.p), int(expr.base.q)))
    if isinstance(expr, sympy.Add) and not expr.free_symbols:
        parts = [_number_product(a) for a in expr.args]
        known = [p for p in parts if p is not None]
        return sum(known, Exact(0)) if len(known) == len(parts) else None
    return None


def _number_product(expr: Expr) -> Exact | None:
    product = ONE
    for f in sympy.Mul.make_args(expr):
        value = _number(f)
        if value is None:
            return None
        product = product * value
    return product


def _factor(expr: Expr, ports: Ports) -> Factor:
    base, power = (expr.base, expr.exp) if isinstance(expr, sympy.Pow) else (expr, sympy.S.One)
    if power.is_Rational and power.q == 2:
        return Factor(rf"\sqrt{{{total(terms(base, ports))}}}", int(power.p), 2, (8, ""))
    n = int(power)
    if isinstance(base, Parameter):
        return Factor(notation.parameter(base.name), n, 0, (0, base.name))
    if isinstance(base, sympy.Symbol):
        port = ports.get(base.name, base.name.removesuffix("_fit"))
        order = list(ports).index(base.name) if base.name in ports else -1
        return Factor(notation.port(port), n, 2, (_TWIST.get(port, 3 + order), ""))
    if isinstance(base, sympy.Abs):
        return Factor(rf"\left|{total(terms(base.args[0], ports))}\right|", n, 2, (8, ""))
    if isinstance(base, sympy.cos | sympy.sin):
        head = "\\cos" if isinstance(base, sympy.cos) else "\\sin"
        return Factor(f"{head}{_angle(base.args[0], ports)}", n, 1, (0, str(head)))
    if base is sympy.pi:
        return Factor(r"\pi", n, 0, (0, "pi"))
    if isinstance(base, sympy.atan2):
        y, x = (total(terms(a, ports)) for a in base.args)
        return Factor(rf"\mathrm{{atan2}}\left({y},\, {x}\right)", n, 1, (8, ""))
    return Factor(total(terms(base, ports)), n, 0, (2, ""), True)


def _angle(angle: Expr, ports: Ports) -> str:
    """The argument of a sine: a joint's name, or an expression in parentheses."""
    if isinstance(angle, sympy.Symbol):
        return notation.port(ports.get(angle.name, angle.name))
    return rf"\left({total(terms(angle, ports))}\right)"
