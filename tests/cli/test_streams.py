"""Streams that fail, files without an end, signals: every command ends, with its exit code and in words."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.conftest import Outcome
from tests.depth import everyday

Cli = Callable[..., Outcome]
POSIX = pytest.mark.skipif(os.name != "posix", reason="pipes and signals")
LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/dev/full")
WMRGEN = f"{sys.executable} -m wmrgen"


def shell(text: str) -> tuple[int, str]:
    """Exit code and output of a command line in which ``wmrgen`` may be redirected."""
    done = subprocess.run(
        ["bash", "-c", text.replace("wmrgen ", f"{WMRGEN} ")], capture_output=True, text=True, timeout=60
    )
    return done.returncode, done.stdout + done.stderr


@LINUX
@pytest.mark.parametrize("to", ["2>/dev/full", ">/dev/full 2>/dev/full"])
@pytest.mark.parametrize(
    "words", everyday(["derive", "fly", "eval PAIR inverse vx=1", "eval PAIR inverse q=1"], ["fly"])
)
def test_an_error_stream_that_is_full_is_no_stale_file(robot_file: Path, words: str, to: str) -> None:
    assert shell(f"wmrgen {words.replace('PAIR', str(robot_file))} {to}") == (4, "")


@POSIX
@pytest.mark.parametrize("to", [pytest.param(">/dev/full", marks=LINUX), ">&-"])
@pytest.mark.parametrize(
    "words", everyday(["--version", "--help", "eval PAIR inverse vx=0 vy=0 omega=0"], ["--version"])
)
def test_a_result_that_cannot_be_written(robot_file: Path, words: str, to: str) -> None:
    code, said = shell(f"wmrgen {words.replace('PAIR', str(robot_file))} {to}")
    assert code == 4
    assert len(said.splitlines()) == 1 and "standard output" in said


@pytest.mark.slow
@POSIX
def test_a_closed_error_stream_only_loses_the_words(robot_file: Path) -> None:
    code, out = shell(f"wmrgen eval {robot_file} inverse vx=1 2>&-")
    assert code == 0
    assert "left.spin" in out
    assert shell(f"wmrgen eval {robot_file} inverse q=1 2>&-") == (2, "")


@POSIX
@pytest.mark.parametrize(
    "words",
    everyday(
        ["fly", "eval PAIR inverse q=1", "--help", "derive PAIR --json -o OUT"], ["derive PAIR --json -o OUT"]
    ),
)
def test_a_reader_that_is_gone_is_no_stale_file(robot_file: Path, tmp_path: Path, words: str) -> None:
    words = words.replace("PAIR", str(robot_file)).replace("OUT", str(tmp_path / "out"))
    code, said = shell(f"set -o pipefail; (sleep 0.2; wmrgen {words} 2>&1) | true")
    assert (code, said) == (141, "")


@POSIX
def test_a_pipe_nobody_writes_to(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for words in (("derive", pipe), ("eval", robot_file, "inverse", "--cases", pipe)):
        done = wmrgen_cli(*words)
        assert (done.code, done.out) == (2, "")
        assert done.err.startswith(f"error[WMR110]: {pipe}: ")


@POSIX
def test_a_pipe_of_the_shell_is_read(robot_file: Path, tmp_path: Path) -> None:
    cases = """<(echo '[{"vx": 1, "omega": 0}]')"""
    code, out = shell(f"wmrgen eval <(cat {robot_file}) inverse --cases {cases}")
    assert code == 0
    assert "left.spin" in out


@LINUX
def test_files_without_an_end(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "--cases", "/dev/zero")
    assert done.code == 2 and done.err.startswith("error[WMR110]: /dev/zero: ")
    code, said = shell(f"wmrgen eval {robot_file} inverse --cases - </dev/zero")
    assert code == 2
    assert said.startswith("error[WMR112]") and "16 MiB" in said


def test_a_huge_file_of_cases(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    with (tmp_path / "cases.json").open("wb") as file:
        file.truncate(1 << 33)
    done = wmrgen_cli("eval", robot_file, "inverse", "--cases", tmp_path / "cases.json")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[WMR112]") and "16 MiB" in done.err


@POSIX
def test_closed_standard_input(robot_file: Path) -> None:
    code, said = shell(f"wmrgen eval {robot_file} inverse --cases - <&-")
    assert code == 4 and said.startswith("error[WMR114]") and len(said.splitlines()) == 1


# ---- signals

SLOW_COMPILER = """#!/bin/sh
echo $$ > "$PIDS/driver"
sleep 60 &
echo $! > "$PIDS/child"
wait
"""
SLOW_DISK = """
import os, sys, time
from pathlib import Path
import wmrgen.derivation.artifacts as artifacts
from wmrgen import __main__

def slow(contents, plain=artifacts._stage):
    plain(contents)
    print("staged", flush=True)
    time.sleep(60)

artifacts._stage = slow
__main__.main()
"""
SIGNALS = ["SIGINT", "SIGTERM", "SIGHUP"]


def _alive(pid: int) -> bool:
    """A process that runs; one that ended and waits for its parent does not."""
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False


def _until(ready: Callable[[], bool]) -> None:
    end = time.monotonic() + 120
    while not ready():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def heeded() -> Iterator[None]:
    """A shell lets what it starts in the background ignore SIGINT, nohup SIGHUP, and children inherit that."""
    numbers = [getattr(signal, name) for name in SIGNALS]
    before = [signal.signal(number, signal.SIG_DFL) for number in numbers]
    yield
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


@LINUX
@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("name", everyday(SIGNALS, ["SIGTERM"]))
def test_a_signal_stops_the_compiler_and_what_it_started(robot_file: Path, tmp_path: Path, name: str) -> None:
    compiler, temporary = tmp_path / "slow-cc", tmp_path / "tmp"
    compiler.write_text(SLOW_COMPILER)
    compiler.chmod(0o755)
    temporary.mkdir()
    running = subprocess.Popen(
        [*WMRGEN.split(), "eval", str(robot_file), "inverse", "vx=1", "--backend", "c"],
        env={**os.environ, "CC": str(compiler), "TMPDIR": str(temporary), "PIDS": str(tmp_path)},
        stderr=subprocess.PIPE,
        text=True,
    )
    _until(lambda: (tmp_path / "child").exists() and bool((tmp_path / "child").read_text()))
    pids = [int((tmp_path / what).read_text()) for what in ("driver", "child")]
    assert all(map(_alive, pids)) and list(temporary.iterdir())
    running.send_signal(getattr(signal, name))
    said = running.communicate(timeout=120)[1]
    assert running.returncode == 128 + getattr(signal, name)
    assert len(said.splitlines()) == 1 and "Traceback" not in said
    _until(lambda: not any(map(_alive, pids)))
    assert not list(temporary.iterdir())


@POSIX
@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("name", everyday(SIGNALS, ["SIGINT"]))
def test_a_signal_leaves_nothing_staged(robot_file: Path, tmp_path: Path, name: str) -> None:
    out = tmp_path / "out"
    running = subprocess.Popen(
        [sys.executable, "-c", SLOW_DISK, "derive", str(robot_file), "-o", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert running.stdout and running.stdout.readline() == "staged\n"
    assert [p.name for p in out.iterdir()] != []
    running.send_signal(getattr(signal, name))
    running.communicate(timeout=120)
    assert running.returncode == 128 + getattr(signal, name)
    assert not out.exists() or not list(out.iterdir())


@pytest.mark.slow
@POSIX
def test_what_a_killed_run_staged_is_cleared_and_no_stale_file(robot_file: Path, tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    robot_file.rename(tmp_path / "robots" / "pair.yaml")
    leftover = tmp_path / "generated" / ".wmrgen-stage-killed"
    leftover.mkdir(parents=True)
    (leftover / "pair.c").write_text("half of it")
    assert shell(f"cd {tmp_path}; PYTHONPATH={Path.cwd()} wmrgen derive robots/pair.yaml")[0] == 0
    assert not leftover.exists()


@pytest.mark.slow
@POSIX
def test_a_signal_while_the_compiler_starts(robot_file: Path, tmp_path: Path) -> None:
    """It comes when the compiler runs and nobody has its number yet."""
    compiler = tmp_path / "slow-cc"
    compiler.write_text(SLOW_COMPILER)
    compiler.chmod(0o755)
    early = f"""
import os, signal, subprocess, sys, time
from wmrgen import __main__

def start(*args, plain=subprocess._fork_exec):
    number = plain(*args)
    print(number, flush=True)
    time.sleep(0.2)
    os.kill(os.getpid(), signal.SIGTERM)
    return number

subprocess._fork_exec = start
subprocess._USE_VFORK = False
sys.argv = ["wmrgen", "eval", {str(robot_file)!r}, "inverse", "vx=1", "--backend", "c"]
__main__.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", early],
        env={**os.environ, "CC": str(compiler), "PIDS": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=50,
    )
    assert done.returncode == 128 + signal.SIGTERM, done.stderr
    _until(lambda: not _alive(int(done.stdout)))
