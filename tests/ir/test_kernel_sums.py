"""Sums of products: fused if the product has no other user, with the same value everywhere, without cancellation."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from fractions import Fraction

import pytest

from tests.ir.common import build
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import EXACT, FLOAT32, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS
from wmrgen.ir.kernels.sums import fuse
from wmrgen.ir.nodes import Function, Module, Op, pruned
from wmrgen.ir.rounding import nearest_float32

NAMES = ("x", "y", "z", "w")
Body = Callable[[Builder, dict[str, int]], int]


def made(body: Body) -> Function:
    return build(NAMES, lambda b, at: {"out": body(b, at)})


def fused(f: Function, kernel: bool = False) -> Counter[str]:
    """How often operations stand in the fused function, which has the values of ``f``."""
    result = pruned(fuse(f, kernel))
    chance = random.Random(3)
    for _ in range(5):
        at = {n: Exact(Fraction(chance.randrange(-50, 50), 7)) for n in NAMES}
        assert evaluate(result, at, EXACT) == evaluate(f, at, EXACT)
    return Counter(str(n.op) for n in result.nodes if n.op not in (Op.INPUT, Op.CONST))


@pytest.mark.parametrize(
    ("body", "operations"),
    [
        (lambda b, at: b.add(b.mul(at["x"], at["y"]), at["z"]), "fma"),
        (lambda b, at: b.add(at["z"], b.mul(at["x"], at["y"])), "fma"),
        (lambda b, at: b.sub(b.mul(at["x"], at["y"]), at["z"]), "fma neg"),
        (lambda b, at: b.sub(at["z"], b.mul(at["x"], at["y"])), "fma neg"),
        (lambda b, at: b.sub(b.mul(at["x"], at["y"]), b.const(3)), "fma"),
        (lambda b, at: b.sub(b.mul(at["x"], at["y"]), b.neg(at["z"])), "fma"),
        (lambda b, at: b.sub(at["z"], b.mul(b.const(3), at["y"])), "fma"),
        (lambda b, at: b.add(b.mul(at["x"], at["y"]), b.mul(at["z"], at["w"])), "fma mul"),
        (lambda b, at: b.sub(b.mul(at["x"], at["y"]), b.mul(at["z"], at["w"])), "fma mul neg"),
        (lambda b, at: b.add(b.mul(b.const(2), at["x"]), at["z"]), "add mul"),
        (lambda b, at: b.add(b.mul(b.const(2), at["x"]), b.mul(at["z"], at["w"])), "fma mul"),
        (lambda b, at: b.mul(b.add(at["x"], at["y"]), at["z"]), "add mul"),
        (lambda b, at: b.div(at["x"], b.add(at["y"], at["z"])), "add div"),
    ],
)
def test_a_product_for_one_sum_alone_is_fused(body: Body, operations: str) -> None:
    assert fused(made(body)) == Counter(operations.split())


def test_a_product_that_is_needed_twice_stays() -> None:
    def twice(b: Builder, at: dict[str, int]) -> int:
        product = b.mul(at["x"], at["y"])
        return b.div(b.add(product, at["z"]), b.add(product, at["w"]))

    assert fused(made(twice)) == Counter({"add": 2, "mul": 1, "div": 1})
    both = build(NAMES, lambda b, at: {"a": (p := b.mul(at["x"], at["y"])), "s": b.add(p, at["z"])})
    assert fused(both) == Counter({"add": 1, "mul": 1})


def test_an_opposite_is_formed_once() -> None:
    def two(b: Builder, at: dict[str, int]) -> int:
        return b.div(b.sub(at["z"], b.mul(at["x"], at["y"])), b.sub(at["w"], b.mul(at["x"], at["z"])))

    assert fused(made(two)) == Counter({"fma": 2, "neg": 1, "div": 1})


@pytest.mark.parametrize(
    ("body", "kernel", "plain"),
    [
        # The square of an input stays in a kernel, and the other product is fused.
        (lambda b, at: b.add(b.mul(at["x"], at["x"]), b.mul(at["y"], at["z"])), "fma mul", "fma mul"),
        (lambda b, at: b.add(b.mul(at["x"], at["x"]), b.mul(at["y"], at["y"])), "add mul mul", "fma mul"),
        (lambda b, at: b.add(b.mul(at["x"], at["x"]), at["y"]), "add mul", "fma"),
        (lambda b, at: b.add(b.mul(at["x"], at["y"]), at["z"]), "fma", "fma"),
    ],
)
def test_squares_of_the_inputs_of_a_kernel_stay(body: Body, kernel: str, plain: str) -> None:
    f = made(body)
    assert fused(f, kernel=True) == Counter(kernel.split())
    assert fused(f) == Counter(plain.split())
    squares = [n for n in fuse(f, kernel=True).nodes if n.op is Op.FMA and n.args[0] == n.args[1]]
    assert squares == []


def square_of_a_sum(b: Builder, at: dict[str, int]) -> int:
    total = b.add(at["x"], at["y"])
    return b.add(b.mul(total, total), at["z"])


def test_a_square_of_what_is_no_input_is_fused_in_a_kernel_too() -> None:
    assert fused(made(square_of_a_sum), kernel=True) == Counter("add fma".split())


# ---- compensated sums


FACTORS = (Exact(Fraction(1, 3)), Exact(Fraction(-7, 30)), Exact(2), Exact(Fraction(-1, 4)), Exact(3))


@pytest.mark.parametrize("target", ["m4f", "m0", "host"])
@pytest.mark.parametrize("factor", [*FACTORS, None, "negative"], ids=str)
def test_a_sum_that_cancels_keeps_its_digits(factor: Exact | str | None, target: str) -> None:
    """x + c y where that is a millionth of its terms, c a constant or computed, to a few units in the last place."""

    def body(b: Builder, at: dict[str, int]) -> dict[str, int]:
        c = b.const(factor) if isinstance(factor, Exact) else at["c"]
        product = b.mul(c, at["y"])
        return {
            "out": b.apply(Op.COMPENSATED, (at["x"], b.neg(product) if factor == "negative" else product))
        }

    f = build(("x", "y", "c"), body)
    code = expand(Module("m", (f,)), "float", "inline", target).function("f")
    chance = random.Random(9)
    for k in range(60):
        y, c = (nearest_float32(chance.uniform(-3, 3)) for _ in range(2))
        exact = (
            factor.rational()
            if isinstance(factor, Exact)
            else Fraction(c) * (-1 if factor == "negative" else 1)
        )
        size = (1.0, 1e-3, 1e-6, 0.0)[k % 4]
        x = nearest_float32(-float(exact) * y * (1 + size * chance.uniform(-1, 1)))
        wanted = Fraction(x) + exact * Fraction(y)
        out = evaluate(code, {"x": x, "y": y, "c": c}, FLOAT32)["out"]
        off = abs(Fraction(out) - wanted)
        assert off <= abs(wanted) * Fraction(3, 2**24) + abs(exact * Fraction(y)) * Fraction(1, 2**47)


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("factor", [Exact(Fraction(1, 3)), Exact(-3), None, "negative"], ids=str)
def test_only_where_sums_are_fused_is_one_compensated_so(factor: Exact | str | None, target: str) -> None:
    """In place of the parts that others form, of which there are more."""

    def body(b: Builder, at: dict[str, int]) -> dict[str, int]:
        product = b.mul(b.const(factor) if isinstance(factor, Exact) else at["c"], at["y"])
        return {
            "out": b.apply(Op.COMPENSATED, (at["x"], b.neg(product) if factor == "negative" else product))
        }

    f = build(("x", "y", "c"), body)
    code = pruned(expand(Module("m", (f,)), "float", "inline", target).function("f"))
    operations = Counter(n.op for n in code.nodes)
    assert (
        (Op.FMA in operations) == (target == "m4f") == (Op.ADD not in operations and Op.SUB not in operations)
    )


def test_a_plain_sum_does_not() -> None:
    """The control of the test above."""
    f = build(("x", "y"), lambda b, at: {"out": b.add(at["x"], b.mul(b.const(Fraction(1, 3)), at["y"]))})
    code = expand(Module("m", (f,)), "float", "inline", "host").function("f")
    x, y = 1.0, nearest_float32(-3 * (1 - 1e-6))
    wanted = Fraction(x) + Fraction(y) / 3
    assert abs(Fraction(evaluate(code, {"x": x, "y": y}, FLOAT32)["out"]) - wanted) > abs(wanted) / 10**4
