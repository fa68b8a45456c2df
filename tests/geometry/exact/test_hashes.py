"""Equal numbers have equal hashes, so that an `Exact`, an int and a Fraction find one another in a dictionary."""

from __future__ import annotations

import sys
from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from wmrgen.geometry.exact.number import Exact

MODULUS = sys.hash_info.modulus
# Multiples of the modulus have no inverse; -1 is no hash.
EDGES = [Fraction(n, d) for n in (-1, 0, 1, 3, MODULUS, -MODULUS - 1) for d in (1, 7, MODULUS, 2 * MODULUS)]


@given(st.one_of(st.fractions(), st.sampled_from(EDGES)))
def test_hash_of_a_rational_number(value: Fraction) -> None:
    assert Exact(value) == value
    assert hash(Exact(value)) == hash(value)


def test_every_edge() -> None:
    for value in EDGES:
        assert hash(Exact(value)) == hash(value), value
