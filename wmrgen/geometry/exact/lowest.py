"""Fractions of polynomials in lowest terms.

sympy finds common divisors over Q, and treats the generators as unrelated. A polynomial with coefficients
a + b sqrt2 + c sqrt3 + d sqrt6 is split into four rational polynomials; a rational polynomial that divides all four
divides their sum. Each division is exact, or sympy raises an error, so cancelling never changes a value.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import sympy
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyRing

from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Gen, Monomial, Poly, common_powers

SIGNALS = ("input", "local", "cos", "sin")  # generators that change while the robot drives
_ROOTS = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))  # 1, sqrt2, sqrt3, sqrt6


class Product(NamedTuple):
    """A product ``factor * rest``."""

    factor: Poly  # depends on geometry alone
    rest: Poly  # has no denominator


def quotient(above: Poly, below: Poly) -> Product:
    """Return above / below in lowest terms, with the common divisor of all coefficients as a separate factor.

    Args:
        above: A polynomial in signals (inputs, intermediate results) whose coefficients are geometry.
        below: A polynomial in geometry alone, not zero.

    Returns:
        The quotient as a product. Only the content of ``above``, the common divisor of its coefficients, can share a
        divisor with ``below``.
    """
    if not above:
        return Product(Poly.of(1), above)
    content = common_divisor(_coefficients(above))
    rest = divided(above, content)
    shared = common_divisor([content, below])
    scale = _common_number(rest)
    top = divided(content, shared).scale(scale)
    return Product(top * reciprocal(divided(below, shared)), rest.scale(scale.inverse()))


def reciprocal(p: Poly) -> Poly:
    """Return 1 / p with common monomials and numbers factored out: 1/(4 a + 4 b) is 1/4 * 1/(a + b)."""
    if len(p.terms) < 2:
        return p.inverse()
    scale, monomial = _common_number(p), _monomial(common_powers([p]))
    outside = monomial.scale(scale)
    return outside.inverse() * (p * outside.inverse()).inverse()


def common_divisor(polys: Iterable[Poly]) -> Poly:
    """Return a polynomial that divides all of ``polys`` and has content 1 over Q; 0 if all are 0.

    Generators are treated as unrelated: a divisor that appears only because c**2 + s**2 = 1 is not found.
    """
    given = [p for p in polys if p]
    if not given:
        return Poly({})
    shared = common_powers(given)
    over = _monomial({g: -e for g, e in shared.items()})
    rest = [p * over for p in given]
    if any(len(p.terms) == 1 for p in rest):
        return _monomial(shared)
    gens = tuple(sorted({g for p in rest for g in p.generators}))
    ring = _ring(len(gens))
    parts = [part for p in rest for part in _to_ring(p, gens, ring) if part]
    divisor = parts[0]
    for part in parts[1:]:
        if divisor.is_ground:
            break
        divisor = divisor.gcd(part)
    if divisor.is_ground:
        return _monomial(shared)
    return _from_ring([divisor.primitive()[1]], gens) * _monomial(shared)


def divided(p: Poly, divisor: Poly) -> Poly:
    """Return p / divisor. sympy raises ExactQuotientFailed if the divisor does not divide p."""
    if len(divisor.terms) == 1:
        return p * divisor.inverse()
    if not p:
        return p
    own, other = common_powers([p]), common_powers([divisor])
    above, below = p * _monomial(own).inverse(), divisor * _monomial(other).inverse()
    gens = tuple(sorted({*above.generators, *below.generators}))
    ring = _ring(len(gens))
    (rational,) = [part for part in _to_ring(below, gens, ring) if part]
    parts = [part.exquo(rational) for part in _to_ring(above, gens, ring)]
    return _from_ring(parts, gens) * _monomial(own) * _monomial(other).inverse()


def unrelated(p: Poly) -> Poly:
    """Return ``p`` with sines and cosines of geometry as plain symbols, so that s**2 is not rewritten as 1 - c**2."""
    return p.substitute(lambda g: Poly.gen("free", "", g.alone) if g.kind in ("cosf", "sinf") else None)


def related(p: Poly) -> Poly:
    """Return ``p`` with the plain symbols of `unrelated` replaced by sines and cosines again."""
    return p.substitute(lambda g: related(g.args[0]) if g.kind == "free" else _inside(g))


def shorter(p: Poly) -> Poly:
    """Return an `unrelated` polynomial or its form with c**2 + s**2 = 1 applied, whichever has fewer terms."""
    reduced = unrelated(related(p))
    return reduced if len(reduced.terms) < len(p.terms) else p


def _inside(g: Gen) -> Poly | None:
    """Return a reciprocal with `related` arguments; None for another generator."""
    if g.kind != "inv":
        return None
    return related(g.args[0]).inverse()


def _coefficients(p: Poly) -> list[Poly]:
    """Return the coefficients of ``p`` as a polynomial in its signals."""
    groups: dict[Monomial, dict[Monomial, Exact]] = {}
    for monomial, coefficient in p.terms.items():
        signals = tuple((g, e) for g, e in monomial if g.kind in SIGNALS)
        geometry = tuple((g, e) for g, e in monomial if g.kind not in SIGNALS)
        groups.setdefault(signals, {})[geometry] = coefficient
    return [Poly(terms) for terms in groups.values()]


def _common_number(p: Poly) -> Exact:
    """Return the most frequent coefficient up to sign, so that most terms need no product after division by it.

    It is negative if most coefficients are, so that most signs become +.
    """
    if not p:
        return ONE
    coefficients = [c for _, c in p.ordered]
    size = Counter(map(abs, coefficients)).most_common(1)[0][0]
    negative = sum(c.sign < 0 for c in coefficients)
    return -size if negative * 2 > len(coefficients) else size


def _monomial(powers: dict[Gen, int]) -> Poly:
    return Poly(
        {tuple(sorted(((g, e) for g, e in powers.items() if e), key=lambda power: power[0].key)): ONE}
    )


@lru_cache(maxsize=64)
def _ring(size: int) -> Any:
    """Return sympy's ring over Q of polynomials in ``size`` anonymous generators."""
    return PolyRing([sympy.Dummy() for _ in range(size)], sympy.QQ, lex)


def _to_ring(p: Poly, gens: Sequence[Gen], ring: Any) -> list[Any]:
    """Return four rational polynomials; ``p`` is their sum, weighted with 1, sqrt2, sqrt3 and sqrt6."""
    place = {g: k for k, g in enumerate(gens)}
    parts: list[dict[tuple[int, ...], Any]] = [{}, {}, {}, {}]
    for monomial, coefficient in p.terms.items():
        powers = [0] * len(gens)
        for g, e in monomial:
            powers[place[g]] = e
        for part, value in zip(parts, coefficient.parts, strict=True):
            if value:
                part[tuple(powers)] = sympy.QQ(value.numerator, value.denominator)
    return [ring.from_dict(part) for part in parts]


def _from_ring(parts: Sequence[Any], gens: Sequence[Gen]) -> Poly:
    """Return the sum of rational polynomials times 1, sqrt2, sqrt3, sqrt6, with relations of generators applied."""
    terms: list[Poly] = []
    for part, root in zip(parts, _ROOTS[: len(parts)], strict=True):
        for powers, value in part.terms():
            coefficient = Exact(*root) * Exact.ratio(int(value.numerator), int(value.denominator))
            term = Poly.of(coefficient)
            for g, e in zip(gens, powers, strict=True):
                term = term * g.alone**e if e else term
            terms.append(term)
    return Poly.sum(terms)
