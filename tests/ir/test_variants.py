"""`forward` and `forward_slip` give the same twist to the bit, whatever the processor."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest

from tests.ir.common import port
from tests.robots import of_gallery
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import keep_outputs, nominal
from wmrgen.ir.interpret import FLOAT32, FLOAT64, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import AVR, HOST, INLINE, LIBM, M0, M4F, Choice
from wmrgen.ir.nodes import Function, Module, Node, Op, Role

ROBOTS = Path(__file__).resolve().parents[2] / "robots"
CHOICES = (
    Choice("float", INLINE, M4F), Choice("float", INLINE, M0), Choice("float", INLINE, HOST),
    Choice("float", LIBM, AVR), Choice("double", LIBM, M4F),
)  # fmt: skip


def differing(name: str, points: int, choices: tuple[Choice, ...]) -> list[str]:
    """Outputs of `forward` that `forward_slip` gives in other bits, with the inputs."""
    module = of_gallery(name).c_module
    source = random.Random(name)
    wrong = []
    for choice in choices:
        printed = expand(module, choice.scalar, choice.math, choice.target)
        arithmetic = FLOAT32 if choice.scalar == "float" else FLOAT64
        inputs = [p.name for p in printed.function("forward_slip").inputs if p.role is not Role.PREPARED]
        for _ in range(points):
            size = 10.0 ** source.uniform(-3, 3)
            case = {n: source.uniform(-3, 3) * (1.0 if n.endswith(".steer") else size) for n in inputs}
            case = nominal(printed) | case
            twist = evaluate_module(printed, "forward", case, arithmetic)
            with_slip = evaluate_module(printed, "forward_slip", case, arithmetic)
            assert with_slip.keys() == {*twist, "slip"}
            differences = {n: (v, with_slip[n]) for n, v in twist.items() if v.hex() != with_slip[n].hex()}
            wrong += [f"{choice} {case}: {differences}"] if differences else []
    return wrong


@pytest.mark.parametrize("name", sorted(p.stem for p in ROBOTS.glob("*.yaml")))
def test_the_twist_is_the_same(name: str) -> None:
    assert differing(name, 60, CHOICES) == []


def test_a_product_that_the_residual_needs_too() -> None:
    """Of this robot `forward` fuses products that the residual needs on their own."""
    assert differing("kelly_4ws", 200, CHOICES[:1]) == []


def numbered(function: Function, numbers: dict[object, int]) -> dict[str, int]:
    """A number for each output; equal operations on equal values have the same in all functions."""
    own: list[int] = []
    for node in function.nodes:
        term = (node.op.name, node.name, node.value, *(own[a] for a in node.args))
        own.append(numbers.setdefault(term, len(numbers)))
    return {p.name: own[r] for p, r in zip(function.outputs, function.results, strict=True)}


def drawn(source: random.Random) -> Function:
    """Sums, products and quotients of few values, so that many are needed twice."""
    nodes = [Node(Op.INPUT, name=name) for name in ("x", "y", "z")] + [Node(Op.CONST, value=Exact(1))]
    for _ in range(24):
        op = source.choice((Op.ADD, Op.SUB, Op.MUL, Op.MUL, Op.DIV))
        first = 3 if op is Op.DIV and source.random() < 0.5 else source.randrange(len(nodes))
        nodes.append(Node(op, (first, source.randrange(len(nodes)))))
    results = tuple(source.sample(range(4, len(nodes)), 4))
    return Function("f", tuple(port(n) for n in "xyz"), tuple(nodes), tuple(port(n) for n in "abcd"), results)


@pytest.mark.parametrize("seed", range(40))
def test_what_a_variant_gives_too_is_computed_alike(seed: int) -> None:
    """Of any function: a product or a quotient that the other results need as well changes nothing."""
    source = random.Random(seed)
    whole = drawn(source)
    some = source.sample([p.name for p in whole.outputs], 2)
    base = keep_outputs(whole, frozenset(some), "base")
    variant = replace(whole, name="variant", variant_of="base")
    for choice in CHOICES:
        printed = expand(Module("m", (base, variant)), choice.scalar, choice.math, choice.target)
        numbers: dict[object, int] = {}
        alone, beside = (numbered(f, numbers) for f in printed.functions)
        assert alone == {name: beside[name] for name in some}
