"""rollers, textbook, `eval textbook` and what check says about them."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome, tree

Cli = Callable[..., Outcome]


def rollers(cli: Cli, radius: str, count: str, angle: str, *more: str) -> Outcome:
    return cli("rollers", "--radius", radius, "--count", count, "--angle", angle, *more)


@pytest.mark.parametrize("words", [("150mm", "8", "45deg"), ("0.15", "8", "pi/4"), ("15 cm", "8", "45 deg")])
def test_rollers_of_tzafestas_2_88(wmrgen_cli: Cli, words: tuple[str, str, str]) -> None:
    done = rollers(wmrgen_cli, *words)
    assert done.code == 0 and done.err == ""
    half = 0.15 * math.sin(math.pi / 8)
    found = {line.split()[0]: float(line.split()[2]) for line in done.out.splitlines()[:3]}
    assert found == pytest.approx({"D_r": 2 * half * math.sqrt(2), "d": 2 * half, "b": half})
    assert all(" m  " in line for line in done.out.splitlines()[:3])
    assert "gamma of the robot file: ±45 deg" in done.out


def test_rollers_as_json(wmrgen_cli: Cli) -> None:
    found = json.loads(rollers(wmrgen_cli, "150mm", "6", "90deg", "--json").out)
    assert found["d"] == 0.0 and found["gamma_deg"] == 0.0
    assert found["D_r"] == pytest.approx(2 * 0.15 * math.sin(math.pi / 6))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("0", "8", "45deg"), "the radius is not positive"),
        (("-150mm", "8", "45deg"), "the radius is not positive"),
        (("150mm", "2", "45deg"), "at least 3"),
        (("150mm", "7.5", "45deg"), "whole number"),
        (("150mm", "8", "0deg"), "impossible"),
        (("150mm", "8", "91deg"), "impossible"),
        (("150mm", "8", "45"), "write 45deg"),
        (("150kg", "8", "45deg"), "not a unit"),
        (("150deg", "8", "45deg"), "is a length"),
        (("150mm", "eight", "45deg"), "eight"),
    ],
)
def test_rollers_refuse_what_cannot_be(wmrgen_cli: Cli, words: tuple[str, str, str], said: str) -> None:
    done = rollers(wmrgen_cli, *words)
    assert (done.code, done.out) == (2, "")
    assert said in done.err and "Traceback" not in done.err


@pytest.mark.parametrize("backend", ["exact", "casadi", "c"])
def test_eval_textbook(wmrgen_cli: Cli, backend: str) -> None:
    words = ("wheelbase=1.4", "distance=3", "epsilon=0.5")
    done = wmrgen_cli(
        "eval", "textbook", "pursuit", *words, "--backend", backend, "--scalar", "double", "--json"
    )
    assert done.code == 0 and done.err == ""
    assert json.loads(done.out)["psi"] == pytest.approx(0.42074284961060243)


def test_eval_textbook_says_what_it_has(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("eval", "textbook", "pursui")
    assert done.code == 2 and "Did you mean pursuit?" in done.err
    done = wmrgen_cli("eval", "textbook", "pursuit", "wheelbas=1")
    assert done.code == 2 and "wheelbase" in done.err


def test_a_file_called_textbook_is_a_robot(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(robot_file, tmp_path / "textbook")
    monkeypatch.chdir(tmp_path)
    assert wmrgen_cli("eval", "textbook", "inverse", "vx=1").code == 0


@pytest.mark.slow
def test_written_and_checked(wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `textbook` writes is what stands in generated/, and check notices a change in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").mkdir()
    shutil.copy(ROOT / "robots" / "unicycle.yaml", tmp_path / "robots")
    assert wmrgen_cli("derive", "robots/unicycle.yaml").code == 0
    assert wmrgen_cli("check").code == 0  # a project without the library owes nothing
    done = wmrgen_cli("textbook")
    assert done.code == 0 and "generated/errata.md (new or changed)" in done.out
    made = tree(tmp_path / "generated")
    kept = {
        k: v for k, v in tree(ROOT / "generated").items() if k.startswith("textbook/") or k == "errata.md"
    }
    assert {k: v for k, v in made.items() if not k.startswith("unicycle/")} == kept
    assert wmrgen_cli("check").code == 0
    again = wmrgen_cli("textbook")
    assert "all up to date" in again.out and "errata.md (up to date)" in again.out
    page = tmp_path / "generated" / "errata.md"
    page.write_text(page.read_text() + "\n")
    (tmp_path / "generated" / "textbook" / "textbook.c").unlink()
    done = wmrgen_cli("check")
    assert done.code == 1
    assert "generated/errata.md: " in done.out and "generated/textbook/textbook.c: missing" in done.out


@pytest.mark.slow
def test_a_linked_page_is_refused(wmrgen_cli: Cli, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (tmp_path / "elsewhere.md").write_text("mine")
    (out / "errata.md").symlink_to(tmp_path / "elsewhere.md")
    done = wmrgen_cli("textbook", "-o", out)
    assert done.code == 4 and "symbolic link" in done.err
    assert (tmp_path / "elsewhere.md").read_text() == "mine"
