"""Writing: all or nothing, inside the chosen directory, through no link."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import tree
from wmrgen.derivation.artifacts import differences, write_file, write_tree
from wmrgen.derivation.manifest import MANIFEST
from wmrgen.errors import EnvironmentFailure

OLD = {"a.c": b"old a", "b.h": b"old b", "c.json": b"same"}
NEW = {"a.c": b"new a", "b.h": b"new b", "c.json": b"same", "d/e.md": b"new e"}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A directory that holds OLD."""
    place = tmp_path / "out" / "pair"
    write_tree(place, OLD)
    return place


def test_writes_the_files_and_their_manifest(place: Path) -> None:
    written = write_tree(place, NEW)
    assert {k: v for k, v in tree(place).items() if k != MANIFEST} == NEW
    assert json.loads((place / MANIFEST).read_text())["files"].keys() == NEW.keys()
    assert set(written.changed) == {"a.c", "b.h", "d/e.md", MANIFEST}
    assert written.unchanged == ("c.json",)
    assert [p.name for p in place.parent.iterdir()] == ["pair"], "nothing staged is left"
    assert not differences(place, NEW)


def test_equal_bytes_are_left_alone(place: Path) -> None:
    for path in place.iterdir():
        os.utime(path, ns=(1, 1))
    before = place.parent.stat().st_mtime_ns
    assert write_tree(place, OLD).changed == ()
    assert {path.stat().st_mtime_ns for path in place.iterdir()} == {1}
    assert place.parent.stat().st_mtime_ns == before, "nothing is staged: the folder may be read-only"


def test_removes_what_it_no_longer_produces_and_nothing_else(place: Path) -> None:
    write_tree(place, NEW)
    (place / "mine.txt").write_text("the user's")
    assert write_tree(place, OLD).removed == ("d/e.md",)
    assert tree(place).keys() == {*OLD, MANIFEST, "mine.txt"}
    assert not (place / "d").exists()


def test_a_forged_manifest_removes_nothing_outside(place: Path) -> None:
    victim = place.parent / "victim"
    victim.write_text("keep")
    (place / MANIFEST).write_text(json.dumps({"format": 1, "files": {"../victim": "", "a.c": ""}}))
    write_tree(place, OLD)
    assert victim.read_text() == "keep"


@pytest.mark.parametrize(
    "name", ["../x", "/x", "a/../../x", "", ".", "..", "a//b", ".hidden", "a\\b", "x\n", MANIFEST]
)
def test_names_that_could_leave_the_directory(place: Path, name: str) -> None:
    with pytest.raises(ValueError, match="not a name"):
        write_tree(place, {name: b""})
    assert tree(place).keys() == {*OLD, MANIFEST}


@pytest.mark.parametrize("link", ["", "a.c", MANIFEST, "d"])
def test_symbolic_links_are_refused(place: Path, tmp_path: Path, link: str) -> None:
    target = tmp_path / "elsewhere"
    target.mkdir()
    (target / "e.md").write_text("keep")
    path = place / link if link else place
    if link == "":
        place.rename(tmp_path / "moved")
    else:
        path.unlink(missing_ok=True)
    path.symlink_to(target)
    with pytest.raises(EnvironmentFailure, match="symbolic link"):
        write_tree(place, NEW)
    assert tree(target) == {"e.md": b"keep"}
    if link:
        assert (place / "b.h").read_bytes() == OLD["b.h"]


def test_a_file_where_the_directory_should_be(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(EnvironmentFailure, match="cannot write"):
        write_tree(tmp_path / "out" / "pair", NEW)
    assert (tmp_path / "out").read_text() == "a file"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
def test_a_pipe_or_device_is_not_replaced(place: Path) -> None:
    """As `-o /dev/null` by root, who could. In the folder of a robot it is in the way."""
    pipe = place / "a.c"
    pipe.unlink()
    os.mkfifo(pipe)
    with pytest.raises(EnvironmentFailure, match="no regular file"):
        write_file(pipe, b"new")
    assert pipe.is_fifo() and "a.c" in write_tree(place, OLD).changed


def test_a_file_where_a_folder_should_be_changes_nothing(place: Path) -> None:
    (place / "d").write_text("the user's")
    before = tree(place)
    with pytest.raises(EnvironmentFailure, match="d is a file; wmrgen would make a folder"):
        write_tree(place, NEW)
    assert tree(place) == before


def test_what_stands_in_a_folder_is_checked_too(place: Path, tmp_path: Path) -> None:
    write_tree(place, NEW)
    (place / "d" / "stray.c").write_text("int main(void);")
    assert [(d.path, d.why) for d in differences(place, NEW)] == [(place / "d" / "stray.c", "not produced")]
    (place / "d" / "stray.c").unlink()
    (place / "d" / "e.md").write_text("edited")
    assert [(d.path, d.why) for d in differences(place, NEW)] == [(place / "d" / "e.md", "differs")]
    write_tree(place, NEW)
    (place / "d").rename(tmp_path / "elsewhere")
    (place / "d").symlink_to(tmp_path / "elsewhere")
    assert [d.path for d in differences(place, NEW)] == [place / "d"], "a link in place of a folder"


def test_a_file_moves_into_a_folder(place: Path) -> None:
    """As the self-test did: it stood beside the sources."""
    moved = {"d/a.c" if name == "a.c" else name: content for name, content in OLD.items()}
    assert [(d.path, d.why) for d in differences(place, moved)] == [
        (place / "d" / "a.c", "missing"),
        (place / MANIFEST, "differs"),
        (place / "a.c", "not produced"),
    ]
    assert write_tree(place, moved).removed == ("a.c",)
    assert tree(place).keys() == {*moved, MANIFEST} and not differences(place, moved)


@pytest.mark.parametrize("step", ["write_bytes", "mkdtemp"])
def test_a_full_disk_leaves_the_old_files(place: Path, monkeypatch: pytest.MonkeyPatch, step: str) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    before = tree(place)
    monkeypatch.setattr(
        {"write_bytes": "pathlib.Path.write_bytes", "mkdtemp": "tempfile.mkdtemp"}[step], full
    )
    with pytest.raises(EnvironmentFailure, match=": No space left"):
        write_tree(place, NEW)
    assert tree(place) == before
    assert [p.name for p in place.parent.iterdir()] == ["pair"]
    other = place.parents[1] / "new" / "out"
    for write in (lambda: write_tree(other / "pair", NEW), lambda: write_file(other / "x.urdf", b"new")):
        with pytest.raises(EnvironmentFailure, match=": No space left"):
            write()
        assert not other.parent.exists(), "folders that were made for it"


KILLED = """
import os, signal, sys
from pathlib import Path
from wmrgen.derivation import artifacts

left = int(sys.argv[2])
plain = Path.replace

def replace(self, target):
    global left
    if left == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    left -= 1
    return plain(self, target)

Path.replace = replace
new = {"a.c": b"new a", "b.h": b"new b", "c.json": b"same", "d/e.md": b"new e"}
artifacts.write_tree(Path(sys.argv[1]), new)
"""


MOVES = 6  # two files out, three in, the manifest


@pytest.mark.parametrize("after", range(MOVES + 1))
def test_killed_at_any_moment(place: Path, after: int) -> None:
    """Old files or new ones, whole, and never both; the manifest is new when everything is; a second run completes."""
    done = subprocess.run([sys.executable, "-c", KILLED, str(place), str(after)], check=False)
    finished = after == MOVES
    assert done.returncode == (0 if finished else -signal.SIGKILL)
    found = tree(place)
    stand = {name: content for name, content in found.items() if name not in ("c.json", MANIFEST)}
    assert stand.items() <= OLD.items() or stand.items() <= NEW.items()
    listed = json.loads(found[MANIFEST])["files"].keys()
    assert listed == (NEW.keys() if finished else OLD.keys())
    write_tree(place, NEW)
    assert not differences(place, NEW)
    assert [p.name for p in place.parent.iterdir()] == ["pair"], (
        "the staging of the killed run is cleared away"
    )


@pytest.mark.parametrize("after", range(MOVES))
def test_a_move_that_fails_leaves_the_old_files(
    place: Path, monkeypatch: pytest.MonkeyPatch, after: int
) -> None:
    """All stand as they did, at whichever move; but for the last, of the manifest, all are new then."""
    before, plain, moves = tree(place), Path.replace, iter(range(MOVES))

    def replace(self: Path, target: Path) -> Path:
        if next(moves, MOVES) == after:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(EnvironmentFailure, match="Input/output error"):
        write_tree(place, NEW)
    if after == MOVES - 1:
        assert {name: c for name, c in tree(place).items() if name != MANIFEST} == NEW
    else:
        assert tree(place) == before
    assert [p.name for p in place.parent.iterdir()] == ["pair"]
