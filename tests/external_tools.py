"""Tools that CI installs: there a test that lacks one fails, elsewhere it is skipped and says so."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest

BIN = str(Path(sys.executable).parent)  # where PyPI's tools lie


def need(*names: str) -> None:
    """Go on only where all of ``names`` are installed."""
    absent = [name for name in names if _path(name) is None]
    if absent:
        missing(f"not installed: {', '.join(absent)}")


def tool(name: str) -> str:
    """Path of a tool: beside Python, else on PATH."""
    need(name)
    return str(_path(name))


def missing(what: str) -> None:
    """Something that CI installs is not here."""
    if os.environ.get("CI_DEEP"):
        pytest.fail(what)
    pytest.skip(what)


def _path(name: str) -> str | None:
    return shutil.which(name, path=BIN) or shutil.which(name)
