"""Polynomials in sines and cosines of steering angles: derivatives, quotients in short form, and zeros."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, lcm, pi, sin

from wmrgen.analysis.kinematics.least_squares import NEGLIGIBLE
from wmrgen.functions.system import Domain
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Gen, Poly, Row, common_powers, derivative, each, triple
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.symbolic import Expr, expression


def without_lengths(p: Poly) -> Poly:
    """Return the left-hand side of p = 0 without powers of lengths that all terms share."""
    lengths = sorted((g, e) for g, e in common_powers([p]).items() if e and g.kind == "param")
    return p * Poly({tuple(lengths): ONE}).inverse()


def whole(polys: Sequence[Poly]) -> list[Poly]:
    """Return polynomials of one scale times the smallest number that removes all fractions, if it is small."""
    common = lcm(*(c.den for p in polys for c in p.terms.values()))
    # A larger factor makes the numbers longer.
    return [p.scale(common) if common <= 100 else p for p in polys]


def by_angle(poly: Poly, cosine: Gen, sine: Gen) -> Poly:
    """Return the derivative by an angle that occurs only in this cosine and this sine.

    Args:
        poly: The polynomial.
        cosine: The generator of the angle's cosine.
        sine: The generator of the angle's sine.
    """
    rates = {cosine: -sine.alone, sine: cosine.alone}
    return derivative(poly, lambda g: rates.get(g, Poly({})))


def by_steering(poly: Poly, wheel: str) -> Poly:
    """Return d poly / d(steering angle of ``wheel``)."""
    return by_angle(poly, Gen("cos", wheel), Gen("sin", wheel))


def angles_in(polys: tuple[Poly, ...] | Row) -> set[str]:
    """Return the names of the wheels whose steering angle occurs."""
    names: set[str] = set()
    for p in polys:
        for g in p.generators:
            names |= {g.name} if g.kind in ("cos", "sin") else angles_in(g.args)
    return names


def without_rounding(*polys: Poly) -> tuple[Poly, ...]:
    """Return the polynomials without terms that are only rounding errors of their coefficients."""
    least = NEGLIGIBLE * max((abs(float(c)) for p in polys for c in p.terms.values()), default=0.0)

    def large_terms(p: Poly) -> Poly:
        return Poly({m: c for m, c in p.terms.items() if abs(float(c)) > least})

    return tuple(map(large_terms, polys))


def row_without_rounding(row: Row) -> Row:
    """Return a row without terms that are only rounding errors."""
    return triple(without_rounding(*row))


def divided(row: Row, divisor: Poly) -> Row:
    """Return row / divisor, with common factors cancelled."""
    return each(row_without_rounding(row), lambda p: quotient(p, divisor))


def quotient(above: Poly, below: Poly) -> Poly:
    """Return above / below: a constant times monomials if one is a multiple of the other."""
    if not above or len(below.terms) == 1:
        return above * below.inverse() if above else above
    core, factor = split(below)
    own, scale = split(above)
    if own == core:
        return scale * factor.inverse()
    return above * factor.inverse() * core.inverse()


def split(poly: Poly) -> tuple[Poly, Poly]:
    """Return core and factor of poly = core * factor. The factor is a monomial; the core has none and starts with 1."""
    first, coefficient = poly.ordered[0]
    common = {g: e for g, e in first if g.kind != "inv"}
    for m in poly.terms:
        powers = dict(m)
        common = {g: min(e, powers[g]) for g, e in common.items() if g in powers}
    factor = Poly({tuple((g, e) for g, e in sorted(common.items()) if e): coefficient})
    return poly * factor.inverse(), factor


def zero_condition(poly: Poly) -> Poly:
    """Return the condition poly = 0 without factors that are lengths, numbers, powers or roots."""
    core, factor = split(poly)
    (core,) = whole([without_lengths(core)])
    parts = [_squared(Poly({((g, 1),): ONE})) for m in factor.terms for g, e in m if e > 0]
    condition = Poly.of(1)
    for part in (core, *parts):
        if part.constant is None and angles_in((part,)):
            condition = condition * part
    return condition


def _squared(part: Poly) -> Poly:
    """Return the polynomial under a root, else the part itself."""
    ((monomial, _),) = part.terms.items()
    gen = monomial[0][0]
    return gen.args[0] if gen.kind == "sqrt" else part


def domain_of(
    condition: Poly, text: str, robot: Robot, shown: Callable[[Poly], Expr] = expression
) -> tuple[Domain, ...]:
    """Return where a model does not hold.

    Args:
        condition: The polynomial that is zero there.
        text: What happens there, with names in backticks.
        robot: The robot, for the values of its parameters.
        shown: Converts the polynomial to an expression.

    Returns:
        One domain; none if the condition is never zero.
    """
    return () if never_zero(condition, robot) else (Domain(shown(condition), text),)


def never_zero(poly: Poly, robot: Robot) -> bool:
    """Return whether a polynomial is a constant, or a function of one steering angle without zeros."""
    if poly.constant is not None:
        return True
    names = angles_in((poly,))
    if len(names) != 1:
        return False
    (name,) = names
    cosine, sine = Gen("cos", name), Gen("sin", name)
    valued = fix(poly, {p.name: p.value for p in robot.parameters})
    if not {*valued.generators} <= {cosine, sine}:
        return False
    terms = [(float(c), dict(m)) for m, c in valued.terms.items()]
    samples = []
    for half_degrees in range(720):
        angle = half_degrees * pi / 360
        c, s = cos(angle), sin(angle)
        samples.append(sum(k * c ** powers.get(cosine, 0) * s ** powers.get(sine, 0) for k, powers in terms))
    top = max(abs(v) for v in samples)
    clear = 1e-3 * top  # samples nearer to zero are treated as zero
    return min(abs(v) for v in samples) > clear and (min(samples) > 0) == (max(samples) > 0)
