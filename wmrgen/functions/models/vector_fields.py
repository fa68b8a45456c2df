"""Vector fields as exact polynomials, and their Lie brackets (Siegwart 3.4.1; Tzafestas 2.2.3).

Generators are states, parameters, and sines and cosines of sums of states; tan is sin/cos. The bracket [f, g] =
(dg/dq) f - (df/dq) g is formed in symbols. Its values are taken at a rational point of the state space, where every
angle is a rational point of the unit circle, so they have no rounding error.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import sympy

from wmrgen.geometry.exact.evaluate import CosSin, add_angles, circle, function, multiple, number, sqrt_poly
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, derivative
from wmrgen.geometry.ports import Port
from wmrgen.geometry.symbolic import Expr, Parameter, Quantity

Field = tuple[Poly, ...]


def to_poly(expr: Expr) -> Poly:
    """Return a field component as a polynomial. Inputs and locals keep their printed name (`front_steer`)."""
    match expr:
        case sympy.Rational():
            return Poly.of(Fraction(int(expr.p), int(expr.q)))
        case sympy.core.numbers.Pi():
            return Poly.gen("pi")
        case Parameter():
            return Poly.gen("param", expr.name)
        case Quantity():
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
        case sympy.atan2():
            return function("atan2", "", tuple(to_poly(a) for a in expr.args))
    raise ValueError(f"no polynomial: {expr}")


def _power(expr: Expr) -> Poly:
    """Return a power or a square root as a polynomial."""
    base, exponent = to_poly(expr.base), expr.exp
    if exponent.is_Integer:
        return base ** int(exponent)
    if exponent.is_Rational and exponent.q == 2:
        return sqrt_poly(base) ** int(exponent.p)
    raise ValueError(f"no polynomial: {expr}")


def _circle(angle: Expr) -> tuple[Poly, Poly]:
    """Return cosine and sine of a sum of states whose first coefficient is made positive."""
    poly = to_poly(angle)
    if poly and poly.ordered[0][1].sign < 0:
        return Poly.gen("cosf", "", -poly), -Poly.gen("sinf", "", -poly)
    return Poly.gen("cosf", "", poly), Poly.gen("sinf", "", poly)


def by_state(poly: Poly, state: str) -> Poly:
    """Return d poly / d state."""
    name = state.replace(".", "_")
    return derivative(poly, lambda g: _of_generator(g, name))


def _of_generator(g: Gen, name: str) -> Poly:
    """Return the derivative of a generator by a state."""
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


def generic_point(state: tuple[Port, ...], seed: int) -> dict[str, Exact]:
    """Return a number for each state; for an angle, the tangent of its half. Names are printed names, see `to_poly`."""
    return {
        p.name.replace(".", "_"): Exact(Fraction((-1) ** k * (2 * k + 1 + seed), 7 + 3 * k + 2 * seed))
        for k, p in enumerate(state)
    }


def at_point(poly: Poly, point: Mapping[str, Exact], numbers: Mapping[str, Exact]) -> Poly:
    """Return a polynomial with the values of states and parameters inserted.

    Args:
        poly: The polynomial.
        point: Values of the states; for an angle, the tangent of its half.
        numbers: Values of the parameters.

    Returns:
        A polynomial: a number if the exact field contains the value.
    """

    def value(g: Gen) -> Poly | None:
        match g.kind:
            case "input":
                return Poly.of(point[g.name])
            case "param":
                return Poly.of(numbers[g.name]) if g.name in numbers else None
            case "cosf" | "sinf":
                cos_sin = _on_circle(g.args[0], point)
                return None if cos_sin is None else cos_sin[g.kind == "sinf"]
            case "inv":
                return g.args[0].substitute(value).inverse()
            case "sqrt":
                return sqrt_poly(g.args[0].substitute(value))
        return None

    return poly.substitute(value)


def value_at(poly: Poly, point: Mapping[str, Exact], numbers: Mapping[str, Exact]) -> Exact:
    """Return the value of a polynomial at a point.

    Args:
        poly: The polynomial.
        point: Values of the states; for an angle, the tangent of its half.
        numbers: Values of the parameters.

    Returns:
        The exact value; rounded if the field does not contain it, see `exact.evaluate`.
    """
    return number(at_point(poly, point, numbers), {name: Poly.of(n) for name, n in numbers.items()})


def _on_circle(angle: Poly, point: Mapping[str, Exact]) -> CosSin | None:
    """Return (cos, sin) of a whole-numbered sum of states; None for an angle of parameters."""
    total: CosSin = Poly.of(1), Poly({})
    for monomial, count in angle.terms.items():
        if len(monomial) != 1:
            return None
        ((g, e),) = monomial
        if g.kind != "input" or e != 1 or count.den != 1 or not count.is_rational:
            return None
        c, s = circle(point[g.name].rational())
        total = add_angles(total, multiple((Poly.of(c), Poly.of(s)), count.num[0]))
    return total


class Slopes:
    """Derivatives by the states. Each derivative of a generator is computed once."""

    def __init__(self, state: tuple[str, ...]) -> None:
        self.states = tuple(q.replace(".", "_") for q in state)
        self.rates: dict[Gen, tuple[Poly, ...]] = {}

    def of_generator(self, g: Gen) -> tuple[Poly, ...]:
        """Return dg / dq_k for each state."""
        if g not in self.rates:
            self.rates[g] = tuple(_of_generator(g, q) for q in self.states)
        return self.rates[g]

    def jacobian(self, f: Field) -> tuple[Field, ...]:
        """Return df_i / dq_k, a row for each component."""

        def by(p: Poly, k: int) -> Poly:
            return derivative(p, lambda g: self.of_generator(g)[k])

        def gradient(p: Poly) -> Field:
            return tuple(by(p, k) for k in range(len(self.states)))

        return tuple(map(gradient, f))

    def products(self, f: Field) -> int:
        """Return how many products of terms the Jacobian takes."""
        count = 0
        for monomial in (m for p in f for m in p.terms):
            for g, _ in monomial:
                count += sum(len(rate.terms) for rate in self.of_generator(g))
        return count


def bracket_by(f: Field, df: tuple[Field, ...], g: Field, dg: tuple[Field, ...]) -> Field:
    """Return the Lie bracket [f, g] = (dg/dq) f - (df/dq) g.

    Args:
        f: A vector field.
        df: The Jacobian of f, row by row.
        g: A vector field.
        dg: The Jacobian of g, row by row.
    """
    components = []
    for dg_row, df_row in zip(dg, df, strict=True):
        parts = []
        for dg_k, f_k, df_k, g_k in zip(dg_row, f, df_row, g, strict=True):
            parts += [part for part in (dg_k * f_k, -(df_k * g_k)) if part]
        components.append(Poly.sum(parts))
    return tuple(components)
