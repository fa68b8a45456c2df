"""Rounding errors in ulp of the sum of the terms' magnitudes: linear maps at most 2.5, with steering at most 4.5."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from benchmarks.accuracy import ROBOTS, Values, measure, robot
from benchmarks.accuracy import inputs as drawn
from benchmarks.counts import ROOT
from wmrgen import derive, load
from wmrgen.ir.interpret import FLOAT32, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS
from wmrgen.ir.nodes import Module

LINEAR, STEERED = 2.5, 4.5
FEW = ("lekiwi", "wpilib_swervebot", "nomad_xr4000", "ackermann_car")


def predicted(module: Module, name: str, cases: Sequence[Values]) -> list[Values]:
    """What the expanded C computes, which tests/c shows to be its bits."""
    return [evaluate_module(module, name, case, FLOAT32) for case in cases]


def limit(function_inputs: Sequence[str]) -> float:
    return STEERED if any(name.endswith(".steer") for name in function_inputs) else LINEAR


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", FEW)
def test_few(name: str, target: str) -> None:
    import random

    derivation = derive(load(ROOT / "robots" / f"{name}.yaml"))
    module = expand(derivation.c_module, "float", "inline", target)
    for function in ("inverse", "forward"):
        reference = derivation.raw_module.function(function)
        source = random.Random(f"{name} {function} few")
        cases = [drawn(reference, source) for _ in range(12)]
        worst = measure(reference, module, cases, compute=predicted)
        assert worst.ulp <= limit([p.name for p in reference.inputs]), worst
        assert worst.other <= 1, worst


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_compiled(name: str) -> None:
    """The C as derive writes it, from the system compiler."""
    derivation = derive(load(ROOT / "robots" / f"{name}.yaml"))
    for function, worst in robot(name, 100):
        inputs = [p.name for p in derivation.raw_module.function(function).inputs]
        assert worst.ulp <= limit(inputs), worst
