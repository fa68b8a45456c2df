"""Mistakes in logs: each rule undoes its mistake, and refusals name what was wrong with real logs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import wmrgen
from tests.tools.calibration.drives import LOGS, change_references, change_rows, copied, rows_of
from tests.tools.calibration.simulated import Reals
from wmrgen.errors import UsageError
from wmrgen.tools.calibration.calibrate import calibrate, counts_per_turn, increments_of
from wmrgen.tools.calibration.diagnoses import RULES, misfit, unlikely
from wmrgen.tools.calibration.logs import Log, Poses
from wmrgen.tools.calibration.model import LEVER
from wmrgen.tools.calibration.reading import Recording, read

DEGREES = 180 / np.pi


@cache
def robot_of(name: str) -> wmrgen.Derivation:
    return wmrgen.derive(wmrgen.load(LOGS / name / "robot.yaml"))


@cache
def log_of(name: str) -> Log:
    """Return the first real log of a robot."""
    log = LOGS / name / "run-01.csv"
    robot = robot_of(name)
    joints = increments_of(robot)[0].joints
    return read(Recording("run", log, log.with_suffix(".truth.csv")), joints, counts_per_turn(robot.robot))


def with_columns(log: Log, ending: str, factor: float) -> Log:
    """Return the log with other numbers in the columns with an ending."""
    return replace(log, columns={n: c * factor if n.endswith(ending) else c for n, c in log.columns.items()})


def with_poses(log: Log, x: float = 1.0, y: float = 1.0, theta: float = 1.0) -> Log:
    poses = log.poses
    return replace(log, poses=Poses(poses.t, x * poses.x, y * poses.y, theta * poses.theta))


def exchanged(log: Log, a: str, b: str) -> Log:
    return replace(log, columns={**log.columns, a: log.columns[b], b: log.columns[a]})


# The mistake as somebody makes it, the code of the rule, and the robot.
MISTAKES: dict[str, tuple[Callable[[Log], Log], str, str]] = {
    "left and right exchanged": (lambda o: exchanged(o, "left.spin", "right.spin"), "wheels-exchanged", "diff-square"),
    "two of three": (lambda o: exchanged(o, "wheel1.spin", "wheel3.spin"), "wheels-exchanged", "omni3-square"),
    "one backwards": (lambda log: with_columns(log, "left.spin", -1.0), "wheel-backwards", "diff-square"),
    "all backwards": (lambda log: with_columns(log, ".spin", -1.0), "wheel-backwards", "omni3-square"),
    "steering backwards": (lambda log: with_columns(log, ".steer", -1.0), "steering-sign", "tricycle-square"),
    "steering in degrees": (lambda log: with_columns(log, ".steer", DEGREES), "steering-sign", "tricycle-circle"),
    "wheels in degrees": (lambda log: with_columns(log, ".spin", DEGREES), "wheel-unit", "diff-square"),
    "wheels in turns": (lambda log: with_columns(log, ".spin", 0.5 / np.pi), "wheel-unit", "omni3-square"),
    "speeds in rpm": (lambda log: with_columns(log, ".spin", 30 / np.pi), "wheel-unit", "diff-square"),
    "millimetres": (partial(with_poses, x=1000, y=1000), "reference-length", "diff-square"),
    "centimetres": (partial(with_poses, x=100, y=100), "reference-length", "tricycle-square"),
    "inches": (partial(with_poses, x=1 / 0.0254, y=1 / 0.0254), "reference-length", "omni3-square"),
    "feet": (partial(with_poses, x=1 / 0.3048, y=1 / 0.3048), "reference-length", "diff-square"),
    "headings in degrees": (partial(with_poses, theta=DEGREES), "reference-degrees", "diff-square"),
    "headings clockwise": (partial(with_poses, theta=-1.0), "reference-mirrored", "diff-square"),
    "north, east, clockwise": (partial(with_poses, y=-1.0, theta=-1.0), "reference-mirrored", "tricycle-square"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_rule_undoes_its_mistake(mistake: str) -> None:
    """One of its readings of the wrong log is the right log, and no reading of another rule is."""
    change, code, name = MISTAKES[mistake]
    right = log_of(name)
    wrong = change(right)
    assert not same(wrong, right)
    undone = [
        rule.code for rule in RULES for _, reading in rule.readings(wrong) if same(reading(wrong), right)
    ]
    assert undone == [code]


def same(one: Log, other: Log) -> bool:
    """Return whether two logs have the same numbers."""
    pairs = [(one.columns[name], other.columns[name]) for name in one.columns]
    pairs += [(getattr(one.poses, axis), getattr(other.poses, axis)) for axis in ("t", "x", "y", "theta")]
    return all(np.allclose(a, b, rtol=1e-9, atol=1e-12) for a, b in pairs)


def test_there_are_at_most_eight_rules() -> None:
    codes = [rule.code for rule in RULES]
    assert len(codes) == len(set(codes)) <= 8
    assert {code for _, code, _ in MISTAKES.values()} == set(codes)


@pytest.mark.parametrize("name", ["diff-square", "omni3-square", "tricycle-circle", "tricycle-square"])
def test_every_reading_changes_the_log(name: str) -> None:
    log = log_of(name)
    words = []
    for rule in RULES:
        for text, reading in rule.readings(log):
            words.append(text)
            assert not same(reading(log), log)
    assert len(words) == len(set(words))


def shortened(folder: Path, name: str, seconds: float) -> list[Path]:
    """Copy the first seconds of two real logs."""
    paths = copied(folder, name)
    for path in paths:
        change_rows(path, lambda rows: rows[rows[:, 0] < seconds])
    change_references(paths, lambda rows: rows[rows[:, 0] < seconds])
    return paths


def times(rows: Reals, which: slice | int, factor: float) -> Reals:
    changed = rows.copy()
    changed[:, which] *= factor
    return changed


FILES: dict[str, tuple[str, slice | int, float, str]] = {
    "headings in degrees": ("truth", 3, DEGREES, "theta .* degrees"),
    "millimetres": ("truth", slice(1, 3), 1000.0, "millimetres"),
    "headings clockwise": ("truth", 3, -1.0, "theta .* clockwise"),
    "wheels in turns": ("log", slice(1, 3), 0.5 / np.pi, "turns"),
}


@pytest.mark.slow
@pytest.mark.parametrize("mistake", FILES)
def test_a_refusal_names_the_mistake(tmp_path: Path, mistake: str) -> None:
    """In the first 40 s of two real drives."""
    paths = shortened(tmp_path, "diff-square", 40.0)
    file, which, factor, said = FILES[mistake]
    for path in paths:
        change_rows(
            path.with_suffix(".truth.csv" if file == "truth" else ".csv"),
            partial(times, which=which, factor=factor),
        )
    with pytest.raises(UsageError, match=said):
        calibrate(robot_of("diff-square"), paths)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("which", "factor", "said"),
    [(1, -1.0, r"right\.spin counts the other way"), (slice(1, None), DEGREES, "wheels are in degrees")],
)
def test_a_mistake_that_parameters_absorb_is_named(
    tmp_path: Path, which: int | slice, factor: float, said: str
) -> None:
    """Radii that are negative or tiny explain the logs as well, but no robot has them."""
    paths = shortened(tmp_path, "diff-square", 40.0)
    for path in paths:
        change_rows(path, partial(times, which=which, factor=factor))
    with pytest.raises(UsageError, match=said):
        calibrate(robot_of("diff-square"), paths)


@pytest.mark.slow
def test_steering_in_degrees_is_named(tmp_path: Path) -> None:
    paths = shortened(tmp_path, "tricycle-circle", 40.0)
    column = rows_of(paths[0])[0].index("front.steer")
    for path in paths:
        change_rows(path, partial(times, which=column, factor=DEGREES))
    with pytest.raises(UsageError, match=r"steering angles .* degrees"):
        calibrate(robot_of("tricycle-circle"), paths)


@pytest.mark.slow
def test_references_of_other_drives_are_refused(tmp_path: Path) -> None:
    """The reference of each drive is that of a circle of another robot: no rule explains it."""
    paths = shortened(tmp_path, "diff-square", 40.0)
    for path in paths:
        other = LOGS / "tricycle-circle" / path.name
        path.with_suffix(".truth.csv").write_bytes(other.with_suffix(".truth.csv").read_bytes())
    change_references(paths, lambda rows: rows[rows[:, 0] < 40])
    with pytest.raises(UsageError, match=r"\d m off|would be") as refusal:
        calibrate(robot_of("diff-square"), paths)
    assert "They would agree" not in refusal.value.what


def fit_of(values: list[float], nominal: list[float]) -> Any:
    return SimpleNamespace(
        problem=SimpleNamespace(nominal=np.array(nominal), increments=SimpleNamespace(parameters=["a", "b"])),
        state=SimpleNamespace(shared=np.array([*values, 0.0, 0.0, 0.0])),
    )


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ([0.1, 0.2], []), ([0.19, 0.2], []), ([0.051, 0.2], []), ([0.21, 0.2], ["a"]), ([0.049, 0.2], ["a"]),
        ([-0.1, 0.2], ["a"]), ([0.3, -0.2], ["a", "b"]),
    ],
)  # fmt: skip
def test_values_that_no_tape_measure_gives(values: list[float], named: list[str]) -> None:
    assert [text.split()[0] for text in unlikely(fit_of(values, [0.1, 0.2]))] == named


def test_an_angle_that_is_nominally_zero_may_be_anything() -> None:
    assert unlikely(fit_of([1.3, 0.2], [0.0, 0.2])) == []


def test_a_misfit_is_relative_to_the_extent_of_the_drive() -> None:
    """Above 1 from a twentieth of it on, of half a metre for a robot on the spot, and from 0.25 rad on."""
    line = np.linspace(0, 4, 50)

    def of(error: float, extent: float, heading: float = 0.0) -> float:
        log = SimpleNamespace(poses=SimpleNamespace(x=extent / 4 * line, y=0 * line))
        values = np.repeat([[error], [error], [LEVER * heading]], 50, axis=1)
        rows = SimpleNamespace(values=values, weights=np.ones((3, 50)))
        fit: Any = SimpleNamespace(problem=SimpleNamespace(logs=[log]), rows=[rows])
        return misfit(fit)

    assert of(0.21, 4.0) > 1 > of(0.19, 4.0)
    assert of(0.026, 0.0) > 1 > of(0.024, 0.0)
    assert of(0.0, 4.0, 0.26) > 1 > of(0.0, 4.0, 0.24)
