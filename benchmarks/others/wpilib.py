"""WPILib's kinematics on the host, from the C++ of the robotpy-native-wpimath package; valgrind counts."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.jobs import derivations
from wmrgen.codegen.c import sources
from wmrgen.ir.kernels.choice import MATHS, Choice

ROBOTS = {"differential": "textbook_differential", "mecanum": "clearpath_do100", "swerve": "wpilib_swervebot"}
CALLS = 500
_PROGRAM = Path(__file__).with_suffix(".cpp")


def missing() -> str:
    """Return the names of missing tools; empty if the table can be made."""
    if importlib.util.find_spec("native") is None or importlib.util.find_spec("native.wpimath") is None:
        return "robotpy-wpimath (pip)"
    return ", ".join(tool for tool in ("gcc", "g++", "valgrind") if shutil.which(tool) is None)


def _places() -> list[Path]:
    folders = []
    for name in ("native.wpimath", "native.wpiutil"):
        spec = importlib.util.find_spec(name)
        assert spec is not None and spec.submodule_search_locations
        folders.append(Path(spec.submodule_search_locations[0]))
    return folders


def _run(*words: str | Path, folder: Path) -> str:
    done = subprocess.run(
        [str(w) for w in words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(f"{words[0]} failed:\n{done.stderr[:3000]}")
    return done.stderr


def build(folder: Path) -> list[Path]:
    """Build a program for each of `MATHS` that calls WPILib or wmrgen."""
    flags = [
        word
        for p in _places()
        for word in ("-isystem", p / "include", "-L", p / "lib", f"-Wl,-rpath,{p / 'lib'}")
    ]
    files = [f"{robot}.c" for robot in ROBOTS.values()]
    programs = []
    for math in MATHS:
        for robot in ROBOTS.values():
            header, source = sources(derivations()[robot].c_module, Choice(math=math, target="host"))
            (folder / f"{robot}.h").write_text(header)
            (folder / f"{robot}.c").write_text(source)
        if not programs:  # the structs are the same for each
            _run("g++", "-O2", "-std=c++20", "-I.", *flags, "-c", _PROGRAM, "-o", "calls.o", folder=folder)
        _run("gcc", "-O2", "-std=c99", "-c", *files, folder=folder)
        objects = [f"{robot}.o" for robot in ROBOTS.values()]
        _run("g++", "calls.o", *objects, *flags, "-lwpimath", "-lwpiutil", "-lm", "-o", math, folder=folder)
        programs.append(folder / math)
    return programs


def count(program: Path, function: str) -> float:
    """Return the instructions per call, inputs included, from the difference that `CALLS` more calls make."""
    totals = [_total(program, function, n) for n in (CALLS, 2 * CALLS)]
    return (totals[1] - totals[0]) / CALLS


def _total(program: Path, function: str, calls: int) -> int:
    with tempfile.TemporaryDirectory() as folder:
        words = ("valgrind", "--tool=callgrind", "--callgrind-out-file=out", program, function, str(calls))
        told = _run(*words, folder=Path(folder))
    collected = re.search(r"Collected\s*:\s*(\d+)", told)
    assert collected is not None, told
    return int(collected[1])


def table() -> Iterator[str]:
    """Yield the instructions of WPILib and of wmrgen, in Markdown."""
    if missing():
        yield f"WPILib on the host: needs {missing()}."
        return
    yield "Instructions per call on x86-64 with `-O2`, the call with its inputs; WPILib computes in double:"
    yield ""
    yield f"| layout | function | WPILib | {' | '.join(f'wmrgen, {math}' for math in MATHS)} |"
    yield f"|---|---|---:|{'---:|' * len(MATHS)}"
    with tempfile.TemporaryDirectory() as name:
        programs = build(Path(name))
        for layout in ROBOTS:
            for function in ("inverse", "forward"):
                cells = [count(programs[0], f"wpilib_{layout}_{function}")]
                cells += [count(program, f"wmrgen_{layout}_{function}") for program in programs]
                yield f"| {layout} | {function} | {' | '.join(f'{cell:.0f}' for cell in cells)} |"
