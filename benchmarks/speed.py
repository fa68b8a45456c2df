"""Times of whole processes. Commands that are compared run alternately, A B A B, in one session."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from benchmarks.large import LARGE

ROOT = Path(__file__).resolve().parent.parent
WMRGEN = (sys.executable, "-m", "wmrgen")
IMPORTS = (sys.executable, "-c", "import sympy, casadi, numpy, jinja2, yaml")
EMPTY = (sys.executable, "-c", "pass")
# Python keeps compiled modules, as it does for everyone who installs a package.
SURROUNDINGS = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
HELP_TARGET = 0.15  # s
CHECK_TARGET = 16.0  # s, all robots derived
FRESH_TARGET = 0.07  # s, one robot that has not changed
ALL_FRESH_TARGET = 0.2  # s, all robots unchanged
RATIO_TARGET = 1.5  # of `derive` to importing the libraries, for a robot of the gallery
LARGE_TARGET = 2.5  # the same ratio for a robot of `large`
FORMATS_TARGET = 2.0  # s, what --html adds


def seconds(command: Sequence[str]) -> float:
    """Return the wall time of one run [s]. RuntimeError if the command fails."""
    start = time.perf_counter()
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=SURROUNDINGS,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    took = time.perf_counter() - start
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(command)} exited with {done.returncode}: {done.stderr.strip()}")
    return took


def alternating(
    commands: Mapping[str, Sequence[str]], runs: int, out: Path | None = None
) -> dict[str, float]:
    """Return the median time of each command [s].

    Args:
        commands: Name -> command. Each round runs all of them once; a first round is not counted.
        runs: How many rounds.
        out: A folder to remove before each command, because a derivation that changes nothing is skipped.

    Returns:
        Name -> time [s].
    """
    times: dict[str, list[float]] = {name: [] for name in commands}
    for k in range(runs + 1):
        for name, command in commands.items():
            if out is not None:
                shutil.rmtree(out, ignore_errors=True)
            took = seconds(command)
            if k:
                times[name].append(took)
    return {name: median(values) for name, values in times.items()}


def start(runs: int) -> Iterator[str]:
    """Yield the table of start-up times."""
    medians = alternating({"python -c pass": EMPTY, "wmrgen --help": (*WMRGEN, "--help")}, 2 * runs)
    yield "| start-up | median | target |"
    yield "|---|---:|---:|"
    for name, value in medians.items():
        target = f"{HELP_TARGET:.2f} s" if name.startswith("wmrgen") else ""
        yield f"| `{name}` | {value:.3f} s | {target} |"


def derive(runs: int) -> Iterator[str]:
    """Yield the table of `wmrgen derive`, all files written, relative to importing the libraries that it uses."""
    yield "| `wmrgen derive`, whole process | median | imports alone | ratio | target |"
    yield "|---|---:|---:|---:|---:|"
    ratios: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        for path, target in robots(Path(folder)):
            out = Path(folder) / "out" / path.stem
            commands = {"derive": (*WMRGEN, "derive", str(path), "-o", str(out)), "imports": IMPORTS}
            try:
                medians = alternating(commands, runs, out)
            except RuntimeError as error:
                yield f"| {path.stem} | {error} | | | {target} |"
                continue
            ratio = medians["derive"] / medians["imports"]
            ratios += [ratio] if target == RATIO_TARGET else []
            ours, imports = medians.values()
            yield f"| {path.stem} | {ours:.3f} s | {imports:.3f} s | {ratio:.2f} | {target} |"
    yield ""
    if ratios:
        yield f"Ratio over the gallery: median {median(ratios):.2f}, largest {max(ratios):.2f} (target {RATIO_TARGET})."


def formats(runs: int) -> Iterator[str]:
    """Yield the table of what --html adds to a derivation. A PDF takes what the browser takes."""
    yield "| `wmrgen derive`, whole process | median | with `--html` | beyond | target |"
    yield "|---|---:|---:|---:|---:|"
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted((ROOT / "robots").glob("*.yaml")):
            out = Path(folder) / "out"
            words = (*WMRGEN, "derive", str(path), "-o", str(out))
            plain, html = alternating({"derive": words, "html": (*words, "--html")}, runs, out).values()
            yield f"| {path.stem} | {plain:.2f} s | {html:.2f} s | {html - plain:.2f} s | {FORMATS_TARGET:.0f} s |"


def robots(folder: Path) -> Iterator[tuple[Path, float]]:
    """Yield the robot files of the gallery, then the large ones, each with the ratio that it should not exceed."""
    for path in sorted((ROOT / "robots").glob("*.yaml")):
        yield path, RATIO_TARGET
    for name, text in LARGE.items():
        path = folder / f"{name}.yaml"
        path.write_text(text, encoding="utf-8")
        yield path, LARGE_TARGET


def check(runs: int) -> Iterator[str]:
    """Yield the table of `wmrgen derive` and `wmrgen check` for robots that changed and robots that did not."""
    robot, every = "robots/pioneer3dx.yaml", [str(path) for path in sorted((ROOT / "robots").glob("*.yaml"))]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        to = ("-o", str(out))
        one, several = (*WMRGEN, "derive", *every, *to, "--jobs", "1"), (*WMRGEN, "derive", *every, *to)
        derived = alternating(
            {"one process": one, "a process for each processor": several}, min(runs, 3), out
        )
        seconds(several)
        fresh = {
            "`wmrgen check`, one robot": (*WMRGEN, "check", robot, *to),
            "`wmrgen derive`, one robot": (*WMRGEN, "derive", robot, *to),
            "`wmrgen check`, all robots": (*WMRGEN, "check", *every, *to),
        }
        unchanged = alternating(fresh, runs)
        full = median(seconds((*WMRGEN, "check", *every, *to, "--full")) for _ in range(min(runs, 3)))
    yield "| freshness | median | target |"
    yield "|---|---:|---:|"
    for name, took in unchanged.items():
        target = ALL_FRESH_TARGET if "all" in name else FRESH_TARGET
        yield f"| {name}, nothing changed | {took:.3f} s | {target} s |"
    yield f"| `wmrgen check --full`, {len(every)} robots | {full:.2f} s | {CHECK_TARGET:.0f} s |"
    for name, took in derived.items():
        yield f"| `wmrgen derive`, {len(every)} robots, {name} | {took:.2f} s | |"
