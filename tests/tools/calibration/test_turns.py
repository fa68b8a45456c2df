"""Whole turns between two reference headings: what nominal odometry cannot decide is tried and reported."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.tools.calibration.drives import change_references, derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Reals
from wmrgen.tools.calibration.calibrate import Calibration, calibrate

LAYOUT = LAYOUTS["differential_with_castor"]  # nominal: radius 0.033, track 0.16
EVERY_TURN = 4.0  # [s]


def _spot(total: int, t: Reals) -> tuple[Reals, Reals, Reals]:
    """Turn on the spot, from rest to rest, with a second of rest before and after."""
    share = np.clip((t - 1) / (total * EVERY_TURN), 0, 1)
    return 0 * t, 0 * t, 2 * np.pi / EVERY_TURN * (1 - np.cos(2 * np.pi * share))


def spot(folder: Path, total: int, off: float, cumulative: bool) -> tuple[Calibration, float]:
    """Calibrate from the first and the last pose of turns on the spot.

    Args:
        folder: Where the log is written.
        total: The true number of turns.
        off: The true track relative to the nominal one.
        cumulative: Whether the reference counts turns.

    Returns:
        The calibration, and the true ratio of track to radius.
    """
    true = {"radius": 0.033, "track": 0.16 * off}
    layout = replace(LAYOUT, true=true, drives=(partial(_spot, total),))
    encoders = Encoders(2 * np.pi / 1000)
    paths = written(folder, layout, seconds=2 + total * EVERY_TURN, rate=10, encoders=encoders)

    def ends(rows: Reals) -> Reals:
        wrapped = (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi
        return np.column_stack([rows[:, :3], rows[:, 3] if cumulative else wrapped])[[0, -1]]

    change_references(paths, ends)
    return calibrate(derived(layout.text), paths), true["track"] / true["radius"]


def ratio(values: dict[str, float]) -> float:
    return values["track"] / values["radius"]


CASES = [
    pytest.param(total, off, marks=[] if total < 15 and off != 1.066 else pytest.mark.slow)
    for off in (0.9, 1.066, 1.1)
    for total in (3, 5, 8, 10, 15, 20)
]


@pytest.mark.parametrize(("total", "off"), CASES)
def test_the_true_number_is_chosen_or_listed(tmp_path: Path, total: int, off: float) -> None:
    """The nominal track is 10 % or 6.6 % off, and headings are between -pi and pi."""
    result, true = spot(tmp_path, total, off, cumulative=False)
    found = {round(abs(result.turns)): ratio({n: e.value for n, e in result.parameters.items()})}
    assert len(found | {round(abs(a.turns)): 0.0 for a in result.alternatives}) == 1 + len(
        result.alternatives
    )
    found |= {round(abs(a.turns)): ratio(a.parameters) for a in result.alternatives}
    assert total in found and found[total] == pytest.approx(true, rel=0.002)
    assert all(1 <= a.odds < 100 for a in result.alternatives)
    assert [a.odds for a in result.alternatives] == sorted(a.odds for a in result.alternatives)


@pytest.mark.parametrize(("total", "off"), CASES)
def test_headings_that_count_turns_are_kept(tmp_path: Path, total: int, off: float) -> None:
    result, true = spot(tmp_path, total, off, cumulative=True)
    assert not result.alternatives and np.isnan(result.turns)
    assert ratio({n: e.value for n, e in result.parameters.items()}) == pytest.approx(true, rel=0.002)
    assert ("track", "radius") in result.unobservable or ("radius", "track") in result.unobservable


def test_poses_on_the_way_decide_the_number(tmp_path: Path) -> None:
    """A pose each second leaves no doubt, whatever the track is."""
    layout = replace(LAYOUT, true={"radius": 0.033, "track": 0.18}, drives=(partial(_spot, 20),))
    paths = written(tmp_path, layout, seconds=82, rate=10, encoders=Encoders(2 * np.pi / 1000))

    def wrap(rows: Reals) -> Reals:
        return np.column_stack([rows[:, :3], (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi])[::10]

    change_references(paths, wrap)
    result = calibrate(derived(layout.text), paths)
    assert not result.alternatives and np.isnan(result.turns)
    assert ratio({n: e.value for n, e in result.parameters.items()}) == pytest.approx(0.18 / 0.033, rel=0.002)
