"""SDFormat, as Gazebo reads it (http://sdformat.org/spec): the model of the URDF in the words of SDFormat.

Gazebo has a system for differential, Ackermann and mecanum drives; a robot that is one of them gets it, the joints of
others are commanded one by one. SDFormat has <mimic> from 1.11: readers of that convert a file of 1.8 first, older ones
pass over it.
"""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element

from wmrgen.errors import NotDerivableError
from wmrgen.exporting.bodies import BASE, PLACEHOLDERS, bodies
from wmrgen.exporting.drives import CORNERS, drive_of, limits_of
from wmrgen.exporting.text import GAZEBO, banner, decimal, document, element
from wmrgen.exporting.urdf import described
from wmrgen.layout.records import Robot

_KEPT = {"name", "type", "reference"}  # attributes that SDFormat has; others are elements there
_TEXTS = {"link", "value"}  # attributes that are the text of their element
_AXIS = ("limit", "mimic")  # what stands in <axis>
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
    links = described(robot, lambda _, __: [])
    try:
        plugins, notes = _drive(robot)
    except NotDerivableError as error:
        plugins = [
            _plugin(*_CONTROLLERS[body.part], {"joint_name": (body.joint,)})
            for body in bodies(robot)
            if body.driven
        ]
        notes = (f"No system of Gazebo drives it: {error.what}. Its joints are commanded one by one.",)
    model = _model(links)
    model.extend(plugins)
    root = element("sdf", model, version="1.8")
    root.set("xmlns:gz", GAZEBO)
    frame = f"The model frame and {BASE} are the frame of the robot file: P, on the ground, x forward."
    return document([*banner(robot), frame, PLACEHOLDERS, *notes], root)


def _drive(robot: Robot) -> tuple[list[Element], tuple[str, ...]]:
    """The <plugin> of a robot's drive, and what is to say of it. NotDerivableError where Gazebo has none."""
    drive = drive_of(robot)
    if drive.kind not in _SYSTEMS:
        raise NotDerivableError(f"it has none for {drive.kind} drives")
    name, file, terms = _SYSTEMS[drive.kind]
    return [_plugin(name, file, drive.named(terms, limits_of(robot)))], drive.notes


def _plugin(name: str, file: str, values: Mapping[str, float | tuple[str, ...]]) -> Element:
    plugin = element("plugin", filename=f"gz-sim-{file}-system", name=f"gz::sim::systems::{name}")
    for tag, value in values.items():
        texts = (decimal(value),) if isinstance(value, float) else value
        plugin.extend([element(tag, text=text) for text in texts])
    return plugin


def _model(robot: Element) -> Element:
    """<model> of a <robot>: a joint's <origin> becomes the <pose> of its child link in its parent."""
    links = {link.get("name", ""): _converted(link) for link in robot.iter("link")}
    for name, link in links.items():
        for shape in link:
            if shape.tag in ("visual", "collision"):
                shape.set("name", f"{name}_{shape.tag}")
    parts: list[Element] = []
    for part in robot:
        if part.tag == "link":
            parts.append(links[part.get("name", "")])
        elif part.tag == "joint":
            joint = _converted(part)
            pose, child, parent = (joint.find(tag) for tag in ("pose", "child", "parent"))
            if pose is not None and child is not None and parent is not None:
                joint.remove(pose)
                pose.set("relative_to", parent.text or "")
                links[child.text or ""].insert(0, pose)
            for axis in joint.findall("axis"):
                for moved in [e for e in joint if e.tag in _AXIS]:
                    joint.remove(moved)
                    axis.append(moved)
            parts.append(joint)
        elif part.tag == "gazebo":
            collision = links[part.get("reference", "")].find("collision")
            if collision is not None:
                collision.extend(part[0])
        else:
            parts.append(part)
    return element("model", *parts, name=robot.get("name", ""), canonical_link=BASE)


def _converted(e: Element) -> Element:
    """An element of URDF with its attributes as elements, but for names and types."""
    if not isinstance(e.tag, str):
        return e
    if e.tag == "origin":
        return element("pose", text=f"{e.get('xyz')} {e.get('rpy')}")
    kept = {
        key: value for key, value in e.attrib.items() if key in _KEPT or (e.tag, key) == ("mimic", "joint")
    }
    made = element(
        e.tag, *map(_converted, e), text=next((e.attrib[k] for k in e.attrib if k in _TEXTS), ""), **kept
    )
    made.extend([element(k, text=v) for k, v in e.attrib.items() if k not in kept and k not in _TEXTS])
    return made
