"""Noise levels are found back from tracks that were drawn with them."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
import pytest

from tests.tools.calibration.simulated import Reals
from wmrgen.tools.calibration.noise import USUAL, Track, differences, noise

STEP, SPEED, COUNT = 0.5, 0.4, 400  # [s], [m/s], poses of a track


def track(random: np.random.Generator, level: tuple[float, ...], bend: float) -> Track:
    """Draw a track whose odometry walks off, and whose reference is noisy.

    Args:
        random: Draws it.
        level: Variances of the walk of place [m^2/m] and heading [rad^2/m], and of the noise of place [m^2] and heading
            [rad^2].
        bend: Rotation [rad/s].
    """
    walk, turn_walk, position, heading = level
    moved = SPEED * STEP + 0.15 * abs(bend) * STEP  # as `noise.distance` counts
    true = bend * STEP * np.arange(COUNT)
    steps = SPEED * STEP * np.exp(1j * (true[:-1] + bend * STEP / 2)) * np.sinc(bend * STEP / 2 / np.pi)
    seen = np.concatenate([[0], np.cumsum(steps)])
    drift = np.concatenate([[0.0], np.cumsum(np.sqrt(turn_walk * moved) * random.standard_normal(COUNT - 1))])
    slips = np.sqrt(walk * moved) * (
        random.standard_normal(COUNT - 1) + 1j * random.standard_normal(COUNT - 1)
    )
    own = np.concatenate([[0], np.cumsum((steps + slips) * np.exp(1j * (drift[:-1] + drift[1:]) / 2))])
    measured = seen + np.sqrt(position) * (random.standard_normal(COUNT) + 1j * random.standard_normal(COUNT))
    theta = true + np.sqrt(heading) * random.standard_normal(COUNT)
    return Track(0, STEP * np.arange(COUNT), own, true + drift, measured, theta, moved * np.arange(COUNT))


LEVELS = {
    "walks": (4e-6, 9e-6, 1e-10, 1e-10),
    "noise": (1e-12, 1e-12, 4e-6, 9e-6),
    "all": (4e-6, 9e-6, 4e-6, 9e-6),
}


@pytest.mark.parametrize(
    ("name", "bend"), [("walks", 0.0), ("noise", 0.0), ("all", 0.0), ("walks", 0.2), ("noise", 0.2)]
)
def test_levels_are_found_back(name: str, bend: float) -> None:
    """To 25 % of 40 tracks; what is not there is found to be less than a tenth of what is."""
    random, level = np.random.default_rng(4), LEVELS[name]
    found = noise([track(random, level, bend) for _ in range(40)])
    values = found.position_walk, found.heading_walk, found.position, found.heading
    for value, true in zip(values, level, strict=True):
        if true > 1e-8:
            assert value == pytest.approx(true, rel=0.25)
        else:
            assert value < 4e-7


def test_a_slip_counts_little() -> None:
    """One jump of a metre among 40 tracks moves no level by more than a third."""
    random = np.random.default_rng(4)
    tracks = [track(random, LEVELS["all"], 0.1) for _ in range(40)]
    plain = noise(tracks)
    tracks[0].place[200:] += 1.0
    slipped = noise(tracks)
    for value, before in zip(astuple(slipped), astuple(plain), strict=True):
        assert value == pytest.approx(before, rel=0.34)


def test_no_track_gives_the_usual_noise() -> None:
    """Nor do tracks that unknowns can be fitted to exactly."""
    assert astuple(noise([])) == pytest.approx(astuple(USUAL))
    exact = noise([track(np.random.default_rng(1), LEVELS["all"], 0.1)], 0.0)
    assert astuple(exact) == pytest.approx(astuple(USUAL))


def test_differences_are_seen_from_the_first_pose() -> None:
    """A frame of the reference that is turned and shifted changes nothing."""
    random = np.random.default_rng(2)
    one = track(random, LEVELS["all"], 0.2)
    other = Track(
        0, one.t, one.place, one.heading, 3 + 1j + np.exp(0.7j) * one.seen, one.theta + 0.7, one.travelled
    )
    for lag in (1, 8):
        place, turn = differences(one, lag)
        moved, turned = differences(other, lag)
        assert place == pytest.approx(moved) and turn == pytest.approx(turned)
        assert len(place) == len(turn) == COUNT - lag


def test_a_perfect_track_has_nearly_no_noise() -> None:
    """400 poses outweigh what is usual."""
    levels: Reals = np.array(astuple(noise([track(np.random.default_rng(1), (0.0,) * 4, 0.1)])))
    assert np.all(levels < 0.01 * np.array(astuple(USUAL)))
