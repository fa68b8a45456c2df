"""What is written for simulators and controllers, in URDF and SDF alike: which joints are driven, and friction."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from xml.etree.ElementTree import Element

from wmrgen.tools.importing.read import below, children, local, number, vector
from wmrgen.tools.importing.records import Friction

_WATCHES = re.compile(
    "state[-_]?publisher|sensor|torque|mimic|odometry[-_]?publisher|_ir_|camera|laser|lidar|(?<![a-z])imu(?![a-z])|opcode",
    re.IGNORECASE,
)
_PUSHES = re.compile("thrust|motor[-_]?model|lift[-_]?drag", re.IGNORECASE)
_MOVES_THE_BODY = re.compile("planar[-_]?move|object_controller|velocity-?control-?system", re.IGNORECASE)


def driven_by_plugins(
    plugins: Iterable[tuple[Element, str]], joints: Collection[str]
) -> frozenset[str] | None:
    """The joints that plugins drive, each with the prefix of the model in which it stands; none where one moves the
    body as a whole, None where no plugin drives any.

    A plugin names a joint as the text of an element, alone or in a list, with or without the models before it; what
    is called an encoder is measured.
    """
    driven: set[str] = set()
    as_a_whole = False
    ending: dict[str, list[str]] = {}
    for joint in joints:
        ending.setdefault(joint.rpartition("::")[2], []).append(joint)
    for plugin, prefix in plugins:
        title = plugin.get("filename", "") + " " + plugin.get("name", "")
        if not _WATCHES.search(title):
            elements = (each for each in plugin.iter() if "encoder" not in local(each).lower())
            for word in (word for element in elements for word in _words(element.text or "")):
                own = next((name for name in _names(word, prefix) if name in joints), None)
                driven |= {own} if own else {*ending.get(word.rpartition("::")[2], ())}
        as_a_whole = as_a_whole or bool(_MOVES_THE_BODY.search(title))
    return frozenset(driven) if driven or as_a_whole else None


def _names(word: str, prefix: str) -> Iterator[str]:
    """What a model of a prefix may mean by a name that may have the models before it: its own joint first."""
    parts = word.split("::", 8)
    for end in ("::".join(parts[k:]) for k in range(len(parts))):
        yield from (prefix + end, end)


def pushing(plugins: Iterable[Element]) -> frozenset[str]:
    """The joints and links that push air or water, by the plugins that say how strongly: propellers, rotors, wings."""
    titles = ((plugin, plugin.get("filename", "") + " " + plugin.get("name", "")) for plugin in plugins)
    pushes = (plugin for plugin, title in titles if _PUSHES.search(title))
    tags = ("joint_name", "jointName", "link_name", "linkName")
    return frozenset((e.text or "").strip() for p in pushes for e in p.iter() if local(e) in tags)


def _words(text: str) -> Iterator[str]:
    yield text.strip()
    yield from re.split(r"[\s,]+", text.strip()[:10_000])


def driven_by_control(root: Element) -> set[str]:
    """The joints to which ros2_control gives commands."""
    controls = children(root, "ros2_control")
    return {
        j.get("name", "") for c in controls for j in children(c, "joint") if children(j, "command_interface")
    }


def transmitted(root: Element, interface: str = "") -> set[str]:
    """The joints of transmissions; with an ``interface``, such as Position, only of those that take that."""
    joints = [joint for each in children(root, "transmission") for joint in children(each, "joint")]
    names = set()
    for joint in joints:
        text = "".join(e.text or "" for e in below(joint, "hardwareInterface"))
        if interface in text:
            names.add(joint.get("name", ""))
    return names


def friction(element: Element, link: str) -> Friction | None:
    """The friction that an element below ``element`` gives a direction, in the frame of ``link`` unless it says
    another. RobotFileError for what is no direction."""
    direction = next(below(element, "fdir1"), None)
    if direction is None:
        return None
    sizes = []
    for tags in (("mu1", "mu", "friction_coefficient"), ("mu2", "friction2")):
        sizes.append(next((e.text or "1" for tag in tags for e in below(element, tag)), "1"))
    frame_of = [
        v for k, v in direction.attrib.items() if k.rsplit("}", 1)[-1].rsplit(":", 1)[-1] == "expressed_in"
    ]
    along = vector(direction.text, "fdir1")
    if not any(along):
        return None
    mu1, mu2 = (number(size, key) for key, size in zip(("mu1", "mu2"), sizes, strict=True))
    return Friction(along, frame_of[0] if frame_of else link, mu1, mu2)


def words(root: Element) -> Iterator[str]:
    """Names of the robot and of its plugins, but of those that watch."""
    yield root.get("name", "")
    for plugin in below(root, "plugin"):
        title = [plugin.get(key, "").rsplit("/", 1)[-1] for key in ("filename", "name")]
        if not _WATCHES.search(" ".join(title)):
            yield from title
