"""The builder shares equal operations and makes no node for trivial ones."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.depth import examples
from tests.ir.common import CONSTANTS, functions, verify_function
from wmrgen.geometry.exact.number import SQRT2, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Op


@pytest.fixture
def b() -> Builder:
    return Builder()


def test_equal_operations_are_one_node(b: Builder) -> None:
    x, y = b.input("x"), b.input("y")
    assert b.add(x, y) == b.add(y, x)
    assert b.mul(x, y) == b.mul(y, x)
    assert b.min(x, y) == b.min(y, x)
    assert b.sub(x, y) != b.sub(y, x)
    assert b.sin(x) == b.sin(x)


def test_neutral_and_absorbing_elements(b: Builder) -> None:
    x, zero, one = b.input("x"), b.const(0), b.const(1)
    assert b.add(x, zero) == b.add(zero, x) == b.sub(x, zero) == b.mul(x, one) == b.div(x, one) == x
    assert b.mul(x, zero) == b.sub(x, x) == b.div(zero, x) == zero
    assert b.nodes[b.sub(zero, x)].op is Op.NEG
    assert b.mul(x, b.const(-1)) == b.neg(x)
    assert b.power(x, 0) == one


@given(st.sampled_from(CONSTANTS), st.sampled_from(CONSTANTS))
def test_constants_fold_exactly(p: Exact, q: Exact) -> None:
    b = Builder()
    x, y = b.const(p), b.const(q)
    assert b.value(b.add(x, y)) == p + q
    assert b.value(b.sub(x, y)) == p - q
    assert b.value(b.mul(x, y)) == p * q
    assert b.value(b.neg(x)) == -p
    assert b.value(b.abs(x)) == abs(p)
    assert b.value(b.min(x, y)) == min(p, q)
    assert b.value(b.max(x, y)) == max(p, q)
    assert b.select(x, y, x, y) == (x if p < q else y)
    if q:
        assert b.value(b.div(x, y)) == p / q


def test_negations_cancel(b: Builder) -> None:
    x, y = b.input("x"), b.input("y")
    assert b.neg(b.neg(x)) == x
    assert b.neg(b.sub(x, y)) == b.sub(y, x)
    assert b.add(x, b.neg(y)) == b.sub(x, y)
    assert b.sub(x, b.neg(y)) == b.add(x, y)
    assert b.mul(b.neg(x), b.neg(y)) == b.mul(x, y)
    assert b.cos(b.neg(x)) == b.cos(x)
    assert b.sin(b.neg(x)) == b.neg(b.sin(x))
    assert b.abs(b.neg(x)) == b.abs(b.abs(x)) == b.abs(x)
    assert b.abs(b.sub(x, y)) == b.abs(b.sub(y, x))


def test_constant_factors_merge(b: Builder) -> None:
    x, y, c = b.input("x"), b.input("y"), b.const(Fraction(3, 2))
    assert b.mul(b.mul(c, x), b.const(Fraction(2, 3))) == x
    assert b.mul(b.mul(c, x), y) == b.mul(c, b.mul(x, y))
    assert b.div(x, b.const(2)) == b.mul(b.const(Fraction(1, 2)), x)
    assert b.div(b.mul(c, x), b.mul(c, y)) == b.div(x, y)


def test_roots_fold_inside_the_field(b: Builder) -> None:
    assert b.value(b.sqrt(b.const(Fraction(9, 2)))) == SQRT2 * Fraction(3, 2)
    assert b.nodes[b.sqrt(b.const(5))].op is Op.SQRT
    with pytest.raises(ValueError):
        b.sqrt(b.const(-1))
    assert b.value(b.sqrt(b.const(0))) == Exact(0)


def test_division_by_the_constant_zero_is_refused(b: Builder) -> None:
    with pytest.raises(ZeroDivisionError):
        b.div(b.input("x"), b.const(0))


def test_selects(b: Builder) -> None:
    x, y, z = b.input("x"), b.input("y"), b.input("z")
    assert b.select(x, y, z, z) == z
    assert b.select(x, x, y, z) == z
    assert b.atan2(b.const(0), b.const(0)) == b.const(0)


def test_powers_multiply_few_times(b: Builder) -> None:
    b.function("f", (), (), [b.power(b.input("x"), 8)])
    assert sum(node.op is Op.MUL for node in b.nodes) == 3
    assert b.nodes[b.power(b.input("x"), -2)].op is Op.DIV


@given(functions())
@settings(max_examples=examples(150))
def test_canonical_form_keeps_every_value(f) -> None:
    builder, again = Builder(), []
    for node in f.nodes:
        again.append(builder.copy(node, [again[arg] for arg in node.args]))
    once = builder.function(f.name, f.inputs, f.outputs, [again[r] for r in f.results])
    verify_function(f, once, "the builder", 3)
    assert len(once.nodes) <= len(f.nodes) + 8
