"""``wmrgen compare``: what descriptions of one robot say differently, and what that does to its motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from wmrgen.cli import console
from wmrgen.cli.loading import paths_and_arguments
from wmrgen.errors import StaleError, UsageError
from wmrgen.tools.comparing.compare import compare as compared
from wmrgen.tools.comparing.record import Comparison
from wmrgen.tools.comparing.sources import layouts


def compare(
    files: Sequence[str],
    base: str | None,
    package: Sequence[str] | None,
    as_json: bool,
) -> int:
    """Print what differs from the first file that has wheels, else the first controller, to each other. Exit code 1
    where something does."""
    paths, arguments = paths_and_arguments(files)
    every = [layout for path in paths for layout in layouts(path, arguments, package or (), base)]
    if len(every) < 2:
        raise UsageError("there is nothing to compare: give a second file")
    robot = next((layout for layout in every if not layout.controller), every[0])
    results = [compared(robot, layout) for layout in every if layout is not robot]
    if as_json:
        console.data({"robot": robot.file, "comparisons": [_as_data(c) for c in results]})
    else:
        for result in results:
            console.result("\n".join(_lines(result)))
    return StaleError.exit_code if any(c.differences for c in results) else 0


def _lines(c: Comparison) -> Iterable[str]:
    equal = "equal in what both say" if c.unsaid else "equal"
    yield f"{c.a.source} -> {c.b.source}: {'' if c.differences else equal}".rstrip()
    for d in c.differences:
        where = f"   {d.marks[0]}" if d.marks else ""
        yield f"  {d.code}  {d.words}{where}"
    for effect in c.effects:
        if effect.words:
            yield f"  {effect.motion + ':':<9} {effect.words}"
    for words in c.unsaid:
        yield f"  not compared: {words}"
    for note in c.notes:
        yield f"  note: {note}"


def _as_data(c: Comparison) -> dict[str, Any]:
    differences = [{**asdict(d), "marks": [console.place(mark) for mark in d.marks]} for d in c.differences]
    return {
        "file": c.b.file,
        "controller": c.b.title or None,
        "equal": not differences,
        "differences": differences,
        "motion": {e.motion: {"ratio": e.ratio, "words": e.words} for e in c.effects},
        "not_compared": list(c.unsaid),
        "notes": list(c.notes),
    }
