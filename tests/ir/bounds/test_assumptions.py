"""What bounds rest on: ranges of inputs that the docstring of `assumptions` lists, and errors of the library."""

from __future__ import annotations

import math
from collections.abc import Mapping

import mpmath
import numpy as np
import pytest

from tests.robots import of_text
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE, library
from wmrgen.ir.bounds.robot import Bounds
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.kernels.trigonometry import HALF, QUARTER, worst
from wmrgen.ir.nodes import Op

LIMITS = {"vx": 1.0, "omega": 2.0, "steer_rate": 3.0}
RADIUS, OFFSET = 0.1, 0.05
PIVOTS = {"a": (0.4, 0.3, OFFSET), "b": (-0.4, -0.3, -OFFSET), "c": (-0.4, 0.3, 0.0)}
TURNS = 4 * math.pi
ROUNDED = 1e-5  # of six printed digits, and of float32 ends [1]


def swerve(limits: Mapping[str, float] = LIMITS) -> Bounds:
    """The bounds of three steered wheels, two of which are beside their axes."""
    wheels = [
        f"  - {{name: {n}, type: steered, x: {x}, y: {y}, heading: 0, r: {RADIUS}, offset_y: {o}}}"
        for n, (x, y, o) in PIVOTS.items()
    ]
    written = ", ".join(f"{n}: {v}" for n, v in limits.items())
    text = "\n".join(["wmrgen: 1", "name: robot", f"limits: {{{written}}}"])
    return of_text("\n".join([text, "wheels:", *wheels, ""])).bounds


def within(found: tuple[float, float], wanted: float) -> bool:
    """Whether a range is -wanted to wanted, no less than float32 may hold and little more."""
    low, high = found
    return -low == high and wanted * (1 - 1e-6) <= high <= wanted * (1 + 3 * ROUNDED)


def test_wheels_are_looked_at_for_all_that_inverse_commands_and_for_what_steering_adds() -> None:
    """Spins are largest at a corner of the limits of the twist; steering a wheel beside its axis adds to them."""
    ranges = {f.name: f.inputs for f in swerve().functions}["forward"]
    for name, (x, y, o) in PIVOTS.items():
        fastest = 0.0
        for vx in (-1.0, 1.0):
            for vy in (-1.0, 1.0):  # as vx
                for omega in (-2.0, 2.0):
                    pivot = math.hypot(vx - omega * y, vy + omega * x)
                    fastest = max(fastest, pivot + abs(o * omega))
        commanded = fastest / RADIUS + abs(o) * LIMITS["steer_rate"] / RADIUS
        low, high = ranges[f"{name}.spin"]
        assert -low == high and commanded <= high <= 1.05 * commanded
        assert within(ranges[f"{name}.steer"], TURNS)
        assert not o or within(ranges[f"{name}.steer_rate"], 3.0)


def test_poses_steps_and_twists_of_odometry() -> None:
    ranges = {f.name: f.inputs for f in swerve().functions}["odometry"]
    assert within(ranges["x"], 100.0) and within(ranges["y"], 100.0) and within(ranges["theta"], TURNS)
    assert within(ranges["vx"], 1.0) and within(ranges["vy"], 1.0) and within(ranges["omega"], 2.0)
    low, high = ranges["dt"]
    assert low == 0 and high == pytest.approx(0.1, rel=1e-6)


def differential(
    functions: str = "", limits: str = "{vx: 1, omega: 2, spin: 30}", tunable: str = "0.1"
) -> Bounds:
    return of_text(f"""wmrgen: 1
name: robot
parameters: {{radius: {tunable}}}
limits: {limits}
{functions}
wheels:
  - {{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: radius}}
  - {{name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: radius}}
""").bounds


def test_what_keeps_twists_inside_their_limits_is_looked_at_for_four_times_as_much() -> None:
    found = [
        f for f in differential("functions: [limit_twist, desaturate]").functions if f.name == "limit_twist"
    ]
    assert found, "limit_twist has bounds"
    assert within(found[0].inputs["vx"], 4.0) and within(found[0].inputs["omega"], 8.0)


def test_wheels_turn_in_a_step_as_far_as_their_spin_takes_them() -> None:
    steps = [
        f for f in differential("functions: [odometry_from_angles]").functions if "left.spin_step" in f.inputs
    ]
    assert steps
    assert within(steps[0].inputs["left.spin_step"], 30 * 0.1)


def test_a_tunable_radius_takes_its_whole_range() -> None:
    """10 % below its nominal value spins are largest."""
    (found,) = (
        f for f in differential(tunable="{value: 0.1, tunable: true}").functions if f.name == "inverse"
    )
    assert found.inputs["radius"] == pytest.approx((0.09, 0.11), rel=1e-6)
    spin = {o.name: o for o in found.outputs}["left.spin"]
    assert spin.high >= (1 + 2 * 0.2) / 0.09


# ---- the library


@pytest.mark.parametrize("target", ["m4f", "m0", "host"])
def test_the_error_of_atan2_covers_those_of_its_steps(target: str) -> None:
    """Quotient, arctangent, pi/2 less that and pi less that: each step's largest error, carried to the end.

    The arctangent's is what `tests.accuracy` finds by trying every float.
    """
    allowed = library(Choice("float", "inline", target)).atan2
    stated = float(worst(target).arctangent)
    needed = 0.0
    for angle in np.linspace(1e-3, math.pi - 1e-3, 4001):
        first = min(angle, math.pi - angle)
        slope_angle = min(first, math.pi / 2 - first)
        slope = math.tan(slope_angle)
        error = ulp(slope) / 2 / (1 + slope**2) + stated * ulp(slope_angle)
        if first > math.pi / 4:
            error += abs(float(float(QUARTER) - mpmath.pi / 2)) + ulp(first) / 2
        if angle > math.pi / 2:
            error += abs(float(float(HALF) - mpmath.pi)) + ulp(angle) / 2
        needed = max(needed, error / ulp(angle))
    assert needed <= allowed <= 2.2 * needed


def ulp(value: float) -> float:
    return float(np.spacing(np.float32(value)))


def test_sines_of_our_own_are_off_by_the_unit_of_1_however_small() -> None:
    for target in ("m4f", "m0", "host"):
        found = library(Choice("float", "inline", target))
        assert found.circle and found.sin == found.cos == float(worst(target).circle)
        assert found.atan == float(worst(target).arctangent)
        assert (found.reach, found.slope) == (100.0, 1.0)
    for choice in (Choice("float", "libm", "m4f"), Choice("float", "inline", "avr")):
        assert library(choice) == LIBM
    assert (LIBM.sin, LIBM.cos, LIBM.atan, LIBM.atan2) == (1, 1, 1, 2)
    assert LIBM.ulps(Op.SIN) == 1 and LIBM.ulps(Op.ATAN2) == 2


def test_half_an_ulp_on_both_sides_of_powers_of_two() -> None:
    powers = 2.0 ** np.arange(-40, 40)
    assert (SINGLE.half_ulp(powers) == powers * 2.0**-25).all(), "floats up to 2**k lie 2**(k - 24) apart"
    assert (SINGLE.half_ulp(np.nextafter(powers, np.inf)) == powers * 2.0**-24).all()
    assert (SINGLE.half_ulp(np.array([0.0, 2.0**-149, 2.0**-126])) == 2.0**-150).all()
