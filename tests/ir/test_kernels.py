"""Rounding and signs: exact, in floats, and as the operations that C prints."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import EXACT, FLOAT32, FLOAT64, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.rounding import nearest_float32, round_rational


def alternating() -> Function:
    """y = a (-1)**n and n = rint(x)."""
    b = Builder()
    n = b.rint(b.input("x"))
    results = [b.mul(b.input("a"), b.flip(b.const(1), n)), n]
    inputs = tuple(Port(name, Role.STATE, "", name) for name in ("a", "x"))
    outputs = tuple(Port(name, Role.COMMAND, "", name) for name in ("y", "n"))
    return b.function("alternating", inputs, outputs, results)


@pytest.mark.parametrize("scalar", ["float", "double"])
@pytest.mark.parametrize("target", TARGETS)
def test_rounding_and_sign(scalar: str, target: str) -> None:
    arithmetic = FLOAT32 if scalar == "float" else FLOAT64
    function = alternating()
    printed = expand(Module("m", (function,)), scalar, "inline" if scalar == "float" else "libm", target)
    for x in (0.0, 0.5, -0.5, 1.5, 2.5, -2.5, 0.49999997, 3.0, -7.25, 12345.0, 4194303.0):
        want = evaluate(function, {"a": 3.0, "x": x}, EXACT)
        found = evaluate(printed.function("alternating"), {"a": 3.0, "x": x}, arithmetic)
        assert found == {name: float(value) for name, value in want.items()}, x
        assert found["n"] == round(x)


def test_fused_multiply_add_is_rounded_once() -> None:
    source = random.Random(1)
    fma = FLOAT32.of(Op.FMA)
    for k in range(3000):
        a, b = (nearest_float32(source.uniform(-4, 4)) for _ in range(2))
        c = nearest_float32(-a * b * (1 + source.choice((0, 1e-7, 1e-3, 1.0)) * source.uniform(-1, 1)))
        if k % 5 == 0:  # the sum lies half-way between two floats but for its last bits
            a, b, c = 1.0 + 2.0**-12, 1.0 + 2.0**-12, source.choice((1, -1)) * 2.0 ** source.randint(-70, 30)
        exact = Fraction(a) * Fraction(b) + Fraction(c)
        assert fma(a, b, c) == round_rational(exact, 24, -149, 128)
    double, a, b = FLOAT64.of(Op.FMA), 1.0 + 2.0**-30, 1.0 - 2.0**-30
    assert double(a, b, -1.0) == -(2.0**-60) and a * b == 1
    assert math.isinf(fma(3e38, 3e38, 0.0)) and math.isinf(double(math.inf, 2.0, 0.0))
    assert math.isnan(fma(math.inf, 0.0, 1.0))


def test_exact_rounding_ties_to_even() -> None:
    rint, flip = EXACT.of(Op.RINT), EXACT.of(Op.FLIP)
    assert [rint(Exact(Fraction(k, 2))) for k in (-3, -1, 1, 3, 5)] == [Exact(k) for k in (-2, 0, 0, 2, 2)]
    assert [flip(Exact(5), Exact(n)) for n in (-1, 0, 1, 2)] == [Exact(-5), Exact(5), Exact(-5), Exact(5)]
