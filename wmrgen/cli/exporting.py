"""``wmrgen export``: a robot file to a description for another tool."""

from __future__ import annotations

from pathlib import Path

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import noted
from wmrgen.derivation.artifacts import write_file
from wmrgen.errors import UsageError
from wmrgen.tools.exporting.ros2_control import ros2_control
from wmrgen.tools.exporting.sdf import sdf
from wmrgen.tools.exporting.urdf import urdf
from wmrgen.tools.exporting.wpilib import wpilib

_KINDS = {
    "urdf": lambda robot: {f"{robot.name}.urdf": urdf(robot)},
    "sdf": lambda robot: {f"{robot.name}.sdf": sdf(robot)},
    "ros2_control": ros2_control,
    "wpilib": wpilib,
}


def export(robot: Path, to: str, out: Path | None, as_json: bool) -> int:
    """Write or print the files of one kind. ``out`` is a file where it ends as the one file of a kind."""
    loaded = noted(wmrgen.load(robot))
    files: dict[str, str] = _KINDS[to](loaded)
    is_file = out is not None and out.suffix in {".xml", *(Path(name).suffix for name in files)}
    if is_file and len(files) > 1:
        raise UsageError(f"{to} is {len(files)} files: {', '.join(files)}. Give a folder: -o DIR.")
    places = {name: out if is_file else out / name for name in files} if out else {}
    for name, place in places.items():
        write_file(place, files[name].encode())
    if as_json:
        console.data({"robot": loaded.name, "to": to, "files": files})
        return 0
    for name, text in files.items():
        if len(files) > 1 and not places:
            console.result(f"==> {name} <==")
        console.result(str(places[name]) if places else text.rstrip("\n"))
    return 0
