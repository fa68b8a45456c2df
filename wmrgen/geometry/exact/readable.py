"""Write sines and cosines of geometry as an engineer does: tan g for sin g / cos g, sin(a - b) for two products.

The results have the same values but no normal form: equal polynomials may have different results. They are for
reports and for expressions that users read. Do not compute with them.
"""

from __future__ import annotations

from math import gcd, lcm

from wmrgen.geometry.exact.lowest import Product
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Monomial, Poly

_OTHER = {"cosf": "sinf", "sinf": "cosf"}


def readable(product: Product) -> Product:
    """Return the same product with sines of sums, tangents, and sums without fractions or common numbers."""
    factor, rest = (with_sines_squared(with_sums_of_angles(part)) for part in product)
    size = _content(rest)
    factor = factor.scale(size).substitute(_whole_divisor)
    return Product(with_tangents(factor), rest.scale(size.inverse()))


def _whole_divisor(g: Gen) -> Poly | None:
    """Return 1 / (a + b/3) as 3 / (3 a + b), and 1 / (1 + 2 a), where 1 is a length, as 0.5 / (a + 0.5)."""
    if g.kind != "inv":
        return None
    lengths = {m: _degree_in_parameters(m) for m in g.args[0].terms}
    most = max(lengths.values())
    size = _content(g.args[0])
    if min(lengths.values()) < most:
        size = min((c for m, c in g.args[0].terms.items() if lengths[m] == most), key=abs)
    return g.args[0].scale(size.inverse()).inverse().scale(size.inverse())


def _degree_in_parameters(monomial: Monomial) -> int:
    return sum(e for h, e in monomial if h.kind == "param")


def _content(p: Poly) -> Exact:
    """Return the largest number of which all coefficients are integer multiples; 1 if some are irrational."""
    numbers = [c.parts[0] for c in p.terms.values() if c.is_rational]
    if not numbers or len(numbers) < len(p.terms):
        return ONE
    return Exact.ratio(gcd(*(n.numerator for n in numbers)), lcm(*(n.denominator for n in numbers)))


def with_tangents(p: Poly) -> Poly:
    """Return ``p`` with sin g / cos g as tan g, term by term.

    If the divisor is a sum, cos g / (a sin g + b cos g) becomes 1 / (a tan g + b).
    """
    return Poly.sum(_with_tangent(m).scale(c) for m, c in p.terms.items())


def _with_tangent(monomial: Monomial) -> Poly:
    powers = dict(monomial)
    for cosine in [g for g in powers if g.kind == "cosf" and powers[g] > 0]:
        for inv in [g for g in powers if g.kind == "inv" and powers[g] == 1]:
            below = _over_cosine(inv.args[0], cosine)
            if below is not None and powers.get(cosine, 0) > 0:
                rest = Poly({_without(powers, inv, cosine): ONE})
                return with_tangents(rest * below.inverse())
    for g in [g for g in powers if g.kind == "sinf"]:
        cosine = Gen("cosf", "", g.args)
        power = powers[g]
        if powers.get(cosine, 0) * power < 0 and abs(power) == 1:
            others = {h: e for h, e in powers.items() if h is not g} | {cosine: powers[cosine] + power}
            tangent = Poly({((Gen("tan", "", g.args), power),): ONE})
            return with_tangents(Poly({_monomial(others): ONE})) * tangent
    return Poly({monomial: ONE})


def _without(powers: dict[Gen, int], inv: Gen, cosine: Gen) -> Monomial:
    """Return the monomial without ``inv`` and with one ``cosine`` less."""
    return _monomial({g: e for g, e in powers.items() if g is not inv} | {cosine: powers[cosine] - 1})


def _monomial(powers: dict[Gen, int]) -> Monomial:
    return tuple(sorted(((g, e) for g, e in powers.items() if e), key=lambda item: item[0].key))


def _over_cosine(p: Poly, cosine: Gen) -> Poly | None:
    """Return p / cosine in tangents if each term of p has exactly one sine or cosine of the angle, else None."""
    sine, terms = Gen("sinf", "", cosine.args), []
    for monomial, coefficient in p.terms.items():
        powers = dict(monomial)
        own = (powers.pop(sine, 0), powers.pop(cosine, 0))
        if own not in ((1, 0), (0, 1)):
            return None
        rest = Poly({tuple((g, e) for g, e in monomial if g in powers): coefficient})
        terms.append(rest * Poly.gen("tan", "", *cosine.args) if own[0] else rest)
    return Poly.sum(terms)


def with_sums_of_angles(p: Poly) -> Poly:
    """Return ``p`` with sin a cos b - cos a sin b as sin(a - b), likewise for sums and cosines, and in divisors."""
    p = p.substitute(lambda g: with_sums_of_angles(g.args[0]).inverse() if g.kind == "inv" else None)
    rest, done = list(p.ordered), list[Poly]()
    while rest:
        monomial, coefficient = rest.pop(0)
        for other, factor in rest:
            joined = factor in (coefficient, -coefficient) and _joined(monomial, other, factor == coefficient)
            if joined:
                rest.remove((other, factor))
                done.append(joined.scale(coefficient))
                break
        else:
            done.append(Poly({monomial: coefficient}))
    return Poly.sum(done)


def with_sines_squared(p: Poly) -> Poly:
    """Return ``p`` with 1 - cos**2 as sin**2."""
    rest, done = dict(p.terms), dict[Monomial, Exact]()
    for monomial, coefficient in p.ordered:
        for g in [g for g, e in monomial if g.kind == "cosf" and e == 2]:
            plain = tuple(power for power in monomial if power[0] is not g)
            if rest.get(plain) == -coefficient and monomial in rest:
                del rest[plain], rest[monomial]
                sine, powers = Gen("sinf", "", g.args), dict(plain)
                squared = _monomial(powers | {sine: powers.get(sine, 0) + 2})
                done[squared] = done.get(squared, ZERO) - coefficient
    return Poly({**rest, **done})


def _joined(first: Monomial, second: Monomial, alike: bool) -> Poly | None:
    """Return first + second (if ``alike``) or first - second as one sine or cosine, or None if it is neither."""
    own = [power for power in first if power not in second]
    others = {power for power in second if power not in first}
    if len(own) != 2 or any(e != 1 or g.kind not in _OTHER for g, e in own):
        return None
    (f, _), (g, _) = own
    if f.args == g.args or others != {(Gen(_OTHER[h.kind], "", h.args), 1) for h in (f, g)}:
        return None
    rest = Poly({tuple(power for power in first if power not in own): ONE})
    (a,), (b,) = f.args, g.args
    if f.kind == g.kind:  # cos a cos b -+ sin a sin b, or its negative
        cosine = Poly.gen("cosf", "", a - b if alike else a + b)
        return rest * (cosine if f.kind == "cosf" or alike else -cosine)
    if alike:
        return rest * Poly.gen("sinf", "", a + b)
    return rest * Poly.gen("sinf", "", a - b if f.kind == "sinf" else b - a)
