"""Vector fields as exact polynomials: what Lie brackets are formed of.

Generators are states, parameters, and sines and cosines of sums of states; tan is sin/cos. Derivatives are exact, and
so are values where every angle is a rational point of the unit circle.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy

from wmrgen.exact.evaluate import circle, fix
from wmrgen.exact.number import ONE, ZERO, Exact, exact_sqrt
from wmrgen.exact.poly import Gen, Poly, derivative
from wmrgen.symbolic import Expr, Input, Parameter

Field = tuple[Poly, ...]


def to_poly(expr: Expr) -> Poly:
    """A field component as a polynomial. Input symbols keep their printed name (`front_steer`)."""
    match expr:
        case sympy.Rational():
            return Poly.of(Fraction(int(expr.p), int(expr.q)))
        case Parameter():
            return Poly.gen("param", expr.name)
        case Input():
            return Poly.gen("input", expr.name)
        case sympy.Add():
            return Poly.sum(to_poly(a) for a in expr.args)
        case sympy.Mul():
            result = Poly.of(1)
            for a in expr.args:
                result = result * to_poly(a)
            return result
        case sympy.Pow():
            return _power(expr)
        case sympy.cos():
            return _circle(expr.args[0])[0]
        case sympy.sin():
            return _circle(expr.args[0])[1]
        case sympy.tan():
            c, s = _circle(expr.args[0])
            return s * c.inverse()
    raise ValueError(f"no polynomial: {expr}")


def _power(expr: Expr) -> Poly:
    base, exponent = to_poly(expr.base), expr.exp
    if exponent.is_Integer:
        return base ** int(exponent)
    if exponent.is_Rational and exponent.q == 2:
        number = base.constant
        root = exact_sqrt(number) if number is not None else None
        kept = Poly.of(root) if root is not None else Poly.gen("sqrt", "", base)
        return kept ** int(exponent.p)
    raise ValueError(f"no polynomial: {expr}")


def _circle(angle: Expr) -> tuple[Poly, Poly]:
    """Cosine and sine of a sum of states, its first coefficient positive."""
    poly = to_poly(angle)
    first = min(poly.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]], default=((), ONE))[1]
    if first.sign < 0:
        return Poly.gen("cosf", "", -poly), -Poly.gen("sinf", "", -poly)
    return Poly.gen("cosf", "", poly), Poly.gen("sinf", "", poly)


def by_state(poly: Poly, state: str) -> Poly:
    """d poly / d state."""
    name = state.replace(".", "_")
    return derivative(poly, lambda g: _of_generator(g, name))


def _of_generator(g: Gen, name: str) -> Poly:
    if g.kind == "input":
        return Poly.of(int(g.name == name))
    if not g.args:
        return Poly({})
    inner = by_state(g.args[0], name)
    if not inner:
        return inner
    match g.kind:
        case "cosf":
            return -(Poly.gen("sinf", "", *g.args) * inner)
        case "sinf":
            return Poly.gen("cosf", "", *g.args) * inner
        case "inv":
            return -(Poly({((g, 2),): ONE}) * inner)
        case "sqrt":
            return (Poly({((g, -1),): ONE}) * inner).scale(Fraction(1, 2))
    raise ValueError(f"no derivative of {g.kind}")


def value_at(poly: Poly, point: Mapping[str, Fraction], numbers: Mapping[str, Exact]) -> Exact:
    """The value where each state is what ``point`` gives: a number, for angles the tangent of the half."""
    states = {name.replace(".", "_"): value for name, value in point.items()}

    def value(g: Gen) -> Poly | None:
        match g.kind:
            case "input":
                return Poly.of(states[g.name])
            case "param":
                return Poly.of(numbers[g.name]) if g.name in numbers else None
            case "cosf" | "sinf":
                known = _turned(g.args[0], states)
                return None if known is None else Poly.of(known[g.kind == "sinf"])
            case "inv":
                return g.args[0].substitute(value).inverse()
        return None

    found = fix(poly.substitute(value), {name: Poly.of(n) for name, n in numbers.items()}).constant
    if found is None:
        raise ValueError(f"no value: {poly.key}")
    return found


def _turned(angle: Poly, states: Mapping[str, Fraction]) -> tuple[Exact, Exact] | None:
    """(cos, sin) of a whole-numbered sum of states; None for an angle of parameters."""
    c, s = ONE, ZERO
    for monomial, count in angle.terms.items():
        ((g, e),) = monomial
        if g.kind != "input" or e != 1 or count.den != 1 or not count.is_rational:
            return None
        p, q = circle(states[g.name])
        q = q if count.num[0] > 0 else -q
        for _ in range(abs(count.num[0])):
            c, s = c * p - s * q, s * p + c * q
    return c, s
