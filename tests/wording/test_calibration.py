"""What `wmrgen calibrate` says: the verdict first, and what to do in each refusal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.tools.calibration.drives import change_references, derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders
from tests.tools.calibration.test_command import loaded_and_empty
from tests.tools.calibration.test_reading import LOG as READINGS
from tests.tools.calibration.test_reading import log_of, without
from tests.tools.calibration.test_turns import LAYOUT, _spot
from wmrgen.errors import UsageError
from wmrgen.tools.calibration.calibrate import calibrate
from wmrgen.tools.calibration.notes import notes

Cli = Callable[..., Outcome]


def test_the_verdict_comes_first(tmp_path: Path, wmrgen_cli: Cli) -> None:
    (tmp_path / "robot.yaml").write_text(LAYOUT.text, encoding="utf-8")
    paths = written(tmp_path, LAYOUT, seconds=20, rate=10)
    good = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths).out.splitlines()
    assert good[0] == "differential_with_castor: 3 drives, 60 s"
    assert good[1].startswith("  the new values predict drives that were left out: ")
    bad = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *loaded_and_empty(tmp_path)).out.splitlines()
    assert bad[1].startswith("  the new values do not predict drives that were left out, DO NOT USE THEM: ")


def test_what_is_not_determined_is_named(tmp_path: Path) -> None:
    layout = replace(LAYOUTS["differential"], drives=(lambda t: (0.3 + 0.1 * np.sin(t), 0 * t, 0 * t),) * 2)
    paths = written(tmp_path, layout, seconds=20, rate=10, encoders=Encoders(slip=0.01))
    robot = derived(layout.text)
    assert "These drives do not determine half_track. It stays nominal." in notes(
        robot.robot, calibrate(robot, paths)
    )


def test_possible_numbers_of_turns_are_listed(tmp_path: Path) -> None:
    layout = replace(LAYOUT, true={"radius": 0.033, "track": 0.176}, drives=(partial(_spot, 8),))
    paths = written(tmp_path, layout, seconds=34, rate=10)

    def ends(rows: np.ndarray) -> np.ndarray:
        return np.column_stack([rows[:, :3], (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi])[[0, -1]]

    change_references(paths, ends)
    robot = derived(layout.text)
    said = next(note for note in notes(robot.robot, calibrate(robot, paths)) if "turns" in note)
    assert said.startswith("The reference does not determine how often the robot turned. ")
    assert " 8 turns" in said and said.endswith("Record cumulative headings, or more poses on the way.")


def test_what_to_write_instead_of_a_column(tmp_path: Path) -> None:
    log = {**without(READINGS, "left.angle"), "left.counts": READINGS["left.angle"]}
    with pytest.raises(UsageError) as refusal:
        log_of(tmp_path, log)
    assert refusal.value.what.endswith(
        "left.counts needs counts per turn: write encoder: of left in the robot file"
    )
