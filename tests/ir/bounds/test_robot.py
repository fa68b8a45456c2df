"""Bounds as they are printed: rounded outward, with what is proved and what is not."""

from __future__ import annotations

import random

import numpy as np
import pytest

from wmrgen.ir.bounds.analysis import Claim
from wmrgen.ir.bounds.assumptions import LIBM, POSE_RANGES
from wmrgen.ir.bounds.robot import (
    SINGULAR,
    TIES,
    Bounds,
    FunctionBound,
    OutputBound,
    bound,
    data,
    error,
    header_lines,
    limit,
    listed,
    output_bound,
    rounded_outward,
    rounded_up,
)

OUTPUT = OutputBound("left.spin", "rad/s", -2.0, 3.0, 1.234e-7, 0.0, 0.0)
PROVED = FunctionBound("inverse", {"vx": (-1.0, 1.0)}, (OUTPUT,), ())
ALARMED = PROVED._replace(name="forward", alarms=("div: by zero",))
UNKNOWN = FunctionBound("odometry", {}, (), (), ("dt",))
BOUNDS = Bounds(LIBM, (), {"vx": (-1.0, 1.0)}, {}, (PROVED,))


def test_six_digits_lie_outside() -> None:
    chance = random.Random(4)
    for _ in range(300):
        value = chance.choice([-1, 1]) * chance.uniform(1, 10) * 10.0 ** chance.randint(-40, 40)
        high, low = rounded_outward(value), rounded_outward(value, -1)
        assert low <= value <= high
        assert low == -rounded_outward(-value)
        for shown in (low, high):
            assert abs(shown - value) <= 1.01e-5 * abs(value)
            assert float(f"{shown:.5e}") == shown
    assert rounded_outward(1.0) == 1.00001 and rounded_outward(-1.0, -1) == -1.00001, (
        "the last place of a processor does not count"
    )
    assert rounded_outward(0.999) == 0.999001
    assert [rounded_outward(v) for v in (0.0, 1e-101, -1e-150, float("inf"), float("-inf"))] == [
        0, 0, 0, float("inf"), float("-inf"),
    ]  # fmt: skip
    assert rounded_outward(1e-99) > 1e-99


def test_a_printed_claim_holds_the_claim() -> None:
    claim = Claim(-2.0, 3.0, 1.2345678e-7, 3e-9, 1e-4)
    o = output_bound(claim, "left.spin", "rad/s")
    assert (o.name, o.unit, o.singular) == ("left.spin", "rad/s", False)
    assert (o.low, o.high) == (-2.00001, 3.00001) and (o.error, o.per_length) == (1.23457e-7, 3.00001e-9)
    assert o.from_length == pytest.approx(64e-4, rel=1e-5) and o.from_length >= 64e-4
    assert output_bound(claim._replace(singular=True, length_error=0.0), "x", "").singular


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0, "0"), (1.2e-7, "1.2e-07"), (1.21e-7, "1.3e-07"), (1.19e-7, "1.2e-07"), (9.91e-7, "1.0e-06"),
        (4.0, "4.0e+00"), (4.01, "4.1e+00"),
    ],
)  # fmt: skip
def test_two_digits_not_below(value: float, shown: str) -> None:
    assert rounded_up(value) == shown and float(shown) >= value


def test_errors_of_directions_name_the_length() -> None:
    assert error(OUTPUT) == "1.3e-07"
    assert error(OUTPUT._replace(from_length=0.01)) == "1.3e-07 where speed >= 1.0e-02"
    both = OUTPUT._replace(from_length=0.01, per_length=2e-8)
    assert error(both) == "1.3e-07 + 2.0e-08/speed where speed >= 1.0e-02"
    assert bound(OUTPUT) == "in [-2, 3] rad/s, off by 1.3e-07"
    assert bound(OUTPUT._replace(unit="")) == "in [-2, 3] 1, off by 1.3e-07"
    assert bound(OUTPUT._replace(singular=True)) == f"has no bound: {SINGULAR}"


def test_ranges_by_joint() -> None:
    assert limit("vx", (-2.0, 2.0)) == "|vx| <= 2" and limit("vx", (-2.0, 1.5)) == "-2 <= vx <= 1.5"
    ranges = {"left.spin": (-4.0, 4.0), "vx": (-4.0, 4.0), "right.spin": (-4.0, 4.0), "back.spin": (0.0, 4.0)}
    assert listed(ranges) == "|left.spin, right.spin| <= 4, |vx| <= 4, 0 <= back.spin <= 4"


def test_what_counts_as_proved() -> None:
    assert PROVED.proved and not ALARMED.proved and not UNKNOWN.proved


def test_the_header_of_the_c() -> None:
    assert header_lines(BOUNDS._replace(missing=("vx",))) == ()
    under, line = header_lines(BOUNDS)
    assert limit("vx", (-1.0, 1.0)) in under and "speed" not in under and TIES not in under
    assert line == f"  inverse: left.spin {bound(OUTPUT)}"
    twin = OUTPUT._replace(name="right.spin")
    steer = OUTPUT._replace(name="front.steer", unit="rad", from_length=0.01)
    slip = steer._replace(name="slip", singular=True)
    full = PROVED._replace(outputs=(OUTPUT, steer, twin, slip))
    assumed = BOUNDS._replace(functions=(full, ALARMED, UNKNOWN), assumed={"omega": (-3.0, 3.0)})
    under, *lines = header_lines(assumed)
    assert limit("omega", (-3.0, 3.0)) in under and "speed" in under and TIES in under
    assert lines[:3] == [
        f"  inverse: left.spin, right.spin {bound(OUTPUT)}",
        f"  inverse: front.steer {bound(steer)}",
        f"  inverse: slip {bound(slip)}",
    ]
    alarmed, unknown = lines[3:]
    assert alarmed.startswith("  forward: ") and ALARMED.alarms[0] in alarmed
    assert unknown.startswith("  odometry: ") and "dt" in unknown


def test_plain_data() -> None:
    steer = OUTPUT._replace(name="front.steer", per_length=2e-8, from_length=0.01)
    full = PROVED._replace(outputs=(OUTPUT, steer, OUTPUT._replace(name="slip", singular=True)))
    plain = data(BOUNDS._replace(functions=(full, ALARMED, UNKNOWN)))
    assert (
        plain["scalar"] == "float"
        and plain["library"]["name"] == "libm"
        and plain["limits"] == {"vx": [-1.0, 1.0]}
    )
    assert plain["functions"]["inverse"] == {
        "proved": True,
        "outputs": {
            "left.spin": {"range": [-2.0, 3.0], "error": 1.234e-7},
            "front.steer": {
                "range": [-2.0, 3.0],
                "error": 1.234e-7,
                "error_per_speed": 2e-8,
                "from_speed": 0.01,
            },
            "slip": {"no_bound": SINGULAR},
        },
    }
    forward = plain["functions"]["forward"]
    assert not forward["proved"] and forward["not_shown"] == ["div: by zero"]
    assert plain["functions"]["odometry"] == {"proved": False, "no_range": ["dt"]}


@pytest.mark.parametrize("name", ["x", "y", "theta"])
def test_what_a_pose_leaves_over_is_half_a_last_place(name: str) -> None:
    low, high = POSE_RANGES[f"{name}_rest"]
    half = np.spacing(np.float32(POSE_RANGES[name][1])) / 2
    assert -low == high and half <= high < 1.1 * half
