"""URDF, as robot_state_publisher, RViz and Gazebo read it (https://wiki.ros.org/urdf/XML).

What drives the robot stands in <transmission>, which URDF has for it; `wmrgen import` reads it. Friction stands in a
<gazebo> tag, which Gazebo joins to a collision without a name of its own.
"""

from __future__ import annotations

from wmrgen.codegen.render import render
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.bodies import bodies, context

_INTERFACES = {"spin": "Velocity", "steer": "Position"}  # of commands
_COMMANDS = {"spin": "velocity", "steer": "position"}


def urdf(robot: Robot, control: bool = False) -> str:
    """The description of a robot, with a <transmission> for each joint that has a motor; with ``control``, a
    <ros2_control> of the joints that are driven or measured."""
    links = bodies(robot)
    transmissions = [(b.joint, _INTERFACES[b.part]) for b in links if b.driven]
    used = [b for b in links if b.driven or b.part in (*b.wheel.sensed, *b.wheel.actuated)]
    controls = [[(b.joint, [_COMMANDS[b.part]] if b.driven else []) for b in used]]
    ways = {"transmissions": [] if control else transmissions, "controls": controls if control else []}
    return render("export/robot.urdf.j2", bodies=links, **ways, **context(robot))
