"""A file to a `Description`: what its text is, and which packages and arguments it was given."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from wmrgen.errors import RobotFileError, UsageError
from wmrgen.importing.read import MAX_BYTES, describe, parse, refuse
from wmrgen.importing.records import Description
from wmrgen.spec.text import printable, quoted, read_at_most

_XACRO = ("http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro", "http://ros.org/wiki/xacro")


def description_of(file: Path, arguments: Sequence[str], packages: Sequence[str]) -> Description:
    """What the file says. RobotFileError for what cannot be read, UsageError for words of a wrong form."""
    given = _pairs(arguments, ":=")
    _pairs(packages, "=")
    name = printable(file.name)
    root = parse(_bytes(file), name)
    if _is_xacro(root):
        raise refuse(
            f"{name}: is xacro, which is not read yet", "", "Resolve it first: xacro FILE > robot.urdf"
        )
    if given:
        raise UsageError(f"{name} is no xacro, and takes no {next(iter(given))}:=")
    return describe(root, name)


def _pairs(words: Sequence[str], sign: str) -> dict[str, str]:
    pairs = {}
    for word in words:
        name, equals, value = word.partition(sign)
        if not name or not equals:
            raise UsageError(f"write NAME{sign}VALUE, not {quoted(word)}")
        pairs[name] = value
    return pairs


def _bytes(file: Path) -> bytes:
    name = printable(str(file))
    try:
        return read_at_most(file, MAX_BYTES + 1)
    except FileNotFoundError:
        raise RobotFileError(f"{name}: no such file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RobotFileError(f"{name}: cannot be read: {printable(reason)}") from None


def _is_xacro(root: Element) -> bool:
    """An element or attribute outside comments is xacro's, whatever the file is called."""
    return any(
        isinstance(element.tag, str)
        and (element.tag.startswith(tuple(f"{{{space}" for space in _XACRO)) or _substitutes(element))
        for element in root.iter()
    )


def _substitutes(element: Element) -> bool:
    return any("${" in value or "$(" in value for value in element.attrib.values())
