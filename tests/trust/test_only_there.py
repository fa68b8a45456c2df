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


def watched(out: Path, log: Path, *words: object) -> tuple[Outcome, list[tuple[bool, str, str]]]:
    """The command line as a process, and every change that it made: (outside?, audit event, arguments)."""
    python = (sys.executable, "-m", "tests.watched", str(out), str(log))
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
@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("place", ["out", "out/pair", "out/pair/example"])
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
