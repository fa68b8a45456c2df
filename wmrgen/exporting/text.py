"""What exports are written with: decimals, comments, XML elements."""

from __future__ import annotations

from collections.abc import Iterable
from typing import SupportsFloat, cast
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from wmrgen import __version__
from wmrgen.layout.records import Robot

GAZEBO = "http://gazebosim.org/schema"  # the namespace of gz:expressed_in


def decimal(value: SupportsFloat) -> str:
    """Fifteen significant digits, which the noise of floats does not reach; no negative zero."""
    return f"{round(float(value), 15) + 0.0:.15g}"


def decimals(*values: SupportsFloat) -> str:
    return " ".join(map(decimal, values))


def banner(robot: Robot) -> list[str]:
    """What a file says of itself: the robot, its description in one line, its frame."""
    about = " ".join(robot.description.split())
    lines = [
        f"{robot.name}: {about}" if about else robot.name,
        f"Written by wmrgen {__version__} from a robot file: write it anew rather than edit it.",
    ]
    if robot.tunable:
        names = ", ".join(p.name for p in robot.tunable)
        lines.append(f"Tunable parameters are at their nominal values: {names}.")
    if robot.trailers:
        lines.append("The trailers of the robot file are left out.")
    return lines


def element(tag: str, *children: Element, text: str = "", **attributes: str) -> Element:
    """``<tag attributes>text children</tag>``, whatever characters the values have."""
    made = Element(tag, attributes)
    made.text = text or None
    made.extend(children)
    return made


def comment(text: str) -> Element:
    """An XML comment: two hyphens would end it, and one at the end would be part of the mark."""
    while "--" in text:
        text = text.replace("--", "- -")
    return cast(Element, ElementTree.Comment(f" {text} "))


def document(lines: Iterable[str], root: Element) -> str:
    """An XML file: ``lines`` as comments, the root below."""
    ElementTree.indent(root)
    parts = [*(comment(line) for line in lines), root]
    return '<?xml version="1.0"?>\n' + "".join(
        ElementTree.tostring(part, encoding="unicode") + "\n" for part in parts
    )
