"""Read a robot file as a RobotSpec. Keys and the form of values are checked here; `geometry.layout` computes values."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from wmrgen.errors import Code, ErrorCollector, RobotFileError, WmrgenError
from wmrgen.robotfile.expressions import UndeclaredParameter
from wmrgen.robotfile.fields import Text, Version
from wmrgen.robotfile.joints import read_of_joints
from wmrgen.robotfile.keys import ROBOT
from wmrgen.robotfile.mapping import tree_of
from wmrgen.robotfile.names import Names, outer_name, robot_name
from wmrgen.robotfile.parts import (
    Reading,
    read_gains,
    read_gyro,
    read_parameters,
    read_point,
    read_trailers,
    read_virtual,
)
from wmrgen.robotfile.quantities import Scope
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.records import FunctionSpec, RobotSpec
from wmrgen.robotfile.tables import Table, table_of
from wmrgen.robotfile.text import (
    MAX_BYTES,
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    Source,
    bytes_of,
    decode,
    quoted,
    scalar_of,
)
from wmrgen.robotfile.wheels import declared_types, every_wheel_is_named, read_couplings, read_wheels

_DUNDER = re.compile(r"__\w+__")  # names such as __import__, which would be code in Python
OPEN = "TODO"  # `wmrgen import` and `new` write it, without quotes, for a value that the user must fill in
_KEYS_OF_A_MODEL = {"format", "robot_type", "C1f"}  # by which a model.json is recognised


def read_robot(path: str | Path, collector: ErrorCollector | None = None) -> RobotSpec:
    """Read the robot file at ``path``; see `read_text`."""
    return read_text(text_of(path), str(path), collector)


def text_of(path: str | Path) -> str:
    """Return the text of a robot file. Raise RobotFileError if it cannot be read."""
    return decode(bytes_of(path, MAX_BYTES + 1), str(path))


def read_text(text: str, file_name: str, collector: ErrorCollector | None = None) -> RobotSpec:
    """Read the text of a robot file.

    Args:
        text: The whole file.
        file_name: The name of the file, for messages.
        collector: Receives errors in parts of the file, so that the other parts can be checked further. Without it,
            all errors are raised.

    Returns:
        The robot; with a collector that received errors, only what could be read of it.

    Raises:
        RobotFileError: The file is not a valid robot file.
    """
    wrong, tree = ErrorCollector(), None
    with wrong:
        tree = read_tree(text, file_name, wrong)
    if tree is None or (isinstance(tree, Scalar) and not tree.text):
        wrong.end()
        mark, example = Source.of(text, file_name).mark(0, 0), f"Write {ROBOT.example}."
        raise RobotFileError("the file is empty", mark, "", example, Code.NOT_YAML)
    return _read(tree, wrong, collector)


def read_mapping(values: Mapping[str, object], collector: ErrorCollector | None = None) -> RobotSpec:
    """Read a robot that is given as a mapping with the keys of a robot file; see `read_text`."""
    return _read(tree_of(values), ErrorCollector(), collector)


def _read(tree: Node, wrong: ErrorCollector, collector: ErrorCollector | None) -> RobotSpec:
    """Return the robot that a tree describes; ``wrong`` has the errors that the YAML reader found."""
    if isinstance(tree, MappingNode) and {key.text for key, _ in tree.entries} >= _KEYS_OF_A_MODEL:
        raise tree.error(
            "this is a model.json, which `wmrgen derive` writes",
            "It is the result of a robot file.",
            "Give the robot file itself. To compare with the generated code, give its C header.",
            code=Code.FILE,
        )
    table = table_of(tree, ROBOT, wrong)
    if not _can_read_on(table, wrong):
        wrong.errors = [error for error in wrong.errors if error.code is not Code.UNKNOWN_KEY]
        wrong.end()
    with wrong:
        _refuse_questions(tree)
    if any(error.code is Code.OPEN for error in wrong.errors):
        wrong.end()
    spec = _robot(table, wrong)
    wrong.errors = _causes(table, wrong.errors)
    if collector is None or not wrong.errors:
        wrong.end()
        return spec
    collector.add(*wrong.errors)
    return replace(spec, couplings=(), virtual=())


def _robot(table: Table, collector: ErrorCollector) -> RobotSpec:
    """Return what can be read of a robot; ``collector`` receives the errors in the rest."""
    table.require_all("the robot file", collector)
    name, scope, names = "", Scope(), Names()
    facts: dict[str, Any] = {"parameters": (), "wheels": ()}
    with collector:
        name = robot_name(scalar_of(table.require("name", "the robot file"), "name"))
    with collector:
        scope = Scope(degrees=table.word("angles"))
    with collector:
        facts["parameters"], scope = read_parameters(table.get("parameters"), scope, names, collector)
    with collector:
        facts["wheels"] = read_wheels(table, scope, names, collector)
    reading = Reading(table, scope, names, declared_types(table), collector)
    for part, read in _PARTS.items():
        with collector:
            facts[part] = read(reading)
    return RobotSpec(name=name, **facts)


def _can_read_on(table: Table, collector: ErrorCollector) -> bool:
    """Return whether this is a robot file of this version, so that errors in its parts make sense."""
    version = ROBOT.field("wmrgen").value
    assert isinstance(version, Version)
    with collector:
        node = scalar_of(table.require("wmrgen", "the robot file"), "wmrgen")
        if node.text == version.number:
            return True
        collector.add(
            node.error(
                f"unknown format version {quoted(node.text)}",
                f"This wmrgen reads version {version.number}. In another version, keys may have other meanings.",
                f"Write wmrgen: {version.number}.",
            )
        )
        return not re.fullmatch(r"[0-9.]+", node.text) or bool(
            re.fullmatch(rf"{version.number}(\.0*)?", node.text)
        )
    return table.get("wheels") is not None or table.get("name") is not None


def _free_text(table: Table, key: str) -> str:
    """Return a text for people. Each back end escapes it for its language."""
    node, value = table.get(key), ROBOT.field(key).value
    assert isinstance(value, Text)
    if node is None:
        return ""
    scalar = scalar_of(node, key)
    text = scalar.text.strip()
    if len(text) > value.longest:
        what = f"{key} has {len(text)} characters"
        raise scalar.error(what, f"At most {value.longest} are allowed.", "Shorten it.")
    if "\t" in text:
        raise scalar.error(f"{key} has a tab", "Control characters are refused.", "Write spaces.")
    if _DUNDER.search(text):
        raise scalar.error(
            f"{key} has {quoted(_DUNDER.findall(text)[0])}",
            "Names with two underscores on both sides are code, and a robot file has no code.",
            "Write it in words.",
        )
    return text


def _frame(table: Table) -> str:
    """Return the name of the robot frame in other tools; "" if the file has none."""
    node = table.get("frame")
    return "" if node is None else outer_name(scalar_of(node, "frame"), "frame")


# The fields of a RobotSpec that are read after parameters and wheels, each with its reader.
_PARTS: dict[str, Callable[[Reading], Any]] = {
    "description": lambda r: _free_text(r.table, "description"),
    "source": lambda r: _free_text(r.table, "source"),
    "frame": lambda r: _frame(r.table),
    "snap": lambda r: r.table.word("snap"),
    "tolerance": lambda r: r.table.amount("tolerance", "the robot", r.scope),
    "couplings": lambda r: read_couplings(r.table, r.types, r.scope, r.collector),
    "limits": lambda r: read_of_joints("limits", r.table, "the robot", r.scope, r.collector),
    "noise": lambda r: read_of_joints("noise", r.table, "the robot", r.scope, r.collector),
    "encoders": lambda r: read_of_joints("encoder", r.table, "the robot", r.scope, r.collector),
    "gyro": read_gyro,
    "lag": lambda r: read_of_joints("lag", r.table, "the robot", r.scope, r.collector),
    "virtual": read_virtual,
    "trailers": read_trailers,
    "slip": lambda r: r.table.word("slip"),
    "precise": lambda r: r.table.word("precise"),
    "cg": lambda r: read_point(r.table.get("cg"), r.scope),
    "gains": lambda r: read_gains(r.table.get("gains"), r.scope),
    "effective_track": lambda r: r.table.amount("effective_track", "the robot", r.scope),
    "deadband": lambda r: r.table.amount("deadband", "the robot", r.scope),
    "functions": lambda r: tuple(FunctionSpec(item.text, item.mark) for item in r.table.scalars("functions")),
}


# ---- errors about the file as a whole


def _refuse_questions(tree: Node) -> None:
    """Raise RobotFileError with all open questions."""
    collector = ErrorCollector()
    for key, node in _questions(tree, ""):
        with collector:
            raise node.error(
                f"{key or 'this value'} is an open question",
                "The file does not give this value yet.",
                f"Write the value in place of {OPEN}; the comment next to it says what is asked.",
                code=Code.OPEN,
            )
    collector.end()


def _questions(node: Node, key: str) -> Iterator[tuple[str, Scalar]]:
    """Yield each open question below a node with its key."""
    if isinstance(node, Scalar) and node.plain and node.text == OPEN:
        yield key, node
    elif isinstance(node, SequenceNode):
        for item in node.items:
            yield from _questions(item, key)
    elif isinstance(node, MappingNode):
        for name, value in node.entries:
            yield from _questions(value, name.text)


def _causes(table: Table, errors: Sequence[WmrgenError]) -> list[WmrgenError]:
    """Return ``errors`` without uses of names whose declaration cannot be read."""
    parameters, others = _names_in_doubt(table, errors)
    causes = []
    for error in errors:
        in_doubt = parameters if isinstance(error, UndeclaredParameter) else others
        if error.code is not Code.UNDECLARED or not in_doubt:
            causes.append(error)
    return causes


def _names_in_doubt(table: Table, errors: Sequence[WmrgenError]) -> tuple[bool, bool]:
    """Return whether the name of a parameter cannot be read, and whether another name cannot be read.

    Uses of such a name are not reported as undeclared.
    """
    parameters = table.get("parameters")
    declared = [key.mark for key, _ in parameters.entries] if isinstance(parameters, MappingNode) else []
    unread = [error.mark in declared for error in errors if error.code is Code.NAME]
    no_mapping = parameters is not None and not isinstance(parameters, MappingNode)
    return no_mapping or any(unread), not every_wheel_is_named(table) or not all(unread)
