"""Inverse and forward kinematics against each other and against the oracle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.laws.common import NAMES, admissible, coupled, derived, drive, gallery, law, sensed, turning
from tests.laws.layouts import layouts, steers, twists
from tests.oracle import oracle
from tests.oracle.harness import Model, named, twist_of

Layout = dict[str, Any]
RANDOM = np.random.default_rng(20240229)


def near(found: Any, wanted: Any, scale: float = 1.0, tol: float = 1e-8) -> None:
    np.testing.assert_allclose(found, wanted, rtol=tol, atol=tol * max(1.0, scale))


def check_round_trip(model: Model, layout: Layout, weights: Any, present: dict[str, float]) -> None:
    """FK(IK(xi)) = xi without slip, for a twist that every wheel can follow."""
    twist = admissible(layout, np.asarray(weights, float))
    joints, back, slip = drive(model, layout, twist, present)
    assert joints["slip"] == pytest.approx(0.0, abs=1e-9)
    assert slip == pytest.approx(0.0, abs=1e-7)
    state = present | {k: v for k, v in joints.items() if k != "slip"}
    fitted, residual, rank = oracle.forward(layout, sensed(model, state))
    assert residual == pytest.approx(0.0, abs=1e-8)
    if rank == 3:
        near(fitted, twist, tol=1e-7)
        near(back, twist, tol=1e-6)


def check_inverse(model: Model, layout: Layout, weights: Any, present: dict[str, float]) -> None:
    """Joint commands as the oracle finds them from contact velocities; a wheel may run reversed."""
    twist = admissible(layout, np.asarray(weights, float))
    found = model.call("inverse", named(twist) | present)
    wanted = oracle.inverse(layout, twist, present)
    assert found.keys() - {"slip"} == wanted.keys()
    limited = any(w.limits or model.robot.limits for w in model.robot.wheels)
    for w in layout["wheels"]:
        name = w["name"]
        if f"{name}.steer" in wanted:
            turns = (found[f"{name}.steer"] - wanted[f"{name}.steer"]) / np.pi
            assert abs(turns - round(turns)) < 1e-8
            if not limited:
                assert abs(found[f"{name}.steer"] - present.get(f"{name}.steer", 0.0)) <= np.pi / 2 + 1e-9
            wanted |= oracle.joint_rates(w, twist, found[f"{name}.steer"])
        for joint in ("spin", "steer_rate"):
            if f"{name}.{joint}" in wanted:
                near(found[f"{name}.{joint}"], wanted[f"{name}.{joint}"], scale=1 / w["r"])


def check_least_squares(model: Model, layout: Layout, values: dict[str, float]) -> None:
    """Forward kinematics of inconsistent rates is numpy's least squares; slip is its residual norm."""
    found = model.call("forward", values)
    wanted, residual, rank = oracle.forward(layout, values)
    near(found["slip"], residual, scale=10 * residual, tol=1e-7)
    if rank == 3:
        near(twist_of(found), wanted, scale=float(np.abs(wanted).max()), tol=1e-6)


def present_of(layout: Layout, angle: float) -> dict[str, float]:
    return {f"{n}.steer": round(angle * (0.4 + 0.3 * k), 3) for k, n in enumerate(turning(layout))}


def within_limits(model: Model, present: dict[str, float]) -> dict[str, float]:
    """No wheel stands beyond its steering limits, where the commanded angle would be clamped."""
    limited = any("steer" in (w.limits or {}) or "steer" in model.robot.limits for w in model.robot.wheels)
    return {k: 0.1 * v for k, v in present.items()} if limited else present


WEIGHTS = [(0.7, 0.2, -0.3), (-0.9, 0.05, 0.1), (0.3, 0.01, 0.02)]


@pytest.mark.parametrize("name", NAMES)
def test_round_trip_of_the_gallery(name: str) -> None:
    model, layout = gallery(name)
    for k, weights in enumerate(WEIGHTS):
        present = within_limits(model, coupled(layout, present_of(layout, 0.4 * k - 0.3)))
        check_round_trip(model, layout, gentle(model, layout, weights), present)


@pytest.mark.parametrize("name", NAMES)
def test_inverse_of_the_gallery(name: str) -> None:
    model, layout = gallery(name)
    for k, weights in enumerate(WEIGHTS):
        present = within_limits(model, coupled(layout, present_of(layout, 0.4 * k - 0.3)))
        check_inverse(model, layout, gentle(model, layout, weights), present)


def gentle(model: Model, layout: Layout, weights: Any) -> Any:
    """Weights whose twist asks for no steering beyond the limits: mostly straight ahead for cars."""
    tight = [w for w in model.robot.wheels if "steer" in w.limits]
    if not tight:
        return weights
    basis = oracle.null(oracle.sliding_rows(layout, "fixed", {}))
    straight = np.linalg.lstsq(basis, np.array([1.0, 0.0, 0.0]), rcond=None)[0]
    bend = np.linalg.lstsq(basis, np.array([1.0, 0.0, 0.1]), rcond=None)[0]
    return weights[0] * straight + weights[1] * bend


@pytest.mark.parametrize("name", NAMES)
def test_least_squares_of_the_gallery(name: str) -> None:
    model, layout = gallery(name)
    for _ in range(5):
        values = sensed(model, {})
        check_least_squares(
            model,
            layout,
            {k: float(v) for k, v in zip(values, RANDOM.uniform(-3, 3, len(values)), strict=True)},
        )


@law(20)
@given(layouts(), twists, steers)
def test_round_trip(layout: Layout, weights: Any, angle: float) -> None:
    check_round_trip(derived(layout), layout, weights, present_of(layout, angle))


@law(20)
@given(layouts(), twists, steers)
def test_inverse(layout: Layout, weights: Any, angle: float) -> None:
    check_inverse(derived(layout), layout, weights, present_of(layout, angle))


@law(20)
@given(layouts(), st.lists(st.integers(-300, 300), min_size=24, max_size=24))
def test_least_squares(layout: Layout, numbers: list[int]) -> None:
    model = derived(layout)
    values = {k: n / 100 for k, n in zip(sensed(model, {}), numbers, strict=False)}
    check_least_squares(model, layout, values)


@law(15)
@given(layouts(), twists)
def test_forbidden_twists_are_reported(layout: Layout, twist: Any) -> None:
    """slip is zero exactly when the fixed wheels allow the twist, and never negative."""
    model = derived(layout)
    sliding = oracle.sliding_rows(layout, "fixed", {}) @ np.array(twist)
    slip = model.call("inverse", named(twist))["slip"]
    assert slip >= 0.0
    assert (slip > 1e-9) == (np.abs(sliding).max(initial=0.0) > 1e-9)
