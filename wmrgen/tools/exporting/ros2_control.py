"""Write the URDF and the controller's parameters of a robot for ros2_control.

The <ros2_control> of the URDF names the joints with their commands and states. The parameters are those of the
controller of ros2_controllers whose formula is the robot's inverse kinematics (`tools/controllers`). Without a release,
names are those of ros2_controllers 5 and later (Kilted and Rolling).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.controllers import ros2_controller
from wmrgen.tools.controllers.record import Distro
from wmrgen.tools.exporting.drives import drive_with, limits_of, refusing
from wmrgen.tools.exporting.text import banner, decimal
from wmrgen.tools.exporting.urdf import urdf

NAME = "base_controller"
_OWN_CONTROLLER = (
    "`wmrgen derive ROBOT.yaml --package ros2` writes a controller for ros2_control that fits this robot."
)


def ros2_control(robot: Robot, distro: Distro | None = None) -> dict[str, str]:
    """Return ``<robot>.urdf`` and ``<robot>_controllers.yaml``.

    Args:
        robot: The robot.
        distro: The release of ROS 2 whose parameters are written; None: the newest one.

    Raises:
        NotDerivableError: No controller fits, with the reason.
    """
    motors = any(wheel.actuated for wheel in robot.wheels)
    with refusing(f"{robot.name}: no controller of ros2_controllers fits", _OWN_CONTROLLER if motors else ""):
        drive, record = drive_with(robot, ros2_controller)
        if distro in record.absent:
            raise NotDerivableError(f"{distro} has no {record.name}")
        release = record.release(distro)
        limits = limits_of(robot)
        values: dict[str, Any] = dict(drive.named(release.names, limits))
    for path, (word, term) in release.constants.items():
        if not term or term in limits:
            values[path] = word
    manager = {
        "update_rate": 100,
        "joint_state_broadcaster": {"type": "joint_state_broadcaster/JointStateBroadcaster"},
        NAME: {"type": record.name},
    }
    own: dict[str, Any] = {"base_frame_id": robot.frame, "odom_frame_id": "odom"}
    for path, value in values.items():
        *groups, key = path.split(".")
        place = own
        for group in groups:
            place = place.setdefault(group, {})
        place[key] = value[0] if isinstance(value, tuple) and not key.endswith("names") else value
    version = f"in {distro.title()}" if distro else "5 and later"
    lines = [*banner(robot), f"Parameters of ros2_controllers {version}. [m], [rad], [s]", *drive.notes]
    if distro and distro in record.older_commands:
        lines.append(
            f"The formula of {distro.title()} is an older one. Check it: wmrgen compare --distro {distro}"
        )
    tree = {name: {"ros__parameters": v} for name, v in (("controller_manager", manager), (NAME, own))}
    return {
        f"{robot.name}.urdf": urdf(robot, control=True),
        f"{robot.name}_controllers.yaml": "".join(f"# {line}\n" for line in lines)
        + "".join(yaml_lines(tree)),
    }


def yaml_lines(tree: Mapping[str, Any], indent: str = "") -> list[str]:
    """Return the lines of a YAML file. A float has a point, because ROS distinguishes it from an integer."""
    lines = []
    for key, value in tree.items():
        if isinstance(value, Mapping):
            lines += [f"{indent}{key}:\n", *yaml_lines(value, f"{indent}  ")]
        else:
            written = f"[{', '.join(value)}]" if isinstance(value, tuple) else value
            lines.append(f"{indent}{key}: {pointed(value) if isinstance(value, float) else written}\n")
    return lines


def pointed(value: float) -> str:
    """Return a number with a point."""
    digits, e, exponent = decimal(value).partition("e")
    return digits + ("" if "." in digits else ".0") + e + exponent
