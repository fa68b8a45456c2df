"""SDFormat, as Gazebo reads it (http://sdformat.org/spec): the model of the URDF in the words of SDFormat.

Gazebo has a system for differential, Ackermann and mecanum drives; a robot that is one of them gets it, the joints of
others are commanded one by one. SDFormat has <mimic> from 1.11: readers of that convert a file of 1.8 first, older ones
pass over it.
"""

from __future__ import annotations

from wmrgen.codegen.render import render
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.bodies import bodies, context
from wmrgen.tools.exporting.drives import CORNERS, drive_of, limits_of
from wmrgen.tools.exporting.text import decimal

Plugin = tuple[str, str, list[tuple[str, str]]]
_CONTROLLERS = {
    "spin": ("JointController", "joint-controller"),
    "steer": ("JointPositionController", "joint-position-controller"),
}
_SYSTEMS = {
    "differential": (
        "DiffDrive", "diff-drive",
        {"left_joint": "left", "right_joint": "right", "wheel_separation": "separation", "wheel_radius": "radius",
         "min_linear_velocity": "vx.low", "max_linear_velocity": "vx.high",
         "min_angular_velocity": "omega.low", "max_angular_velocity": "omega.high"},
    ),
    "mecanum": (
        "MecanumDrive", "mecanum-drive",
        {**{f"{corner.replace('rear', 'back')}_joint": corner for corner in CORNERS},
         "wheelbase": "wheelbase", "wheel_separation": "track", "wheel_radius": "radius"},
    ),
    "ackermann": (
        "AckermannSteering", "ackermann-steering",
        {"right_joint": "right_traction", "left_joint": "left_traction",
         "right_steering_joint": "right_steering", "left_steering_joint": "left_steering",
         "wheel_base": "wheelbase", "wheel_separation": "traction_track", "kingpin_width": "steering_track",
         "wheel_radius": "radius", "steering_limit": "least_turn",
         "min_velocity": "vx.low", "max_velocity": "vx.high"},
    ),
}  # fmt: skip


def sdf(robot: Robot) -> str:
    """The model of a robot, with Gazebo's system for its drive where there is one."""
    links, printed = bodies(robot), context(robot)
    try:
        plugin, notes = _drive(robot)
        plugins = [plugin]
    except NotDerivableError as error:
        plugins = [(*_CONTROLLERS[b.part], [("joint_name", b.joint)]) for b in links if b.driven]
        notes = (f"No system of Gazebo drives it: {error.what}. Its joints are commanded one by one.",)
    printed["about"] += notes
    return render("export/robot.sdf.j2", bodies=links, plugins=plugins, **printed)


def _drive(robot: Robot) -> tuple[Plugin, tuple[str, ...]]:
    """The system of a robot's drive, and what is to say of it. NotDerivableError where Gazebo has none."""
    drive = drive_of(robot, _SYSTEMS)
    name, file, terms = _SYSTEMS[drive.kind]
    values = drive.named(terms, limits_of(robot))
    texts = {tag: [decimal(value)] if isinstance(value, float) else value for tag, value in values.items()}
    return (name, file, [(tag, text) for tag in texts for text in texts[tag]]), drive.notes
