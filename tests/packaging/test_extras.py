"""Libraries that only one command needs are not loaded by others, and their absence is reported with the cure."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, ROOT, Outcome, process

# scipy cannot be imported, as where it is not installed.
WITHOUT = """
import sys
sys.modules["scipy"] = None
from wmrgen.__main__ import main
main()
"""


def without_scipy(*words: object, cwd: Path) -> Outcome:
    return process(*words, cwd=cwd, python=(sys.executable, "-c", WITHOUT))


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder with a robot file that has a parameter to calibrate."""
    text = DIFFERENTIAL.replace("half_track: 0.1655", "half_track: {value: 0.1655, tunable: true}")
    (tmp_path / "pair.yaml").write_text(text)
    return tmp_path


def test_derive_does_without_scipy(place: Path) -> None:
    done = without_scipy("derive", "pair.yaml", "--html", "--batch", "--package", "cmake", cwd=place)
    assert done.code == 0, done.err
    assert without_scipy("check", "pair.yaml", "--full", cwd=place).code == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ("lint", "pair.yaml"),
        ("eval", "pair.yaml", "inverse", "vx=1"),
        ("compare", "pair.yaml", "pair.yaml"),
        ("prove", "pair.yaml"),
        ("structure", "pair.yaml"),
        ("export", "pair.yaml", "--to", "urdf"),
        ("list",),
        ("explain", "WMR114"),
    ],
    ids=" ".join,
)
def test_other_commands_do_without_scipy(place: Path, words: tuple[str, ...]) -> None:
    with_it = process(*words, cwd=place)
    assert without_scipy(*words, cwd=place) == with_it
    assert with_it.code in (0, 1, 3), with_it.err


def test_calibrate_says_what_to_install(place: Path) -> None:
    done = without_scipy("calibrate", "pair.yaml", "--plan", "--json", cwd=place)
    (error,) = json.loads(done.out)["errors"]
    assert (done.code, error["code"]) == (4, "WMR114")
    assert "wmrgen[calibrate]" in error["what"]


def test_only_calibration_imports_scipy() -> None:
    users = {
        path.relative_to(ROOT / "wmrgen").parts[:2]
        for path in (ROOT / "wmrgen").rglob("*.py")
        if "from scipy" in path.read_text(encoding="utf-8")
        or "import scipy" in path.read_text(encoding="utf-8")
    }
    assert users == {("tools", "calibration")}


def test_the_page_on_installation_has_every_extra() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    page = (ROOT / "docs" / "installation.md").read_text(encoding="utf-8")
    table = page.partition("| extra |")[2].partition("\n\n")[0]
    first = [line.split("|")[1] for line in table.splitlines()[2:]]
    assert set(re.findall(r"`(\w+)`", " ".join(first))) == set(project["optional-dependencies"])
