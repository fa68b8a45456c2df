"""Tools that CI installs: there a test that lacks one fails, elsewhere it is skipped and says so."""

from __future__ import annotations

import os
import shutil

import pytest


def need(*tools: str) -> None:
    """Go on only where all ``tools`` are installed."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    if missing:
        told = f"not installed: {', '.join(missing)}"
        if os.environ.get("CI_DEEP") == "1":
            pytest.fail(told)
        pytest.skip(told)
