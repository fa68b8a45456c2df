"""The command: exit codes, files, and the keys of its JSON that other programs rely on."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml

import wmrgen
from tests.conftest import Outcome
from tests.tools.calibration.drives import change_rows, written
from tests.tools.calibration.simulated import LAYOUTS, Tracker, csv, drive

Cli = Callable[..., Outcome]
LAYOUT = LAYOUTS["differential_with_castor"]  # nominal: radius 0.033, track 0.16
ENCODER = "encoder: {spin: {counts: 1000, gear: 2, bits: 32}}\n"


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a robot file and three logs, which have their reference poses beside them."""
    folder = tmp_path_factory.mktemp("robot")
    (folder / "robot.yaml").write_text(LAYOUT.text, encoding="utf-8")
    written(folder, LAYOUT, seconds=20, rate=10)
    return folder


def runs(folder: Path) -> list[Path]:
    """Return what a shell makes of run-*.csv: the logs, and their reference poses."""
    return sorted(folder.glob("run-*.csv"))


def data_of(outcome: Outcome) -> dict[str, Any]:
    assert outcome.code in (0, 1), outcome.err
    data: dict[str, Any] = json.loads(outcome.out)
    return data


def test_the_keys_of_json(place: Path, wmrgen_cli: Cli) -> None:
    data = data_of(wmrgen_cli("calibrate", place / "robot.yaml", *runs(place), "--json"))
    assert data["better"] is True and data["unobservable"] == []
    for name, value in LAYOUT.true.items():
        entry = data["parameters"][name]
        assert entry["value"] == pytest.approx(value, rel=3e-4) and entry["observable"] is True
        assert 0 < entry["sigma"] < 1e-3 and entry["nominal"] in (0.033, 0.16)
    assert data["rms"] < 0.001 and data["rms_heading"] < 0.001
    assert np.shape(data["covariance"]) == (2, 2)
    for index, name in enumerate(data["parameters"]):
        assert data["covariance"][index][index] ** 0.5 == pytest.approx(data["parameters"][name]["sigma"])
    assert set(data["mount"]) == {"x", "y", "theta"} and set(data["clocks"]) == {"run-0", "run-1", "run-2"}
    assert set(data["errors"]) == {"before", "after", "nominal", "held_out"}
    assert data["errors"]["after"]["position"] == data["rms"] < data["errors"]["before"]["position"]
    assert set(data["noise"]) == {"position_walk", "heading_walk", "position", "heading"}
    assert data["slips"] == data["alternatives"] == [] and data["turns"] is None
    assert all(isinstance(note, str) for note in data["notes"])


def test_the_new_robot_file(place: Path, tmp_path: Path, wmrgen_cli: Cli) -> None:
    new = tmp_path / "new.yaml"
    outcome = wmrgen_cli("calibrate", place / "robot.yaml", *runs(place), "-o", new)
    assert outcome.code == 0, outcome.err
    tuned = {p.name: float(p.nominal) for p in wmrgen.load(new).tunable}
    assert tuned == pytest.approx(LAYOUT.true, rel=3e-4)
    for name, value in LAYOUT.true.items():
        printed = re.search(rf"{name} += (\S+)", outcome.out)
        assert printed is not None and float(printed[1]) == pytest.approx(value, rel=3e-4)
    assert (place / "robot.yaml").read_text(encoding="utf-8") == LAYOUT.text


def test_files_for_others(place: Path, tmp_path: Path, wmrgen_cli: Cli) -> None:
    """A picture of all drives and each parameter, what diff_drive_controller reads, and a macro for the C."""
    texts = []
    for name in ("one", "two"):
        folder = tmp_path / name
        outcome = wmrgen_cli("calibrate", place / "robot.yaml", *runs(place), "--files", folder)
        assert outcome.code == 0, outcome.err
        texts.append({path.name: path.read_text(encoding="utf-8") for path in sorted(folder.iterdir())})
    assert texts[0] == texts[1]
    files = texts[0]
    assert set(files) == {
        "robot.yaml", "differential_with_castor_calibration.svg", "differential_with_castor_controllers.yaml",
        "differential_with_castor_calibrated.h",
    }  # fmt: skip
    picture = ElementTree.fromstring(files["differential_with_castor_calibration.svg"])
    assert {"radius", "track"} <= {e.text for e in picture.iter("{http://www.w3.org/2000/svg}text")}
    ros = yaml.safe_load(files["differential_with_castor_controllers.yaml"])
    parameters = ros["base_controller"]["ros__parameters"]
    assert parameters["wheel_separation"] == pytest.approx(LAYOUT.true["track"], rel=1e-3)
    assert parameters["wheel_radius"] == pytest.approx(LAYOUT.true["radius"], rel=1e-3)
    macro = re.search(r"_CALIBRATED \{(.*)\}", files["differential_with_castor_calibrated.h"])
    assert macro is not None
    entries = dict(entry.strip().removeprefix(".").split(" = ") for entry in macro[1].split(","))
    assert {name: float(value) for name, value in entries.items()} == pytest.approx(LAYOUT.true, rel=1e-3)


def loaded_and_empty(folder: Path) -> list[Path]:
    """Write four drives of a robot whose track changes with its load, by 3 % to both sides of the nominal one."""
    paths = []
    for index, track in enumerate((0.155, 0.165) * 2):
        layout = replace(LAYOUT, true={"radius": 0.033, "track": track})
        recorded = drive(layout, layout.drives[index % 3], 20, 10, Tracker(noise=(0.002, 0.003)), seed=index)
        path = folder / f"run-{index}.csv"
        path.write_text(csv(recorded.log), encoding="utf-8")
        path.with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
        paths.append(path)
    return paths


def test_values_that_do_not_predict_other_drives_are_not_written(tmp_path: Path, wmrgen_cli: Cli) -> None:
    """Drives without a load give a track that predicts those with it worse than the nominal track does."""
    (tmp_path / "robot.yaml").write_text(LAYOUT.text, encoding="utf-8")
    paths, new, folder = loaded_and_empty(tmp_path), tmp_path / "new.yaml", tmp_path / "files"
    words = ("calibrate", tmp_path / "robot.yaml", *paths, "-o", new, "--files", folder)
    outcome = wmrgen_cli(*words, "--json")
    assert outcome.code == 1
    data = data_of(outcome)
    assert data["better"] is False
    assert data["errors"]["held_out"]["heading"] > 1.5 * data["errors"]["nominal"]["heading"]
    assert wmrgen_cli(*words).code == 1
    assert not new.exists() and not folder.exists()


def test_counts_and_radius_are_one_number(tmp_path: Path, wmrgen_cli: Cli) -> None:
    """A radius that is 2 % larger is an encoder with 2 % fewer counts."""
    (tmp_path / "robot.yaml").write_text(LAYOUT.text + ENCODER, encoding="utf-8")
    paths = written(tmp_path, LAYOUT, seconds=20, rate=10)
    for path in paths:
        change_rows(path, lambda rows: rows * [1, *[2000 / (2 * np.pi)] * (rows.shape[1] - 1)])
        path.write_text(path.read_text(encoding="utf-8").replace("angle", "counts"), encoding="utf-8")
    data = data_of(wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths, "--json"))
    counts = 2000 * 0.033 / LAYOUT.true["radius"]
    assert data["counts_per_turn"] == pytest.approx({"left.spin": counts, "right.spin": counts}, rel=3e-4)


def test_a_sum_that_is_determined_is_written(place: Path, tmp_path: Path, wmrgen_cli: Cli) -> None:
    """Two parts of the track: their sum is determined, and new radii would be wrong with the nominal sum."""
    text = LAYOUT.text.replace("track: {value: 0.16,", "a: {value: 0.06, tunable: true}\n  b: {value: 0.1,")
    text = text.replace("-track/2", "-(a + b)/2").replace("track/2", "(a + b)/2")
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    new = tmp_path / "new.yaml"
    outcome = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *runs(place), "--json", "-o", new)
    assert [set(group) for group in data_of(outcome)["unobservable"]] == [{"a", "b"}]
    tuned = {p.name: float(p.nominal) for p in wmrgen.load(new).tunable}
    assert tuned["a"] + tuned["b"] == pytest.approx(LAYOUT.true["track"], rel=3e-4)
    assert tuned["radius"] == pytest.approx(LAYOUT.true["radius"], rel=3e-4)


def test_plans(place: Path, wmrgen_cli: Cli) -> None:
    """Courses in json and in text; none are needed after drives that determine everything."""
    robot = place / "robot.yaml"
    planned = data_of(wmrgen_cli("calibrate", robot, "--plan", "--precision", "0.03", "--json"))
    assert planned["plan"] and planned["unobservable"] == []
    assert all(set(course) == {"drive", "seconds"} and course["seconds"] > 0 for course in planned["plan"])
    told = wmrgen_cli("calibrate", robot, "--plan", "--precision", "0.03").out
    assert len(told.splitlines()) == len(planned["plan"])
    assert data_of(wmrgen_cli("calibrate", robot, "--plan", "--precision", "1e-6", "--json"))["plan"] is None
    assert data_of(wmrgen_cli("calibrate", robot, *runs(place), "--plan", "--json"))["plan"] == []


def test_wrong_words(place: Path, tmp_path: Path, wmrgen_cli: Cli) -> None:
    robot, log = place / "robot.yaml", place / "run-0.csv"
    fixed = tmp_path / "fixed.yaml"
    fixed.write_text(LAYOUT.text.replace(", tunable: true", ""), encoding="utf-8")
    for words in (
        (robot,), (robot, place / "none.csv"), (robot, log, "--start-error=0"), (robot, log, "--start-error=-1"),
        (robot, log, "--start-error=nan"), (robot, log, "--mount=1,2"), (fixed, log), (robot, log, "--truth", log),
    ):  # fmt: skip
        assert wmrgen_cli("calibrate", *words).code == 2, words
