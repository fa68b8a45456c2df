"""External tools that CI installs. A test that lacks one is skipped and says so; in CI it fails."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

BIN = str(Path(sys.executable).parent)  # the scripts of packages from PyPI
_PATIENCE = 60  # s; a tool that takes longer to print its version does not run
_EXITS_WITH_1 = {"simavr"}  # tools that print their usage instead of a version


def need(*names: str) -> None:
    """Go on only if all tools are installed and run."""
    absent = [name for name in names if _path(name) is None]
    if absent:
        missing(f"not installed, or does not run: {', '.join(absent)}")


def tool(name: str) -> str:
    """Return the path of a tool: beside Python, else on the PATH."""
    need(name)
    return str(_path(name))


def missing(what: str) -> None:
    """Skip the test, or fail it in CI, because ``what`` is not here."""
    if os.environ.get("CI_DEEP"):
        pytest.fail(what)
    pytest.skip(what)


def _path(name: str) -> str | None:
    """Return the path of a tool that runs; None if it is not installed, or only a launcher without its program."""
    path = shutil.which(name, path=BIN) or shutil.which(name)
    return path if path and _exit_code(path) in (0, 1 if name in _EXITS_WITH_1 else 0) else None


@cache
def _exit_code(path: str) -> int | None:
    """Return the exit code of a tool that prints its version, None if it cannot be started; asked once in a session."""
    command = [path, "--version"]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.returncode
