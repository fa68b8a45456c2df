"""The interpreter: exact where it can be, otherwise IEEE 754."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.depth import examples
from tests.ir.common import build, functions, port
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import SQRT2, SQRT3, Exact
from wmrgen.ir.interpret import EXACT, FLOAT32, FLOAT64, evaluate, evaluate_module
from wmrgen.ir.nodes import Function, Module, Node, Op, Role
from wmrgen.ir.rounding import to_float32, to_float64

RATIONALS = st.fractions(max_denominator=10**12) | st.builds(
    lambda q, n: q * Fraction(2) ** n, st.fractions(max_denominator=10**6), st.integers(-170, 140)
)
FIELD = st.builds(Exact, *[st.fractions(max_denominator=10**6)] * 4)
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


@given(RATIONALS)
def test_constants_round_once_to_double(q: Fraction) -> None:
    assert to_float64(Exact(q)) == q.numerator / q.denominator


@given(RATIONALS)
def test_constants_round_once_to_float32(q: Fraction) -> None:
    """No float32 is nearer, and of two equally near ones the even is taken."""
    value = to_float32(Exact(q))
    if math.isinf(value):
        assert abs(q) >= Fraction(2) ** 128 - Fraction(2) ** 103
        return
    assert float(np.float32(value)) == value
    error = abs(Fraction(value) - q)
    for direction in (-math.inf, math.inf):
        other = float(np.nextafter(np.float32(value), np.float32(direction)))
        if math.isinf(other):
            continue
        assert error < abs(Fraction(other) - q) or (
            error == abs(Fraction(other) - q) and np.float32(value).view(np.int32) % 2 == 0
        )


def test_double_rounding_is_avoided() -> None:
    tie = 1 + Fraction(1, 2**24)  # half way between two float32 numbers
    above = tie + Fraction(1, 2**70)  # rounds to the tie as a double
    assert float(np.float32(float(above))) == 1.0
    assert to_float32(Exact(above)) == 1.0 + 2.0**-23


@given(FIELD)
def test_irrational_constants_round_correctly(v: Exact) -> None:
    near = v.rational(200)
    assert to_float64(v) == near.numerator / near.denominator
    assert to_float32(v) == to_float32(Exact(near))


@pytest.mark.parametrize("op", [Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.MIN, Op.MAX])
@given(a=FLOATS, b=FLOATS)
def test_float32_operations_are_those_of_numpy(op: Op, a: float, b: float) -> None:
    nodes = (Node(Op.INPUT, name="a"), Node(Op.INPUT, name="b"), Node(op, (0, 1)))
    f = Function("f", (port("a"), port("b")), nodes, (port("o"),), (2,))
    got = evaluate(f, {"a": a, "b": b}, FLOAT32)["o"]
    x, y = np.float32(a), np.float32(b)
    with np.errstate(all="ignore"):
        expected = float({
            Op.ADD: lambda: x + y, Op.SUB: lambda: x - y, Op.MUL: lambda: x * y, Op.DIV: lambda: x / y,
            Op.MIN: lambda: min(x, y), Op.MAX: lambda: max(x, y),
        }[op]())  # fmt: skip
    assert got == expected or (math.isnan(got) and math.isnan(expected))


@given(st.floats(0, 2.0**100, width=32))
def test_float32_roots_are_those_of_numpy(a: float) -> None:
    f = build(["a"], lambda b, v: {"o": b.sqrt(v["a"])})
    assert evaluate(f, {"a": a}, FLOAT32)["o"] == float(np.sqrt(np.float32(a)))


def test_exact_arithmetic_stays_in_the_field() -> None:
    f = build(["a", "b"], lambda b, v: {"o": b.sqrt(b.add(b.square(v["a"]), b.square(v["b"])))})
    assert evaluate(f, {"a": 3, "b": 4}, EXACT)["o"] == 5
    assert evaluate(f, {"a": Fraction(1, 2), "b": Fraction(1, 2)}, EXACT)["o"] == SQRT2 / 2
    g = build(["a"], lambda b, v: {"o": b.mul(b.const(SQRT3), v["a"])})
    assert evaluate(g, {"a": SQRT3}, EXACT)["o"] == 3


def test_exact_functions_are_good_to_sixty_digits() -> None:
    f = build(["a"], lambda b, v: {
        "one": b.add(b.square(b.sin(v["a"])), b.square(b.cos(v["a"]))),
        "root": b.square(b.sqrt(v["a"])),
        "angle": b.atan2(b.sin(v["a"]), b.cos(v["a"])),
    })  # fmt: skip
    for a in (Fraction(7, 5), Fraction(-3), Fraction(1, 10**30)):
        if a > 0:
            got = evaluate(f, {"a": a}, EXACT)
            assert abs(got["one"] - 1) < Fraction(1, 10**60)
            assert abs(got["root"] - a) < a * Fraction(1, 10**60)
            assert abs(got["angle"] - a) < a * Fraction(1, 10**40)


def test_exact_arctangent_knows_its_quadrants() -> None:
    f = build(["y", "x"], lambda b, v: {"o": b.atan2(v["y"], v["x"])})
    for y in (-1, 0, 1):
        for x in (-1, 0, 1):
            for arithmetic in (EXACT, FLOAT64):
                got = evaluate(f, {"y": Exact(y), "x": Exact(x)}, arithmetic)["o"]
                assert float(got) == pytest.approx(math.atan2(y, x), abs=1e-15)
    assert math.copysign(1, evaluate(f, {"y": -0.0, "x": 1.0}, FLOAT64)["o"]) == -1


def test_undefined_operations() -> None:
    f = build(["a", "b"], lambda b, v: {"o": b.div(v["a"], v["b"])})
    with pytest.raises(ZeroDivisionError, match=r"\bf\b.*\b2\b"):  # the function and the node
        evaluate(f, {"a": 1, "b": 0}, EXACT)
    assert evaluate(f, {"a": 1, "b": 0}, FLOAT64)["o"] == math.inf
    assert evaluate(f, {"a": 1.0, "b": -0.0}, FLOAT32)["o"] == -math.inf
    assert math.isnan(evaluate(f, {"a": 0, "b": 0}, FLOAT64)["o"])
    with pytest.raises(UsageError, match=r"\bf\b.*\bb\b"):  # the function and the input
        evaluate(f, {"a": 1}, FLOAT64)


def test_module_prepares_from_defaults() -> None:
    radius = port("r", Role.GEOMETRY, Fraction(1, 4))
    prepare = Function("prepare", (radius,), (Node(Op.INPUT, name="r"), Node(Op.MUL, (0, 0))),
                       (port("k0", Role.PREPARED),), (1,))  # fmt: skip
    step = build(["x", "k0"], lambda b, v: {"o": b.mul(v["x"], v["k0"])})
    step = Function("step", (port("x"), port("k0", Role.PREPARED)), step.nodes, step.outputs, step.results)
    module = Module("m", (step,), prepare)
    assert evaluate_module(module, "step", {"x": 16}, EXACT)["o"] == 1
    assert evaluate_module(module, "step", {"x": 16, "r": 1}, EXACT)["o"] == 16


@given(functions(size=12), st.lists(st.fractions(-3, 3, max_denominator=50), min_size=5, max_size=5))
@settings(max_examples=examples(60))
def test_floats_stay_near_the_exact_value(f: Function, point: list[Fraction]) -> None:
    """On functions without comparisons, whose jumps floats may see elsewhere."""
    if any(node.op in (Op.SELECT, Op.ATAN2) for node in f.nodes):
        return
    inputs = dict(zip("xyzgh", point, strict=True))
    exact, double = evaluate(f, inputs, EXACT), evaluate(f, inputs, FLOAT64)
    for name, value in exact.items():
        if abs(value) < 1000:
            assert double[name] == pytest.approx(float(value), rel=1e-6, abs=1e-5)
