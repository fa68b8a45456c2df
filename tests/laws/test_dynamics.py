"""The posture model is R(theta)^T N eta with the public null space, and drives where steering is straight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given

from tests.laws.common import NAMES, derived, gallery, law
from tests.laws.layouts import layouts, steers
from tests.oracle.harness import Model, turn

RATES = ("x_rate", "y_rate", "theta_rate")


def rates_of(model: Model, values: dict[str, float]) -> Any:
    found = model.call("dynamics", values)
    return np.array([found[k] for k in RATES])


def check_null_space(model: Model, angle: float) -> None:
    """Wheels that ``dynamics`` has no input for (followers of a coupled one) do not enter N."""
    inputs = model.ports("dynamics")[0]
    joints = [n for n in inputs if n.endswith(".steer")]
    steer = {n: angle * (1 - 0.37 * k) for k, n in enumerate(joints)}
    null = model.derivation.null_space
    angles = {f"{n.split('.')[0]}_steer" for n in joints}
    assert {s.name for s in null.free_symbols} - set(model.nominal) <= angles
    wanted = turn(0.8) @ model.evaluate(null, {n.split(".")[0]: v for n, v in steer.items()})
    etas = [n for n in inputs if n.startswith("eta")]
    assert len(etas) == null.cols
    for k, eta in enumerate(etas):
        found = rates_of(model, {"theta": 0.8, eta: 1.0, **steer})
        np.testing.assert_allclose(found, wanted[:, k], rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("angle", [0.0, 0.7, -2.9])
def test_null_space_of_the_gallery(name: str, angle: float) -> None:
    check_null_space(gallery(name)[0], angle)


@law(15)
@given(layouts(), steers)
def test_null_space(layout: dict[str, Any], angle: float) -> None:
    check_null_space(derived(layout), angle)


@pytest.mark.parametrize("name", NAMES)
def test_straight_steering_drives(name: str) -> None:
    """With every steering angle zero, eta1 = 1 moves the robot; so does each further eta."""
    model, _ = gallery(name)
    for k in range(model.derivation.mobility.degree_of_mobility):
        assert np.abs(rates_of(model, {f"eta{k + 1}": 1.0})).max() > 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_eta_is_a_speed(name: str) -> None:
    """1 rad/s about a point that stays; else 1 m/s of what stands straight: P, or on average the pivots of the wheels
    that decide, and the only one of them at any angle."""
    model, _ = gallery(name)
    d = model.derivation
    units = {p.name: p.unit for p in d.formula("dynamics").inputs}
    deciding = [d.robot.wheel(n) for n in d.mobility.basis_wheels]
    for angle in (0.0, 0.7, -2.9) if len(deciding) == 1 else (0.0,):
        steer = {w.name: angle for w in deciding}
        null = model.evaluate(d.null_space, steer)
        for k in range(null.shape[1]):
            vx, vy, omega = null[:, k]
            if units[f"eta{k + 1}"] == "rad/s":
                assert omega == 1
                continue
            pivots = np.array([w.pivot for w in deciding] if omega else [0])
            speeds = np.abs(vx + 1j * vy + 1j * omega * pivots)
            assert np.mean(speeds) == pytest.approx(1, rel=1e-12)
