"""The analysis: intervals enclose, roundings are within their bounds, undefined operations raise alarms."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds.gallery import proved
from tests.ir.bounds.small import BAD, function, guarded
from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.bounds.analysis import analysed
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE, constant

COUNT = 400
BINARY = {"plus": np.add, "minus": np.subtract, "times": np.multiply}
UNARY = {"sine": np.sin, "cosine": np.cos, "square": np.square, "absolute": np.abs, "negative": np.negative}


def _boxes(seed: int) -> iv.Interval:
    rng = np.random.default_rng(seed)
    ends = rng.normal(0, 1, (2, COUNT)) * 10.0 ** rng.uniform(-3, 1.5, (2, COUNT))
    ends[:, :40] = np.round(ends[:, :40])  # intervals that end at zero, or are one point
    return ends.min(axis=0), ends.max(axis=0)


def _inside(box: iv.Interval, seed: int) -> np.ndarray:
    return box[0] + (box[1] - box[0]) * np.random.default_rng(seed).random(COUNT)


@pytest.mark.parametrize("name", BINARY)
def test_binary_operations_enclose(name: str) -> None:
    a, b = _boxes(1), _boxes(2)
    lo, hi = getattr(iv, name)(a, b)
    for seed in range(20):
        value = BINARY[name](_inside(a, seed), _inside(b, seed + 100))
        assert ((lo <= value) & (value <= hi)).all()


@pytest.mark.parametrize("count", [7, 300])
def test_rounding_goes_outward(count: int) -> None:
    """Of numbers, not ranges: the exact sum, difference and product lie inside, by fractions; of few boxes and many."""
    a, b = (box[0][:count] for box in (_boxes(1), _boxes(2)))
    for name, exact in {
        "plus": Fraction.__add__,
        "minus": Fraction.__sub__,
        "times": Fraction.__mul__,
    }.items():
        lo, hi = getattr(iv, name)((a, a), (b, b))
        for x, y, low, high in zip(a, b, lo, hi, strict=True):
            value = exact(Fraction(float(x)), Fraction(float(y)))
            assert Fraction(float(low)) <= value <= Fraction(float(high))
            assert high - low <= 8 * np.spacing(max(abs(low), abs(high))) + 1e-299


def test_a_constant_and_its_rounding_lie_inside_and_it_is_off_by_what_is_said() -> None:
    chance = random.Random(24)
    for _ in range(100):
        value = Fraction(chance.randint(-(10**20), 10**20), chance.randint(1, 10**20))
        lo, hi, error, _ = constant(Exact(value))
        assert Fraction(lo) <= value <= Fraction(hi)
        step = Fraction(2) ** (math.frexp(value)[1] - 24)
        off = abs(round(value / step) * step - value)
        assert off <= Fraction(error) <= off * (1 + Fraction(2) ** -48)


@pytest.mark.parametrize("name", UNARY)
def test_unary_operations_enclose(name: str) -> None:
    a = _boxes(3)
    lo, hi = getattr(iv, name)(a)
    for seed in range(20):
        value = UNARY[name](_inside(a, seed))
        assert ((lo <= value) & (value <= hi)).all()


def test_roots_quotients_and_angles_enclose() -> None:
    a, b = _boxes(4), _boxes(5)
    with np.errstate(all="ignore"):
        found = iv.root(a), iv.reciprocal(b), iv.arctangent(a, b)
        for seed in range(20):
            x, y = _inside(a, seed), _inside(b, seed + 1) + 0.0
            positive = x >= 0
            assert (found[0][0] <= np.sqrt(np.abs(x)))[positive].all()
            assert (np.sqrt(np.abs(x)) <= found[0][1])[positive].all()
            for value, (lo, hi) in zip((1 / y, np.arctan2(x, y)), found[1:], strict=True):
                assert ((lo <= value) & (value <= hi)).all()


def test_half_ulp_bounds_every_rounding() -> None:
    rng = np.random.default_rng(6)
    value = rng.normal(0, 1, 5000) * 2.0 ** rng.integers(-150, 120, 5000)
    value[:50] = 2.0 ** rng.integers(-20, 20, 50)
    error = np.abs(value.astype(np.float32).astype(np.float64) - value)
    assert (error <= SINGLE.half_ulp(np.abs(value))).all()
    assert SINGLE.half_ulp(np.array([1.0]))[0] == 2.0**-25
    assert Fraction(SINGLE.largest) == Fraction(2) ** 128 - Fraction(2) ** 104


@pytest.mark.parametrize("what", BAD)
def test_undefined_operations_raise_alarms(what: str) -> None:
    make, good, bad = BAD[what]
    control = function(make)
    assert not analysed(control, {"vx": good}, LIBM).alarms
    words = {"division by zero": "may be zero", "overflow": "overflow"}.get(what, "may be negative")
    assert any(words in text for _, text in analysed(control, {"vx": bad}, LIBM).alarms)


def test_guarded_division_raises_none() -> None:
    found = analysed(function(guarded), {"vx": (-2.0, 2.0)}, LIBM)
    assert not found.alarms
    assert found.claims[0].low > -1.001 and found.claims[0].high < 1.001


def test_a_sum_of_floats_has_the_error_that_can_be_counted_by_hand() -> None:
    """vx + 1/3 over [1, 2]: the constant is off by 1/3 - fl(1/3), the sum by half a unit of [2, 4)."""
    control = function(lambda b, x: b.add(x, b.const(Fraction(1, 3))))
    third = abs(Fraction(float(np.float32(1 / 3))) - Fraction(1, 3))
    error = float(analysed(control, {"vx": (1.0, 2.0)}, LIBM).claims[0].error)
    assert error == pytest.approx(float(third) + 2.0**-23, rel=1e-6)


def test_halved_limits_give_smaller_bounds() -> None:
    for f, b in proved("clearpath_do100").pairs:
        if f.name == "inverse":
            half = {name: (lo / 2, hi / 2) for name, (lo, hi) in b.inputs.items()}
            found = analysed(f, half, LIBM)
            for claim, o in zip(found.claims, b.outputs, strict=True):
                assert claim.error <= o.error * 0.51 + 1e-12
