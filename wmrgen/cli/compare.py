"""``wmrgen compare``: differences between descriptions of one robot, and what they do to its motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Base, Distro, Json, Package, argument, verb
from wmrgen.cli.loading import paths_and_arguments
from wmrgen.errors import NotDerivableError, StaleError, UsageError

if TYPE_CHECKING:
    from wmrgen.tools.comparing.record import Comparison


@verb("compare")
def compare(
    files: Annotated[
        list[str],
        argument(
            "FILE...",
            "Robot files, URDF, xacro, SDF, controllers' YAML, generated headers; NAME:=VALUE for xacro.",
        ),
    ],
    base: Base = None,
    package: Package = None,
    distro: Distro = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen compare my_robot.urdf controllers.yaml

    Compare each file with the first one that has wheels: track, wheelbase, radius, signs, rollers, order, limits. For
    a known controller, compare the command of each joint with the robot's inverse kinematics. Print how that robot
    moves if it is commanded with the numbers of the other file. Lengths and rates within 0.2 % and angles within
    0.002 rad are equal. Exit code 1 if there are differences, 3 if the files have nothing in common.
    """
    from wmrgen.tools.comparing.compare import compare as compared
    from wmrgen.tools.comparing.sources import layouts

    paths, arguments = paths_and_arguments(files)
    every = [layout for path in paths for layout in layouts(path, arguments, package or (), base, distro)]
    if len(every) < 2:
        raise UsageError("there is nothing to compare: give a second file")
    robot = next((layout for layout in every if not layout.controller), every[0])
    results = [compared(robot, layout) for layout in every if layout is not robot]
    if as_json:
        console.data({"robot": robot.file, "comparisons": [_as_data(c) for c in results]})
    else:
        for result in results:
            console.result("\n".join(_lines(result)))
    if any(c.differences for c in results):
        return StaleError.exit_code
    return 0 if all(c.compared for c in results) else NotDerivableError.exit_code


def _lines(c: Comparison) -> Iterator[str]:
    """Yield a comparison as lines to read."""
    verdict = ""
    if not c.compared:
        verdict = "nothing compared: the files have nothing in common"
    elif not c.differences:
        verdict = "equal in everything that both have" if c.unsaid else "equal"
    yield f"{c.a.source} -> {c.b.source}: {verdict}".rstrip()
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
    differences = []
    for d in c.differences:
        places = [console.place(mark) for mark in d.marks]
        differences.append({**asdict(d), "marks": places})
    return {
        "file": c.b.file,
        "controller": c.b.title or None,
        "compared": c.compared,
        "equal": not differences if c.compared else None,
        "differences": differences,
        "motion": {e.motion: {"ratio": e.ratio, "words": e.words} for e in c.effects},
        "not_compared": list(c.unsaid),
        "notes": list(c.notes),
    }
