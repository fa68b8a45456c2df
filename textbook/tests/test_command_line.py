"""`textbook`, `eval textbook` and what check says about them."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, ROOT, Outcome, tree
from wmrgen.derivation.artifacts import write_tree

Cli = Callable[..., Outcome]


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


def test_no_robot_takes_the_folder_of_the_library(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """A robot called textbook would remove every file of generated/textbook."""
    robot, folder = tmp_path / "mine.yaml", tmp_path / "generated" / "textbook"
    robot.write_text(DIFFERENTIAL.replace("name: pair", "name: textbook"))
    write_tree(folder, {"textbook.c": b"the library"})
    before = tree(folder)
    done = wmrgen_cli("derive", robot, "-o", tmp_path / "generated")
    assert done.code == 2 and "mine.yaml:2:7" in done.err and "Write textbook_robot." in done.err
    assert tree(folder) == before


def test_check_without_the_library(
    wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, robot_file: Path
) -> None:
    """Robots are checked all the same; that the rest is not is an error, never silence."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").mkdir()
    shutil.copy(robot_file, tmp_path / "robots")
    assert wmrgen_cli("derive", "robots/pair.yaml").code == 0
    monkeypatch.setitem(sys.modules, "textbook.command", None)
    assert wmrgen_cli("check").code == 0
    write_tree(tmp_path / "generated" / "textbook", {"textbook.c": b"the library"})
    (tmp_path / "generated" / "pair" / "pair.c").unlink()
    done = wmrgen_cli("check")
    assert done.code == 4 and "WMR114" in done.err and "pair.c: missing" in done.out


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
    del made["textbook/manifest.json"], kept["textbook/manifest.json"]  # it records versions of libraries
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
