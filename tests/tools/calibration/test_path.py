"""Dead reckoning: arcs, poses inside of steps, and derivatives against finite differences."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from tests.tools.calibration.drives import derived
from tests.tools.calibration.simulated import LAYOUTS, Reals
from wmrgen.tools.calibration.calibrate import increments_of
from wmrgen.tools.calibration.logs import Log, Poses, steps_at, thinned
from wmrgen.tools.calibration.path import Increments, Path, chained

H = 1e-6  # step of central differences: their error is 1e-12 by the third derivative, 1e-10 by rounding


@cache
def columns(name: str, count: int = 100) -> tuple[Increments, dict[str, Reals], Reals]:
    """Return a robot's odometry, random increments, and true parameters."""
    increments, nominal = increments_of(derived(LAYOUTS[name].text))
    random = np.random.default_rng(3)
    joints = {joint: 0.1 * random.standard_normal(count) for joint in increments.joints}
    values = np.array([LAYOUTS[name].true[parameter] for parameter in increments.parameters])
    assert values.shape == nominal.shape
    return increments, joints, values


@pytest.mark.parametrize("name", LAYOUTS)
def test_derivatives_of_paths(name: str) -> None:
    """By each parameter, at parameters that are not nominal."""
    increments, joints, values = columns(name)
    path = increments.path(joints, values)
    assert path.position_by.shape == (len(values), 101)
    for index in range(len(values)):
        step = H * np.eye(len(values))[index]
        high, low = increments.path(joints, values + step), increments.path(joints, values - step)
        assert np.allclose((high.position - low.position) / (2 * H), path.position_by[index], atol=1e-6)
        assert np.allclose((high.heading - low.heading) / (2 * H), path.heading_by[index], atol=1e-6)


@pytest.mark.parametrize("name", ["swerve", "car", "four_omni", "mecanum", "differential"])
def test_derivatives_of_redundant_rows(name: str) -> None:
    increments, joints, values = columns(name)
    off = increments.disagreement(joints, values)
    assert off.shape[0] == 1 + len(values) and off.shape[2] == 100
    assert (off.shape[1] == 0) == (name == "differential")
    for index in range(len(values)):
        step = H * np.eye(len(values))[index]
        high = increments.disagreement(joints, values + step)[0]
        low = increments.disagreement(joints, values - step)[0]
        assert np.allclose((high - low) / (2 * H), off[1 + index], atol=1e-6)


@pytest.mark.parametrize("name", ["differential", "swerve"])
def test_without_derivatives_paths_are_equal(name: str) -> None:
    increments, joints, values = columns(name)
    whole, alone = increments.path(joints, values), increments.alone.path(joints, values)
    assert np.array_equal(whole.position, alone.position) and np.array_equal(whole.heading, alone.heading)
    assert alone.position_by.shape == (0, 101)


@pytest.mark.parametrize("omega", [0.0, 1e-6, 1.99e-4, 2.01e-4, -2.01e-4, 0.3, -3.0])
def test_a_step_is_an_arc(omega: float) -> None:
    """(e^(i omega) - 1) / (i omega), which is 1 + i omega / 2 - omega^2 / 6 - ..., and its derivative."""
    one, terms = np.ones(1), [1j**k / math.factorial(k + 1) for k in range(40)]
    path = chained(Path(one + 0j, omega * one, np.zeros((1, 1), complex), np.ones((1, 1))))
    assert path.position[1] == pytest.approx(sum(c * omega**k for k, c in enumerate(terms)), rel=1e-12)
    by = sum(k * c * omega ** (k - 1) for k, c in enumerate(terms) if k)
    assert path.position_by[0, 1].real == pytest.approx(by.real, rel=1e-6, abs=1e-16)
    assert path.position_by[0, 1].imag == pytest.approx(by.imag, rel=1e-6)


@pytest.mark.parametrize(("omega", "off"), [(0.0, 1e-12), (0.1, 1e-4), (-0.4, 2e-3)])
def test_poses_inside_of_a_step_are_on_its_arc(omega: float, off: float) -> None:
    """For a step of 1 m; outside of it the robot goes on along the chord."""
    one, turn = np.ones(1), np.array([omega])

    def after(share: float) -> Path:
        by, heading_by = np.full((1, 1), share * (1 + 0.1j)), np.full((1, 1), 0.2 * share)
        return chained(Path(share * one + 0j, share * turn, by, heading_by))

    for share in (0.0, 0.3, 0.7, 1.0, 1.5, -0.5):
        there = after(1.0).between(np.array([0]), np.array([share]))
        true = after(share).position[1] if 0 <= share <= 1 else share * after(1.0).position[1]
        assert there.position[0] == pytest.approx(true, abs=off)
        assert there.heading[0] == pytest.approx(share * omega)
        assert there.heading_by[0, 0] == pytest.approx(0.2 * share)
        more, less = (
            chained(
                Path(one * (1 + h * (1 + 0.1j)), turn + 0.2 * h, np.zeros((0, 1), complex), np.zeros((0, 1)))
            )
            .between(np.array([0]), np.array([share]))
            .position[0]
            for h in (H, -H)
        )
        assert there.position_by[0, 0] == pytest.approx((more - less) / (2 * H), abs=1e-8)


def test_steps_at_times() -> None:
    step, share = steps_at(np.array([0.0, 1.0, 3.0]), np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 5.0]))
    assert step.tolist() == [0, 0, 0, 1, 1, 1, 1]
    assert share.tolist() == [-1, 0, 0.5, 0, 0.5, 1, 2]


@pytest.mark.parametrize("name", ["tricycle", "differential", "mecanum"])
def test_a_thinned_log_goes_as_far(name: str) -> None:
    """Wheels turn by as much in as much time, and the path ends within a millimetre of where it ended."""
    increments, _, values = columns(name)
    t = np.linspace(0, 20, 2001)
    wheels = {
        joint: 0.3 * np.sin(0.2 * t[1:])
        if joint.endswith(".steer")
        else 0.02 + 0.01 * np.sin(0.3 * t[1:] + k)
        for k, joint in enumerate(increments.joints)
    }
    poses = Poses(t, np.where(np.arange(2001) % 3, t, np.nan), t, np.full(2001, np.nan))
    log = Log("run", t, wheels, poses)
    fewer = thinned(log, increments, values)
    assert len(fewer.t) < 600 and fewer.rows == 2001
    assert (fewer.t[0], fewer.t[-1]) == (0, 20) and np.all(np.diff(fewer.t) > 0)
    for joint, column in wheels.items():
        assert len(fewer.columns[joint]) == len(fewer.t) - 1
        if joint.endswith(".spin"):
            assert fewer.columns[joint].sum() == pytest.approx(column.sum())
    whole, part = increments.path(wheels, values), increments.path(fewer.columns, values)
    assert part.position[-1] == pytest.approx(whole.position[-1], abs=1e-3)
    assert part.heading[-1] == pytest.approx(whole.heading[-1], abs=1e-3)
    kept = fewer.poses
    assert (kept.t[0], kept.t[-1]) == (0, 20) and 41 <= len(kept.t) < 150
    assert np.isfinite(kept.x).sum() >= 40 and np.isnan(kept.x).sum() >= 40  # each kind of row is kept
