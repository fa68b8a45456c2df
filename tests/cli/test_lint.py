"""lint and explain as contracted; derive says the same findings on stderr and nothing else on stdout."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.tools.importing.urdf import robot, wheel
from wmrgen.tools.lint import RULES

Cli = Callable[..., Outcome]


@pytest.fixture
def swapped(robot_file: Path) -> Path:
    """A differential drive whose right wheel has beta = 0."""
    robot_file.write_text(robot_file.read_text().replace("beta: pi", "beta: 0"))
    return robot_file


def test_a_finding_has_place_line_caret_and_help(wmrgen_cli: Cli, swapped: Path) -> None:
    done = wmrgen_cli("lint", swapped)
    assert done.code == 1
    what, place, line, caret, instead = done.out.splitlines()
    assert what.startswith("warning[WMR012]: ") and "left" in what and "right" in what
    assert place == f" --> {swapped}:7:5"
    assert line.startswith("7 |   - {name: right") and caret.index("^") == line.index("{")
    assert instead.startswith("  = ") and "beta: pi" in instead
    assert "wmrgen explain" in done.err


def test_no_finding_is_success(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("lint", robot_file)
    assert (done.code, done.out, done.err) == (0, "1 robot: no findings\n", "")


def test_derive_says_the_same_and_writes_what_it_wrote(
    wmrgen_cli: Cli, swapped: Path, tmp_path: Path
) -> None:
    told = wmrgen_cli("lint", swapped).out
    first = wmrgen_cli("derive", swapped, "-o", tmp_path / "a")
    assert first.code == 0 and told in first.err and "WMR" not in first.out
    swapped.write_text(swapped.read_text().rstrip() + "  # wmrgen: ignore WMR012\n")
    again = wmrgen_cli("derive", swapped, "-o", tmp_path / "a")
    assert again.err == "" and "all up to date" in again.out


def test_derive_refuses_what_cannot_move_unless_asked(wmrgen_cli: Cli, tmp_path: Path) -> None:
    path, out = tmp_path / "stuck.yaml", tmp_path / "out"
    path.write_text("wmrgen: 1\nname: stuck\n" + RULES["WMR030"].wrong)
    done = wmrgen_cli("derive", path, "-o", out)
    assert (done.code, done.out) == (3, "") and not out.exists()
    assert f" --> {path}:4:5\n" in done.err and "# wmrgen: ignore WMR030" in done.err
    path.write_text(path.read_text().replace("0,      r: 0.1}", "0, r: 0.1}  # wmrgen: ignore WMR030", 1))
    done = wmrgen_cli("derive", path, "-o", out)
    assert done.code == 0 and "mobility 0" in done.out


def test_one_json_object_with_findings_and_errors(wmrgen_cli: Cli, swapped: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("wmrgen: 1\nname: bad\nwheels: []\nwheelz: 3\nnam: 3\n")
    done = wmrgen_cli("lint", swapped, bad, "--json")
    told = json.loads(done.out)
    assert done.code == 2 and done.err == ""
    (finding,), (empty, error, _) = told["findings"], told["errors"]
    assert (finding["code"], finding["file"], finding["line"], finding["column"]) == (
        "WMR012",
        str(swapped),
        7,
        5,
    )
    assert (empty["line"], empty["column"], empty["code"]) == (3, 9, "WMR104")
    assert (error["line"], error["column"], error["exit_code"]) == (4, 1, 2)
    assert "wheelz" in error["what"]


def test_explain(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("explain", "wmr012")
    assert done.code == 0
    assert done.out.startswith(f"WMR012: {RULES['WMR012'].title}\n")
    assert "\nwrong:\n" in done.out and "\nright:\n" in done.out and "# wmrgen: ignore WMR012" in done.out
    told = json.loads(wmrgen_cli("explain", "WMR012", "--json").out)
    assert told["wrong"] != told["right"] and told["code"] == "WMR012"


def test_explain_lists_all_codes(wmrgen_cli: Cli) -> None:
    lines = wmrgen_cli("explain").out.splitlines()
    rules = json.loads(wmrgen_cli("explain", "--json").out)["rules"]
    assert [line.split()[0] for line in lines] == [rule["code"] for rule in rules]
    assert all(f"## {rule['code']}" in (ROOT / "docs" / "lint.md").read_text() for rule in rules)


def test_an_unknown_code_names_the_nearest(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("explain", "WMR0012")
    assert done.code == 2 and "WMR012?" in done.err


def test_parameters_are_not_blamed_for_a_robot_that_cannot_be_read(wmrgen_cli: Cli, tmp_path: Path) -> None:
    parameters = tmp_path / "c.yaml"
    parameters.write_text("drive: {type: diff_drive_controller/DiffDriveController, wheel_separation: 0.4}\n")
    alone = wmrgen_cli("lint", parameters)
    assert alone.code == 2 and alone.err.startswith("error[WMR112]") and str(parameters) in alone.err
    done = wmrgen_cli("lint", tmp_path / "none.yaml", parameters)
    assert done.code == 2 and done.err.startswith("error[WMR110]") and str(parameters) not in done.err


def test_what_is_not_compared_is_told(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    """Of a controller without lengths and of a description alone, "no findings" says too much."""
    parameters, description = tmp_path / "c.yaml", tmp_path / "a.urdf"
    parameters.write_text("drive: {type: diff_drive_controller/DiffDriveController, wheel_radius: 0.0975}\n")
    done = wmrgen_cli("lint", robot_file, parameters)
    assert (done.code, done.out) == (0, "2 files: no findings in what was compared\n")
    (told,) = json.loads(wmrgen_cli("lint", robot_file, parameters, "--json").out)["not_compared"]
    assert told in done.err and "track" in told
    description.write_text(robot(wheel("left", "0 0.2 0.1"), wheel("right", "0 -0.2 0.1")))
    done = wmrgen_cli("lint", description)
    assert (done.code, done.out) == (0, "1 file: no findings in what was compared\n")
    assert str(description) in done.err and "`wmrgen import`" in done.err


@pytest.mark.parametrize(
    ("word", "near"), [("WMR999", ""), ("12", "WMR012"), ("wmr34", "WMR034"), ("castor", "")]
)
def test_only_the_code_with_the_same_number_is_suggested(wmrgen_cli: Cli, word: str, near: str) -> None:
    done = wmrgen_cli("explain", word)
    assert (done.code, done.out) == (2, "") and word in done.err
    assert re.findall(r"WMR\d{3}\?", done.err) == ([f"{near}?"] if near else [])


@pytest.mark.parametrize(("verb", "first"), [("lint", False), ("lint", True), ("compare", False)])
def test_a_robot_file_without_its_version_is_no_controller(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, verb: str, first: bool
) -> None:
    """Its types of wheels are words that types of controllers have too."""
    file = tmp_path / "omni.yaml"
    file.write_text("name: x\nwheels:\n  - {name: a, type: omni, x: 0.2, y: 0, r: 0.05}\n")
    done = wmrgen_cli(verb, *([] if first else [robot_file]), file)
    assert done.code == 2
    places = re.findall(r"error\[(WMR\d+)\].*\n --> .*omni.yaml:(\d+):", done.err)
    assert places == [("WMR103", "1"), ("WMR104", "3")]


@pytest.mark.parametrize("verb", ["lint", "derive"])
def test_wheels_are_checked_even_if_the_robot_cannot_have_its_virtual_wheels(
    wmrgen_cli: Cli, tmp_path: Path, verb: str
) -> None:
    """The rear wheels are 10 mm off one axle, so that no wheel can steer."""
    file = tmp_path / "car.yaml"
    file.write_text(
        "wmrgen: 1\nname: car\nwheels:\n"
        "  - {name: rl, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.1}\n"
        "  - {name: rr, type: fixed, x: 0.01, y: -0.4, heading: 0, r: 0.1}\n"
        "  - {name: fl, type: steered, x: 1.4, y: 0.4, heading: 0, r: 0.1}\n"
        "  - {name: fr, type: steered, x: 1.4, y: -0.4, heading: 0, r: 0.1}\n"
        "virtual:\n  - {name: psi, steers: [fl, fr]}\n"
    )
    done = wmrgen_cli(verb, file)
    assert done.code == 3
    text = done.out + done.err
    assert "warning[WMR034]" in text and f"{file}:5:5" in text
    error = done.err[done.err.index("error[WMR113]") :]
    assert f"{file}:9:5" in error and "10 mm" in error and "tolerance: 10 mm" in error
