"""`wmrgen exercise`: formats, files, and what it refuses."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

Cli = Callable[..., Outcome]
STUCK = """\
wmrgen: 1
name: stuck
wheels:
  - {name: a, type: fixed, x: 0.3, y: 0.1, heading: 10 deg, r: 0.1}
  - {name: b, type: fixed, x: -0.3, y: 0.2, heading: 50 deg, r: 0.1}
  - {name: c, type: fixed, x: 0.1, y: -0.4, heading: 200 deg, r: 0.1}
"""


@pytest.mark.parametrize(
    ("name", "start"), [("a.md", "# "), ("a.tex", "\\documentclass"), ("a.html", "<!doctype")]
)
def test_the_name_of_the_file_chooses_the_format(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, name: str, start: str
) -> None:
    out = tmp_path / "sheets" / name
    done = wmrgen_cli("exercise", robot_file, "--seed", 3, "-o", out)
    assert done.code == 0, done.err
    text = out.read_text(encoding="utf-8")
    assert text.lower().startswith(start) and "pair" in text
    beside = {file.name for file in out.parent.iterdir()} - {name}
    assert beside == (set() if name == "a.html" else {"pair_layout.svg", "pair_symbols.svg"})
    assert all(file.removesuffix(".svg") in text for file in beside)
    forced = wmrgen_cli("exercise", robot_file, "--seed", 3, "-o", out, "--format", "md")
    assert forced.code == 0 and out.read_text(encoding="utf-8").startswith("# ")


def test_the_solution_is_written_on_request(wmrgen_cli: Cli, robot_file: Path) -> None:
    statement, solution = (
        wmrgen_cli("exercise", robot_file, "--seed", 3, *more).out for more in ((), ("--solution",))
    )
    assert "…" in statement and "…" not in solution and len(solution) > len(statement)


def test_html_has_its_figures(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("exercise", robot_file, "--format", "html", "--solution")
    assert done.code == 0 and done.out.count('<span class="figure"><svg') == 2


def test_the_text_is_the_same_in_each_process(robot_file: Path) -> None:
    texts = set()
    for salt in ("1", "2"):
        command = [sys.executable, "-m", "wmrgen", "exercise", str(robot_file), "--seed", "7", "--solution"]
        environment = {**os.environ, "PYTHONHASHSEED": salt}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=True)
        texts.add(done.stdout)
    assert len(texts) == 1


@pytest.mark.parametrize(
    "words", [("--seed", "-1"), ("--seed", "1.5"), ("--seed", "seven"), ("--format", "pdf"), ("--format", "")]
)
def test_wrong_options_are_refused(wmrgen_cli: Cli, robot_file: Path, words: tuple[str, ...]) -> None:
    done = wmrgen_cli("exercise", robot_file, *words)
    assert (done.code, done.out) == (2, "") and "error[WMR112]" in done.err and "Traceback" not in done.err


def test_robots_without_a_motion_and_missing_files_are_refused(wmrgen_cli: Cli, tmp_path: Path) -> None:
    stuck = tmp_path / "stuck.yaml"
    stuck.write_text(STUCK)
    for path in (stuck, tmp_path / "nowhere.yaml"):
        done = wmrgen_cli("exercise", path, "-o", tmp_path / "a.md")
        assert (
            (done.code, done.out) == (2, "")
            and done.err.startswith("error[")
            and not (tmp_path / "a.md").exists()
        )
