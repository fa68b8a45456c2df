"""URDF, as robot_state_publisher, RViz and Gazebo read it (https://wiki.ros.org/urdf/XML).

What drives the robot stands in <transmission>, which URDF has for it; `wmrgen import` reads it. A wheel with rollers is
a cylinder that grips along the roller's axis at the ground: <gazebo> with fdir1, seen from base_link, which does not
turn with the wheel. Gazebo joins that to a collision without a name of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import degrees, pi
from xml.etree.ElementTree import Element

from wmrgen.exporting.bodies import (
    BASE,
    EFFORT,
    MASSES,
    PLACEHOLDERS,
    SPEED,
    WIDTH,
    Body,
    Vector,
    bodies,
    chassis,
)
from wmrgen.exporting.text import GAZEBO, banner, comment, decimal, decimals, document, element
from wmrgen.importing.records import RIGID
from wmrgen.layout.records import Robot

_INTERFACES = {"spin": "Velocity", "steer": "Position"}  # of commands
Motors = Callable[[Robot, Sequence[Body]], list[Element]]


def urdf(robot: Robot) -> str:
    """The description of a robot, with a <transmission> for each joint that has a motor."""
    frame = f"{BASE} is the frame of the robot file: P, on the ground, x forward."
    return document([*banner(robot), frame, PLACEHOLDERS], described(robot, _transmissions))


def described(robot: Robot, motors: Motors) -> Element:
    """<robot>; ``motors`` says what drives it."""
    links = bodies(robot)
    root = element("robot", *_chassis(robot), name=robot.name)
    if any(body.wheel.kind.rollers for body in links):
        root.set("xmlns:gz", GAZEBO)
    for body in links:
        root.extend([_link(body), _joint(body), *_friction(body)])
    root.extend(motors(robot, links))
    return root


def _transmissions(robot: Robot, links: Sequence[Body]) -> list[Element]:
    """The joints of ``robot`` that have a motor."""
    return [
        element(
            "transmission",
            element("type", text="transmission_interface/SimpleTransmission"),
            element(
                "joint",
                element(
                    "hardwareInterface", text=f"hardware_interface/{_INTERFACES[body.part]}JointInterface"
                ),
                name=body.joint,
            ),
            element("actuator", element("mechanicalReduction", text="1"), name=f"{body.joint}_motor"),
            name=f"{body.joint}_transmission",
        )
        for body in links
        if body.driven
    ]


def _chassis(robot: Robot) -> Iterator[Element]:
    """The base, and a link of its own for the body: tools that build a tree want no inertia in its root."""
    size, centre, moments = chassis(robot)
    box = element("geometry", element("box", size=decimals(*size)))
    yield element("link", name=BASE)
    yield element(
        "link",
        _inertial("chassis", moments),
        element("visual", box),
        name="chassis_link",
    )
    yield _carried("chassis", BASE, "chassis_link", centre)


def _carried(
    name: str, parent: str, child: str, place: Vector, yaw: float = 0.0, kind: str = RIGID
) -> Element:
    ends = element("parent", link=parent), element("child", link=child)
    return element(
        "joint", *ends, element("origin", xyz=decimals(*place), rpy=decimals(0, 0, yaw)), name=name, type=kind
    )


def _inertial(part: str, moments: Vector) -> Element:
    values = dict(zip(("ixx", "iyy", "izz"), map(decimal, moments), strict=True))
    inertia = element("inertia", **values, ixy="0", ixz="0", iyz="0")
    return element("inertial", comment("placeholder"), element("mass", value=decimal(MASSES[part])), inertia)


def _link(body: Body) -> Element:
    """A steering link has no shape."""
    link = element("link", _inertial(body.part, body.inertia), name=body.link)
    for role in ("visual", "collision") if body.part != "steer" else ():
        if body.part == "spin":
            shape = element("cylinder", radius=decimal(body.radius), length=decimal(WIDTH * body.radius))
        else:
            shape = element("sphere", radius=decimal(body.radius))
        along_y = element("origin", xyz="0 0 0", rpy=decimals(pi / 2, 0, 0))
        link.append(element(role, along_y, element("geometry", shape)))
    return link


def _joint(body: Body) -> Element:
    kind = RIGID if body.part == "ball" else "revolute" if body.limits else "continuous"
    joint = _carried(body.joint, body.parent, body.link, body.place, body.yaw, kind)
    if kind != RIGID:
        joint.append(element("axis", xyz="0 1 0" if body.part == "spin" else "0 0 1"))
    if body.limits or body.speed is not None:
        ends = {"lower": decimal(body.limits.low), "upper": decimal(body.limits.high)} if body.limits else {}
        speed = SPEED if body.speed is None else body.speed
        joint.append(element("limit", **ends, effort=decimal(EFFORT), velocity=decimal(speed)))
    if body.leader:
        joint.append(element("mimic", joint=body.leader, multiplier="1", offset="0"))
    return joint


def _friction(body: Body) -> list[Element]:
    """What Gazebo must know: a ball slips; rollers give way across their axis (SDFormat, which URDF borrows)."""
    grip, about = [element("mu", text="0"), element("mu2", text="0")], []
    if body.part == "spin" and body.wheel.kind.rollers:
        g = body.wheel.nominal
        ch, sh, cg, sg = map(float, (g.ch, g.sh, g.cg, g.sg))
        direction = element("fdir1", text=decimals(ch * cg - sh * sg, sh * cg + ch * sg, 0))
        direction.set("gz:expressed_in", BASE)
        grip = [element("mu", text="1"), element("mu2", text="0"), direction]
        gamma = decimal(degrees(body.wheel.gamma))
        text = "from the rolling direction to the axis of the roller at the ground"
        about = [comment(f"{body.wheel.name}: gamma = {gamma} deg, {text}.")]
    elif body.part != "ball":
        return []
    surface = element("surface", element("friction", element("ode", *grip)))
    return [*about, element("gazebo", element("collision", surface), reference=body.link)]
