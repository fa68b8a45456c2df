"""Quotients of polynomials in short form, and the conditions under which they exist."""

from __future__ import annotations

from math import cos, pi, sin

from wmrgen.exact.evaluate import number
from wmrgen.exact.number import ONE
from wmrgen.exact.poly import Gen, Poly, Row
from wmrgen.functions.models.frame import angles_in, cleaned
from wmrgen.layout.records import Robot

_STEPS = 720
_MARGIN = 1e-3


def divided(row: Row, divisor: Poly) -> Row:
    """row / divisor, with what is common cancelled."""
    row = cleaned(row)
    return quotient(row[0], divisor), quotient(row[1], divisor), quotient(row[2], divisor)


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
    first, coefficient = min(poly.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]])
    common = {g: e for g, e in first if g.kind != "inv"}
    for m in poly.terms:
        powers = dict(m)
        common = {g: min(e, powers[g]) for g, e in common.items() if g in powers}
    factor = Poly({tuple((g, e) for g, e in sorted(common.items()) if e): coefficient})
    return poly * factor.inverse(), factor


def essential(poly: Poly) -> Poly:
    """The condition poly = 0 without factors that are lengths, numbers, powers or roots."""
    core, factor = split(poly)
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


def never_zero(poly: Poly, robot: Robot) -> bool:
    """True for a constant, and for a function of one steering angle that keeps clear of zero all the way round."""
    if poly.constant is not None:
        return True
    names = sorted(angles_in((poly,)))
    if len(names) != 1:
        return False
    values = {p.name: p.value for p in robot.parameters}
    powers: dict[tuple[int, int], float] = {}
    cosine, sine = Gen("cos", names[0]), Gen("sin", names[0])
    for monomial, coefficient in poly.terms.items():
        rest = tuple((g, e) for g, e in monomial if g not in (cosine, sine))
        exponents = dict(monomial)
        if any(g.args for g, _ in rest):
            return False
        key = (exponents.get(cosine, 0), exponents.get(sine, 0))
        powers[key] = powers.get(key, 0.0) + float(number(Poly({rest: coefficient}), values))
    samples = [
        sum(k * cos(a) ** i * sin(a) ** j for (i, j), k in powers.items())
        for a in (2 * pi * step / _STEPS for step in range(_STEPS))
    ]
    top = max(abs(v) for v in samples)
    return min(abs(v) for v in samples) > _MARGIN * top and (min(samples) > 0) == (max(samples) > 0)
