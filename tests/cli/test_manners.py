"""Help, colour, stack traces, pipes: how the command line behaves."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome, process

Cli = Callable[..., Outcome]


@pytest.mark.parametrize("command", [(), ("derive",), ("eval",), ("check",)])
def test_help_starts_with_an_example(wmrgen_cli: Cli, command: tuple[str, ...]) -> None:
    done = wmrgen_cli(*command, "--help")
    assert done.code == 0
    lines = [line.strip() for line in done.out.splitlines() if line.strip()]
    assert lines[0].startswith("Usage: wmrgen")
    assert lines[1].startswith("Example:  wmrgen")


def test_version(wmrgen_cli: Cli) -> None:
    assert wmrgen_cli("--version").out == f"wmrgen {wmrgen.__version__}\n"


@pytest.mark.parametrize(
    "words", [("derive",), ("fly",), ("eval", "x.yaml"), ("derive", "--scalar", "half", "x.yaml")]
)
def test_bad_usage(wmrgen_cli: Cli, words: tuple[str, ...]) -> None:
    done = wmrgen_cli(*words)
    assert done.code == 2
    assert "Usage:" in done.err


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


def test_a_missing_robot_file(tmp_path: Path) -> None:
    done = process("derive", "nowhere.yaml", cwd=tmp_path)
    assert done.code == 2
    assert "nowhere.yaml" in done.err
    assert "Traceback" not in done.err
    assert list(tmp_path.iterdir()) == []


def test_no_colour_when_piped(robot_file: Path, tmp_path: Path) -> None:
    done = process("derive", robot_file, "-o", tmp_path / "out", env={"TERM": "xterm-256color"})
    bad = process("eval", robot_file, "inverse", "q=1", env={"TERM": "xterm-256color"})
    assert "\x1b" not in done.out + done.err + bad.out + bad.err


def test_a_name_from_a_file_cannot_steer_the_terminal(robot_file: Path) -> None:
    done = process("eval", robot_file, "inverse", "\x1b[31mvx=1")
    assert done.code == 2
    assert "\x1b" not in done.err


@pytest.mark.skipif(os.name != "posix", reason="pipes")
def test_a_reader_that_goes_away(robot_file: Path, tmp_path: Path) -> None:
    read, write = os.pipe()
    os.close(read)
    command = [
        sys.executable,
        "-m",
        "wmrgen",
        "derive",
        str(robot_file),
        "-o",
        str(tmp_path / "out"),
        "--json",
    ]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert "Traceback" not in done.stderr
    assert "BrokenPipe" not in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="terminals")
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
