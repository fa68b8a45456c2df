"""Arithmetic modulo a prime agrees with exact numbers, for every operation that is not opaque."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT
from wmrgen.ir.ops import OPERATIONS, Op
from wmrgen.ir.verify import RESIDUES

COMPUTED = [op for op in OPERATIONS.values() if op.exact and op.modular and not op.opaque]


@pytest.mark.parametrize("op", COMPUTED, ids=str)
def test_operations_agree_with_exact_ones(op: Op) -> None:
    rng = random.Random(op.name)
    for _ in range(50):
        numbers = [Exact(Fraction(rng.randrange(-60, 61), rng.randrange(1, 9))) for _ in range(op.arity)]
        if op is Op.FLIP:
            numbers[1] = Exact(rng.randrange(-5, 6))
        if op in (Op.CLAMP, Op.AT_LEAST):
            numbers[1] = abs(numbers[1]) + 1
        if op is Op.DIV and not numbers[1]:
            continue
        exact = EXACT.of(op)(*numbers)
        found = RESIDUES.of(op)(*map(RESIDUES.enter, numbers))
        assert found.r == RESIDUES.enter(exact).r
        assert found.size == pytest.approx(float(exact))
