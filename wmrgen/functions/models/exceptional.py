"""Configurations with a smaller growth vector: brackets that are independent elsewhere are dependent there.

The growth vector is valid at generic configurations. The brackets that add its dimensions are independent wherever one
of their minors is not zero. There every order spans as many dimensions as generically, because it never spans more.
The minor is formed in the robot frame, in which no component depends on the position of the robot. If it is a product
of cosines and sines, each factor that can be zero gives a set of configurations, and the growth vector at a generic
configuration of the set is computed from all brackets. Any other minor is reported as a condition alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import prod
from typing import NamedTuple

import sympy

from wmrgen.functions.models.growth import Growth
from wmrgen.functions.models.polynomials import split, whole, without_lengths
from wmrgen.functions.models.vector_fields import Field, Slopes, bracket_by, generic_point, value_at
from wmrgen.functions.system import System
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.linalg import determinant, rank
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly
from wmrgen.geometry.symbolic import Expr, expression

MOST_TERMS = 4_000  # products of terms in a minor that is expanded: a tenth of a second
MOST_FACTORED = 60  # terms of a minor that is factored: a hundredth of a second
MOST_BRACKETS = 200  # brackets formed at an exceptional configuration: a second
THETA = Poly.gen("input", "theta")


class Exceptional(NamedTuple):
    """A set of configurations with another growth vector."""

    condition: Expr  # 0 at these configurations
    vector: tuple[int, ...]  # at generic configurations of the set; () if unknown


def exceptional(system: System, growth: Growth) -> tuple[Exceptional, ...] | None:
    """Return the sets of configurations at which the growth vector of a system may differ.

    The result is empty if the vector is valid at every configuration of the model. It is None if no minor is short
    enough to be expanded: then only the vector of generic configurations is known.
    """
    values = {p.name: Poly.of(p.default) for p in system.geometry if p.default is not None}
    best: tuple[Poly, ...] | None = None
    for minor in _minors([_in_robot_frame(b.polys) for b in growth.brackets]):
        sets = _zeros(minor, values)
        if best is None or len(sets) < len(best):
            best = sets
        if not best:
            return ()
    if best is None:
        return None
    return tuple(_with_growth_vector(system, growth, one) for one in best)


def _in_robot_frame(field: Field) -> Field:
    """Return the field with the velocity of P in the robot frame: x and y come first in every state."""
    c, s = Poly.gen("cosf", "", THETA), Poly.gen("sinf", "", THETA)
    x, y, *rest = field
    return (c * x + s * y, c * y - s * x, *rest)


def _minors(rows: list[Field]) -> Iterator[Poly]:
    """Yield the minors of full size that are not zero and short enough to be expanded."""
    for columns in combinations(range(len(rows[0])), len(rows)):
        entries = [[row[k] for k in columns] for row in rows]
        if prod(max(1, _terms_in(row)) for row in entries) <= MOST_TERMS:
            minor = determinant(entries)
            if minor:
                yield minor


def _zeros(minor: Poly, values: Mapping[str, Poly]) -> tuple[Poly, ...]:
    """Return the factors of a minor that can be zero in the model: cosines, sines, and factors that are sums."""
    core, factor = split(minor)
    ((powers, _),) = factor.terms.items()
    found = [
        _argument(g) for g, e in powers if (e > 0) != (g.kind == "inv") and not _never_zero(g.alone, values)
    ]
    if len(core.terms) > 1 and not _never_zero(core, values):
        parts = whole([without_lengths(part) for part in _factors(core)])
        found += [part for part in parts if not _never_zero(part, values)]
    return tuple(dict.fromkeys(found))


def _terms_in(row: Sequence[Poly]) -> int:
    return sum(len(p.terms) for p in row)


def _factors(p: Poly) -> list[Poly]:
    """Return the factors of a short polynomial with rational coefficients, each once; else the polynomial itself."""
    gens = p.generators
    powers: dict[tuple[int, ...], Exact] = {}  # coefficient by the exponents of the generators
    for m, c in p.terms.items():
        exponent_of = dict(m)
        powers[tuple(exponent_of.get(g, 0) for g in gens)] = c
    if (
        len(powers) > MOST_FACTORED
        or min(map(min, powers)) < 0
        or not all(c.is_rational for c in powers.values())
    ):
        return [p]
    table = {m: sympy.Rational(c.parts[0].numerator, c.parts[0].denominator) for m, c in powers.items()}
    _, factors = sympy.Poly.from_dict(table, *(sympy.Dummy() for _ in gens)).factor_list()

    def back(factor: sympy.Poly) -> Poly:
        terms = []
        for exponents, c in factor.terms():
            monomial = tuple((g, e) for g, e in zip(gens, exponents, strict=True) if e)
            terms.append(Poly({monomial: Exact(Fraction(int(c.p), int(c.q)))}))
        return Poly.sum(terms)

    return [back(factor) for factor, _ in factors]


def _argument(g: Gen) -> Poly:
    """Return the polynomial that is zero if a root or the inverse of a quotient is."""
    return g.args[0] if g.kind in ("sqrt", "inv") else g.alone


def _never_zero(p: Poly, values: Mapping[str, Poly]) -> bool:
    """Return whether a polynomial is not zero at the nominal parameters, for every state.

    This is certain if the constant term is larger than the sum of all other terms, because cosines and sines are at
    most 1. In all other cases the answer is False.
    """
    terms = fix(p, values).terms
    if any(g.kind not in ("cosf", "sinf") or e < 0 for m in terms for g, e in m):
        return False
    constant = abs(float(terms.get((), ZERO)))
    others = sum(abs(float(c)) for m, c in terms.items() if m)
    return constant > (1 + 1e-9) * others  # more than the rounding error of the sum


def _with_growth_vector(system: System, growth: Growth, condition: Poly) -> Exceptional:
    """Return a condition with the growth vector at a generic configuration that satisfies it."""
    point = generic_point(system.state, 0)
    ((monomial, _),) = condition.terms.items() if len(condition.terms) == 1 else (((), ONE),)
    placed = len(monomial) == 1 and _move_to_zero(monomial[0][0], point)
    return Exceptional(expression(condition), _vector(system, growth, point) if placed else ())


def _move_to_zero(g: Gen, point: dict[str, Exact]) -> bool:
    """Move the point to where a cosine or a sine is zero. Return False if its argument is no sum of states."""
    sums = g.kind in ("cosf", "sinf") and all(
        len(m) == 1 and m[0][1] == 1 and m[0][0].kind == "input" and abs(c) == ONE
        for m, c in g.args[0].terms.items()
    )
    if not sums:
        return False
    terms = {m[0][0].name: c for m, c in g.args[0].terms.items()}
    moved, sign = terms.popitem()
    total = Exact(int(g.kind == "cosf"))  # tangents of half angles: pi/2 less the others
    for name, c in terms.items():
        other = -c * point[name]
        total = (total + other) / (1 - total * other)
    point[moved] = sign * total
    return True


def _vector(system: System, growth: Growth, point: Mapping[str, Exact]) -> tuple[int, ...]:
    """Return dimensions by order at a point, up to the generic dimension; () if that takes too many brackets."""
    values = {p.name: p.default for p in system.geometry if p.default is not None}
    inputs = [b.polys for b in growth.brackets if b.order == 1]
    slopes, newest, rows, dims, formed = Slopes(growth.state), inputs, [], list[int](), 0
    seen = {*inputs}

    def is_new(field: Field) -> bool:
        return any(field) and field not in seen and tuple(-p for p in field) not in seen

    while newest and formed <= MOST_BRACKETS:
        rows += [[value_at(p, point, values) for p in field] for field in newest]
        dims.append(rank(rows))
        if dims[-1] == growth.vector[-1]:
            return tuple(dims)
        pairs = combinations(inputs, 2) if newest is inputs else ((g, b) for b in newest for g in inputs)
        rates = {f: slopes.jacobian(f) for f in {*inputs, *newest}}
        fields = [bracket_by(f, rates[f], g, rates[g]) for f, g in pairs]
        newest = [f for f in dict.fromkeys(fields) if is_new(f)]
        seen.update(newest)
        formed += len(newest)
    return ()
