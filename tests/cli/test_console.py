"""How the command line behaves: bugs, colour, locales, and the progress line on a terminal."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome, process
from wmrgen.cli import console
from wmrgen.errors import EnvironmentFailure, NotDerivableError, UsageError

Cli = Callable[..., Outcome]
TERMINALS = pytest.mark.skipif(os.name != "posix", reason="terminals")


def test_a_bug_is_one_line_and_a_log(capsys: pytest.CaptureFixture[str]) -> None:
    def broken() -> int:
        raise ZeroDivisionError("one\ntwo")

    assert console.outcome(broken) == 70
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.splitlines()) == 1
    found = re.search(r" (\S*)\)$", shown.err)
    assert found
    log = Path(found[1])
    assert "in broken" in log.read_text()
    log.unlink()


@pytest.mark.skipif(os.name != "posix", reason="pipes and handles")
@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_reader_that_is_gone_ends_the_process_as_its_signal_would(stream: str) -> None:
    read, write = os.pipe()
    os.close(read)
    words = {"stdout": "--version", "stderr": "--none"}[stream]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, stream: write}
    running = subprocess.Popen([sys.executable, "-m", "wmrgen", words], **streams)  # type: ignore[call-overload]
    os.close(write)
    assert [text for text in running.communicate() if text] == []
    assert running.returncode == 128 + signal.SIGPIPE


@pytest.mark.skipif(os.name != "posix", reason="pipes and handles")
@pytest.mark.parametrize("handle", [0, 1, 2])
def test_no_file_takes_the_number_of_a_closed_stream(handle: int, tmp_path: Path) -> None:
    """What is opened later could otherwise be written over by a note."""
    opened = tmp_path / "opened"
    program = (
        f"import os; os.close({handle})\nfrom wmrgen.cli import console\nconsole.prepare()\n"
        f"file = open({str(opened)!r}, 'w'); file.write(str(file.fileno()))"
    )
    subprocess.run([sys.executable, "-c", program], stdin=subprocess.DEVNULL, capture_output=True, check=True)
    assert int(opened.read_text()) > 2


def test_numbers_that_json_cannot_say_are_null(capsys: pytest.CaptureFixture[str]) -> None:
    console.data(
        {"a": [1.5, math.inf, (math.nan, "inf")], "b": {"c": -math.inf, "d": True, "e": None}, "f": 3}
    )
    shown = json.loads(capsys.readouterr().out)
    assert shown == {"a": [1.5, None, [None, "inf"]], "b": {"c": None, "d": True, "e": None}, "f": 3}


def test_values_stand_one_below_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    console.values({"a": 0.5, "longer": "text", "icr": [1.0, -2.0], "n": 3})
    assert capsys.readouterr().out.splitlines() == [
        "a      = 0.5", "longer = text", "icr    = (1.0, -2.0)", "n      = 3",
    ]  # fmt: skip
    console.values({})
    console.note("one\ttwo\x1b[31m\nthree")
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", "one\\ttwo\\x1b[31m\nthree\n")


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (OverflowError(), 2, "error[WMR112]: "),
        (KeyboardInterrupt(), 130, "interrupted"),
        (console.Stopped("SIGTERM", 15), 143, "terminated"),
        (console.Stopped("SIGHUP", 1), 129, "the terminal was closed"),
        (UsageError("no such word"), 2, "error[WMR112]: no such word"),
        (NotDerivableError("it cannot move"), 3, "error[WMR113]: it cannot move"),
        (EnvironmentFailure("no compiler"), 4, "error[WMR114]: no compiler"),
    ],
)
def test_exit_codes(error: BaseException, code: int, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    def work() -> int:
        raise error

    assert console.outcome(work) == code
    shown = capsys.readouterr()
    assert shown.out == "" and len(shown.err.splitlines()) == 1 and shown.err.startswith(words)
    assert [console.outcome(lambda code=code: code) for code in (0, 1)] == [0, 1]


@pytest.mark.slow
def test_no_colour_when_piped(robot_file: Path, tmp_path: Path) -> None:
    done = process("derive", robot_file, "-o", tmp_path / "out", env={"TERM": "xterm-256color"})
    bad = process("eval", robot_file, "inverse", "q=1", env={"TERM": "xterm-256color"})
    assert "\x1b" not in done.out + done.err + bad.out + bad.err


def test_a_name_from_a_file_cannot_steer_the_terminal(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "\x1b[31mvx=1")
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
    assert re.search(rb"left \| +\+ +\| right", shown), "the top view"


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
@pytest.mark.slow
def test_progress_on_a_terminal_after_a_second(robot_file: object, tmp_path: object) -> None:
    shown, first = stderr_of(robot_file, f"{tmp_path}/out", 2.0, terminal=True)
    assert b"deriving pair (1 of 1)" in shown
    assert first is not None and first >= 1.0
    assert shown.endswith(b"\r\x1b[K")


@TERMINALS
def test_no_progress_for_quick_work(robot_file: object, tmp_path: object) -> None:
    assert console.PATIENCE == 1.0
    assert stderr_of(robot_file, f"{tmp_path}/out", 0.0, terminal=True, patience=600.0)[0] == b""


@pytest.mark.slow
@TERMINALS
def test_no_progress_when_piped(robot_file: object, tmp_path: object) -> None:
    assert stderr_of(robot_file, f"{tmp_path}/out", 0.5, terminal=False, patience=0.1)[0] == b""
