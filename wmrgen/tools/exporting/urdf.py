"""Write URDF, as robot_state_publisher, RViz and Gazebo read it (https://wiki.ros.org/urdf/XML).

Motors are <transmission> elements, which `wmrgen import` reads. Friction is in a <gazebo> element, which Gazebo assigns
to the collision of the link.
"""

from __future__ import annotations

from wmrgen.codegen.render import render
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.bodies import bodies, context

_INTERFACES = {"spin": "Velocity", "steer": "Position"}  # of commands
_COMMANDS = {"spin": "velocity", "steer": "position"}


def urdf(robot: Robot, control: bool = False) -> str:
    """Return the description of a robot, with a <transmission> for each joint that has a motor.

    With ``control`` it has a <ros2_control> of the joints that are driven or measured instead.
    """
    links = bodies(robot)
    transmissions = [(b.joint, _INTERFACES[b.part]) for b in links if b.driven]
    used = [b for b in links if b.driven or b.part in (*b.wheel.sensed, *b.wheel.actuated)]
    controls = [[(b.joint, [_COMMANDS[b.part]] if b.driven else []) for b in used]]
    ways = {"transmissions": [] if control else transmissions, "controls": controls if control else []}
    return render("export/robot.urdf.j2", bodies=links, **ways, **context(robot))
