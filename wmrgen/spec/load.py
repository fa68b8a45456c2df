"""Robot files to RobotSpec: form is checked here, values are computed by the layout."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from wmrgen.errors import Code, RobotFileError, Several
from wmrgen.spec.consequences import causes
from wmrgen.spec.expressions import scalar_of
from wmrgen.spec.fields import Text, Version
from wmrgen.spec.joints import read_encoders, read_lag, read_limits, read_noise
from wmrgen.spec.keys import ROBOT
from wmrgen.spec.names import Names, robot_name, wheel_name
from wmrgen.spec.numbers import Scope
from wmrgen.spec.parameters import read_parameters
from wmrgen.spec.part_keys import CG, GAINS, TRAILER, VIRTUAL
from wmrgen.spec.questions import refuse_questions
from wmrgen.spec.reader import read_tree
from wmrgen.spec.records import (
    FunctionSpec,
    PointSpec,
    Quantity,
    RobotSpec,
    TrailerSpec,
    VirtualSpec,
)
from wmrgen.spec.tables import Table, read_number, table_of
from wmrgen.spec.text import (
    MAX_BYTES,
    Node,
    Scalar,
    Source,
    bytes_of,
    decode,
    quoted,
)
from wmrgen.spec.wheels import declared_types, read_couplings, read_wheels, wheel_called
from wmrgen.wheels import WHEEL_TYPES, WheelType

_DUNDER = re.compile(r"__\w+__")
_ROLE, _POINT = VIRTUAL.choices


def read_robot(path: str | Path, several: Several | None = None) -> RobotSpec:
    """`read_text` of the file at ``path``."""
    return read_text(text_of(path), str(path), several)


def text_of(path: str | Path) -> str:
    """The text of a robot file. RobotFileError where it cannot be read."""
    return decode(bytes_of(path, MAX_BYTES + 1), str(path))


def read_text(text: str, file_name: str, several: Several | None = None) -> RobotSpec:
    """A robot file given as text; ``file_name`` stands in messages. RobotFileError for everything that can be wrong.

    With ``several``, which takes what is wrong in its parts: what the parts say in which nothing is.
    """
    wrong, tree = Several(), None
    with wrong:
        tree = read_tree(text, file_name, wrong)
    if tree is None or (isinstance(tree, Scalar) and not tree.text):
        wrong.end()
        mark, example = Source.of(text, file_name).mark(0, 0), f"A robot file begins {ROBOT.example}."
        raise RobotFileError("the file is empty", mark, "", example, Code.NOT_YAML)
    table = table_of(tree, ROBOT, wrong)
    if not _of_this_format(table, wrong):
        wrong.errors = [error for error in wrong.errors if error.code is not Code.UNKNOWN_KEY]
        wrong.end()
    with wrong:
        refuse_questions(tree)
    if any(error.code is Code.OPEN for error in wrong.errors):
        wrong.end()
    spec = _robot(table, wrong)
    wrong.errors = causes(table, wrong.errors)
    if several is None or not wrong.errors:
        wrong.end()
        return spec
    several.add(*wrong.errors)
    return replace(spec, couplings=(), virtual=())


class _Reading(NamedTuple):
    """What the parts of a robot file are read by: its keys, parameters, names, the types of its wheels, if known, and
    what takes the mistakes."""

    table: Table
    scope: Scope
    names: Names
    types: Mapping[str, WheelType | None]
    several: Several


def _robot(table: Table, several: Several) -> RobotSpec:
    """What can be read; ``several`` takes the rest."""
    table.require_all("the robot file", several)
    name, scope, names = "", Scope(), Names()
    facts: dict[str, Any] = {"parameters": (), "wheels": ()}
    with several:
        name = robot_name(scalar_of(table.require("name", "the robot file"), "name"))
    with several:
        scope = Scope(degrees=table.word("angles"))
    with several:
        facts["parameters"], scope = read_parameters(table.get("parameters"), scope, names, several)
    with several:
        facts["wheels"] = read_wheels(table, scope, names, several)
    reading = _Reading(table, scope, names, declared_types(table), several)
    for part, read in _PARTS.items():
        with several:
            facts[part] = read(reading)
    return RobotSpec(name=name, mark=table.mark, **facts)


def _of_this_format(table: Table, several: Several) -> bool:
    """Whether the file can be read on: it is one of a robot, and names no other version of the format."""
    version = ROBOT.field("wmrgen").value
    assert isinstance(version, Version)
    with several:
        node = scalar_of(table.require("wmrgen", "the robot file"), "wmrgen")
        if node.text == version.number:
            return True
        several.add(
            node.error(
                f"format version {quoted(node.text)} is not known",
                f"This wmrgen reads version {version.number}; another one may mean the same words differently.",
                f"Write wmrgen: {version.number}.",
            )
        )
        return not re.fullmatch(r"[0-9.]+", node.text)
    return table.get("wheels") is not None or table.get("name") is not None


def _free_text(table: Table, key: str) -> str:
    """A text for people. Writers escape it for the language it lands in."""
    node, value = table.get(key), ROBOT.field(key).value
    assert isinstance(value, Text)
    if node is None:
        return ""
    scalar = scalar_of(node, key)
    text = scalar.text.strip()
    if len(text) > value.longest:
        raise scalar.error(
            f"{key} has {len(text)} characters", f"At most {value.longest} are kept.", "Shorten it."
        )
    if "\t" in text:
        raise scalar.error(f"{key} holds a tab", "Control characters are refused.", "Write spaces.")
    if _DUNDER.search(text):
        raise scalar.error(
            f"{key} holds {quoted(_DUNDER.findall(text)[0])}",
            "Names with two underscores on both sides belong to code, which a robot file cannot hold.",
            "Write it in plain words.",
        )
    return text


def _trailers(reading: _Reading) -> tuple[TrailerSpec, ...]:
    """Trailers from the robot backwards; without a name they are trailer1, trailer2, …"""
    trailers = []
    for number, item in enumerate(reading.table.items("trailers"), 1):
        several, name = Several(), f"trailer{number}"
        with reading.several:
            table = table_of(item, TRAILER, several)
            with several:
                name = _own_name(table, name, reading.names, "a trailer")
            table.require_all(f"the trailer {name}", several)
            length, hitch = (_amount(table, key, name, reading.scope, several) for key in ("length", "hitch"))
            several.end()
            assert length is not None
            trailers.append(TrailerSpec(name, length, hitch, table.mark))
    return tuple(trailers)


def _amount(table: Table, key: str, of: str, scope: Scope, several: Several) -> Quantity | None:
    """A quantity; ``several`` takes what is wrong with it."""
    with several:
        return table.amount(key, of, scope)
    return None


def _virtual(reading: _Reading) -> tuple[VirtualSpec, ...]:
    """Virtual wheels: each steers or drives in place of real ones."""
    virtual = []
    for item in reading.table.items("virtual"):
        several, name, role = Several(), "", ""
        wheels: tuple[str, ...] = ()
        with reading.several:
            table = table_of(item, VIRTUAL, several)
            table.require_all("the virtual wheel", several)
            with several:
                name = _own_name(table, "", reading.names, "a virtual wheel")
            what = f"the virtual wheel {name}".rstrip()
            with several:
                (role,) = table.choose(_ROLE, what)
                wheels = _members(table, role, reading.types)
            with several:
                table.choose(_POINT, what)
            x, y = (_amount(table, key, name, reading.scope, several) for key in ("x", "y"))
            several.end()
            virtual.append(VirtualSpec(name, role, wheels, x, y, table.mark))
    return tuple(virtual)


def _members(table: Table, role: str, types: Mapping[str, WheelType | None]) -> tuple[str, ...]:
    several = Several()
    wanted = [k.name for k in WHEEL_TYPES.values() if (k.steers if role == "steers" else k.constrains)]
    scalars = table.scalars(role)
    for scalar in scalars:
        with several:
            kind = wheel_called(scalar.text, scalar, types)
            if kind is not None and kind.name not in wanted:
                raise scalar.error(
                    f"{scalar.text} is a {kind.name} wheel",
                    f"A virtual wheel that {role} stands for {' or '.join(wanted)} wheels.",
                )
    several.end()
    return tuple(scalar.text for scalar in scalars)


def _point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    several = Several()
    table = table_of(node, CG, several)
    table.require_all("cg", several)
    x, y, z = (_amount(table, key, "cg", scope, several) for key in ("x", "y", "z"))
    several.end()
    return PointSpec(x, y, z) if x and y and z else None


def _gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Gains of the control laws, as expressions over parameters."""
    if node is None:
        return ()
    several, gains = Several(), []
    for key, value in table_of(node, GAINS, several).values.items():
        with several:
            gains.append((key, read_number(value, key, scope)))
    several.end()
    return tuple(gains)


def _own_name(table: Table, default: str, names: Names, what: str) -> str:
    """The name of an entry, entered into ``names``."""
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name:
        names.add(name, what, node or table.node)
    return name


_PARTS: dict[str, Callable[[_Reading], Any]] = {  # of a RobotSpec
    "description": lambda r: _free_text(r.table, "description"),
    "source": lambda r: _free_text(r.table, "source"),
    "snap": lambda r: r.table.word("snap"),
    "tolerance": lambda r: r.table.amount("tolerance", "the robot", r.scope),
    "couplings": lambda r: read_couplings(r.table, r.types, r.scope, r.several),
    "limits": lambda r: read_limits(r.table.get("limits"), "the robot", r.scope),
    "noise": lambda r: read_noise(r.table.get("noise"), "the robot", r.scope),
    "encoders": lambda r: read_encoders(r.table.get("encoder"), "the robot", r.scope),
    "lag": lambda r: read_lag(r.table.get("lag"), "the robot", r.scope),
    "virtual": _virtual,
    "trailers": _trailers,
    "slip": lambda r: r.table.word("slip"),
    "cg": lambda r: _point(r.table.get("cg"), r.scope),
    "gains": lambda r: _gains(r.table.get("gains"), r.scope),
    "effective_track": lambda r: r.table.amount("effective_track", "the robot", r.scope),
    "deadband": lambda r: r.table.amount("deadband", "the robot", r.scope),
    "functions": lambda r: tuple(FunctionSpec(item.text, item.mark) for item in r.table.scalars("functions")),
}
