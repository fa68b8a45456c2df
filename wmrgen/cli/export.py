"""``wmrgen export``: a robot file to a description for another tool."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from wmrgen.cli import console
from wmrgen.cli.declare import Distro, Json, Robot, option_with_default, output, verb
from wmrgen.errors import UsageError

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot as Loaded

Kind = Literal["urdf", "sdf", "ros2_control", "wpilib", "nav2", "robot_localization"]


@verb("export")
def export(
    robot: Robot,
    to: Annotated[
        Kind,
        option_with_default("What to write. ros2_control: a URDF and the parameters of the controller."),
    ],
    out: Annotated[Path | None, output("DIR|FILE", "Where to write; without it the text is printed.")] = None,
    distro: Distro = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen export robots/pioneer3dx.yaml --to ros2_control -o build

    Describe a robot for another tool. Masses and other values that a robot file does not have are marked as
    placeholders. Exit code 3, with the reason, if ros2_controllers, WPILib or Nav2 has no such drive.
    """
    import wmrgen
    from wmrgen.cli.loading import print_notes
    from wmrgen.derivation.artifacts import write_file

    if distro and to != "ros2_control":
        raise UsageError("--distro names the release of ROS 2 whose parameters ros2_control writes")
    loaded = print_notes(wmrgen.load(robot))
    files = _files(loaded, to, distro)
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
        if places:
            console.result(str(places[name]))
            continue
        if len(files) > 1:
            console.result(f"==> {name} <==")
        console.result(text.rstrip("\n"))
    return 0


def _files(robot: Loaded, to: Kind, distro: Distro) -> dict[str, str]:
    """Return the texts of one kind of description by file name.

    Args:
        robot: The robot.
        to: The kind.
        distro: The release of ROS 2; None: the newest one.

    Returns:
        File name -> text.
    """
    if to == "urdf":
        from wmrgen.tools.exporting.urdf import urdf

        return {f"{robot.name}.urdf": urdf(robot)}
    if to == "sdf":
        from wmrgen.tools.exporting.sdf import sdf

        return {f"{robot.name}.sdf": sdf(robot)}
    if to == "wpilib":
        from wmrgen.tools.exporting.wpilib import wpilib

        return wpilib(robot)
    if to in ("nav2", "robot_localization"):
        from wmrgen.tools.exporting import navigation

        return navigation.nav2(robot) if to == "nav2" else navigation.robot_localization(robot)
    from wmrgen.tools.exporting.ros2_control import ros2_control

    return ros2_control(robot, distro)
