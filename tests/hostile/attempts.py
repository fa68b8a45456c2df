"""One attempt to make wmrgen do harm: a command in a process of its own with 1 GiB and 10 s, and what came of it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT
from wmrgen.cli.explain import explained

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks, limits and /proc")
SECONDS = 1.5  # that a processor may work for what is refused, without the start of Python; the most is 0.6 s
_STEP = 5e-8  # that it takes for a step of a loop in Python; one that is slower may work longer
_OURS = re.compile("Traceback|bug in wmrgen|Segmentation|Fatal Python")


@dataclass(frozen=True, slots=True)
class Attempt:
    """How a command ended: exit code, output, processor time [s], changes that it made on disk."""

    code: int
    out: str
    err: str
    seconds: float
    changes: tuple[tuple[bool, str, str], ...] = field(repr=False)

    @property
    def outside(self) -> list[tuple[bool, str, str]]:
        """Changes outside the folder that the command was given."""
        return [change for change in self.changes if change[0]]


def slow(attempt: Attempt) -> bool:
    """Whether it took longer than `SECONDS`; where a processor is slower than `_STEP` now, as much longer.

    Its speed is that of its slowest of several moments: an attempt takes longer than each of them.
    """

    def step() -> float:
        start, total, count = time.process_time(), 0, 300_000
        for k in range(count):
            total += k * k
        return (time.process_time() - start) / count

    if attempt.seconds < SECONDS:
        return False
    slower = max(step() for _ in range(10)) / _STEP
    # What slows loops down slows memory down more.
    return attempt.seconds >= SECONDS * (2 * slower if slower > 1.1 else 1.0)


class Server:
    """The process of `tests.hostile.server`."""

    def __init__(self, logs: Path) -> None:
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-m", "tests.hostile.server"],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self._logs = logs
        self._count = 0
        self._answer()  # once it is ready

    def _answer(self) -> Any:
        assert self._process.stdout
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        self._process.communicate()

    def runs(
        self,
        place: Path,
        *words: object,
        allowed: Path | None = None,
        stdin: Path | None = None,
        runs: int = 1,
        killed_after: float | None = None,
        largest_file: int | None = None,
    ) -> list[Attempt]:
        """``runs`` processes at once of a command in the folder ``place``, which may change the folder ``allowed``."""
        self._count += 1
        log = self._logs / str(self._count)
        order = {
            "words": [str(word) for word in words], "place": str(place), "allowed": str(allowed or place / "out"),
            "stdin": str(stdin or os.devnull), "log": str(log), "runs": runs, "killed_after": killed_after,
            "largest_file": largest_file,
        }  # fmt: skip
        assert self._process.stdin
        self._process.stdin.write(json.dumps(order) + "\n")
        self._process.stdin.flush()
        return [
            self._attempt(f"{log}.{k}", code, seconds) for k, (code, seconds) in enumerate(self._answer())
        ]

    def _attempt(self, log: str, code: int, seconds: float) -> Attempt:
        out, err, changes = (Path(f"{log}.{name}").read_bytes() for name in ("out", "err", "changes"))
        events = tuple(tuple(json.loads(line)) for line in changes.split(b"\n")[:-1])
        return Attempt(code, out.decode(), err.decode(), seconds, events)

    def run(self, place: Path, *words: object, **options: Any) -> Attempt:
        return self.runs(place, *words, **options)[0]


def state(folder: Path) -> Mapping[str, object]:
    """What stands in a folder: the bytes of files, the targets of links, the kinds of the rest."""
    return {
        p.relative_to(folder).as_posix(): p.readlink()
        if p.is_symlink()
        else p.read_bytes()
        if p.is_file()
        else p.stat().st_mode
        for p in sorted(folder.rglob("*"))
    }


def harmless(attempt: Attempt) -> None:
    """It said in words how it ended, in time, and touched nothing but its folder."""
    assert not attempt.outside
    assert not _OURS.search(attempt.err), attempt.err
    assert all(c.isprintable() or c == "\n" for c in attempt.err + attempt.out)
    assert not slow(attempt), attempt.seconds


def refused(
    server: Server, place: Path, *words: object, code: int = 2, says: str = "", **options: Any
) -> Attempt:
    """A command ends with ``code`` and one error that matches ``says`` and has a code, and changes nothing."""
    before = state(place)
    attempt = server.run(place, *words, **options)
    for _ in range(4):  # others may work on the machine; of five tries one in time will do
        if not slow(attempt):
            break
        attempt = server.run(place, *words, **options)
    assert attempt.code == code, attempt
    assert attempt.changes == () and state(place) == before
    assert attempt.out == "" and 0 < len(attempt.err) < 4000
    assert re.search(says, attempt.err), attempt.err
    codes = re.findall(r"^error(?:\[(\w+)\])?: ", attempt.err, re.MULTILINE)
    assert codes and explained().keys() >= {*codes}, attempt.err
    harmless(attempt)
    return attempt


def everyday(cases: Mapping[str, Any], *names: str) -> list[Any]:
    """The cases as parameters with their names; all but ``names`` are slow."""
    assert set(names) <= set(cases)
    return [
        pytest.param(value, id=name, marks=() if name in names else pytest.mark.slow)
        for name, value in cases.items()
    ]
