"""``make mutants``: faults planted in wmrgen's own source, and whether the everyday tests find them.

cosmic-ray plants them, one at a time, in copies of the checkout: an operator, a comparison, a number, a condition or
a loop is changed at a place that a seeded draw chooses among the lines of ``wmrgen/``. A run of the everyday tests
under coverage says which tests execute which line, and how long they take. Those of the changed line are run against
each fault until one fails: the tests of its own room first, and one case of each before a second. Coverage does not see
the processes that tests start, nor what tests read or what an earlier test has left in a cache: those of the room
(``tests/cli`` of ``wmrgen/cli``) and `READERS`, which read the sources or compare what is generated, are run whatever
they execute.
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

from pytest import Item

ROOT = Path(__file__).resolve().parent.parent
COUNT, SEED, JOBS = 200, 1, os.cpu_count() or 1
READERS = (
    "tests/trust/test_source.py",
    "tests/trust/test_imports.py",
    "tests/robotfile/wheel_types/test_one_home.py",
    "tests/gallery/test_gallery.py::test_generated_files",
)
SECONDS = 900  # of processor time for the tests of a fault, three times what all take: a loop counts as found
TIMEOUT = 3600  # s, of a fault that waits: for other work on the machine, too
# Unions of types in annotations, caches and swapped identities are faults in name alone.
_LEFT_OUT = re.compile(r"BitOr|BitAnd|BitXor|Shift|_Is|Is_|IsNot|RemoveDecorator|Variable|ExceptionReplacer")
_PYTEST = (sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider")
_EVERYDAY = (*_PYTEST, "-m", "not slow")
# Those of tests.txt, whatever mark they have; this module is its plugin.
_NAMED = shlex.join((*_PYTEST, "-x", "-m", "slow or not slow", "-p", "benchmarks.mutants", "@files.txt"))


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
    """``found``: by one of the ``tests`` that were run (their number), or since none of them ended in time (``late``).

    ``change``: the lines that differ.
    """

    fault: Fault
    tests: int
    found: bool
    late: bool
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
    """Return the faults of one file, grouped by place."""
    from cosmic_ray.ast import ast_nodes, get_ast_from_path
    from cosmic_ray.plugins import get_operator, operator_names

    tree = get_ast_from_path(ROOT / path)
    by_place: dict[tuple[int, int], list[Fault]] = {}
    for name in operator_names():
        operator = get_operator(name)
        if operator.arguments() or _LEFT_OUT.search(name):
            continue
        starts = (start for node in ast_nodes(tree) for start, _ in operator().mutation_positions(node))
        for occurrence, start in enumerate(starts):
            by_place.setdefault(start, []).append(Fault(path, name, occurrence, start[0]))
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
    there = {line for line in listed.stdout.splitlines() if "::" in line}
    cases = ElementTree.parse(times).iter("testcase")
    took = {f"{case.get('classname')}.{case.get('name')}": float(case.get("time", "1")) for case in cases}
    seconds = {test: took.get(_dotted(test), 1.0) for test in there}
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


def _dotted(test: str) -> str:
    """The name of a test as JUnit's form has it: folder.file.Class.test[case]."""
    name, bracket, case = test.partition("[")
    return name.replace(".py::", ".").replace("::", ".").replace("/", ".") + bracket + case


def pytest_collection_modifyitems(items: list[Item]) -> None:
    """Leaves pytest the tests of tests.txt, in that order. A case that a fault renames is not one that fails."""
    names = Path("tests.txt").read_text(encoding="utf-8").splitlines()
    turn = {name: k for k, name in enumerate(names)}
    items[:] = sorted((i for i in items if i.nodeid in turn), key=lambda i: turn[i.nodeid])


def _environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}


def copy_of_checkout(folder: Path) -> Path:
    """Clone the last commit."""
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
    Path("files.txt").write_text("\n".join(sorted({t.partition("::")[0] for t in tests})), encoding="utf-8")
    spec = MutationSpec(Path(fault.path), fault.operator, fault.occurrence, (fault.line, 0), (fault.line, 1))
    result = mutate_and_test([spec], _NAMED, TIMEOUT)
    if result.worker_outcome is not WorkerOutcome.NORMAL:
        raise RuntimeError(f"{fault}: {result.output}")
    lines = [line for line in (result.diff or "").splitlines() if re.match(r"[-+](?![-+])", line)]
    killed = result.test_outcome is TestOutcome.KILLED
    # pytest names what failed; it prints nothing where wmrgen cannot be imported.
    late = (
        killed
        and bool(result.output)
        and not re.search("^(FAILED|ERROR) ", result.output or "", re.MULTILINE)
    )
    return Outcome(fault, len(tests), killed, late, "\n".join(lines))


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
    """Yield the lines to print: each fault that no test finds or finishes with, its change, and the share found."""
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
        found = late = 0
        with multiprocessing.Pool(JOBS, _start, (folder, numbers)) as pool:
            for done, outcome in enumerate(pool.imap_unordered(_run, jobs), 1):
                print(f"{done} of {count}", end="\r", file=sys.stderr, flush=True)
                found += outcome.found
                late += outcome.late
                if outcome.late or not outcome.found:
                    tests_run = "tests did not end" if outcome.late else f"{outcome.tests} tests"
                    yield f"{outcome.fault}, {tests_run}\n{outcome.change}\n"
    share = f"{100 * found / count:.0f} %, {late} of them by tests that did not end"
    yield f"{found} of {count} faults found by the everyday tests ({share}), seed {seed}"


def _covering(lines: Mapping[int, Sequence[str]], line: int) -> Sequence[str]:
    """The tests of a line; of a statement over several lines, those of the line that coverage counts it by."""
    before = [k for k in lines if k <= line]
    return lines[max(before)] if before else ()
