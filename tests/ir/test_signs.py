"""Signs, limits and comparisons as processors without a quick comparison take them."""

from __future__ import annotations

import itertools
import math
import random

import pytest

from wmrgen.exact.number import Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels.order import kept_across, ordered
from wmrgen.ir.kernels.signs import one_comparison, opposite, signs_as_bits
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.passes.schedule import schedule
from wmrgen.ir.rounding import nearest_float32
from wmrgen.ports import Port, Role

LEAST = Exact(1) / 1024


def function(b: Builder, results: list[int], *names: str) -> Function:
    outputs = tuple(Port(f"y{k}", Role.COMMAND, "", "y") for k in range(len(results)))
    return b.function("f", tuple(Port(n, Role.STATE, "", n) for n in names), outputs, results)


def signed(b: Builder, a: int, x: int) -> int:
    """-x where a < 0, else x."""
    return b.select(a, b.const(0), b.neg(x), x)


def within(b: Builder, x: int, m: int) -> int:
    return b.max(b.const(-m), b.min(b.const(m), x))


def line() -> Function:
    """What steering does: 2 atan(+-b / max(c, |a|)), a speed whose sign goes with it, turned by parity."""
    b = Builder()
    x, y, n = b.input("a"), b.input("b"), b.rint(b.input("n"))
    slope = b.div(signed(b, x, y), b.max(b.abs(x), b.const(LEAST)))
    speed = b.mul(b.const(3), b.mul(b.flip(b.const(1), n), signed(b, x, b.sqrt(b.square(y)))))
    return function(b, [b.mul(b.const(2), b.atan(within(b, slope, 1))), speed], "a", "b", "n")


def together() -> Function:
    """Signs that several values need, that meet, and that come of products with opposite constants."""
    b = Builder()
    x, y = b.input("a"), b.input("b")
    one = signed(b, x, y)
    two = signed(b, y, x)
    three = b.select(x, b.const(0), b.mul(b.const(-3), y), b.mul(b.const(3), y))
    difference = b.select(y, b.const(0), b.sub(x, y), b.sub(y, x))
    return function(b, [b.add(one, b.mul(one, two)), b.mul(two, two), three, b.sin(difference)], "a", "b")


def held() -> Function:
    """A direction that counts only where its size is above LEAST."""
    b = Builder()
    x, y = b.input("a"), b.input("b")
    size = b.sqrt(b.add(b.square(x), b.square(y)))
    q = b.div(y, b.max(b.add(b.abs(x), size), b.const(LEAST)))
    return function(b, [b.select(b.const(LEAST), size, q, b.input("n"))], "a", "b", "n")


@pytest.mark.parametrize("made", [line(), together(), held()], ids=["line", "together", "held"])
def test_the_same_floats(made: Function) -> None:
    changed = signs_as_bits(one_comparison(made))
    source = random.Random(3)
    special = (0.0, 1.0, -1.0, 2.0**-10, -(2.0**-10), 1e-4, -1e-4, 2.5, -2.5)
    cases = [*itertools.product(special, repeat=3)]
    cases += [tuple(nearest_float32(source.uniform(-3, 3)) for _ in range(3)) for _ in range(300)]
    for a, b, n in cases:
        given = {"a": a, "b": b, "n": n}
        assert evaluate(changed, given, FLOAT32) == evaluate(made, given, FLOAT32), given


def test_no_comparison_is_left() -> None:
    ops = [node.op for node in signs_as_bits(line()).nodes]
    assert not {Op.SELECT, Op.MIN, Op.MAX, Op.NEG, Op.ABS} & set(ops)
    assert ops.count(Op.WITH_SIGN_OF) == 1  # the speed's, in its constant
    assert {Op.CLAMP, Op.AT_LEAST, Op.FLIP} <= set(ops)


def test_one_comparison_is_asked_twice() -> None:
    made = one_comparison(held())
    assert Op.MAX not in {node.op for node in made.nodes}
    assert len({node.args[:2] for node in made.nodes if node.op is Op.SELECT}) == 1


def test_what_is_not_asked_stays() -> None:
    b = Builder()
    x = b.input("a")
    size = b.sqrt(b.square(x))
    made = function(b, [b.max(b.add(size, b.abs(x)), b.const(LEAST))], "a")
    assert one_comparison(made) == made


def test_opposites() -> None:
    b = Builder()
    x, y = b.input("a"), b.input("b")
    pairs = [(x, b.neg(x)), (b.sub(x, y), b.sub(y, x)), (b.mul(b.const(2), x), b.mul(b.const(-2), x))]
    assert all(opposite(b.nodes, p, q) and opposite(b.nodes, q, p) for p, q in pairs)
    others = [(x, y), (x, x), (b.mul(b.const(2), x), b.mul(b.const(-3), x)), (b.sub(x, y), b.add(x, y))]
    assert not any(opposite(b.nodes, p, q) for p, q in others)


def test_no_number() -> None:
    of = FLOAT32.of
    for nan in (math.nan, -math.nan):
        assert of(Op.CLAMP)(nan, 2.0) == 2.0
        assert math.isnan(of(Op.AT_LEAST)(nan, 2.0))
    assert of(Op.CLAMP)(-math.inf, 2.0) == -2.0
    assert of(Op.AT_LEAST)(-0.0, 2.0) == -2.0
    assert of(Op.WITH_SIGN_OF)(3.0, -0.0) == -3.0


def waves(count: int, chain: bool) -> Function:
    """Sums of products of sines; ``chain``: each ends before the next begins."""
    b = Builder()
    angles = [b.input(f"x{k}") for k in range(count)]
    pairs = [(b.sin(a), b.cos(a)) for a in angles]
    if chain:
        results = [b.atan(b.mul(a, a)) for a in angles]
    else:
        u = [b.add(b.mul(s, s), b.mul(c, angles[0])) for s, c in pairs]
        v = [b.add(b.mul(s, c), b.mul(c, angles[1])) for s, c in pairs]
        results = [b.add(b.sum(u), b.product(v)), b.sub(b.product(u), b.sum(v))]
    return function(b, results, *(f"x{k}" for k in range(count)))


def test_calls_come_first_where_that_keeps_less() -> None:
    crossing, plain = waves(4, chain=False), waves(4, chain=True)
    assert kept_across(ordered(crossing)) == 7 < kept_across(schedule(crossing))  # all but the last sine
    assert ordered(plain) == schedule(plain)
    assert kept_across(schedule(plain)) == 0
