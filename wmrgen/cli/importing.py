"""``wmrgen import``: a robot description of another tool to a robot file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from wmrgen.cli import console
from wmrgen.cli.declare import Base, Json, Package, Words, argument, option, output, verb
from wmrgen.errors import RobotFileError

if TYPE_CHECKING:
    from wmrgen.tools.importing.records import Controller, Description, Imported

    Parameters = Mapping[Path, Sequence[Controller]]  # by the file that has them


@verb("import")
def import_robot(
    file: Annotated[Path, argument("FILE", "A robot description: URDF, xacro or SDF.")],
    arguments: Annotated[Words, argument("[NAME:=VALUE]...", "Arguments of a xacro file.")] = None,
    out: Annotated[
        Path | None, output("ROBOT.yaml", "Write the robot file; without it the text is printed.")
    ] = None,
    base: Base = None,
    forward: Annotated[
        Literal["x", "y", "-x", "-y"] | None,
        option("The direction that is forward, in the frame of the robot's link."),
    ] = None,
    package: Package = None,
    workspace: Annotated[
        Path | None, option("A folder with ROS packages, such as src of a workspace.", "DIR")
    ] = None,
    controller: Annotated[
        list[Path] | None, option("Read parameters of the wheels' controller too: YAML.", "FILE.yaml")
    ] = None,
    answer: Annotated[
        list[str] | None,
        option(
            "Answer a question, such as left.r=0.1; the robot file has the value in place of TODO.",
            "WHEEL.KEY=VALUE",
        ),
    ] = None,
    update: Annotated[
        Path | None, option("Take the answers to the same questions from this robot file.", "ROBOT.yaml")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen import my_robot.urdf -o my_robot.yaml

    Make a robot file from a robot description. Wheels are recognised by their geometry. Values that the description
    does not have become TODO with a question; `wmrgen derive` rejects the file until they are filled in.
    """
    from wmrgen.cli.new import write_robot_file
    from wmrgen.robotfile.schema import MODELINE
    from wmrgen.tools.importing.answers import answered, read_answers, updated
    from wmrgen.tools.importing.controllers import read_controllers
    from wmrgen.tools.importing.robot_file import as_json as imported_json
    from wmrgen.tools.importing.robot_file import counted, text
    from wmrgen.tools.importing.source import packages_in, pairs

    values = pairs(arguments or ())
    parameters = {path: read_controllers(path, values) for path in controller or ()}
    found = {} if workspace is None else packages_in(workspace)
    packages = [*(f"{name}={folder}" for name, folder in found.items()), *(package or ())]
    robot = _imported(file, arguments or (), base, forward, packages, parameters)
    if update is not None:
        robot = updated(robot, update)
    robot = answered(robot, read_answers(answer or ()))
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


def _imported(
    file: Path,
    arguments: Sequence[str],
    base: str | None,
    forward: str | None,
    package: Sequence[str],
    parameters: Parameters,
) -> Imported:
    """Return the robot of a description and of ``parameters`` of controllers. Errors name the file."""
    from wmrgen.robotfile.text import printable
    from wmrgen.tools.importing.instructions import instructed
    from wmrgen.tools.importing.source import description_of
    from wmrgen.tools.importing.wheels import import_wheels

    controllers = [controller for each in parameters.values() for controller in each]
    try:
        description = instructed(description_of(file, arguments, package), controllers)
        robot = import_wheels(description, base, forward)
    except RobotFileError as error:
        name = printable(file.name)
        if name in error.what:
            raise
        raise RobotFileError(
            f"{name}: {error.what}", error.mark, error.why, error.instead, error.code
        ) from None
    return replace(robot, notes=(*robot.notes, *_contradictions(robot, description, parameters, file)))


def _contradictions(
    robot: Imported, description: Description, parameters: Parameters, file: Path
) -> Iterator[str]:
    """Yield where a controller has other lengths than the description, from which the robot file takes them."""
    from wmrgen.tools.comparing.compare import compare
    from wmrgen.tools.comparing.sources import of_controller, of_import

    sources = {id(c): path.name for path, controllers in parameters.items() for c in controllers}
    imported = of_import(robot, description.joints, file.name)
    for controller in description.controllers:
        layout = of_controller(controller, sources.get(id(controller), file.name))
        for difference in compare(imported, layout).differences:
            yield f"{layout.source} differs; the description is used: {difference.words}"
