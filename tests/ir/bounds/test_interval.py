"""Intervals enclose the exact result: each end is rounded outward, never to nearest."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest

from wmrgen.geometry.exact import interval

OPERATIONS = {
    "plus": (interval.plus, lambda a, b: a + b),
    "minus": (interval.minus, lambda a, b: a - b),
    "times": (interval.times, lambda a, b: a * b),
}


def points(count: int) -> np.ndarray:
    """Floats of both signs and many sizes."""
    source = random.Random(20)
    return np.array(
        [
            source.choice((-1, 1)) * source.uniform(0.5, 1) * 2.0 ** source.randint(-30, 30)
            for _ in range(count)
        ]
    )


@pytest.mark.parametrize("name", OPERATIONS)
def test_the_exact_result_lies_strictly_inside(name: str) -> None:
    """Of points, whose result is no float as a rule: rounded to nearest one bound would lie on the wrong side."""
    enclose, exact = OPERATIONS[name]
    a, b = points(300), points(600)[300:]
    low, high = enclose((a, a), (b, b))
    for x, y, lo, hi in zip(a.tolist(), b.tolist(), low.tolist(), high.tolist(), strict=True):
        value = exact(Fraction(x), Fraction(y))
        assert Fraction(lo) < value < Fraction(hi)


@pytest.mark.parametrize("name", OPERATIONS)
def test_corners_of_all_signs(name: str) -> None:
    enclose, exact = OPERATIONS[name]
    ends = points(8)
    for p in ends:
        for q in ends:
            a = tuple(np.array([v]) for v in sorted((p, q)))
            for r in ends:
                b = tuple(np.array([v]) for v in sorted((r, -p)))
                low, high = enclose(a, b)
                for x in a:
                    for y in b:
                        value = exact(Fraction(float(x[0])), Fraction(float(y[0])))
                        assert Fraction(float(low[0])) < value < Fraction(float(high[0])) or value == 0


def test_roots_and_reciprocals_enclose() -> None:
    a = np.abs(points(300))
    low, high = interval.root((a, a))
    over_low, over_high = interval.reciprocal((a, a))
    for x, lo, hi, p, q in zip(*(v.tolist() for v in (a, low, high, over_low, over_high)), strict=True):
        assert Fraction(lo) ** 2 < Fraction(x) < Fraction(hi) ** 2
        assert Fraction(p) < 1 / Fraction(x) < Fraction(q)
