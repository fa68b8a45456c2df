"""Times of whole processes. Commands that are compared run in turn, A B A B, in one session."""

from __future__ import annotations

import os
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
# Compiled modules are kept, as they are for everyone who installs a package.
SURROUNDINGS = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
HELP_TARGET, CHECK_TARGET, RATIO_TARGET, LARGE_TARGET, FORMATS_TARGET = 0.15, 16.0, 1.5, 2.5, 2.0


def seconds(command: Sequence[str]) -> float:
    """Wall time of one run. A command that fails is an error."""
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


def in_turn(commands: Mapping[str, Sequence[str]], runs: int) -> dict[str, float]:
    """The median time of each command, all run once per round; one round before that is not counted."""
    times: dict[str, list[float]] = {name: [] for name in commands}
    for k in range(runs + 1):
        for name, command in commands.items():
            took = seconds(command)
            if k:
                times[name].append(took)
    return {name: median(values) for name, values in times.items()}


def start(runs: int) -> Iterator[str]:
    """Start-up: what everyone waits for."""
    medians = in_turn({"python -c pass": EMPTY, "wmrgen --help": (*WMRGEN, "--help")}, 2 * runs)
    yield "| start-up | median | target |"
    yield "|---|---:|---:|"
    for name, value in medians.items():
        target = f"{HELP_TARGET:.2f} s" if name.startswith("wmrgen") else ""
        yield f"| `{name}` | {value:.3f} s | {target} |"


def derive(runs: int) -> Iterator[str]:
    """`wmrgen derive`, everything written, against importing the libraries it uses."""
    yield "| `wmrgen derive`, whole process | median | imports alone | ratio | target |"
    yield "|---|---:|---:|---:|---:|"
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for path, target in robots(Path(folder)):
            out = Path(folder) / "out" / path.stem
            commands = {"derive": (*WMRGEN, "derive", str(path), "-o", str(out)), "imports": IMPORTS}
            try:
                medians = in_turn(commands, runs)
            except RuntimeError as error:
                yield f"| {path.stem} | {error} | | | {target} |"
                continue
            ratio = medians["derive"] / medians["imports"]
            worst = max(worst, ratio) if target == RATIO_TARGET else worst
            ours, imports = medians.values()
            yield f"| {path.stem} | {ours:.3f} s | {imports:.3f} s | {ratio:.2f} | {target} |"
    yield ""
    yield f"Largest ratio over the gallery: {worst:.2f} (target {RATIO_TARGET})."


def formats(runs: int) -> Iterator[str]:
    """The report for a browser, beyond the derivation; a PDF is a browser's work."""
    yield "| `wmrgen derive`, whole process | median | with `--html` | beyond | target |"
    yield "|---|---:|---:|---:|---:|"
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted((ROOT / "robots").glob("*.yaml")):
            words = (*WMRGEN, "derive", str(path), "-o", str(Path(folder) / "out"))
            plain, html = in_turn({"derive": words, "html": (*words, "--html")}, runs).values()
            yield f"| {path.stem} | {plain:.2f} s | {html:.2f} s | {html - plain:.2f} s | {FORMATS_TARGET:.0f} s |"


def robots(folder: Path) -> Iterator[tuple[Path, float]]:
    """Every robot file of the gallery, then the large ones, with the ratio to stay below."""
    for path in sorted((ROOT / "robots").glob("*.yaml")):
        yield path, RATIO_TARGET
    for name, text in LARGE.items():
        path = folder / f"{name}.yaml"
        path.write_text(text, encoding="utf-8")
        yield path, LARGE_TARGET


def check(runs: int) -> Iterator[str]:
    """`wmrgen check` over the whole gallery."""
    took = median(seconds((*WMRGEN, "check")) for _ in range(min(runs, 3)))
    count = len(list((ROOT / "robots").glob("*.yaml")))
    yield "| freshness | median | target |"
    yield "|---|---:|---:|"
    yield f"| `wmrgen check`, {count} robots | {took:.2f} s | {CHECK_TARGET:.0f} s |"
