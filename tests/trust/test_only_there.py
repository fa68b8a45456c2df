"""A run of ``wmrgen derive`` touches its output directory and nothing else; a failed one not even that."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.conftest import GALLERY, Outcome, process, tree
from tests.depth import everyday

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="resolves open directories by /proc")
WATCHED = """
import json, os, sys

out, log, words = os.path.realpath(sys.argv[1]), sys.argv[2], sys.argv[3:]
handle = os.open(log, os.O_WRONLY | os.O_CREAT)
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_TRUNC
ONE = {"os.mkdir", "os.remove", "os.rmdir", "os.truncate", "os.chmod", "os.chown", "os.utime", "shutil.rmtree",
       "tempfile.mkdtemp", "tempfile.mkstemp", "os.setxattr", "os.removexattr"}
TWO = {"os.rename", "os.link", "os.symlink", "shutil.move", "shutil.copyfile", "shutil.copytree"}
NEVER = ("socket.", "subprocess.", "os.system", "os.exec", "os.fork", "os.posix_spawn", "os.spawn", "pty.",
         "ftplib.", "urllib.", "http.", "smtplib.", "webbrowser.")


def inside(path, folder):
    if isinstance(path, int):  # an open handle, which an earlier event let through
        return True
    base = os.readlink(f"/proc/self/fd/{folder}") if isinstance(folder, int) and folder >= 0 else os.getcwd()
    path = os.path.realpath(os.path.join(base, os.fsdecode(path)))
    return path == out or path.startswith(out + os.sep) or "__pycache__" in path


def watch(event, args):
    bad = event.startswith(NEVER)
    seen = None
    if event == "open":
        path, mode, flags = args
        seen = bool(flags & WRITES) or (mode is not None and bool(set(mode) & set("wax+")))
        bad = seen and path != os.devnull and not inside(path, -1)
    elif event in ONE:
        folder = args[-1] if event in ("os.mkdir", "os.remove", "os.rmdir", "os.chmod", "os.chown") else -1
        seen, bad = True, not inside(args[0], folder)
    elif event in TWO:
        folders = args[2:4] if len(args) >= 4 else (-1, -1)
        seen, bad = True, not all(map(inside, args[:2], folders))
    if bad or seen:
        os.write(handle, (json.dumps([bool(bad), event, repr(args)]) + "\\n").encode())


sys.addaudithook(watch)
sys.argv = ["wmrgen", *words]
from wmrgen.__main__ import main

main()
"""


def watched(out: Path, log: Path, *words: object) -> tuple[Outcome, list[tuple[bool, str, str]]]:
    """The command line as a process, and every change that it made: (outside?, audit event, arguments)."""
    python = (sys.executable, "-c", WATCHED, str(out), str(log))
    done = process(*words, python=python)
    return done, [tuple(json.loads(line)) for line in log.read_text().splitlines()]


@LINUX
@pytest.mark.parametrize("name", everyday(["pioneer3dx", "pr2"], ["pr2"]))
def test_nothing_outside_the_directory(name: str, tmp_path: Path) -> None:
    robot = next(p for p in GALLERY if p.stem == name)
    out = tmp_path / "out"
    done, events = watched(out, tmp_path / "log", "derive", robot, "-o", out)
    assert done.code == 0, done.err
    assert [e for e in events if e[0]] == []
    assert {"open", "os.mkdir", "os.rename"} <= {e[1] for e in events}  # the hook sees what it should
    assert {p.name for p in tmp_path.iterdir()} == {"out", "log"}
    assert {p.name for p in out.iterdir()} == {name}


@LINUX
def test_the_hook_sees_a_file_elsewhere(tmp_path: Path) -> None:
    robot = next(p for p in GALLERY if p.stem == "unicycle")
    _, events = watched(tmp_path / "in", tmp_path / "log", "derive", robot, "-o", tmp_path / "out")
    assert {"open", "os.mkdir", "os.rename"} <= {e[1] for e in events if e[0]}


@pytest.fixture
def lock() -> Iterator[Callable[[Path], bool]]:
    """Make a directory read-only, for root too where the file system can; False where it cannot be."""
    locked: list[Path] = []
    chattr = shutil.which("chattr")

    def close(folder: Path) -> bool:
        if os.name == "posix" and os.geteuid():
            folder.chmod(0o555)
            locked.append(folder)
            return True
        done = chattr and subprocess.run([chattr, "+i", str(folder)], capture_output=True, check=False)
        if done and not done.returncode:
            locked.append(folder)
            return True
        return False

    yield close
    for folder in locked:
        if os.geteuid():
            folder.chmod(0o755)
        else:
            subprocess.run([str(chattr), "-i", str(folder)], check=True)


def derived_once(robot: Path, out: Path) -> dict[str, bytes]:
    """Older files of the robot in ``out``; the robot file then changes."""
    assert process("derive", robot, "-o", out).code == 0
    before = tree(out)
    robot.write_text(robot.read_text().replace("0.0975", "0.1"))
    return before


@pytest.mark.parametrize("place", everyday(["out", "out/pair"], ["out/pair"]))
def test_a_read_only_directory(
    robot_file: Path, tmp_path: Path, lock: Callable[[Path], bool], place: str
) -> None:
    out = tmp_path / "out"
    before = derived_once(robot_file, out)
    if not lock(tmp_path / place):
        pytest.skip("nothing is read-only for root on this file system")
    done = process("derive", robot_file, "-o", out)
    assert done.code == 4
    assert "cannot write" in done.err and "Traceback" not in done.err
    assert tree(out) == before


@pytest.mark.slow
@pytest.mark.parametrize("call", ["replace", "mkdir"])
def test_permission_is_refused(
    robot_file: Path,
    tmp_path: Path,
    call: str,
    monkeypatch: pytest.MonkeyPatch,
    wmrgen_cli: Callable[..., Outcome],
) -> None:
    """As `test_a_read_only_directory`, on any file system and for any user."""
    out = tmp_path / "out"
    before = derived_once(robot_file, out)
    plain = getattr(os, call)

    def refused(path: object, *rest: object, **more: object) -> object:
        if str(path).startswith(str(out)):
            raise PermissionError(13, "Permission denied", str(path))
        return plain(path, *rest, **more)

    monkeypatch.setattr(os, call, refused)
    done = wmrgen_cli("derive", robot_file, "-o", out)
    monkeypatch.undo()
    assert done.code == 4
    assert "Permission denied" in done.err
    assert tree(out) == before
