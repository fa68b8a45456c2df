"""Fractions of polynomials in lowest terms: equal values, no common divisor left."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from sympy.polys.polyerrors import ExactQuotientFailed

from wmrgen.geometry.exact.lowest import (
    common_divisor,
    divided,
    quotient,
    reciprocal,
    related,
    shorter,
    unrelated,
)
from wmrgen.geometry.exact.number import SQRT2, SQRT3, Exact
from wmrgen.geometry.exact.poly import Gen, Poly

A, B, R = (Poly.gen("param", name) for name in "abr")
U, V = (Poly.gen("input", name) for name in ("u.spin", "v.spin"))
COS, SIN = Poly.gen("cosf", "", A), Poly.gen("sinf", "", A)


def value(p: Poly, numbers: dict[Gen, Exact]) -> Exact:
    def number(g: Gen) -> Poly:
        if g.kind == "inv":
            return Poly.of(value(g.args[0], numbers).inverse())
        return Poly.of(numbers[g])

    found = p.substitute(number).constant
    assert found is not None
    return found


def drawn(rng: random.Random, gens: list[Poly], field: bool) -> Poly:
    """A random polynomial of a few terms."""
    terms = []
    for _ in range(rng.randint(1, 3)):
        term = Poly.of(
            Exact(rng.randint(-5, 5), *(rng.randint(-1, 1) for _ in range(3))) if field else rng.randint(1, 9)
        )
        for g in gens:
            term = term * g ** rng.randint(0, 2)
        terms.append(term)
    return Poly.sum(terms)


@pytest.mark.parametrize("seed", range(40))
def test_a_quotient_keeps_its_value_and_loses_the_common_divisor(seed: int) -> None:
    rng = random.Random(seed)
    shared, below = drawn(rng, [A, B], field=False), drawn(rng, [A, B, R], field=False)
    above = drawn(rng, [A, B, R], field=seed % 2 == 1) * U + drawn(rng, [A, R], field=seed % 2 == 1) * V
    if not above:
        return
    factor, rest = quotient(above * shared, below * shared)
    numbers = {g: Exact(Fraction(rng.randint(1, 99), 7)) for p in (A, B, R, U, V) for g in p.generators}
    assert value(factor * rest, numbers) == value(above, numbers) / value(below, numbers)
    (inverses,) = [[g for g in factor.generators if g.kind == "inv"]]
    for g in inverses:
        assert len(g.args[0].terms) <= len((below * shared).terms)
        assert common_divisor([g.args[0], *(Poly({m: c}) for m, c in rest.terms.items())]) == 1


def test_what_all_coefficients_share_is_taken_out() -> None:
    above = (A + B) * R * (U - V)
    assert quotient(above, (A * A + 2 * A * B + B * B).scale(4)) == (
        (R * (A + B).inverse()).scale(Fraction(1, 4)),
        U - V,
    )
    assert quotient(Poly({}), A) == (Poly.of(1), Poly({}))


def test_irrational_numbers_share_rational_divisors() -> None:
    above = ((A + B) * U).scale(SQRT2) + ((A + B) * V).scale(SQRT3)
    factor, rest = quotient(above, (A + B) * (A - B))
    assert set(rest.generators) == {*U.generators, *V.generators}
    assert [g.args for g in factor.generators] in ([(A - B,)], [(B - A,)])


def test_reciprocals_take_numbers_and_monomials_out() -> None:
    assert reciprocal((A * A).scale(4) + (A * B).scale(4)) == (A.inverse() * (A + B).inverse()).scale(
        Fraction(1, 4)
    )
    assert reciprocal(-A - B) == -((A + B).inverse())
    assert reciprocal(A.scale(2)) == A.inverse().scale(Fraction(1, 2))


def test_exact_division_and_its_refusal() -> None:
    assert divided(A * A - B * B, A - B) == A + B
    assert divided((A * A - B * B).scale(SQRT3), A - B) == (A + B).scale(SQRT3)
    with pytest.raises(ExactQuotientFailed):
        divided(A * A + B * B, A - B)


def test_sines_without_their_relation() -> None:
    square = unrelated(R * SIN + B * COS) * unrelated(R * SIN + B * COS)
    assert len(shorter(square).terms) == 3  # with s**2 = 1 - c**2 there are four terms
    assert shorter(unrelated(COS) * unrelated(COS) + unrelated(SIN) * unrelated(SIN)) == 1
    assert related(square) == (R * SIN + B * COS) * (R * SIN + B * COS)
    assert common_divisor([square, unrelated(R * SIN + B * COS)]) == unrelated(R * SIN + B * COS)
