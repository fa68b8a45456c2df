"""Signs, limits and comparisons on processors without a fast comparison."""

from __future__ import annotations

import itertools
import math
import random

import pytest

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import HOST, LIBM
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.rounding import nearest_float32


def function(b: Builder, results: list[int], *names: str) -> Function:
    outputs = tuple(Port(f"y{k}", Role.COMMAND, "", "y") for k in range(len(results)))
    return b.function("f", tuple(Port(n, Role.STATE, "", n) for n in names), outputs, results)


def kept(b: Builder) -> list[int]:
    """Every operation that is written with comparisons where bits are not read, of inputs and of constants."""
    x, y, m = b.input("a"), b.input("b"), b.const(Exact(1) / 2)
    return [
        b.apply(Op.CLAMP, (x, m)),
        b.apply(Op.AT_LEAST, (x, m)),
        b.with_sign_of(y, x),
        b.div(y, b.apply(Op.AT_LEAST, (x, m))),
        b.sqrt(b.abs(x)),
    ]


def by_comparisons(made: Function) -> Function:
    return expand(Module("m", (made,)), "float", LIBM, HOST).functions[0]


def test_comparisons_compute_the_same() -> None:
    b = Builder()
    made = function(b, kept(b), "a", "b")
    plain = by_comparisons(made)
    assert not {Op.CLAMP, Op.AT_LEAST, Op.WITH_SIGN_OF} & {node.op for node in plain.nodes}
    source = random.Random(3)
    cases = [*itertools.product((0.0, 0.5, -0.5, 0.25, -0.25, 2.5, -2.5), repeat=2)]
    cases += [tuple(nearest_float32(source.uniform(-3, 3)) for _ in range(2)) for _ in range(300)]
    for x, y in cases:
        given = {"a": x, "b": y}
        assert evaluate(plain, given, FLOAT32) == evaluate(made, given, FLOAT32), given


def test_a_quotient_off_zero_has_a_positive_divisor() -> None:
    """Whoever reads the C, an analyser too, sees that it is not zero: the sign is that of what is divided."""
    b = Builder()
    x, y = b.input("a"), b.input("b")
    nodes = by_comparisons(function(b, [b.div(y, b.apply(Op.AT_LEAST, (x, b.const(1))))], "a", "b")).nodes
    (quotient,) = (node for node in nodes if node.op is Op.DIV)
    assert nodes[quotient.args[0]].op is Op.SELECT and nodes[quotient.args[1]].op is Op.MAX


@pytest.mark.parametrize("x", [-3, -1, Exact(-1) / 3, 0, Exact(1) / 3, 1, 3])
def test_constants_are_folded(x: int | Exact) -> None:
    b, one = Builder(), Exact(1)
    value = Exact.of(x)
    a = b.const(value)
    folded = [b.value(b.apply(Op.CLAMP, (a, b.const(1)))), b.value(b.apply(Op.AT_LEAST, (a, b.const(1))))]
    assert folded == [
        min(max(value, -one), one),
        value if abs(value) >= one else -one if value.sign < 0 else one,
    ]
    y = b.input("b")
    assert b.with_sign_of(y, a) == (b.neg(y) if value.sign < 0 else y)


def test_no_number() -> None:
    of = FLOAT32.of
    for nan in (math.nan, -math.nan):
        assert of(Op.CLAMP)(nan, 2.0) == 2.0
        assert math.isnan(of(Op.AT_LEAST)(nan, 2.0))
    assert of(Op.CLAMP)(-math.inf, 2.0) == -2.0
    assert of(Op.AT_LEAST)(-0.0, 2.0) == -2.0
    assert of(Op.WITH_SIGN_OF)(3.0, -0.0) == -3.0
