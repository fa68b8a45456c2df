"""``wmrgen import``: a robot description of another tool to a robot file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wmrgen.cli import console
from wmrgen.cli.writing import write_robot_file
from wmrgen.errors import RobotFileError
from wmrgen.importing.robot_file import as_json as imported_json
from wmrgen.importing.robot_file import text
from wmrgen.importing.source import description_of
from wmrgen.importing.wheels import import_wheels
from wmrgen.spec.schema import MODELINE
from wmrgen.spec.text import printable


def import_robot(
    file: Path,
    arguments: Sequence[str] | None,
    out: Path | None,
    base: str | None,
    forward: str | None,
    package: Sequence[str] | None,
    as_json: bool,
) -> int:
    """Write or print the robot file; say what is open."""
    try:
        robot = import_wheels(description_of(file, arguments or (), package or ()), base, forward)
    except RobotFileError as error:
        name = printable(file.name)
        if name in error.what:
            raise
        raise RobotFileError(f"{name}: {error.what}", error.mark, error.why, error.instead) from None
    for note in robot.notes:
        console.note(f"{file.name}: note: {note}")
    written = f"{MODELINE}\n{text(robot, file.name)}"
    if out is not None:
        write_robot_file(out, written)
    if as_json:
        console.data(imported_json(robot))
    elif out is None:
        console.result(written.rstrip("\n"))
    else:
        console.result(f"{out}: {len(robot.wheels)} wheels, {len(robot.questions)} open questions")
    for question in robot.questions:
        console.note(f"open: {question.wheel}.{question.key}: {question.text}")
    return 0
