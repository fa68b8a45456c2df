"""The tutorial is what happens: its commands, in an empty folder, print what it says they print."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

Cli = Callable[..., Outcome]
TEXT = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


def test_six_commands(wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("cart.urdf").write_text(blocks("xml")[0], encoding="utf-8")
    commands = [part.split("\n", 1) for block in blocks("console") for part in block.split("$ ")[1:]]
    assert len(commands) == 6
    for command, shown in commands:
        if command.startswith("wmrgen "):
            done = wmrgen_cli(*command.split()[1:])
            assert done.code == 0, done.err
            assert set(shown.splitlines()) <= set((done.out + done.err).splitlines())
        elif command.startswith("cc ") and shutil.which("cc"):
            assert subprocess.check_output(["sh", "-c", command], text=True) == shown
        if command.startswith("wmrgen import"):
            written = Path("cart.yaml").read_text(encoding="utf-8")
            assert blocks("yaml")[0] in written
            Path("cart.yaml").write_text(written.replace("r: TODO", "r: 0.08"), encoding="utf-8")
