"""Logs that are hard to read: wheels that spin, quantities that are missing, references that are wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.tools.calibration.drives import change_references, copied, derived, written
from tests.tools.calibration.simulated import AHEAD, LAYOUTS, Encoders, Reals, Tracker
from tests.tools.calibration.test_diagnoses import robot_of
from tests.tools.calibration.test_laws import check_same, copies, logs, plain  # noqa: F401
from tests.tools.calibration.test_noise import track
from tests.tools.calibration.test_simulated_robots import (
    NOISY,
    ROUGH,
    calibrated,
    check_within,
    some,
)
from wmrgen.errors import UsageError
from wmrgen.tools.calibration.calibrate import calibrate
from wmrgen.tools.calibration.noise import noise

pytestmark = pytest.mark.slow

SLIPS = ((7.0, 7.6, 1.8), (20.0, 20.4, 0.3))  # first and last time [s], and how far the wheel turns


@pytest.mark.parametrize("name", some(("differential", "mecanum", "swerve", "tricycle"), ("mecanum",)))
def test_a_wheel_that_spins_for_a_second_in_every_drive(tmp_path: Path, name: str) -> None:
    layout = LAYOUTS[name]
    first = next(iter(layout.wheels(layout.true)))
    encoders = replace(ROUGH, episodes=((10.0, 11.0, first, 2.5),))
    check_within(calibrated(tmp_path, layout, tracker=NOISY, encoders=encoders), layout, most=0.02)


def test_a_long_drive_with_large_slips(tmp_path: Path) -> None:
    """Slips of 1 s turn the robot by more than a radian in all, and the clock is 0.9 s off."""
    layout = replace(LAYOUTS["differential"], drives=AHEAD[:1])
    episodes = ((13.3, 14.4, "right", 2.5), (31.0, 31.8, "right", 2.5), (61.0, 62.1, "right", 2.5))
    tracker = Tracker(0.04, late=0.9, noise=(0.002, 0.003), every=2)
    encoders = Encoders(2 * np.pi / 1000, slip=0.005, episodes=episodes)
    result = calibrated(tmp_path, layout, seconds=80, rate=20, tracker=tracker, encoders=encoders)
    assert result.clocks["run-0"].value == pytest.approx(0.9, abs=0.02)
    assert len(result.slips) == len(episodes)
    check_within(result, layout)


def test_headings_alone_without_noise(tmp_path: Path) -> None:
    """They determine the ratio of radii to track."""
    layout = LAYOUTS["differential"]
    blank = partial(change_references, change=lambda rows: rows * (1, np.nan, np.nan, 1))
    value = {name: e.value for name, e in calibrated(tmp_path, layout, blank).parameters.items()}
    for name in ("r_left", "r_right"):
        expected = layout.true[name] / layout.true["half_track"]
        assert value[name] / value["half_track"] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("measured", [(1, 1, 1, np.nan), (1, np.nan, np.nan, 1)], ids=["places", "headings"])
def test_incomplete_poses_have_a_verdict(
    tmp_path: Path, measured: tuple[float, ...], wmrgen_cli: Callable[..., Outcome]
) -> None:
    """Places without headings, and headings without places, give errors that can be compared."""
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = written(tmp_path, layout, seconds=20, rate=10, tracker=NOISY, encoders=ROUGH)
    change_references(paths, lambda rows: rows * measured)
    outcome = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths, "--json")
    assert outcome.code == 0 and "NaN" not in outcome.out
    assert json.loads(outcome.out)["better"] is not False


def test_a_reference_in_milliseconds_is_refused(tmp_path: Path) -> None:
    """None of its poses but the first is in the log."""
    with pytest.raises(UsageError):
        calibrated(
            tmp_path, LAYOUTS["differential"], partial(change_references, change=lambda rows: rows * (1e3, 1, 1, 1)),
            seconds=10, rate=5,
        )  # fmt: skip


def test_noise_levels_on_arcs() -> None:
    """On an arc a heading error swings the pose by less than on a straight line of the same travel."""
    random, level = np.random.default_rng(4), (4e-6, 9e-6, 4e-6, 9e-6)
    found = noise([track(random, level, 0.2) for _ in range(40)])
    values = found.position_walk, found.heading_walk, found.position, found.heading
    for value, true in zip(values, level, strict=True):
        assert value == pytest.approx(true, rel=0.25)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("tricycle-square", lambda rows: rows[:, [0, 2, 1, 3]]),
        ("omni3-square", lambda rows: rows * (1, 1 / 0.3048, 1 / 0.3048, 1)),
        ("tricycle-square", lambda rows: rows * (1, 1, -1, -1)),
        ("diff-square", lambda rows: rows * (1, 1, -1, 1)),
    ],
    ids=["x and y exchanged", "feet", "y right and theta clockwise", "y right"],
)
def test_wrong_references_are_refused(tmp_path: Path, name: str, change: Callable[[Reals], Reals]) -> None:
    paths = copied(tmp_path, name)
    change_references(paths, change)
    with pytest.raises(UsageError):
        calibrate(robot_of(name), paths)


@pytest.mark.parametrize("off", [0.1, 0.05])
def test_drives_that_contradict_each_other_are_refused(tmp_path: Path, off: float) -> None:
    """The track of one drive is as much narrower as that of the other is wider, so a fit of both stays nominal."""
    layout = LAYOUTS["differential"]
    every = []
    for name, share, drive in (("a", 1 - off, AHEAD[0]), ("b", 1 + off, AHEAD[1])):
        true = {**layout.true, "half_track": share * layout.true["half_track"]}
        (tmp_path / name).mkdir()
        one = replace(layout, true=true, drives=(drive,))
        every += written(tmp_path / name, one, seconds=24, tracker=NOISY, encoders=ROUGH)
    with pytest.raises(UsageError, match=r"half_track is 0\.1\d+ by run-0, 0\.2\d+ by run-0"):
        calibrate(derived(layout.text), every, [path.with_suffix(".truth.csv") for path in every])


def test_values_without_a_verdict_must_explain_their_own_drives(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """Two lines that need radii 10 % apart: the mean radius is the nominal one."""
    robot = tmp_path / "robot.yaml"
    robot.write_text(
        "wmrgen: 1\nname: lines\nparameters:\n  r: {value: 0.1, tunable: true}\nwheels:\n"
        "  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: r}\n"
        "  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: r}\n"
    )
    for name, metres in (("a", 3.8), ("b", 4.2)):
        angle = 40.0  # [rad]: 4 m by the nominal radius
        rows = "".join(f"{t},{angle * t / 20:.6f},{angle * t / 20:.6f}\n" for t in range(21))
        (tmp_path / f"{name}.csv").write_text(f"t,left.angle,right.angle\n{rows}")
        (tmp_path / f"{name}.truth.csv").write_text(f"t,x,y,theta\n0,0,0,0\n20,{metres},0,0\n")
    out = tmp_path / "new.yaml"
    outcome = wmrgen_cli("calibrate", robot, tmp_path / "a.csv", tmp_path / "b.csv", "-o", out)
    assert outcome.code == 1 and not out.exists()
