"""Sines, cosines and arctangents in integers: arguments that need care."""

from __future__ import annotations

import math

import pytest

from wmrgen.ir.ops.integer import arctangent, cosine, sine


@pytest.mark.parametrize("operation", [sine, cosine, arctangent])
def test_what_is_no_number_stays_so(operation: object) -> None:
    assert callable(operation)
    assert math.isnan(operation(math.nan)) and math.isnan(operation(-math.nan))


@pytest.mark.parametrize("x", [0.0, -0.0, 2.0**-149, -(2.0**-130), 2.0**-40])
def test_tiny_angles_are_their_sines_and_arctangents(x: float) -> None:
    for operation in (sine, arctangent):
        assert operation(x) == x and math.copysign(1, operation(x)) == math.copysign(1, x)
    assert cosine(x) == 1.0
