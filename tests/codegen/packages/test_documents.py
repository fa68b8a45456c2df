"""The commands of docs/microcontroller.md, run as printed in an empty folder."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.codegen.packages.arduino import needed
from tests.conftest import ROOT

PAGE = (ROOT / "docs" / "microcontroller.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    (text,) = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    return str(text)


@pytest.mark.slow
def test_the_page_from_an_empty_folder_to_a_running_robot(tmp_path: Path) -> None:
    needed()
    tools, folder = tmp_path / "tools", tmp_path / "empty"
    tools.mkdir()
    folder.mkdir()
    (tools / "wmrgen").write_text(f'#!/bin/sh\nexec {sys.executable} -m wmrgen "$@"\n')
    (tools / "wmrgen").chmod(0o755)
    path = {"PATH": f"{tools}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["bash", "-c", block("sh")],
        cwd=folder, env={**os.environ, **path}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, check=False,
    )  # fmt: skip
    printed = [re.sub(r"\x1b\[[\d;]*m", "", line) for line in done.stdout.splitlines()]
    printed = [re.sub(r"^(\d.*)\.$", r"\1", line) for line in printed]  # simavr's dot for the end of a line
    shown = block("text").splitlines()
    assert len(shown) == 5 and [line for line in printed if line in shown] == shown, done.stdout
