"""``make mutants``: faults planted in wmrgen's own source, and whether the everyday tests find them.

cosmic-ray plants them, one at a time, in copies of the checkout: an operator, a comparison, a number, a condition or
a loop is changed at a place that a seeded draw chooses among the lines of ``wmrgen/``. A run of the everyday tests
under coverage says which tests execute which line, and how long they take. Those of the changed line are run against
each fault until one fails: the tests of its own room first, and one case of each before a second. Coverage does not see
the processes that tests start, nor what tests read: those of the room (``tests/cli`` of ``wmrgen/cli``) and `READERS`,
which read the sources, are run whatever they execute.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import resource
import shlex
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent
COUNT, SEED, JOBS = 200, 1, os.cpu_count() or 1
READERS = ("tests/trust/test_source.py", "tests/trust/test_imports.py", "tests/wheels/test_one_home.py")
SECONDS = 900  # of processor time for the tests of a fault, three times what all take: a loop counts as found
TIMEOUT = 1800  # s, of a fault that waits
# Unions of types in annotations, caches and swapped identities are faults in name alone.
_LEFT_OUT = re.compile(r"BitOr|BitAnd|BitXor|Shift|_Is|Is_|IsNot|RemoveDecorator|Variable|ExceptionReplacer")
_PYTEST = (sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider")
_EVERYDAY = (*_PYTEST, "-m", "not slow")
_NAMED = shlex.join((*_PYTEST, "-x", "-m", "slow or not slow", "@tests.txt"))  # whatever mark they have


@dataclass(frozen=True)
class Fault:
    """``operator`` of cosmic-ray at its ``occurrence``-th place in the file ``path``, which is in ``line``."""

    path: str
    operator: str
    occurrence: int
    line: int

    def __str__(self) -> str:
        return f"{self.path}:{self.line} {self.operator.removeprefix('core/')}"


@dataclass(frozen=True)
class Outcome:
    """``found``: by one of the ``tests`` that were run (their number). ``change``: the lines that differ."""

    fault: Fault
    tests: int
    found: bool
    change: str


def draw(count: int, seed: int) -> list[Fault]:
    """``count`` faults: a file by its number of lines, a place in it, and one of the changes possible there."""
    chance = random.Random(seed)
    paths = sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "wmrgen").rglob("*.py"))
    weights = [(ROOT / path).read_text(encoding="utf-8").count("\n") for path in paths]
    places: dict[str, list[list[Fault]]] = {}
    chosen: list[Fault] = []
    while len(chosen) < count:
        (path,) = chance.choices(paths, weights)
        if path not in places:
            places[path] = _places(path)
        if places[path]:
            fault = chance.choice(places[path].pop(chance.randrange(len(places[path]))))
            chosen.append(fault)
    return chosen


def _places(path: str) -> list[list[Fault]]:
    """The faults of one file, those of one place together."""
    from cosmic_ray.commands.init import init
    from cosmic_ray.work_db import WorkDB, use_db

    by_place: dict[tuple[int, int], list[Fault]] = {}
    with (
        tempfile.TemporaryDirectory() as folder,
        use_db(str(Path(folder, "faults.sqlite")), WorkDB.Mode.create) as session,
    ):
        init([ROOT / path], session, {})
        for item in session.work_items:
            (m,) = item.mutations
            if not _LEFT_OUT.search(m.operator_name):
                fault = Fault(path, m.operator_name, m.occurrence, m.start_pos[0])
                by_place.setdefault(tuple(m.start_pos), []).append(fault)
    return [by_place[place] for place in sorted(by_place)]


def tests_of_lines(folder: Path) -> tuple[Mapping[str, Mapping[int, Sequence[str]]], Mapping[str, float]]:
    """File -> line -> everyday tests that execute it, and how many seconds each test takes.

    A line that runs at import has the tests of its whole file, or every test where that file runs at import alone.
    """
    from coverage import CoverageData

    data, times = folder / ".coverage", folder / "times.xml"
    with_coverage = (
        "--cov=wmrgen",
        "--cov-context=test",
        "--cov-report=",
        f"--junitxml={times}",
        "-n",
        str(JOBS),
        "--dist=worksteal",
    )
    subprocess.run([*_EVERYDAY, *with_coverage], cwd=folder, env=_environment(folder), check=True)
    listed = subprocess.run(
        [*_EVERYDAY, "-o", "addopts=", "--collect-only"],
        cwd=folder, env=_environment(folder), check=True, capture_output=True, text=True,
    )  # fmt: skip
    # A name that pytest does not find would pass for a fault that is found.
    there = {line for line in listed.stdout.splitlines() if "::" in line}
    seconds: dict[str, float] = dict.fromkeys(there, 1.0)
    for case in ElementTree.parse(times).iter("testcase"):
        name = f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}"
        seconds[name] = float(case.get("time", "1"))
    read = CoverageData(str(data))
    read.read()
    result: dict[str, dict[int, Sequence[str]]] = {}
    for file in read.measured_files():
        lines = {
            line: sorted({c.rpartition("|")[0] for c in contexts} & there)
            for line, contexts in read.contexts_by_lineno(file).items()
        }
        every = sorted({test for tests in lines.values() for test in tests} or there)
        path = Path(file).relative_to(folder.resolve()).as_posix()
        result[path] = {line: tests or every for line, tests in lines.items()}
    return result, seconds


def _environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}


def copy_of_checkout(folder: Path) -> Path:
    """A clone of the last commit."""
    subprocess.run(["git", "clone", "-q", "--shared", str(ROOT), str(folder)], check=True)
    return folder


def _start(folder: str, counter: multiprocessing.Queue[int]) -> None:
    """Gives each worker a clone of its own to plant faults in, and the tests that it starts their limit of time."""
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    own = copy_of_checkout(Path(folder) / f"copy{counter.get()}")
    os.chdir(own)
    os.environ.update(_environment(own))


def _run(job: tuple[Fault, Sequence[str]]) -> Outcome:
    from cosmic_ray.mutating import mutate_and_test
    from cosmic_ray.work_item import MutationSpec, TestOutcome, WorkerOutcome

    fault, tests = job
    Path("tests.txt").write_text("\n".join(tests), encoding="utf-8")
    spec = MutationSpec(Path(fault.path), fault.operator, fault.occurrence, (fault.line, 0), (fault.line, 1))
    result = mutate_and_test([spec], _NAMED, TIMEOUT)
    if result.worker_outcome is not WorkerOutcome.NORMAL:
        raise RuntimeError(f"{fault}: {result.output}")
    lines = [line for line in (result.diff or "").splitlines() if re.match(r"[-+](?![-+])", line)]
    return Outcome(fault, len(tests), result.test_outcome is TestOutcome.KILLED, "\n".join(lines))


def _in_order(tests: Sequence[str], path: str, seconds: Mapping[str, float]) -> list[str]:
    """``tests``, those first whose name says most of ``path``, then the quick ones.

    A test of several cases comes with its quickest case first, and with the next when every other has had its turn.
    """
    words = set(re.split(r"[/_.]", path.removeprefix("wmrgen/").removesuffix(".py")))
    turn: Counter[str] = Counter()
    order: dict[str, tuple[int, int, float]] = {}
    for test in sorted(tests, key=lambda t: seconds[t]):
        name = test.partition("[")[0]
        turn[name] += 1
        order[test] = turn[name], -len(words & set(re.split(r"[/_.:]+", name))), seconds[test]
    return sorted(tests, key=lambda t: order[t])


def run(count: int = COUNT, seed: int = SEED) -> Iterator[str]:
    """The lines to print: each fault that no test finds with its change, and the share that is found."""
    with tempfile.TemporaryDirectory(prefix="wmrgen-mutants-") as folder:
        tests, seconds = tests_of_lines(copy_of_checkout(Path(folder) / "covered"))
        jobs = []
        for fault in draw(count, seed):
            always = (*READERS, f"tests/{fault.path.split('/')[1]}/")
            unseen = [test for test in seconds if test.startswith(always)]
            covering = _covering(tests.get(fault.path, {}), fault.line)
            jobs.append((fault, _in_order(sorted({*covering, *unseen}), fault.path, seconds)))
        numbers: multiprocessing.Queue[int] = multiprocessing.Queue()
        for number in range(JOBS):
            numbers.put(number)
        found = 0
        with multiprocessing.Pool(JOBS, _start, (folder, numbers)) as pool:
            for done, outcome in enumerate(pool.imap_unordered(_run, jobs), 1):
                print(f"{done} of {count}", end="\r", file=sys.stderr, flush=True)
                found += outcome.found
                if not outcome.found:
                    yield f"{outcome.fault}, {outcome.tests} tests\n{outcome.change}\n"
    yield f"{found} of {count} faults found by the everyday tests ({100 * found / count:.0f} %), seed {seed}"


def _covering(lines: Mapping[int, Sequence[str]], line: int) -> Sequence[str]:
    """The tests of a line; of a statement over several lines, those of the line that coverage counts it by."""
    before = [k for k in lines if k <= line]
    return lines[max(before)] if before else ()
