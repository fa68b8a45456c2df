"""Write SDFormat, as Gazebo reads it (http://sdformat.org/spec), with the same links as the URDF.

A robot with a differential, Ackermann or mecanum drive gets Gazebo's system for it; the joints of other robots are
commanded one by one. SDFormat has <mimic> from 1.11; older readers ignore it.
"""

from __future__ import annotations

from wmrgen.codegen.render import render
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.controllers import gazebo_system
from wmrgen.tools.exporting.bodies import bodies, context
from wmrgen.tools.exporting.drives import drive_with, limits_of
from wmrgen.tools.exporting.text import decimal

Plugin = tuple[str, str, list[tuple[str, str]]]
_CONTROLLERS = {
    "spin": ("JointController", "joint-controller"),
    "steer": ("JointPositionController", "joint-position-controller"),
}


def sdf(robot: Robot) -> str:
    """Return the model of a robot, with Gazebo's system for its drive if there is one."""
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
    """Return the system of a robot's drive with notes; raise NotDerivableError if Gazebo has none."""
    drive, record = drive_with(robot, gazebo_system)
    values = drive.named(record.names, limits_of(robot))
    texts = {tag: [decimal(value)] if isinstance(value, float) else value for tag, value in values.items()}
    return (record.name, record.tag, [(tag, text) for tag in texts for text in texts[tag]]), drive.notes
