"""Standard deviations against true errors, and statements that logs do not support."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.calibration import Coverage, coverage
from tests.tools.calibration.drives import change_references, derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Reals, Tracker
from wmrgen.tools.calibration.calibrate import calibrate

LINE = replace(LAYOUTS["differential"], true={"r_left": 0.1, "r_right": 0.1, "half_track": 0.2})
ROUGH = Encoders(2 * np.pi / 400, slip=0.01)


def check_coverage(rows: list[Coverage], within: int) -> None:
    """Check that true values of all parameters of so many runs are within three deviations, which are not large."""
    assert sum(row.within for row in rows) >= within
    every = [error for row in rows for error in row.errors]
    assert 0.4 < np.sqrt(np.mean(np.square(every))) < 1.4
    assert [row.name for row in rows if row.named < row.runs] == []


@pytest.mark.parametrize(
    ("names", "runs", "within"),
    [
        pytest.param(("differential", "skid_steer", "mecanum"), 3, 9, id="9 runs"),
        pytest.param(
            ("differential", "tricycle", "mecanum", "three_omni", "skid_steer"), 6, 29, id="30 runs",
            marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_true_parameters_are_within_three_deviations(names: tuple[str, ...], runs: int, within: int) -> None:
    """97 to 99.9 % is required of 200 runs, see ``python -m benchmarks coverage``."""
    check_coverage([coverage(name, runs, rate=10) for name in names], within)


def _straight(speed: float, t: Reals) -> tuple[Reals, Reals, Reals]:
    return speed + 0 * t, 0 * t, 0 * t


@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 6))])
def test_straight_lines_at_constant_speed_say_nothing_of_clocks(tmp_path: Path, seed: int) -> None:
    """18 drives in 6 sets, their clocks up to 0.5 s off: a start that is farther ahead looks the same. No clock gets an
    offset that is wrong by more than three of its deviations."""
    random = np.random.default_rng(seed)
    speeds = random.uniform(0.2, 0.5, 3) * random.choice([-1, 1], 3)
    layout = replace(LINE, drives=tuple(partial(_straight, speed) for speed in speeds))
    late = float(random.uniform(-0.5, 0.5))
    tracker = Tracker(late=late, noise=(0.002, 0.003))
    paths = written(tmp_path, layout, seed=10 * seed, seconds=20, rate=10, tracker=tracker, encoders=ROUGH)
    result = calibrate(derived(layout.text), paths)
    for clock in result.clocks.values():
        assert clock.sigma is None or abs(clock.value - late) < 3 * clock.sigma
        assert clock.observable == (clock.sigma is not None)


def test_a_heading_of_the_mount_is_no_fact_without_a_way(tmp_path: Path) -> None:
    """Of a turn on the spot nothing shows where the tracked body looks."""
    layout = replace(LINE, drives=(lambda t: (0 * t, 0 * t, 0.5 + 0 * t),))
    result = calibrate(derived(layout.text), written(tmp_path, layout, seconds=20, rate=10))
    assert result.mount["theta"].sigma is None and not result.mount["theta"].observable


def _square(way: int, t: Reals) -> tuple[Reals, Reals, Reals]:
    """Drive a square with sides of 2 m once, with turns on the spot."""
    within, driven = np.mod(t - 1, 9.0), (t > 1) & (t < 37)
    ahead = driven & (within < 5)
    return 0.4 * ahead, 0 * t, way * np.pi / 8 * (driven & ~ahead)


@pytest.mark.slow
def test_a_perfect_umbmark_changes_nothing(tmp_path: Path) -> None:
    """Starts and ends of squares of a robot that is exactly nominal: no statement on parameters or mount."""
    layout = replace(LINE, drives=tuple(partial(_square, way) for way in (1, -1) * 2))
    paths = written(tmp_path, layout, seconds=38, rate=10)
    change_references(paths, lambda rows: rows[[0, -1]])
    result = calibrate(derived(layout.text), paths)
    for estimates in (result.parameters, result.mount):
        for estimate in estimates.values():
            assert estimate.value == pytest.approx(estimate.nominal, rel=0.01, abs=0.01)
    assert all(e.sigma is None for e in result.mount.values())


def test_a_known_clock_is_not_estimated(tmp_path: Path) -> None:
    """Starts and ends of drives determine lengths if the clocks and the tracked point are known."""
    layout = LAYOUTS["tricycle"]
    encoders = Encoders(resolution=2 * np.pi / 400, steer=0.002, slip=0.01)
    paths = written(tmp_path, layout, encoders=encoders)
    change_references(paths, lambda rows: rows[[0, -1]])
    result = calibrate(derived(layout.text), paths, one_clock=True, mount=(0.0, 0.0, 0.0))
    for clock in result.clocks.values():
        assert (clock.value, clock.sigma, clock.observable) == (0.0, None, False)
    for name, value in layout.true.items():
        estimate = result.parameters[name]
        assert estimate.sigma is not None
        assert abs(estimate.value - value) < 3 * estimate.sigma < 0.1


def test_noise_levels_of_a_calibration(tmp_path: Path) -> None:
    """The tracker's noise is found back from drives of wheels that hardly slip."""
    layout = LAYOUTS["differential"]
    paths = written(tmp_path, layout, tracker=Tracker(noise=(0.004, 0.006)), encoders=Encoders(slip=0.001))
    level = calibrate(derived(layout.text), paths).noise
    assert level.position**0.5 == pytest.approx(0.004, rel=0.2)
    assert level.heading**0.5 == pytest.approx(0.006, rel=0.2)


def test_more_drives_make_more_certain(tmp_path: Path) -> None:
    """Four times as many drives of a kind halve the deviations."""
    layout, sigmas = LAYOUTS["differential"], []
    for times in (1, 4):
        folder = tmp_path / str(times)
        folder.mkdir()
        many = replace(layout, drives=layout.drives * times)
        tracker = Tracker(0.03, noise=(0.002, 0.003))
        paths = written(folder, many, seconds=20, rate=10, tracker=tracker, encoders=ROUGH)
        sigmas.append([e.sigma for e in calibrate(derived(layout.text), paths).parameters.values()])
    for few, many_drives in zip(*sigmas, strict=True):
        assert few is not None and many_drives is not None
        assert 0.25 < many_drives / few < 0.8
