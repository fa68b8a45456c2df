"""Arithmetic modulo a prime beside exact numbers: every operation that is no opaque function."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from wmrgen.exact.number import Exact
from wmrgen.ir.arithmetic import EXACT
from wmrgen.ir.nodes import ARITY, Op
from wmrgen.ir.residues import RESIDUES

OPAQUE = {Op.SQRT, Op.SIN, Op.COS, Op.ATAN, Op.ATAN2, Op.RINT}


@pytest.mark.parametrize("op", sorted(set(RESIDUES.apply) - OPAQUE))
def test_operations_agree_with_exact_ones(op: Op) -> None:
    rng = random.Random(op.value)
    for _ in range(50):
        numbers = [Exact(Fraction(rng.randrange(-60, 61), rng.randrange(1, 9))) for _ in range(ARITY[op])]
        if op is Op.FLIP:
            numbers[1] = Exact(rng.randrange(-5, 6))
        if op is Op.DIV and not numbers[1]:
            continue
        exact = EXACT.apply[op](*numbers)
        found = RESIDUES.apply[op](*map(RESIDUES.enter, numbers))
        assert found.r == RESIDUES.enter(exact).r
        assert found.size == pytest.approx(float(exact))
