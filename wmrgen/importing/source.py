"""A file to a `Description`: what its text is, and which packages and arguments it was given."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from wmrgen.errors import RobotFileError, UsageError
from wmrgen.importing.read import MAX_BYTES, children, describe, parse, refuse
from wmrgen.importing.records import Description
from wmrgen.importing.xacro import macros, resolve
from wmrgen.spec.text import printable, quoted, read_at_most


def description_of(file: Path, arguments: Sequence[str], packages: Sequence[str]) -> Description:
    """What the file says. RobotFileError for what cannot be read, UsageError for words of a wrong form."""
    values = _pairs(arguments, ":=")
    folders = {name: Path(folder) for name, folder in _pairs(packages, "=").items()}
    name = printable(file.name)
    root = parse(_bytes(file), name)
    if not _is_xacro(root):
        if values:
            raise UsageError(f"{name} is no xacro, and takes no {quoted(next(iter(values)))}")
        return describe(root, name)
    resolved = parse(resolve(file, values, _own_package(file) | folders), name)
    if not children(resolved, "link") and (defined := macros(file)):
        raise refuse(
            f"{name}: only defines macros ({printable(', '.join(defined))[:200]}) and uses none",
            "A macro is no robot.",
            "Give the file that includes it, or write one that calls the macro.",
        )
    return describe(resolved, name)


def _own_package(file: Path) -> dict[str, Path]:
    """The package in which a file stands: the nearest folder above with a package.xml, by the folder's name."""
    for folder in file.resolve().parents:
        if (folder / "package.xml").is_file():
            return {folder.name: folder}
    return {}


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
        isinstance(e.tag, str) and ("xacro" in e.tag.partition("}")[0] or _substitutes(e))
        for e in root.iter()
    )


def _substitutes(element: Element) -> bool:
    return any("${" in value or "$(" in value for value in element.attrib.values())
