"""Slips: where odometry and reference jump apart, and what remains of a log without them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tools.calibration.test_noise import COUNT, LEVELS, STEP, track
from wmrgen.tools.calibration.noise import Track
from wmrgen.tools.calibration.slips import Slip, find, without

SMALL = (1e-6, 1e-6, 1e-6, 1e-6)  # a millimetre and a milliradian each


def fit_of(*legs: list[tuple[float, float]], scale: float = 0.002) -> Any:
    """Return what `find` and `without` take of a fit."""
    t = STEP * np.arange(COUNT)
    logs = [SimpleNamespace(name=f"run-{k}", poses=SimpleNamespace(t=t)) for k in range(len(legs))]
    parts = tuple(np.array(of_log) for of_log in legs)
    return SimpleNamespace(problem=SimpleNamespace(logs=logs, legs=parts, scale=scale))


def jumping(at: int, moved: complex, turned: float, log: int = 0) -> Track:
    """Return a track whose odometry jumps at a pose by a displacement [m] and a rotation [rad]."""
    one = track(np.random.default_rng(7 + log), SMALL, 0.1)
    place, heading = one.place.copy(), one.heading.copy()
    place[at:] = place[at] + moved + np.exp(1j * turned) * (place[at:] - place[at])
    heading[at:] += turned
    return replace(one, log=log, place=place, heading=heading)


@pytest.mark.parametrize(("moved", "turned"), [(0.3, 0.0), (-0.2j, 0.0), (0.0, 0.4), (0.2 + 0.1j, -0.5)])
def test_a_jump_is_found_where_it_is(moved: complex, turned: float) -> None:
    legs = [(0.0, STEP * COUNT)]
    found = find(fit_of(legs, legs), [jumping(150, 0j, 0.0), jumping(230, moved, turned, 1)])
    assert [index for index, _ in found] == [1]
    slip = found[0][1]
    assert slip.log == "run-1" and slip.start - 1 <= 230 * STEP <= slip.end + 1
    assert slip.end - slip.start < 3
    assert slip.turned == pytest.approx(turned, abs=0.03)
    if not turned:
        assert slip.moved == pytest.approx(abs(moved), abs=0.03)


def test_two_jumps_of_one_log_are_two_slips() -> None:
    one = jumping(100, 0.3, 0.0)
    both = replace(one, place=one.place + 0.3j * (np.arange(COUNT) >= 300))
    found = find(fit_of([(0.0, STEP * COUNT)]), [both])
    assert sorted(round(slip.start) for _, slip in found) == pytest.approx([50, 150], abs=3)


def test_walks_noise_and_glitches_are_no_slips() -> None:
    """Random walks of all levels, and one pose that is far off, of odometry or of the reference."""
    for level in LEVELS.values():
        one = track(np.random.default_rng(3), level, 0.1)
        glitch = replace(one, seen=one.seen + 5.0 * (np.arange(COUNT) == 200))
        assert find(fit_of([(0.0, STEP * COUNT)]), [one]) == []
        assert find(fit_of([(0.0, STEP * COUNT)]), [glitch]) == []


def test_no_track_has_no_slip() -> None:
    assert find(fit_of([(0.0, 1.0)]), []) == []
    short = track(np.random.default_rng(1), SMALL, 0.0)
    few = Track(
        0, *(getattr(short, name)[:4] for name in ("t", "place", "heading", "seen", "theta", "travelled"))
    )
    assert find(fit_of([(0.0, 1.0)]), [few]) == []


def test_legs_are_cut_at_slips() -> None:
    """A slip ends a leg and begins another; parts with fewer than three poses are dropped, but never all."""
    fit = fit_of([(0.0, 100.0), (100.5, 199.5)], [(0.0, 199.5)])
    slips = [(0, Slip("run-0", 40.0, 41.0, 1.0, 0.0)), (0, Slip("run-0", 198.9, 199.9, 1.0, 0.0))]
    first, second = without(fit, slips)
    assert first.tolist() == [[0.0, 40.0], [41.0, 100.0], [100.5, 198.9]]
    assert second.tolist() == [[0.0, 199.5]]
    (kept,) = without(fit_of([(0.0, 1.4)]), [(0, Slip("run-0", 0.2, 1.3, 1.0, 0.0))])
    assert kept.tolist() == [[0.0, 1.4]]
