"""What README shows is what wmrgen does."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_the_robot_file_is_the_gallery_s() -> None:
    (shown,) = blocks("yaml")
    assert (ROOT / "robots" / "pioneer3dx.yaml").read_text(encoding="utf-8").endswith(shown)
    assert len(shown.splitlines()) <= 12


@pytest.mark.parametrize("command", ["wmrgen derive robots", "wmrgen eval robots", "wmrgen model robots"])
def test_commands_print_what_is_shown(
    wmrgen_cli: Callable[..., Outcome], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    (shown,) = [b for b in blocks("console") if b.startswith(f"$ {command}")]
    first, expected = shown.split("\n", 1)
    (tmp_path / "robots").symlink_to(ROOT / "robots")
    monkeypatch.chdir(tmp_path)
    done = wmrgen_cli(*shlex.split(first.removeprefix("$ wmrgen ")))
    assert done.code == 0
    assert done.out == expected


def test_the_c_is_what_is_generated(wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> None:
    (shown,) = blocks("c")
    assert wmrgen_cli("derive", ROOT / "robots" / "pioneer3dx.yaml", "-o", tmp_path).code == 0
    assert shown in (tmp_path / "pioneer3dx" / "pioneer3dx.c").read_text(encoding="utf-8")
