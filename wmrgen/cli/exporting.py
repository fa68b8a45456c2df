"""``wmrgen export``: a robot file to a description for another tool."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import wmrgen
from wmrgen.artifacts import write_file
from wmrgen.cli import console
from wmrgen.cli.loading import noted
from wmrgen.errors import UsageError
from wmrgen.exporting.ros2_control import ros2_control
from wmrgen.exporting.sdf import sdf
from wmrgen.exporting.urdf import urdf
from wmrgen.exporting.wpilib import wpilib
from wmrgen.layout.records import Robot

_KINDS: dict[str, Callable[[Robot], dict[str, str]]] = {
    "urdf": lambda robot: {f"{robot.name}.urdf": urdf(robot)},
    "sdf": lambda robot: {f"{robot.name}.sdf": sdf(robot)},
    "ros2_control": ros2_control,
    "wpilib": wpilib,
}


def export(robot: Path, to: str, out: Path | None, as_json: bool) -> int:
    """Write or print the files of one kind."""
    loaded = noted(wmrgen.load(robot))
    files = _KINDS[to](loaded)
    places = {name: out / name for name in files} if out else {}
    if out and out.suffix and not out.is_dir():
        if len(files) > 1:
            raise UsageError(f"{to} is {len(files)} files: {', '.join(files)}. Give a folder: -o DIR.")
        places = dict.fromkeys(files, out)
    for name, place in places.items():
        try:
            write_file(place, files[name].encode())
        except ValueError as error:
            raise UsageError(str(error)) from None
    if as_json:
        console.data({"robot": loaded.name, "to": to, "files": files})
        return 0
    for name, text in files.items():
        if name in places:
            console.result(str(places[name]))
            continue
        if len(files) > 1:
            console.result(f"==> {name} <==")
        console.result(text.rstrip("\n"))
    return 0
