"""URDF text to a `Description`: untrusted XML, by defusedxml, under caps.

No entity, no document type, no reference to another file is followed; numbers are read by a pattern, never evaluated.
Elements and attributes that wheels do not need are passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from xml.etree.ElementTree import Element, ParseError

from wmrgen.errors import EnvironmentFailure, RobotFileError
from wmrgen.importing.frames import frame, unit
from wmrgen.importing.records import KINDS, Description, Frame, Friction, Joint, Shape, Vector
from wmrgen.spec.text import quoted

MAX_BYTES = 4 * 1024 * 1024
MAX_ELEMENTS = 100_000
MAX_JOINTS = 2_000
MAX_DEPTH = 64
_NUMBER = re.compile(r"([+-]?)(\d{1,40}(?:\.\d{0,40})?|\.\d{1,40})(?:[eE]([+-]?\d{1,4}))?")
_LARGEST, _SMALLEST = 30, -30  # exponents; below is zero
_ZERO: Vector = (Fraction(0), Fraction(0), Fraction(0))


def refuse(what: str, why: str = "", instead: str = "") -> RobotFileError:
    return RobotFileError(what, None, why, instead)


def parse(text: bytes, file: str) -> Element:
    """The root element. RobotFileError for what is no XML, has a document type or is too large."""
    try:
        from defusedxml.common import DefusedXmlException
        from defusedxml.ElementTree import fromstring
    except ImportError:
        raise EnvironmentFailure("import reads XML by defusedxml: pip install 'wmrgen[import]'") from None
    if len(text) > MAX_BYTES:
        raise refuse(f"{file}: larger than {MAX_BYTES // 1024 // 1024} MiB")
    try:
        root: Element = fromstring(text, forbid_dtd=True)
    except DefusedXmlException:
        raise refuse(
            f"{file}: has a document type or entities", "They are refused.", "Delete them."
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        raise refuse(f"{file}: not XML: {quoted(str(error), 100)}") from None
    _cap(root, file)
    return root


def _cap(root: Element, file: str) -> None:
    count, level = 0, [root]
    for _ in range(MAX_DEPTH):
        count += len(level)
        level = [child for element in level for child in element]
    if level or count > MAX_ELEMENTS:
        raise refuse(f"{file}: deeper than {MAX_DEPTH} levels or more than {MAX_ELEMENTS} elements")


def local(element: Element) -> str:
    """The name of an element without its namespace; empty for comments."""
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def children(element: Element, name: str) -> list[Element]:
    return [child for child in element if local(child) == name]


def child(element: Element, name: str) -> Element | None:
    return next(iter(children(element, name)), None)


def below(element: Element, name: str) -> Iterator[Element]:
    return (each for each in element.iter() if local(each) == name)


def number(text: str, what: str) -> Fraction:
    match = _NUMBER.fullmatch(text.strip())
    if not match:
        raise refuse(f"{what}: {quoted(text)} is not a number")
    sign, digits, exponent = match.groups()
    power = int(exponent or 0)
    if power > _LARGEST:
        raise refuse(f"{what}: {quoted(text)} is too large")
    return Fraction(f"{sign}{digits}e{power}") if power >= _SMALLEST else Fraction(0)


def _vector(text: str | None, what: str, default: Vector = _ZERO) -> Vector:
    """Three numbers; ``default`` where nothing is written."""
    parts = (text or "").split()
    if not parts:
        return default
    if len(parts) != 3:
        raise refuse(f"{what}: three numbers are needed, not {quoted(str(text))}")
    x, y, z = (number(part, what) for part in parts)
    return x, y, z


def _origin(element: Element, what: str, notes: list[str]) -> Frame:
    origin = child(element, "origin")
    if origin is None:
        return frame(_ZERO, _ZERO)
    if unknown := sorted(set(origin.attrib) - {"xyz", "rpy"}):
        notes.append(
            f"{what}: <origin> has the attribute {quoted(unknown[0])}, which URDF has not; it is not read"
        )
    if "xyz" in origin.attrib and not origin.attrib["xyz"].strip():
        notes.append(f"{what}: xyz is empty, taken as 0 0 0")
    return frame(_vector(origin.get("xyz"), f"{what}: xyz"), _vector(origin.get("rpy"), f"{what}: rpy"))


def describe(root: Element, file: str) -> Description:
    """What a URDF says. RobotFileError for what is none."""
    if local(root) != "robot":
        raise refuse(
            f"{file}: the root element is <{quoted(local(root))[1:-1]}>, not <robot>",
            "Only URDF and xacro are read; SDF is not.",
        )
    notes: list[str] = []
    links = tuple(dict.fromkeys(_name(link, "link") for link in children(root, "link")))
    if not links:
        raise refuse(f"{file}: has no link", "", "Give a file that describes a robot, not only parts of one.")
    joints = _joints(root, set(links), notes)
    return Description(
        name=root.get("name", ""),
        links=links,
        joints=joints,
        shapes={_name(link, "link"): _shapes(link, notes) for link in children(root, "link")},
        frictions=_frictions(root, notes),
        driven=_driven(root, {joint.name for joint in joints}),
        words=tuple(_words(root)),
        notes=tuple(notes),
    )


def _name(element: Element, what: str) -> str:
    name = element.get("name", "")
    if "${" in name or "$(" in name:
        raise refuse(f"the {what} {quoted(name)} is an unresolved xacro expression")
    return name


def _joints(root: Element, links: set[str], notes: list[str]) -> tuple[Joint, ...]:
    """The joints of the tree: a link's second parent and what is in no tree are left out, with a note."""
    joints: dict[str, Joint] = {}
    names: set[str] = set()
    elements = [each for each in children(root, "joint") if child(each, "parent") is not None]
    if len(elements) > MAX_JOINTS:
        raise refuse(f"more than {MAX_JOINTS} joints")
    for element in elements:
        joint = _joint(element, notes)
        what = f"joint {quoted(joint.name)}"
        if unknown := [link for link in (joint.parent, joint.child) if link not in links]:
            raise refuse(f"{what}: there is no link {quoted(unknown[0])}")
        if joint.name in names:
            notes.append(f"{what}: several joints have this name")
        if joint.child in joints:
            notes.append(f"{what}: {quoted(joint.child)} has a parent already; this one is not read")
            continue
        names.add(joint.name)
        joints[joint.child] = joint
    for link in joints:
        seen = {link}
        while link in joints:
            link = joints[link].parent
            if link in seen:
                raise refuse(f"the joints go in a circle through the link {quoted(link)}")
            seen.add(link)
    return tuple(joints.values())


def _joint(element: Element, notes: list[str]) -> Joint:
    name = _name(element, "joint")
    what = f"joint {quoted(name)}"
    kind = element.get("type", "")
    if kind not in KINDS:
        notes.append(f"{what}: URDF has no type {quoted(kind)}; taken for one that is no wheel")
        kind = KINDS[-2]
    ends = (child(element, "parent"), child(element, "child"))
    parent, below_it = ("" if end is None else end.get("link", "") for end in ends)
    axis, limit, mimic = child(element, "axis"), child(element, "limit"), child(element, "mimic")
    limits = None
    if limit is not None and ("lower" in limit.attrib or "upper" in limit.attrib):
        low, high = (number(limit.get(k, "0"), f"{what}: {k}") for k in ("lower", "upper"))
        limits = (low, high)
    return Joint(
        name,
        kind,
        parent,
        below_it,
        _origin(element, what, notes),
        _axis(axis, what),
        limits,
        None
        if mimic is None
        else (
            mimic.get("joint", ""),
            number(mimic.get("multiplier", "1"), f"{what}: multiplier"),
            number(mimic.get("offset", "0"), f"{what}: offset"),
        ),
    )


def _axis(element: Element | None, what: str) -> Vector | None:
    if element is None or not element.get("xyz", "").split():
        return None
    try:
        return unit(_vector(element.get("xyz"), f"{what}: axis"))
    except ValueError:
        return None  # 0 0 0 says as little as no axis


def _shapes(link: Element, notes: list[str]) -> tuple[Shape, ...]:
    shapes = []
    for role in ("collision", "visual"):
        for part in children(link, role):
            geometry = child(part, "geometry")
            what = f"link {quoted(link.get('name', ''))}: {role}"
            for form in [] if geometry is None else list(geometry):
                radius = form.get("radius") if local(form) in ("cylinder", "sphere") else None
                value = number(radius, f"{what} radius") if radius else None
                shapes.append(Shape(local(form), role, _origin(part, what, notes), value))
    return tuple(shapes)


def _frictions(root: Element, notes: list[str]) -> dict[str, Friction]:
    """What <gazebo reference="link"> says of friction, where it has a direction; what cannot be read is noted."""
    frictions = {}
    for gazebo in children(root, "gazebo"):
        link = gazebo.get("reference", "")
        try:
            for direction in below(gazebo, "fdir1"):
                frictions[link] = _friction(gazebo, direction, link)
        except RobotFileError as error:
            notes.append(f"{error.what}; this fdir1 is not read")
    return frictions


def _friction(gazebo: Element, direction: Element, link: str) -> Friction:
    sizes = {
        name: next((e.text or "1" for tag in tags for e in below(gazebo, tag)), "1")
        for name, tags in (("mu1", ("mu1", "mu")), ("mu2", ("mu2",)))
    }
    frame_of = [v for k, v in direction.attrib.items() if k.rsplit("}", 1)[-1] == "expressed_in"]
    return Friction(
        _vector(direction.text, f"fdir1 of {quoted(link)}"),
        frame_of[0] if frame_of else link,
        number(sizes["mu1"], f"mu1 of {quoted(link)}"),
        number(sizes["mu2"], f"mu2 of {quoted(link)}"),
    )


def _driven(root: Element, joints: set[str]) -> frozenset[str] | None:
    """The joints that something of the file drives; None where nothing drives any."""
    driven = set()
    for control in children(root, "ros2_control"):
        driven |= {j.get("name", "") for j in children(control, "joint") if children(j, "command_interface")}
    for transmission in children(root, "transmission"):
        driven |= {j.get("name", "") for j in children(transmission, "joint")}
    for gazebo in children(root, "gazebo"):
        for plugin in children(gazebo, "plugin"):
            if "state_publisher" not in plugin.get("filename", "") + plugin.get("name", ""):
                driven |= {(e.text or "").strip() for e in plugin.iter()}
    return frozenset(driven & joints) or None


def _words(root: Element) -> Iterator[str]:
    yield root.get("name", "")
    for name, key in (("plugin", "filename"), ("plugin", "name"), ("mesh", "filename")):
        yield from (element.get(key, "").rsplit("/", 1)[-1] for element in below(root, name))
