"""The progress line: on a terminal, after a second, and gone at the end."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

from wmrgen.cli import console

pytestmark = pytest.mark.skipif(os.name != "posix", reason="terminals")
SLOW = """
import sys, time
import wmrgen
from wmrgen import __main__

from wmrgen.cli import console
plain, seconds, patience = wmrgen.derive, float(sys.argv.pop(1)), float(sys.argv.pop(1))
console.PATIENCE = patience

def slow(robot):
    time.sleep(seconds)
    return plain(robot)

wmrgen.derive = slow
sys.argv[0] = "wmrgen"
__main__.main()
"""


def stderr_of(
    robot: object, out: object, seconds: float, terminal: bool, patience: float = 1.0
) -> tuple[bytes, float | None]:
    """What a run whose derivation takes ``seconds`` longer writes to stderr, and when the first of it came."""
    read, write = os.openpty() if terminal else os.pipe()
    command = [sys.executable, "-c", SLOW, str(seconds), str(patience), "derive", str(robot), "-o", str(out)]
    start = time.monotonic()
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=write)
    os.close(write)
    shown, first = b"", None
    while True:
        try:
            piece = os.read(read, 4096)
        except OSError:  # Linux says so when the other side of a terminal is closed
            break
        if not piece:
            break
        first = first or time.monotonic() - start
        shown += piece
    os.close(read)
    assert running.wait() == 0
    return shown, first


def test_on_a_terminal_after_a_second(robot_file: object, tmp_path: object) -> None:
    shown, first = stderr_of(robot_file, f"{tmp_path}/out", 2.0, terminal=True)
    assert b"deriving pair (1 of 1)" in shown
    assert first is not None and first >= 1.0
    assert shown.endswith(b"\r\x1b[K")


def test_not_for_quick_work(robot_file: object, tmp_path: object) -> None:
    assert console.PATIENCE == 1.0
    assert stderr_of(robot_file, f"{tmp_path}/out", 0.0, terminal=True, patience=600.0)[0] == b""


def test_never_when_piped(robot_file: object, tmp_path: object) -> None:
    assert stderr_of(robot_file, f"{tmp_path}/out", 2.0, terminal=False)[0] == b""
