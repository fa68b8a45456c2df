"""Steering next to a singularity: the centre of rotation down to 1e-8 m from a wheel.

Heading within 5e-7 rad, speed within 3 ulp of the true values of the float32 inputs, with and without a fused
multiply-add.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest

from benchmarks.singularity import HEADING, SPEED, TARGETS, Values, module, nearby, twists, worst
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.nodes import Module

CHOICES = [("inline", target) for target in TARGETS] + [("libm", "m4f")]


@pytest.mark.parametrize(("math", "target"), CHOICES)
def test_heading_and_speed(math: str, target: str) -> None:
    expanded = expand(module(), "float", math, target)

    def predicted(code: Module, name: str, cases: Sequence[Values]) -> list[Values]:
        return [evaluate(code.function(name), case, FLOAT32) for case in cases]

    heading, speed, near = worst(expanded, twists(150, random.Random(f"{math} {target}")), predicted)
    assert heading <= HEADING
    assert speed <= SPEED
    assert near > 40


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_compiled(target: str) -> None:
    heading, speed = nearby(target, 20_000)
    assert heading <= HEADING
    assert speed <= SPEED
