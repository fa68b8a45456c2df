"""Files that are no files, places that are somewhere else, and what stands in an output folder that is not ours."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL
from tests.hostile.attempts import LINUX, Server, harmless, refused, state

pytestmark = [LINUX, pytest.mark.slow]
Put = Callable[[Path], object]


def link(target: str) -> Put:
    return lambda path: path.symlink_to(target)


def sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 42)


def bound(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))


INPUTS: dict[str, Put] = {
    "missing": lambda path: None,
    "a folder": Path.mkdir,
    "a pipe": os.mkfifo,
    "a socket": bound,
    "a link to nothing": link("nowhere"),
    "a link to itself": link("in.yaml"),
    "zeros without end": link("/dev/zero"),
    "noise without end": link("/dev/urandom"),
    "a terminal": link("/dev/tty"),
    "memory": link("/proc/self/mem"),
    "a process": link("/proc/self/environ"),
    "a link to a folder": link("."),
    "four terabytes": sparse,
}
VERBS = {
    "derive": ("derive", "in.yaml", "-o", "out"),
    "eval": ("eval", "in.yaml", "inverse", "vx=1"),
    "lint": ("lint", "in.yaml"),
    "check": ("check", "in.yaml"),
    "import": ("import", "in.yaml", "-o", "out.yaml"),
    "cases": ("eval", "robot.yaml", "inverse", "--cases", "in.yaml"),
}


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("name", INPUTS)
def test_inputs_that_are_no_files(server: Server, tmp_path: Path, name: str, verb: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    INPUTS[name](tmp_path / "in.yaml")
    names = sorted(tmp_path.iterdir())
    attempt = server.run(tmp_path, *VERBS[verb])
    assert attempt.code == 2 and "in.yaml" in attempt.err and len(attempt.err) < 2000
    harmless(attempt)
    assert attempt.changes == () and sorted(tmp_path.iterdir()) == names


def test_a_link_to_a_robot_file_is_read(server: Server, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    (tmp_path / "in.yaml").symlink_to("robot.yaml")
    assert server.run(tmp_path, "derive", "in.yaml", "-o", "out").code == 0
    assert (tmp_path / "in.yaml").is_symlink()


def in_folder(name: str, put: Put) -> Put:
    """``put`` at a name under the output folder, whose folders are made."""

    def make(out: Path) -> None:
        (out / name).parent.mkdir(parents=True)
        put(out / name)

    return make


VICTIM = "victim"
REFUSED: dict[str, Put] = {
    "a link": link(VICTIM),
    "a link to nothing": link("nowhere"),
    "a link to itself": link("out"),
    "a file": lambda out: out.write_text("mine"),
    "a pipe": os.mkfifo,
    "a device": link("/dev/null"),
    "a robot that is a link": in_folder("pair", link(f"../{VICTIM}")),
    "a robot that is a link to nothing": in_folder("pair", link("../nowhere")),
    "a robot that is a file": in_folder("pair", lambda path: path.write_text("mine")),
    "a robot that is a pipe": in_folder("pair", os.mkfifo),
    "a source that is a link": in_folder("pair/pair.c", link(f"../../{VICTIM}/mine")),
    "a source that is a link to nothing": in_folder("pair/pair.c", link("../../nowhere")),
    "a source that is a device": in_folder("pair/pair.c", link("/dev/zero")),
    "a source that is a folder": in_folder("pair/pair.c", Path.mkdir),
    "a folder that is a link": in_folder("pair/test", link(f"../../{VICTIM}")),
    "a folder that is a file": in_folder("pair/test", lambda path: path.write_text("mine")),
    "a manifest that is a link": in_folder("pair/manifest.json", link(f"../../{VICTIM}/mine")),
    "a manifest that is a folder": in_folder("pair/manifest.json", Path.mkdir),
}


@pytest.mark.parametrize("name", REFUSED)
def test_output_folders_that_are_elsewhere(server: Server, tmp_path: Path, name: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    (tmp_path / VICTIM).mkdir()
    (tmp_path / VICTIM / "mine").write_text("mine")
    REFUSED[name](tmp_path / "out")
    before = state(tmp_path)
    attempt = server.run(tmp_path, "derive", "robot.yaml", "-o", "out", allowed=Path("/"))
    assert attempt.code == 4 and "out" in attempt.err and attempt.out == "", attempt
    harmless(attempt)
    assert state(tmp_path) == before
    checked = server.run(tmp_path, "check", "robot.yaml", "-o", "out")
    assert checked.code == 1 and checked.changes == ()
    harmless(checked)


REPLACED: dict[str, Put] = {
    "a source that is a pipe": in_folder("pair/pair.c", os.mkfifo),
    "a manifest that is a pipe": in_folder("pair/manifest.json", os.mkfifo),
    "a source of four terabytes": in_folder("pair/pair.c", sparse),
    "a manifest of four terabytes": in_folder("pair/manifest.json", sparse),
    "a budget of four terabytes": in_folder("pair/budget.json", sparse),
    "a stage that is a file": in_folder(".wmrgen-stage-x", lambda path: path.write_text("mine")),
}


@pytest.mark.parametrize("name", REPLACED)
def test_what_stands_in_the_way_is_replaced(server: Server, tmp_path: Path, name: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    REPLACED[name](tmp_path / "out")
    attempt = server.run(tmp_path, "derive", "robot.yaml", "-o", "out")
    assert attempt.code == 0, attempt
    harmless(attempt)
    assert "pair" in (tmp_path / "out" / "pair" / "pair.c").read_text()


PLACES = (
    "/dev/null",
    "/dev/full/x",
    "/proc/x",
    "/proc/self/fd",
    "a" * 300,
    "a/" * 3000,
    "robot.yaml",
    "robot.yaml/x",
)


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place[:12])
def test_places_that_cannot_be(server: Server, tmp_path: Path, place: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    before = state(tmp_path)
    attempt = server.run(tmp_path, "derive", "robot.yaml", "-o", place, allowed=Path("/"))
    assert attempt.code == 4 and "cannot write" in attempt.err, attempt
    harmless(attempt)
    assert state(tmp_path) == before


@pytest.mark.parametrize(
    "name", ["\x1b]0;pwned\x07.yaml", "a\nb.yaml", "--help.yaml", "$(touch pwned).yaml", "\u202ea.yaml"]
)
def test_names_of_robot_files(server: Server, tmp_path: Path, name: str) -> None:
    """In messages they are shown, and do nothing to a terminal."""
    (tmp_path / name).write_text("wmrgen: 1\nname: bad\nwheels: 3\n")
    refused(server, tmp_path, "derive", "-o", "out", "--", name, says=r"yaml:3:9")
