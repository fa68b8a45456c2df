"""Robot files: where they come from, what they may say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wmrgen.cli.declare import Json, Words, argument, group, option

verb = group("Robot files")


@verb("importing", "Make a robot file of a URDF or xacro.", "import")
def import_robot(
    file: Annotated[Path, argument("FILE", "A robot description: URDF or xacro.")],
    arguments: Annotated[Words, argument("[NAME:=VALUE]...", "Arguments of a xacro file.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", metavar="ROBOT.yaml", help="Write the robot file; otherwise it is printed."
        ),
    ] = None,
    base: Annotated[str | None, option("The link that is the robot's frame.", "LINK")] = None,
    package: Annotated[
        list[str] | None, option("The folder of a package that the file finds.", "NAME=DIR")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen import my_robot.urdf -o my_robot.yaml

    Make a robot file of a robot description. Wheels are told by geometry; what the file does not say stands as TODO
    with its question, and derive refuses the file until it is answered.
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
