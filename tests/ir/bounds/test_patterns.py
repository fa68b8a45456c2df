"""Patterns in the node list, and node lists that look like them but are not."""

from __future__ import annotations

from fractions import Fraction

import pytest

from wmrgen.ir.bounds.patterns import contracted, effective
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Op


def test_outside_a_limit_a_value_changes_nothing() -> None:
    b = Builder()
    x = b.input("x")
    quotient = b.div(x, b.add(x, b.const(3)))
    scaled = b.mul(b.const(2), quotient)
    kept = b.max(b.const(-1), b.min(scaled, b.const(Fraction(1, 2))))
    found = effective(b.function("f", (), (), [kept]))
    assert found[scaled] == (-1.0, 0.5)
    assert found[quotient] == (-0.5, 0.25)
    assert x not in found


@pytest.mark.parametrize("use", ["a result", "a sum"])
def test_what_is_used_elsewhere_counts_everywhere(use: str) -> None:
    b = Builder()
    x = b.square(b.input("x"))
    kept = b.min(x, b.const(1))
    results = [kept, x] if use == "a result" else [b.add(kept, x)]
    assert x not in effective(b.function("f", (), (), results))


def test_products_in_a_sum_and_elsewhere_may_be_contracted() -> None:
    b = Builder()
    x, y = b.input("x"), b.input("y")
    once, twice, never = b.mul(x, y), b.square(x), b.square(y)
    b.make(Op.ADD, [once, x])
    b.make(Op.ADD, [twice, y])
    b.make(Op.SQRT, [twice])
    b.make(Op.SQRT, [never])
    b.make(Op.MUL, [never, x])
    assert contracted(b.nodes) == {twice}
