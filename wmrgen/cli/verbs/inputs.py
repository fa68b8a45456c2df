"""Robot files: where they come from, what they may say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from wmrgen.cli.declare import Base, Json, Package, Robots, Words, argument, group, option, output

verb = group("Robot files")


def _gallery(incomplete: str) -> list[str]:
    from wmrgen.cli.gallery import gallery

    return [name for name in gallery() if name.startswith(incomplete)]


@verb("gallery", "List the robots that come with wmrgen.", "list")
def list_robots(as_json: Json = False) -> None:
    """Example:  wmrgen list

    List the gallery: name, type (mobility, steerability) and description of every robot that comes with wmrgen.
    """


@verb("new", "Begin a robot file as one of the gallery.")
def new(
    name: Annotated[str | None, argument("[NAME]", "What the robot is called, and its file.")] = None,
    values: Annotated[
        Words, argument("[PARAMETER=VALUE]...", "Values of its parameters: radius='50 mm'.")
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="ROBOT", help="One that `wmrgen list` tells.", autocompletion=_gallery
        ),
    ] = None,
    description: Annotated[str | None, option("What robot it is.", "TEXT")] = None,
    out: Annotated[Path | None, output("ROBOT.yaml", "The file, NAME.yaml otherwise.")] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen new my_robot --from pioneer3dx radius="50 mm"

    Write a robot file that begins as one of the gallery, with a comment on every key. It can be derived as it is; on
    a terminal, what is not given is asked. Beside it stands robot.schema.json, by which editors check and complete.
    """


@verb("importing", "Make a robot file of a URDF, xacro or SDF.", "import")
def import_robot(
    file: Annotated[Path, argument("FILE", "A robot description: URDF, xacro or SDF.")],
    arguments: Annotated[Words, argument("[NAME:=VALUE]...", "Arguments of a xacro file.")] = None,
    out: Annotated[
        Path | None,
        output("ROBOT.yaml", "Write the robot file; otherwise it is printed."),
    ] = None,
    base: Base = None,
    forward: Annotated[
        Literal["x", "y", "-x", "-y"] | None, option("The direction of that frame that is forward.")
    ] = None,
    package: Package = None,
    controller: Annotated[
        list[Path] | None, option("Parameters of the wheels' controller, too: YAML.", "FILE.yaml")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen import my_robot.urdf -o my_robot.yaml

    Make a robot file of a robot description. Wheels are told by geometry; what the file does not say stands as TODO
    with its question, and derive refuses the file until it is answered.
    """


@verb("fmt", "Lay out robot files alike.")
def fmt(
    robots: Robots,
    only_check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit code 1 where a file would change.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen fmt robots/*.yaml

    Lay out robot files alike: indentation, columns of wheels one below the other, spaces at brackets and comments.
    Words, comments and their lines stay, and so does the robot. What no robot file may have is refused and not
    rewritten: anchors and aliases, for which there are parameters, and tags.
    """


@verb("model", "Print the JSON Schema of robot files.")
def schema(
    as_markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the keys as a page to read.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen schema > robot.schema.json

    Print the JSON Schema of robot files, for editors and validators; with --markdown their reference.
    """
