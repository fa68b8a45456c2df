"""Rounding errors in ulp of the sum of the terms' magnitudes: linear maps at most 2.5, with steering at most 4.5."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from benchmarks.accuracy import ROBOTS, Values, limit, measure, precise, robot
from benchmarks.accuracy import inputs as drawn
from tests.robots import of_gallery
from wmrgen.ir.interpret import FLOAT32, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS
from wmrgen.ir.nodes import Module

FEW = ("lekiwi", "wpilib_swervebot", "nomad_xr4000", "ackermann_car")


def predicted(module: Module, name: str, cases: Sequence[Values]) -> list[Values]:
    """What the expanded C computes, which tests/codegen/c shows to be its bits."""
    return [evaluate_module(module, name, case, FLOAT32) for case in cases]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", FEW)
def test_few(name: str, target: str) -> None:
    import random

    derivation = precise(name)
    module = expand(derivation.c_module, "float", "inline", target)
    for function in ("inverse", "forward"):
        reference = derivation.raw_module.function(function)
        source = random.Random(f"{name} {function} few")
        cases = [drawn(reference, source) for _ in range(12)]
        worst = measure(reference, module, cases, compute=predicted)
        assert worst.ulp <= limit(reference), worst
        assert worst.other <= 1, worst


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_compiled(name: str) -> None:
    """The C as derive writes it, from the system compiler."""
    derivation = of_gallery(name)
    for function, worst in robot(name, 100):
        assert worst.ulp <= limit(derivation.raw_module.function(function)), worst
