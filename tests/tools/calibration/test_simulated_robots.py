"""Parameters of simulated robots, which share no code with wmrgen, are found from their logs."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tools.calibration.drives import change_references, change_rows, derived, written
from tests.tools.calibration.simulated import (
    ANYWHERE,
    LAYOUTS,
    Encoders,
    Layout,
    Reals,
    Tracker,
    Wheel,
)
from wmrgen.tools.calibration.calibrate import Calibration, calibrate

ROUGH = Encoders(resolution=2 * np.pi / 400, slip=0.01)
NOISY = Tracker(0.03 - 0.02j, late=0.1, noise=(0.002, 0.003))
EVERYDAY = ("differential", "tricycle", "mecanum", "swerve")  # one of each kind of wheel; the others are slow


def some(names: tuple[str, ...], everyday: tuple[str, ...] = EVERYDAY) -> list[Any]:
    """Return cases, those that are not everyday marked slow."""
    return [pytest.param(n, marks=[] if n in everyday else pytest.mark.slow) for n in names]


def calibrated(
    folder: Path, layout: Layout, change: Callable[[list[Path]], object] = list, **options: Any
) -> Calibration:
    """Calibrate from the logs of all drives of a layout; options as of `drive`."""
    paths = written(folder, layout, **options)
    change(paths)
    return calibrate(derived(layout.text), paths)


def check_within(result: Calibration, layout: Layout, deviations: float = 3.0, most: float = 0.01) -> None:
    """Check that true values are within so many standard deviations, and that these are small against nominal."""
    for name, true in layout.true.items():
        estimate = result.parameters[name]
        assert estimate.sigma is not None, name
        assert abs(estimate.value - true) < deviations * estimate.sigma, name
        assert estimate.sigma < most * (abs(estimate.nominal) or 1.0), name


def weak_parameters(result: Calibration) -> set[str]:
    """Return the parameters that the logs do not determine alone."""
    return {n for group in result.unobservable for n in group if not n.startswith("mount.")}


@pytest.mark.parametrize("name", some(tuple(LAYOUTS)))
def test_clean_drives_give_the_true_parameters(tmp_path: Path, name: str) -> None:
    """Unequal wheels, a tracked point beside the robot's own, and a clock that is off are told apart."""
    layout = LAYOUTS[name]
    result = calibrated(tmp_path, layout, tracker=Tracker(0.04 - 0.07j, late=0.13))
    for parameter, value in layout.true.items():
        weak = parameter in layout.together
        assert result.parameters[parameter].observable != weak
        if not weak:
            assert result.parameters[parameter].value == pytest.approx(value, rel=3e-4, abs=2e-4)
    assert weak_parameters(result) == set(layout.together)
    if len(layout.together) == 1:
        (name,) = layout.together
        assert result.parameters[name].value == result.parameters[name].nominal
    if not layout.together:
        mount = [result.mount[axis].value for axis in ("x", "y", "theta")]
        assert mount == pytest.approx([0.04, -0.07, 0.0], abs=2e-3)
    assert [clock.value for clock in result.clocks.values()] == pytest.approx(
        [0.13] * len(layout.drives), abs=3e-3
    )
    assert result.verdict is not None and result.verdict.better and result.verdict.held_out.position < 0.01
    assert not result.slips and not result.alternatives


ANGLES = (np.pi, np.pi / 2, -1.8)
TURNED = [(name, ANGLES[index % 3]) for index, name in enumerate(LAYOUTS)]


@pytest.mark.parametrize(
    ("name", "turned"),
    [
        pytest.param(name, turned, marks=[] if name == "differential" else pytest.mark.slow)
        for name, turned in TURNED
    ],
)
def test_a_tracker_that_is_turned_on_the_robot(tmp_path: Path, name: str, turned: float) -> None:
    """By any angle, far beside the robot, its clock late, the drive anywhere: no radius becomes negative."""
    layout = LAYOUTS[name]
    tracker = Tracker(-0.3 + 0.5j, turned, late=-0.3, every=5, start=(3 - 2j, 2.6))
    result = calibrated(tmp_path, layout, tracker=tracker)
    for parameter in set(layout.true) - set(layout.together):
        assert result.parameters[parameter].value == pytest.approx(layout.true[parameter], rel=3e-4, abs=2e-4)
    if "zero" not in layout.together:
        assert np.cos(result.mount["theta"].value - turned) == pytest.approx(1, abs=1e-5)
    assert result.after.position < 0.005


@pytest.mark.parametrize("name", some(("differential", "tricycle", "swerve", "mecanum"), ("differential",)))
def test_nominal_values_far_off_and_long_drives(tmp_path: Path, name: str) -> None:
    """Nominal odometry loses its way within the drive; short legs lead to the parameters."""
    layout = LAYOUTS[name]
    far = re.sub(r"value: (0\.\d+)", lambda m: f"value: {1.25 * float(m[1]):.6g}", layout.text)
    assert far != layout.text
    layout = replace(layout, text=far)
    tracker = Tracker(0.03 - 0.02j, 1.0, noise=(0.002, 0.003), start=(2j, -1.0))
    encoders = Encoders(resolution=2 * np.pi / 1000, slip=0.003)
    result = calibrated(tmp_path, layout, seconds=120, rate=10, tracker=tracker, encoders=encoders)
    check_within(result, layout, 3.5)


PLACES = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}
MODULES = Layout(
    "wmrgen: 1\nname: modules\nparameters:\n"
    + "".join(f"  r_{n}: {{value: 0.05, tunable: true}}\n" for n in PLACES)
    + "".join(f"  zero_{n}: {{value: 0, tunable: true}}\n" for n in PLACES)
    + "wheels:\n"
    + "".join(
        f"  - {{name: {n}, type: steered, x: {x}, y: {y}, heading: zero_{n}, r: r_{n}}}\n"
        for n, (x, y) in PLACES.items()
    ),
    lambda p: {n: Wheel(x, y, p[f"zero_{n}"], p[f"r_{n}"], steered=True) for n, (x, y) in PLACES.items()},
    {
        **{f"r_{n}": r for n, r in zip(PLACES, (0.050975, 0.05014, 0.049715, 0.049675), strict=True)},
        **{f"zero_{n}": zero for n, zero in zip(PLACES, (0.0164, 0.0232, 0.001, 0.0144), strict=True)},
    },
    ANYWHERE,
)


@pytest.mark.slow
def test_four_radii_and_four_zeros_of_a_swerve_drive(tmp_path: Path) -> None:
    """The paths alone leave directions open; the joints, which have to agree with one another, determine them."""
    result = calibrated(tmp_path, MODULES, rate=20, tracker=NOISY, encoders=ROUGH)
    check_within(result, MODULES)
    for name, value in MODULES.true.items():
        assert result.parameters[name].value == pytest.approx(value, abs=1e-3)


def test_skid_steer_by_counts(tmp_path: Path) -> None:
    """Counts of an encoder give the same as angles; the effective track is 1.4 times the nominal one."""
    encoder = "encoder: {spin: {counts: 1000, gear: 2, bits: 32}}\n"
    layout = replace(LAYOUTS["skid_steer"], text=LAYOUTS["skid_steer"].text + encoder)

    def counted(paths: list[Path]) -> None:
        for path in paths:
            change_rows(
                path, lambda rows: np.column_stack([rows[:, 0], np.round(rows[:, 1:] * 2000 / 2 / np.pi)])
            )
            path.write_text(path.read_text(encoding="utf-8").replace("angle", "counts"), encoding="utf-8")

    result = calibrated(tmp_path, layout, counted, tracker=NOISY, encoders=Encoders(slip=0.01))
    check_within(result, layout)


@pytest.mark.parametrize("late", [-0.25, 0.25])
def test_clocks_that_are_off(tmp_path: Path, late: float) -> None:
    result = calibrated(tmp_path, LAYOUTS["differential"], tracker=replace(NOISY, late=late), encoders=ROUGH)
    check_within(result, LAYOUTS["differential"])
    for clock in result.clocks.values():
        assert clock.sigma is not None and abs(clock.value - late) < 3 * clock.sigma < 0.05


def test_rows_that_are_dropped(tmp_path: Path) -> None:
    """A third of the readings, and half of the reference poses, at random."""
    random = np.random.default_rng(1)

    def kept(share: float, rows: Reals) -> Reals:
        return rows[(random.random(len(rows)) < share) | (np.arange(len(rows)) == 0)]

    def drop(paths: list[Path]) -> None:
        for path in paths:
            change_rows(path, partial(kept, 0.7))
        change_references(paths, partial(kept, 0.5))

    result = calibrated(tmp_path, LAYOUTS["differential"], drop, tracker=NOISY, encoders=ROUGH)
    check_within(result, LAYOUTS["differential"])


def test_wrapped_headings_give_what_others_give(tmp_path: Path) -> None:
    """Headings between -pi and pi, of poses so close that nothing is in doubt."""

    def wrap(rows: Reals) -> Reals:
        return np.column_stack([rows[:, :3], (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi])

    layout, options = LAYOUTS["differential"], {"tracker": NOISY, "encoders": ROUGH}
    plain = calibrated(tmp_path, layout, **options)
    wrapped = calibrated(tmp_path, layout, partial(change_references, change=wrap), **options)
    assert not wrapped.alternatives
    for name, estimate in plain.parameters.items():
        assert wrapped.parameters[name].value == pytest.approx(estimate.value, rel=1e-6)


@pytest.mark.parametrize("wrapped", [pytest.param(False, marks=pytest.mark.slow), True])
def test_starts_and_ends_alone(tmp_path: Path, wrapped: bool) -> None:
    """Three drives that turn by more than a turn: enough if the tracked point and the clocks are known, not else."""

    def ends(rows: Reals) -> Reals:
        turned = (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi if wrapped else rows[:, 3]
        return np.column_stack([rows[:, :3], turned])[[0, -1]]

    layout, paths = LAYOUTS["differential"], written(tmp_path, LAYOUTS["differential"], rate=10)
    change_references(paths, change=ends)
    derivation = derived(layout.text)
    alone = calibrate(derivation, paths)
    assert {"mount.x", "r_left"} <= {name for group in alone.unobservable for name in group}
    result = calibrate(derivation, paths, mount=(0.0, 0.0, 0.0), one_clock=True)
    for parameter, value in layout.true.items():
        estimate = result.parameters[parameter]
        assert estimate.value == pytest.approx(value, rel=1e-3) and estimate.observable


def test_headings_alone_determine_the_ratio_of_radii_to_track(tmp_path: Path) -> None:
    """As a gyro gives them. They do not determine the scale."""
    layout = LAYOUTS["differential"]
    blank = partial(change_references, change=lambda rows: rows * (1, np.nan, np.nan, 1))
    result = calibrated(tmp_path, layout, blank, tracker=NOISY, encoders=ROUGH)
    assert weak_parameters(result) == set(layout.true)
    value = {name: estimate.value for name, estimate in result.parameters.items()}
    for name in ("r_left", "r_right"):
        expected = layout.true[name] / layout.true["half_track"]
        assert value[name] / value["half_track"] == pytest.approx(expected, rel=1e-3)


def test_places_alone(tmp_path: Path) -> None:
    """x and y without a heading determine all parameters."""
    layout = LAYOUTS["differential"]
    blank = partial(change_references, change=lambda rows: rows * (1, 1, 1, np.nan))
    result = calibrated(tmp_path, layout, blank, tracker=NOISY, encoders=ROUGH)
    check_within(result, layout)


def test_a_tracker_that_glitches(tmp_path: Path) -> None:
    """One pose in a hundred is metres off: it moves no parameter, and no standard deviation by much."""
    layout, options = (
        LAYOUTS["differential"],
        {"tracker": Tracker(noise=(0.001, 0.002)), "encoders": Encoders(0.002)},
    )
    clean = calibrated(tmp_path, layout, **options)

    def glitch(rows: Reals) -> Reals:
        return rows + 5 * np.outer(np.arange(len(rows)) % 97 == 3, (0, 1, 0, 0))

    result = calibrated(tmp_path, layout, partial(change_references, change=glitch), **options)
    assert not result.unobservable
    check_within(result, layout)
    for name, estimate in result.parameters.items():
        before = clean.parameters[name].sigma
        assert estimate.sigma is not None and before is not None and estimate.sigma < 10 * before


def test_a_log_that_covers_a_part_of_the_reference(tmp_path: Path) -> None:
    """Poses before the first and after the last reading move no parameter."""

    def shorter(paths: list[Path]) -> None:
        for path in paths:
            change_rows(path, lambda rows: rows[(rows[:, 0] > 6) & (rows[:, 0] < 24)])

    layout = LAYOUTS["differential"]
    result = calibrated(tmp_path, layout, shorter)
    for parameter, value in layout.true.items():
        assert result.parameters[parameter].value == pytest.approx(value, rel=3e-4)


def _square(way: int, t: Reals) -> tuple[Reals, Reals, Reals]:
    """Drive a square with sides of 1 m once, with turns on the spot, and rest for a second before and after."""
    within, driven = np.mod(t - 1, 5.0), (t > 1) & (t < 21)
    ahead = driven & (within < 3)
    return 0.33 * ahead, 0 * t, way * np.pi / 4 * (driven & ~ahead)


@pytest.mark.parametrize("name", some(("differential", "mecanum"), ("differential",)))
def test_squares_of_which_the_ends_are_measured(tmp_path: Path, name: str) -> None:
    """UMBmark: the robot returns to its start, whatever its size is. Ratios are determined, the scale stays nominal."""
    layout = replace(LAYOUTS[name], drives=tuple(partial(_square, way) for way in (1, -1) * 2))
    ends = partial(change_references, change=lambda rows: rows[[0, -1]])
    result = calibrated(
        tmp_path, layout, ends, seconds=22, rate=10, tracker=Tracker(late=0.1), encoders=ROUGH
    )
    assert result.unobservable
    for estimate in result.parameters.values():
        assert abs(estimate.value / estimate.nominal - 1) < 0.06
    assert result.verdict is not None and result.verdict.better and result.verdict.held_out.position < 0.03
    if name == "differential":
        ratio = result.parameters["r_left"].value / result.parameters["r_right"].value
        assert ratio == pytest.approx(layout.true["r_left"] / layout.true["r_right"], rel=0.003)


def test_a_turn_on_the_spot_determines_the_ratio_of_track_to_radii(tmp_path: Path) -> None:
    """The reference extends over the noise of its tracker alone."""
    layout = replace(LAYOUTS["differential"], drives=(lambda t: (0 * t, 0 * t, 0.5 + 0 * t),))
    tracker = Tracker(noise=(0.008, 0.003))
    result = calibrated(tmp_path, layout, seconds=20, tracker=tracker, encoders=Encoders(slip=0.01))
    assert result.after.position < 0.016
    assert weak_parameters(result) == {"r_left", "r_right", "half_track"}
    value = {name: estimate.value for name, estimate in result.parameters.items()}
    ratio = value["half_track"] / (value["r_left"] + value["r_right"])
    assert ratio == pytest.approx(0.2071 / 0.2007, rel=0.003)


def _line(t: Reals, speed: float) -> tuple[Reals, Reals, Reals]:
    return speed + 0.1 * np.sin(0.5 * t), 0 * t, 0 * t


def test_straight_lines_determine_radii_and_no_track(tmp_path: Path) -> None:
    """Slips are all that the robot turns by. The track stays nominal."""
    layout = replace(LAYOUTS["differential"], drives=(partial(_line, speed=0.3),) * 3)
    tracker = Tracker(0.03 - 0.02j, noise=(0.002, 0.003))
    result = calibrated(tmp_path, layout, seconds=40, rate=20, tracker=tracker, encoders=ROUGH)
    assert ("half_track",) in result.unobservable
    assert result.parameters["half_track"].value == pytest.approx(0.2, rel=0.02)
    for parameter in ("r_left", "r_right"):
        estimate = result.parameters[parameter]
        assert (
            estimate.sigma is not None and abs(estimate.value - layout.true[parameter]) < 3 * estimate.sigma
        )


@pytest.mark.slow
def test_straight_lines_of_a_swerve_drive_determine_its_radii(tmp_path: Path) -> None:
    layout = LAYOUTS["swerve"]
    lines = tuple(partial(_line, speed=speed) for speed in (0.3, -0.3))
    tracker = Tracker(0.03 - 0.02j, noise=(0.002, 0.003))
    result = calibrated(
        tmp_path, replace(layout, drives=lines), seconds=40, rate=10, tracker=tracker, encoders=ROUGH
    )
    assert "half" in weak_parameters(result)
    for parameter in ("r_a", "r_b"):
        estimate = result.parameters[parameter]
        assert estimate.sigma is not None and estimate.value == pytest.approx(
            layout.true[parameter], rel=0.003
        )
    zeros = [result.parameters[name].value for name in ("zero_a", "zero_b")]
    assert zeros[1] - zeros[0] == pytest.approx(0.05, abs=0.005)


def test_what_only_appears_as_a_sum_is_named(tmp_path: Path) -> None:
    """No drive separates half length and half width of mecanum wheels."""
    mecanum = LAYOUTS["mecanum"]
    text = mecanum.text.replace("x: 0.25", "x: half_length").replace("x: -0.25", "x: -half_length")
    text = text.replace("parameters:\n", "parameters:\n  half_length: {value: 0.25, tunable: true}\n")
    text = text.replace("  tilt: {value: 0.7, tunable: true}\n", "  tilt: pi/4\n")
    true = {**mecanum.true, "tilt": np.pi / 4, "half_length": 0.25}
    result = calibrated(tmp_path, Layout(text, mecanum.wheels, true, mecanum.drives))
    assert [set(group) for group in result.unobservable] == [{"half_length", "half_width"}]
    assert result.parameters["r"].value == pytest.approx(mecanum.true["r"], rel=1e-4)
    both = sum(result.parameters[n].value for n in ("half_length", "half_width"))
    assert both == pytest.approx(0.25 + mecanum.true["half_width"], rel=1e-3)


def test_drives_in_which_every_wheel_is_still(tmp_path: Path) -> None:
    """A robot that never moved determines nothing, and everything stays nominal."""
    still = replace(LAYOUTS["differential"], drives=(lambda t: (0 * t, 0 * t, 0 * t),) * 2)
    result = calibrated(tmp_path, still, seconds=10, tracker=Tracker(noise=(0.002, 0.003)))
    assert weak_parameters(result) == set(still.true)
    for estimate in result.parameters.values():
        assert estimate.value == pytest.approx(estimate.nominal, rel=0.01) and estimate.sigma is None
