"""Residuals of a log: derivatives against finite differences, and what they are at true values."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.tools.calibration.drives import derived, written
from tests.tools.calibration.simulated import LAYOUTS, Tracker
from wmrgen.tools.calibration import start
from wmrgen.tools.calibration.calibrate import increments_of
from wmrgen.tools.calibration.logs import Log, thinned
from wmrgen.tools.calibration.model import LEVER, MOUNT, Problem, rows, unit_of
from wmrgen.tools.calibration.reading import read, recordings

H = 1e-6


def problem_of(folder: Path, name: str, legs: int = 1, **options: object) -> Problem:
    """Return the problem of one simulated drive, as a robot's wheels and a tracker without noise see it."""
    layout = LAYOUTS[name]
    increments, nominal = increments_of(derived(layout.text))
    paths = written(folder, replace(layout, drives=layout.drives[:1]), seconds=20, rate=10, **options)
    (recording,) = recordings(paths, ())
    log: Log = thinned(read(recording, increments.joints, {}), increments, nominal)
    width = len(nominal) + MOUNT
    return Problem(
        increments, nominal, (log,), (start.whole(log, 20.0 / legs),), free=np.eye(width), clocks=(True,)
    )


@pytest.mark.parametrize(("nominal", "unit"), [(0.4, 0.04), (-0.4, 0.04), (0.0, 0.1)])
def test_a_unit_is_a_tenth_of_a_parameter(nominal: float, unit: float) -> None:
    assert unit_of(nominal) == pytest.approx(unit)


@pytest.mark.parametrize(
    ("name", "legs"), [("differential", 1), ("differential", 3), ("swerve", 2), ("tricycle", 1)]
)
def test_derivatives_of_residuals(tmp_path: Path, name: str, legs: int) -> None:
    """By parameters, mount, and the starts of legs, at a state that is off everything."""
    problem = problem_of(tmp_path, name, legs, tracker=Tracker(0.1 + 0.2j, 0.3))
    random = np.random.default_rng(5)
    shared = problem.origin + problem.units * 0.3 * random.standard_normal(len(problem.origin))
    own = np.concatenate([[0.02], 0.3 * random.standard_normal(3 * legs)])
    one = rows(problem, 0, shared, own)
    width = len(shared)

    for index in range(width):
        step = H * problem.units * np.eye(width)[index]
        more, less = rows(problem, 0, shared + step, own), rows(problem, 0, shared - step, own)
        assert np.allclose((more.values - less.values) / (2 * H), one.by[..., index], atol=1e-7)
        if index < width - MOUNT and len(one.joints):
            assert np.allclose((more.joints - less.joints) / (2 * H), one.joints_by[:, index], atol=1e-7)
    for leg in range(legs):
        inside = one.leg == leg
        for coordinate in range(3):
            step = H * np.eye(len(own))[1 + 3 * leg + coordinate]
            more, less = rows(problem, 0, shared, own + step), rows(problem, 0, shared, own - step)
            change = (more.values - less.values) / (2 * H)
            assert np.allclose(change[:, inside], one.by[:, inside, width + 1 + coordinate], atol=1e-7)
            assert np.allclose(change[:, ~inside], 0)


def test_the_derivative_by_the_clock_is_a_pace_over_two_seconds(tmp_path: Path) -> None:
    """A difference over a second to both sides, because readings of a single step are rough."""
    problem = problem_of(tmp_path, "differential", tracker=Tracker(0.1 + 0.2j))
    own = np.array([0.0, 0.0, 0.0, 0.0])
    one = rows(problem, 0, problem.origin, own)
    width, second = len(problem.origin), np.array([1.0, 0.0, 0.0, 0.0])
    later, sooner = (
        rows(problem, 0, problem.origin, own + second),
        rows(problem, 0, problem.origin, own - second),
    )
    inner = (one.at > 2.1) & (one.at < 17.9)
    both = np.isin(one.at, later.at - 1) & np.isin(one.at, sooner.at + 1) & inner
    assert both.sum() > 20
    change = (
        later.values[:, np.isin(later.at - 1, one.at[both])]
        - sooner.values[:, np.isin(sooner.at + 1, one.at[both])]
    )
    # The tracked point swings on its arm during the two seconds: up to 0.25 m (1 - sinc) of what it does at once.
    assert np.allclose(change / 2, one.by[:, both, width], atol=0.03)
    assert np.allclose(change[2] / 2, one.by[2][both, width], atol=1e-9)


def test_residuals_at_true_values(tmp_path: Path) -> None:
    """Nothing is left, wherever the tracked point is and however late its clock."""
    tracker = Tracker(0.1 - 0.2j, 0.5, late=0.2, start=(3 - 1j, 2.0))
    problem = problem_of(tmp_path, "differential", tracker=tracker)
    true = [LAYOUTS["differential"].true[name] for name in problem.increments.parameters]
    shared = np.array([*true, 0.1, -0.2, 0.5])
    state = start.begun(problem, shared, np.array([0.2]))
    one = rows(problem, 0, shared, state.own[0])
    assert np.abs(one.values).max() < 2e-3  # of steps of 0.25 s
    assert one.at == pytest.approx(problem.logs[0].poses.t + 0.2)
    more = rows(problem, 0, shared, state.own[0] + [0, 0.01, 0.02, 0.1])
    assert more.values[:, 0] == pytest.approx(one.values[:, 0] + [0.01, 0.02, LEVER * 0.1], abs=0.03)


def test_quantities_that_are_not_measured_have_no_weight(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, "differential")
    (log,) = problem.logs
    poses = replace(
        log.poses, theta=np.where(log.poses.t < 10, np.nan, log.poses.theta), x=np.nan * log.poses.x
    )
    one = rows(replace(problem, logs=(replace(log, poses=poses),)), 0, problem.origin, np.zeros(4))
    assert not one.weights[0].any() and one.weights[1].all()
    assert np.array_equal(one.weights[2] > 0, one.at >= 10)
    assert np.isfinite(one.values).all()


def test_poses_that_follow_closely_count_less(tmp_path: Path) -> None:
    """Poses each 0.5 s count half; a pose each second or less often counts one."""
    problem = problem_of(tmp_path, "differential")
    one = rows(problem, 0, problem.origin, np.zeros(4))
    assert one.weights[0, 3] == pytest.approx(0.5)
    (log,) = problem.logs
    seldom = replace(problem, logs=(replace(log, poses=log.poses.rows(np.arange(0, len(log.poses.t), 4))),))
    assert np.all(rows(seldom, 0, problem.origin, np.zeros(4)).weights == 1)


def test_a_known_start_counts_by_its_error(tmp_path: Path) -> None:
    """Its weight is the square of the scale by the error."""
    problem = replace(problem_of(tmp_path, "differential"), start_error=0.002, scale=0.01)
    one = rows(problem, 0, problem.origin, np.zeros(4))
    assert one.known.tolist() == [True] + [False] * (len(one.known) - 1)
    assert one.weights[:, 0] == pytest.approx([25.0] * 3)
