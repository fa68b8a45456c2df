"""A closed or full standard output is no bug of wmrgen: one line, exit code 4, no trace."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROBOT = Path(__file__).parents[2] / "robots" / "pioneer3dx.yaml"


@pytest.mark.parametrize("redirect", [">&-", ">/dev/full"])
def test_output_that_cannot_be_written(redirect: str) -> None:
    command = f'"{sys.executable}" -m wmrgen eval "{ROBOT}" inverse vx=1 vy=0 omega=0 tail.steer=0 {redirect}'
    done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == 4
    assert "Traceback" not in done.stderr
    assert "bug" not in done.stderr
