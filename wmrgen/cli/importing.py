"""``wmrgen import``: a robot description of another tool to a robot file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from wmrgen.cli import console
from wmrgen.cli.new import write_robot_file
from wmrgen.errors import RobotFileError
from wmrgen.robotfile.schema import MODELINE
from wmrgen.robotfile.text import printable
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.sources import of_controller, of_import
from wmrgen.tools.importing.controllers import read_controllers
from wmrgen.tools.importing.instructions import instructed
from wmrgen.tools.importing.records import Controller, Description, Imported
from wmrgen.tools.importing.robot_file import as_json as imported_json
from wmrgen.tools.importing.robot_file import counted, text
from wmrgen.tools.importing.source import description_of, pairs
from wmrgen.tools.importing.wheels import import_wheels


def import_robot(
    file: Path,
    arguments: Sequence[str] | None,
    out: Path | None,
    base: str | None,
    forward: str | None,
    package: Sequence[str] | None,
    controller: Sequence[Path] | None,
    as_json: bool,
) -> int:
    """Write or print the robot file; say what is open."""
    values = pairs(arguments or ())
    said = {path: read_controllers(path, values) for path in controller or ()}
    try:
        description = description_of(file, arguments or (), package or ())
        description = instructed(description, [c for each in said.values() for c in each])
        robot = import_wheels(description, base, forward)
    except RobotFileError as error:
        name = printable(file.name)
        if name in error.what:
            raise
        raise RobotFileError(
            f"{name}: {error.what}", error.mark, error.why, error.instead, error.code
        ) from None
    robot = replace(robot, notes=(*robot.notes, *_contradictions(robot, description, said, file)))
    for note in robot.notes:
        console.note(f"note: {file.name}: {note.removeprefix(f'{file.name}: ')}")
    written = f"{MODELINE}\n{text(robot, file.name)}"
    if out is not None:
        write_robot_file(out, written)
    if as_json:
        console.data(imported_json(robot))
    elif out is None:
        console.result(written.rstrip("\n"))
    else:
        console.result(f"{out}: {len(robot.wheels)} wheels, {counted(robot.questions)} open")
    for question in robot.questions:
        console.note(f"open: {question.wheel}.{question.key}: {question.text}")
    return 0


def _contradictions(
    robot: Imported, description: Description, said: Mapping[Path, Sequence[Controller]], file: Path
) -> Iterator[str]:
    """Where controllers have other lengths than the description, which stand in the robot file."""
    sources = {id(c): path.name for path, controllers in said.items() for c in controllers}
    seen = of_import(robot, description.joints, file.name)
    for each in description.controllers:
        told = of_controller(each, sources.get(id(each), file.name))
        for difference in compare(seen, told).differences:
            yield f"{told.source} differs; the description is taken: {difference.words}"
