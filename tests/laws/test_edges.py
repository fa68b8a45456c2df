"""Defined for every finite input: no NaN and no infinity, whatever the steering or the instantaneous centre."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.laws.common import NAMES, derived, gallery, law, turning
from tests.laws.layouts import layouts
from tests.oracle.harness import Model, named

Layout = dict[str, Any]
HALF = math.pi / 2
STEERS = (0.0, HALF, -HALF, math.pi, 1e-9, 40.0)
SIZES = (1e-300, 1e-30, 1e-9, 1.0, 1e6, 1e30)


def icr_on(w: dict[str, Any]) -> list[float]:
    """The twist that turns about a wheel's pivot: that pivot stands still."""
    return [w["y"], -w["x"], 1.0]


def finite(values: dict[str, float]) -> None:
    assert all(math.isfinite(v) for v in values.values()), values


def check(model: Model, layout: Layout) -> None:
    twists = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.3, -0.2, 0.0]]
    twists += [icr_on(w) for w in layout["wheels"]]
    for steer in STEERS:
        present = {f"{n}.steer": steer for n in turning(layout)}
        for twist in twists:
            finite(model.call("inverse", named(twist) | present))
        for function in ("forward", "dynamics"):
            inputs = model.ports(function)[0]
            for value in (0.0, 1.0, -2.5):
                case = {n: steer if n.endswith(".steer") else value for n in inputs if n not in model.nominal}
                finite(model.call(function, case))
    for size in SIZES:
        present = {f"{n}.steer": 0.7 for n in turning(layout)}
        finite(model.call("inverse", named([size, -size, size]) | present))
        finite(
            model.call("odometry", {"vx": size, "vy": 1.0, "omega": size if size < 1e7 else 1.0, "dt": 0.01})
        )


@pytest.mark.parametrize("name", NAMES)
def test_gallery(name: str) -> None:
    check(*gallery(name))


@law(12)
@given(layouts())
def test_random(layout: Layout) -> None:
    check(derived(layout), layout)


@pytest.mark.parametrize("name", NAMES)
def test_standstill_holds(name: str) -> None:
    """A zero twist keeps every steering angle and stops every wheel."""
    model, layout = gallery(name)
    limited = bool(model.robot.limits.get("steer")) or any("steer" in w.limits for w in model.robot.wheels)
    coupled = {n for _, names in layout["couplings"] for n in names}
    present = {
        f"{n}.steer": 0.2 if limited or n in coupled else 0.5 + 0.1 * k for k, n in enumerate(turning(layout))
    }
    found = model.call("inverse", present)
    for key, value in found.items():
        assert value == (present[key] if key.endswith(".steer") else 0.0), key


@pytest.mark.parametrize("name", NAMES)
def test_steering_limits_are_kept(name: str) -> None:
    model, _ = gallery(name)
    rng = np.random.default_rng(5)
    for _ in range(50):
        found = model.call("inverse", named(rng.uniform(-2, 2, 3)))
        for w in model.robot.wheels:
            limit = w.limits.get("steer") or model.robot.limits.get("steer")
            if limit and w.type == "steered":
                assert float(limit.low) - 1e-12 <= found[f"{w.name}.steer"] <= float(limit.high) + 1e-12


@law(12)
@given(layouts(), st.floats(-1e-6, 1e-6), st.floats(-1e-6, 1e-6))
def test_icr_near_a_wheel(layout: Layout, dx: float, dy: float) -> None:
    """Within a micrometre of a pivot the joint commands stay finite and the swing within 90 degrees."""
    model = derived(layout)
    for w in layout["wheels"]:
        found = model.call("inverse", named([w["y"] + dy, -w["x"] - dx, 1.0]))
        finite(found)
        assert all(abs(v) <= HALF + 1e-9 for k, v in found.items() if k.endswith(".steer"))
