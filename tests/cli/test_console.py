"""How the command line behaves: bugs, colour, locales, and the progress line on a terminal."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
import wmrgen.cli
from tests.conftest import Outcome, process
from wmrgen.cli import console

Cli = Callable[..., Outcome]
TERMINALS = pytest.mark.skipif(os.name != "posix", reason="terminals")


def test_a_bug_is_one_line_and_a_log(
    wmrgen_cli: Cli, robot_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(path: Path) -> None:
        raise ZeroDivisionError("one\ntwo")

    monkeypatch.setattr(wmrgen, "load", broken)
    done = wmrgen_cli("derive", robot_file)
    assert done.code == 70
    assert done.out == ""
    assert len(done.err.splitlines()) == 1
    found = re.search(r"details in (.*)\)", done.err)
    assert found
    log = Path(found[1])
    assert "in broken" in log.read_text()
    log.unlink()


def test_an_interrupt_is_no_stack_trace(
    wmrgen_cli: Cli, robot_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(path: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(wmrgen, "load", interrupted)
    assert wmrgen_cli("derive", robot_file) == Outcome(130, "", "interrupted\n")


def test_no_colour_when_piped(robot_file: Path, tmp_path: Path) -> None:
    done = process("derive", robot_file, "-o", tmp_path / "out", env={"TERM": "xterm-256color"})
    bad = process("eval", robot_file, "inverse", "q=1", env={"TERM": "xterm-256color"})
    assert "\x1b" not in done.out + done.err + bad.out + bad.err


def test_a_name_from_a_file_cannot_steer_the_terminal(robot_file: Path) -> None:
    done = process("eval", robot_file, "inverse", "\x1b[31mvx=1")
    assert done.code == 2
    assert "\x1b" not in done.err


@TERMINALS
def test_colour_on_a_terminal(robot_file: Path, tmp_path: Path) -> None:
    import pty

    parent, child = pty.openpty()
    command = [sys.executable, "-m", "wmrgen", "derive", str(robot_file), "-o", str(tmp_path / "out")]
    env = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "CI")} | {"TERM": "xterm-256color"}
    running = subprocess.Popen(command, stdout=child, stderr=subprocess.DEVNULL, env=env)
    os.close(child)
    shown = b""
    while True:
        try:
            piece = os.read(parent, 4096)
        except OSError:  # Linux says so when the other side is closed
            break
        if not piece:
            break
        shown += piece
    assert running.wait() == 0
    os.close(parent)
    assert b"\x1b[1m" in shown


def test_output_is_utf8_in_any_locale(robot_file: Path) -> None:
    done = process(
        "eval",
        robot_file,
        "inverse",
        "ω=1",
        env={"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    )
    assert done.code == 2
    assert "Traceback" not in done.err


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


@TERMINALS
def test_progress_on_a_terminal_after_a_second(robot_file: object, tmp_path: object) -> None:
    shown, first = stderr_of(robot_file, f"{tmp_path}/out", 2.0, terminal=True)
    assert b"deriving pair (1 of 1)" in shown
    assert first is not None and first >= 1.0
    assert shown.endswith(b"\r\x1b[K")


@TERMINALS
def test_no_progress_for_quick_work(robot_file: object, tmp_path: object) -> None:
    assert console.PATIENCE == 1.0
    assert stderr_of(robot_file, f"{tmp_path}/out", 0.0, terminal=True, patience=600.0)[0] == b""


@TERMINALS
def test_no_progress_when_piped(robot_file: object, tmp_path: object) -> None:
    assert stderr_of(robot_file, f"{tmp_path}/out", 2.0, terminal=False)[0] == b""
