"""URDF to a `Description`. Elements and attributes that wheels do not need are passed over."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from xml.etree.ElementTree import Element

from wmrgen.errors import RobotFileError
from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import MAX_JOINTS, frame, tree
from wmrgen.tools.importing.gazebo import (
    driven_by_control,
    driven_by_plugins,
    friction,
    pushing,
    transmitted,
    words,
)
from wmrgen.tools.importing.read import (
    ONES,
    ZERO,
    at,
    below,
    bound,
    child,
    children,
    direction,
    local,
    mark_of,
    name_of,
    number,
    radius_in,
    refuse,
    vector,
)
from wmrgen.tools.importing.records import KINDS, Description, Frame, Friction, Joint, Shape, Vector

_TURN, _NEAR = 6.3, 1e-3  # [rad] beyond which an angle is seldom meant, unless so near a multiple of pi/12


def _origin(element: Element, what: str, notes: list[str]) -> Frame:
    origin = child(element, "origin")
    if origin is None:
        return frame(ZERO, ZERO)
    if unknown := sorted(set(origin.attrib) - {"xyz", "rpy"}):
        notes.append(
            f"{what}: <origin> has the attribute {quoted(unknown[0])}, which URDF has not; it is not read"
        )
    if "xyz" in origin.attrib and not origin.attrib["xyz"].strip():
        notes.append(f"{what}: xyz is empty, taken as 0 0 0")
    with at(origin):
        xyz, rpy = vector(origin.get("xyz"), f"{what}: xyz"), vector(origin.get("rpy"), f"{what}: rpy")
    if any(abs(angle) > _TURN and abs(math.remainder(angle, math.pi / 12)) > _NEAR for angle in rpy):
        said = quoted(origin.get("rpy", ""))
        notes.append(f"{what}: rpy is {said}, in radians more than a turn; degrees were likely meant")
    return frame(xyz, rpy)


def describe(root: Element, file: str) -> Description:
    """What a URDF says. RobotFileError for what is none."""
    if local(root) != "robot":
        raise refuse(
            f"{file}: the root element is <{quoted(local(root))[1:-1]}>, not <robot> or <sdf>",
            "URDF, xacro and SDF are read.",
            mark=mark_of(root),
        )
    notes: list[str] = []
    links = _link_names(root)
    if not links:
        raise refuse(f"{file}: has no link", "", "Give a file that describes a robot, not only parts of one.")
    joints, closing = _joints(root, set(links), notes)
    return Description(
        name=root.get("name", ""),
        links=links,
        joints=joints,
        shapes={name_of(link, "link"): _shapes(link, notes) for link in children(root, "link")},
        frictions=_frictions(root, notes),
        driven=_driven(root, {joint.name for joint in joints}),
        words=tuple(words(root)),
        notes=tuple(notes),
        closing=closing,
        transmitted=frozenset(transmitted(root) - transmitted(root, "Position") - driven_by_control(root)),
        commanded=frozenset(transmitted(root, "Velocity")),
        pushing=pushing(below(root, "plugin")),
        masses=_masses(root),
    )


def _link_names(root: Element) -> tuple[str, ...]:
    """Return the names of all links; raise RobotFileError if two links have one name, as urdfdom does."""
    names: dict[str, None] = {}
    for link in children(root, "link"):
        name = name_of(link, "link")
        if name in names:
            raise refuse(
                f"several links are called {quoted(name)}",
                "Joints could not be assigned to one of them. ROS rejects the file, too.",
                "Give each link a name of its own.",
                mark_of(link),
            )
        names[name] = None
    return tuple(names)


def _joints(root: Element, links: set[str], notes: list[str]) -> tuple[tuple[Joint, ...], tuple[Joint, ...]]:
    elements = []
    for each in children(root, "joint"):
        if child(each, "parent") is not None:
            elements.append(each)
        else:
            notes.append(f"joint {quoted(each.get('name', ''))} has no <parent>, and is not read")
    joints = [_joint(element, notes) for element in elements[: MAX_JOINTS + 1]]
    for name, count in Counter(joint.name for joint in joints).items():
        if count > 1:
            notes.append(f"joint {quoted(name)}: several joints have this name")
    return tree(joints, links, notes)


def _joint(element: Element, notes: list[str]) -> Joint:
    name = name_of(element, "joint")
    what = f"joint {quoted(name)}"
    kind = element.get("type", "")
    if kind not in KINDS:
        notes.append(f"{what}: URDF has no type {quoted(kind)}; taken for one that is no wheel")
        kind = "planar"
    ends = (child(element, "parent"), child(element, "child"))
    parent, below_it = ("" if end is None else end.get("link", "") for end in ends)
    axis, limit, mimic = child(element, "axis"), child(element, "limit"), child(element, "mimic")
    where, along, limits, follows = _origin(element, what, notes), None, None, None
    if axis is not None:
        with at(axis):
            along = direction(axis.get("xyz"), f"{what}: axis")
    if limit is not None and ("lower" in limit.attrib or "upper" in limit.attrib):
        with at(limit):
            low, high = (bound(limit.get(k, "0"), f"{what}: {k}") for k in ("lower", "upper"))
            limits = (low, high)
    if mimic is not None:
        with at(mimic):
            factor = number(mimic.get("multiplier", "1"), f"{what}: multiplier")
            follows = mimic.get("joint", ""), factor, number(mimic.get("offset", "0"), f"{what}: offset")
    if kind == "revolute" and limits is not None and not any(limits):
        notes.append(f"{what} is revolute with limits from 0 to 0, so it cannot turn; read as continuous")
    mark = mark_of(element)
    return Joint(name, kind, parent, below_it, where, along, limits, follows, mark=mark)


def _shapes(link: Element, notes: list[str]) -> tuple[Shape, ...]:
    shapes = []
    for role in ("collision", "visual"):
        for part in children(link, role):
            geometry = child(part, "geometry")
            what = f"link {quoted(link.get('name', ''))}: {role}"
            for form in [] if geometry is None else list(geometry):
                radius = form.get("radius", "") if local(form) in ("cylinder", "sphere") else ""
                with at(form):
                    value = radius_in(radius, what, notes)
                scale = _scale(form.get("scale"), what, notes)
                where, uri = _origin(part, what, notes), form.get("filename", "")
                shapes.append(Shape(local(form), role, where, value, uri, scale))
    return tuple(shapes)


def _masses(root: Element) -> dict[str, Vector]:
    """The centres of mass of links, where they can be read."""
    centres = {}
    for link in children(root, "link"):
        for origin in (
            o for inertial in children(link, "inertial")[:1] for o in children(inertial, "origin")
        ):
            with contextlib.suppress(RobotFileError):
                centres[name_of(link, "link")] = vector(origin.get("xyz"), "inertial")
    return centres


def _scale(text: str | None, what: str, notes: list[str]) -> Vector:
    """The scale of a mesh, which only gives hints: what is none is noted."""
    try:
        return vector(text, f"{what} scale", ONES)
    except RobotFileError as error:
        notes.append(f"{error.what}; taken as 1 1 1")
        return ONES


def _frictions(root: Element, notes: list[str]) -> dict[str, Friction]:
    """What <gazebo reference="link"> says of friction, where it has a direction; what cannot be read is noted."""
    frictions, unread = {}, []
    for gazebo in children(root, "gazebo"):
        link = gazebo.get("reference", "")
        try:
            if says := friction(gazebo, link):
                frictions[link] = says
        except RobotFileError as error:
            unread.append(f"link {quoted(link)}: {error.what}")
    if unread:
        more = f" It is the first of {len(unread)}." if len(unread) > 1 else ""
        notes.append(f"{unread[0]}; this fdir1 is not read.{more}")
    return frictions


def _driven(root: Element, joints: set[str]) -> frozenset[str] | None:
    """The joints that something of the file drives; None where nothing drives any."""
    plugins = ((plugin, "") for gazebo in children(root, "gazebo") for plugin in children(gazebo, "plugin"))
    by_plugins = driven_by_plugins(plugins, joints)
    by_control = frozenset((driven_by_control(root) | transmitted(root)) & joints)
    return by_control | (by_plugins or frozenset()) if by_control else by_plugins
