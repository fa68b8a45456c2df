"""A file to a `Description`: what its text is, and which packages and arguments it was given."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

from wmrgen.errors import UsageError
from wmrgen.robotfile.text import printable, quoted, read_at_most
from wmrgen.tools.importing import meshes, sdf, urdf
from wmrgen.tools.importing.controllers import plugin_controllers
from wmrgen.tools.importing.read import below, children, local, mark_of, parse_file, refuse
from wmrgen.tools.importing.records import Description
from wmrgen.tools.importing.rollers import says_rollers
from wmrgen.tools.importing.xacro import macros
from wmrgen.tools.importing.xacro_process import resolve

_URDF = (
    "link joint material transmission gazebo ros2_control sensor plugin model world author version group default static"
    " safety_controller calibration"
).split()
_PREFIX = "write xacro: before it, if it is a macro"
_OF_XACRO = ("insert_block", "if", "unless")  # what stands in links and joints is not known without


def description_of(file: Path, arguments: Sequence[str], packages: Sequence[str]) -> Description:
    """What the file says. RobotFileError for what cannot be read, UsageError for words of a wrong form."""
    values = pairs(arguments)
    roots = {name: Path(folder) for name, folder in pairs(packages, "=").items()}
    name = printable(file.name)
    root = parse_file(file)
    folders = _own_package(file) | roots
    substituted = _is_xacro(root)
    if values and not substituted:
        raise UsageError(f"{name} is no xacro, and takes no {quoted(next(iter(values)))}")
    called, unasked = list[str](), list[str]()
    if substituted:
        root, called, unasked = resolve(file, values, folders)
    passed = dict.fromkeys(local(e) for e in root if "}" not in str(e.tag)) if substituted else {}
    for part in (*children(root, "joint"), *children(root, "link")) if substituted else ():
        for each in part.iter():
            if each.tag in _OF_XACRO:
                what = (
                    f"{name}: <{each.tag}> in {quoted(part.get('name', ''))} has no prefix, and is not read"
                )
                raise refuse(what, "", "Write xacro: before it.", mark_of(each))
    strange = [printable(tag)[:40] for tag in passed if tag and tag not in _URDF]
    if local(root) == "sdf":
        description = sdf.describe(root, name, lambda uri: _model(located(uri, file, folders)))
    elif strange and not children(root, "link"):
        why = f"<{strange[0]}> has no prefix, and is passed over."
        raise refuse(f"{name}: has no link", why, "Write xacro: before the names of macros.")
    elif substituted and not children(root, "link") and (defined := macros(file)):
        raise refuse(
            f"{name}: only defines macros ({printable(', '.join(defined))[:200]}) and uses none",
            "A macro is no robot.",
            "Give the file that includes it, or write one that calls the macro.",
        )
    else:
        description = urdf.describe(root, name)
    seen = plugin_controllers(root)
    notes = [*unasked, *(f"<{tag}> is passed over: {_PREFIX}" for tag in strange), *description.notes]
    return replace(
        description,
        words=(*description.words, *(macro for macro in dict.fromkeys(called) if says_rollers(macro))),
        notes=tuple(notes),
        controllers=seen,
        file_of=lambda uri: _mesh(located(uri, file, folders)),
    )


def located(uri: str, file: Path, packages: Mapping[str, Path]) -> Path | None:
    """The file or folder that a URI of ``file`` names, of the folders given: None for what lies outside of them, or is
    not there."""
    scheme, separator, rest = uri.strip().rpartition("://")
    package, _, below_it = rest.partition("/")
    if scheme in ("package", "model") or (scheme == "file" and package in packages):
        rest = below_it
        if package not in packages:
            return None
        path = packages[package] / rest
    elif separator and scheme != "file":
        return None
    else:
        path = file.parent / rest
        with contextlib.suppress(OSError):  # a name that is too long for a file
            if package in packages and not path.exists():  # SDF names models so, too
                path = packages[package] / below_it
    path = path.resolve()
    roots = [file.resolve().parent, *(folder.resolve() for folder in packages.values())]
    inside = any(path.is_relative_to(root) for root in roots)
    with contextlib.suppress(OSError):
        return path if inside and path.exists() else None
    return None


def _model(path: Path | None) -> Element | None:
    """The SDF of a model: of a file, or of a folder by its model.config, whose last version counts."""
    if path is not None and path.is_dir():
        config = path / "model.config"
        versions = list(below(parse_file(config), "sdf")) if config.is_file() else []
        inside = (path / (versions[-1].text or "" if versions else "model.sdf").strip()).resolve()
        path = inside if inside.is_relative_to(path) else None
    return None if path is None else parse_file(path)


def _mesh(path: Path | None) -> bytes | None:
    try:
        return None if path is None else read_at_most(path, meshes.MAX_BYTES + 1)
    except (OSError, ValueError):
        return None


def _own_package(file: Path) -> dict[str, Path]:
    """The package or model in which a file stands: the nearest folder above that is one, by its
    name and that of its folder."""
    for folder in file.resolve().parents:
        if (folder / "model.config").is_file():
            return {folder.name: folder}
        if (folder / "package.xml").is_file():
            title = next(below(parse_file(folder / "package.xml"), "name"), None)
            name = "" if title is None else (title.text or "").strip()
            return {folder.name: folder, name or folder.name: folder}
    return {}


def packages_in(workspace: Path) -> dict[str, Path]:
    """Return the folders of all ROS packages below a folder by the names in their package.xml.

    The first in alphabetical order counts if several packages have one name.
    """
    found: dict[str, Path] = {}
    for manifest in sorted(workspace.rglob("package.xml")):
        title = next(below(parse_file(manifest), "name"), None)
        name = "" if title is None else (title.text or "").strip()
        found.setdefault(name or manifest.parent.name, manifest.parent)
    return found


def pairs(words: Sequence[str], sign: str = ":=") -> dict[str, str]:
    """Words of the form NAME, sign, VALUE. UsageError for what is none."""
    values = {}
    for word in words:
        name, equals, value = word.partition(sign)
        if not name or not equals:
            raise UsageError(f"write NAME{sign}VALUE, not {quoted(word)}")
        values[name] = value
    return values


def _is_xacro(root: Element) -> bool:
    """An element or attribute outside comments is xacro's, whatever the file is called."""
    return any(
        isinstance(e.tag, str) and ("xacro" in e.tag.partition("}")[0] or _substitutes(e))
        for e in root.iter()
    )


def _substitutes(element: Element) -> bool:
    return any("${" in value or "$(" in value for value in element.attrib.values())
