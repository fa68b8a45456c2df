"""Runs that are killed, that find the disk full, or another run beside them: what stands then is of one of the two
robots, or does not build."""

from __future__ import annotations

import random
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, put, tree
from tests.external_tools import need, tool
from tests.hostile.attempts import LINUX, Server, harmless
from wmrgen.derivation.manifest import MANIFEST

pytestmark = [LINUX, pytest.mark.slow]
FILES = {"first": DIFFERENTIAL, "second": DIFFERENTIAL.replace("0.0975", "0.1").replace("left", "port")}
KILLS = 30
Sets = dict[str, dict[str, bytes]]


@pytest.fixture(scope="module")
def sets(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Sets:
    """The files of either robot, in a folder with packages."""
    folder = tmp_path_factory.mktemp("sets")
    for name, text in FILES.items():
        (folder / f"{name}.yaml").write_text(text)
        assert server.run(folder, *derive(name), f"out/{name}", allowed=folder).code == 0
    return {name: tree(folder / "out" / name) for name in FILES}


def derive(name: str) -> list[str]:
    return ["derive", f"{name}.yaml", "--package", "cmake", "--package", "rust", "-o"]


def parts_of(found: dict[str, bytes], sets: Sets) -> dict[str, set[str]]:
    """Of each robot's folder or package: of which sets its files are, where they differ. Every file is whole."""
    folders: dict[str, set[str]] = {}
    for path, content in found.items():
        owners = {name for name, files in sets.items() if files.get(path) == content}
        assert owners or path.endswith(MANIFEST), f"{path} is of neither"
        folder = path.partition("pair/")[0]
        folders.setdefault(folder, set()).update(
            owners if len(owners) == 1 and not path.endswith(MANIFEST) else ()
        )
    return folders


def started(tmp_path: Path, sets: Sets) -> Path:
    """A folder with the robot files, and what was generated of the first."""
    out = tmp_path / "out"
    shutil.rmtree(out, ignore_errors=True)
    for name, text in FILES.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    put(out, sets["first"])
    return out


def builds(folder: Path) -> bool:
    sources = [folder / "pair.c", folder / "example" / "main.c"]
    words = [tool("gcc"), "-std=c99", "-w", *map(str, sources), "-o", str(folder / "a.out"), "-lm"]
    return all(p.exists() for p in sources) and subprocess.run(words, capture_output=True).returncode == 0


def test_killed_at_random_moments(server: Server, tmp_path: Path, sets: Sets) -> None:
    """No folder holds files of both; the next run completes, and clears what the killed one had staged."""
    need("gcc")
    out = started(tmp_path, sets)
    start = time.monotonic()
    assert server.run(tmp_path, *derive("second"), "out").code == 0
    whole = time.monotonic() - start
    before, random_ = "second", random.Random(1)
    killed = 0
    for _ in range(KILLS):
        now = "second" if before == "first" else "first"
        attempt = server.run(tmp_path, *derive(now), "out", killed_after=random_.uniform(0.2, 1.3) * whole)
        killed += attempt.code == -9
        found = {name: content for name, content in tree(out).items() if ".wmrgen-stage-" not in name}
        folders = parts_of(found, sets)
        assert all(len(owners) <= 1 for owners in folders.values()), folders
        if attempt.code == 0:
            before = now
            assert found == sets[now]
        elif builds(out / "pair"):
            (out / "pair" / "a.out").unlink()
            assert len(folders[""]) == 1
    assert killed > KILLS // 4
    assert server.run(tmp_path, *derive("second"), "out").code == 0
    assert tree(out) == sets["second"]
    assert not [p for p in out.rglob("*") if "stage" in p.name]


def test_two_runs_at_once(server: Server, tmp_path: Path, sets: Sets) -> None:
    """Whichever comes last has it all."""
    out = started(tmp_path, sets)
    for runs in (2, 4):
        attempts = server.runs(tmp_path, *derive("second"), "out", runs=runs)
        for attempt in attempts:
            assert attempt.code == 0, attempt.err
            harmless(attempt)
        assert tree(out) == sets["second"]
        started(tmp_path, sets)


@pytest.mark.parametrize("size", [0, 100, 3000, 8000, 20_000, 100_000])
def test_files_that_cannot_grow(server: Server, tmp_path: Path, sets: Sets, size: int) -> None:
    """As where the disk is full, after so many bytes of a file."""
    out = started(tmp_path, sets)
    attempt = server.run(tmp_path, *derive("second"), "out", largest_file=size)
    largest = max(map(len, sets["second"].values()))
    assert attempt.code == (0 if size >= largest else 4), attempt
    assert size >= largest or tree(out) == sets["first"]
    assert not [p for p in out.rglob("*") if "stage" in p.name]


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of a few hundred KiB."""
    place = tmp_path / "disk"
    place.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=800k", "tmpfs", str(place)], capture_output=True
    )
    if mounted.returncode:
        pytest.skip("no right to mount a small disk: test_files_that_cannot_grow tries what it can")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk(server: Server, disk: Path, sets: Sets) -> None:
    out = started(disk, sets)
    rest = shutil.disk_usage(disk).free
    (disk / "filler").write_bytes(b"x" * (rest - 16_384))
    attempt = server.run(disk, *derive("second"), "out")
    assert attempt.code == 4 and "No space left" in attempt.err, attempt
    assert tree(out) == sets["first"] and not [p for p in out.rglob("*") if "stage" in p.name]
    (disk / "filler").unlink()
    assert server.run(disk, *derive("second"), "out").code == 0
    assert tree(out) == sets["second"]


def test_a_disk_that_is_read_only(server: Server, disk: Path, sets: Sets) -> None:
    """Nothing has changed; and once it can be written, the next run finds nothing in its way."""
    out = started(disk, sets)
    for rights, code in (("ro", 4), ("rw", 0)):
        subprocess.run(["mount", "-o", f"remount,size=4m,{rights}", str(disk)], check=True)
        attempts = [server.run(disk, *derive("second"), place) for place in ("out", "new")]
        assert [attempt.code for attempt in attempts] == [code, code], attempts
        assert server.run(disk, *derive("first" if code else "second"), "out").code == 0, "nothing to write"
        assert code == 0 or all(a.err.count("error[WMR114]") == 1 and "Read-only" in a.err for a in attempts)
        assert tree(out) == sets["second" if code == 0 else "first"]
        assert (disk / "new").exists() is (code == 0)
        assert not [p for p in disk.rglob("*") if "stage" in p.name]
