"""Polynomials in sines and cosines of steering angles: values, derivatives, equations and quotients in short form, and
where they vanish."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, lcm, pi, sin

from wmrgen.functions.system import Domain
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Gen, Poly, Row, common_powers, derivative, each, triple
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.symbolic import Expr, expression

NEGLIGIBLE = 1e-12
_STEPS = 720
_MARGIN = 1e-3


def without_lengths(p: Poly) -> Poly:
    """The left-hand side of p = 0 without powers of lengths that all terms have."""
    lengths = sorted((g, e) for g, e in common_powers([p]).items() if e and g.kind == "param")
    return p * Poly({tuple(lengths): ONE}).inverse()


def whole(polys: Sequence[Poly]) -> list[Poly]:
    """Polynomials of one scale times the least number that leaves no fraction, where that is small."""
    common = lcm(*(c.den for p in polys for c in p.terms.values()))
    return [p.scale(common) if common <= 100 else p for p in polys]  # more makes numbers longer


def by_angle(poly: Poly, cosine: Gen, sine: Gen) -> Poly:
    """The derivative by an angle that enters through this cosine and sine alone."""
    rates = {cosine: -sine.alone, sine: cosine.alone}
    return derivative(poly, lambda g: rates.get(g, Poly({})))


def by_steering(poly: Poly, wheel: str) -> Poly:
    """d poly / d(steering angle of ``wheel``)."""
    return by_angle(poly, Gen("cos", wheel), Gen("sin", wheel))


def angles_in(polys: tuple[Poly, ...] | Row) -> set[str]:
    """Names of the wheels whose steering angle occurs."""
    names: set[str] = set()
    for p in polys:
        for g in p.generators:
            names |= {g.name} if g.kind in ("cos", "sin") else angles_in(g.args)
    return names


def clean(*polys: Poly) -> tuple[Poly, ...]:
    """The polynomials without terms that only rounding of their coefficients has left over."""
    least = NEGLIGIBLE * max((abs(float(c)) for p in polys for c in p.terms.values()), default=0.0)
    return tuple(Poly({m: c for m, c in p.terms.items() if abs(float(c)) > least}) for p in polys)


def cleaned(row: Row) -> Row:
    """The same of a row."""
    return triple(clean(*row))


def divided(row: Row, divisor: Poly) -> Row:
    """row / divisor, with what is common cancelled."""
    return each(cleaned(row), lambda p: quotient(p, divisor))


def quotient(above: Poly, below: Poly) -> Poly:
    """above / below: a constant times monomials where one is a multiple of the other."""
    if not above or len(below.terms) == 1:
        return above * below.inverse() if above else above
    core, factor = split(below)
    own, scale = split(above)
    if own == core:
        return scale * factor.inverse()
    return above * factor.inverse() * core.inverse()


def split(poly: Poly) -> tuple[Poly, Poly]:
    """poly = core * factor: the factor is a monomial, the core has no common one and leading coefficient 1."""
    first, coefficient = poly.ordered[0]
    common = {g: e for g, e in first if g.kind != "inv"}
    for m in poly.terms:
        powers = dict(m)
        common = {g: min(e, powers[g]) for g, e in common.items() if g in powers}
    factor = Poly({tuple((g, e) for g, e in sorted(common.items()) if e): coefficient})
    return poly * factor.inverse(), factor


def essential(poly: Poly) -> Poly:
    """The condition poly = 0 without factors that are lengths, numbers, powers or roots."""
    core, factor = split(poly)
    (core,) = whole([without_lengths(core)])
    parts = [_squared(Poly({((g, 1),): ONE})) for m in factor.terms for g, e in m if e > 0]
    condition = Poly.of(1)
    for part in (core, *parts):
        if part.constant is None and angles_in((part,)):
            condition = condition * part
    return condition


def _squared(part: Poly) -> Poly:
    """What stands under a root, else the part itself."""
    ((monomial, _),) = part.terms.items()
    gen = monomial[0][0]
    return gen.args[0] if gen.kind == "sqrt" else part


def domain_of(
    condition: Poly, text: str, robot: Robot, shown: Callable[[Poly], Expr] = expression
) -> tuple[Domain, ...]:
    """Where a model does not hold, and what ``text`` says of it; empty where the condition is never zero."""
    return () if never_zero(condition, robot) else (Domain(shown(condition), text),)


def never_zero(poly: Poly, robot: Robot) -> bool:
    """True for a constant, and for a function of one steering angle that keeps clear of zero all the way round."""
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
    samples = [
        sum(k * cos(a) ** powers.get(cosine, 0) * sin(a) ** powers.get(sine, 0) for k, powers in terms)
        for a in (2 * pi * step / _STEPS for step in range(_STEPS))
    ]
    top = max(abs(v) for v in samples)
    return min(abs(v) for v in samples) > _MARGIN * top and (min(samples) > 0) == (max(samples) > 0)
