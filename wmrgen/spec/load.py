"""Robot files to RobotSpec: form is checked here, values are computed by the layout."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from wmrgen.errors import RobotFileError
from wmrgen.reading import read_at_most
from wmrgen.spec.extras import read_functions, read_gains, read_point, read_trailers, read_virtual
from wmrgen.spec.fields import Mapped, Text, Version
from wmrgen.spec.joints import read_couplings, read_limits
from wmrgen.spec.keys import PARAMETER, ROBOT
from wmrgen.spec.mappings import Table, mapping_of, table_of
from wmrgen.spec.names import parameter_name, robot_name
from wmrgen.spec.nodes import Mapping, Node, Scalar
from wmrgen.spec.numbers import Kind
from wmrgen.spec.quantities import parse_value, scalar_of
from wmrgen.spec.reader import read_tree
from wmrgen.spec.records import Parameter, Quantity, RobotSpec
from wmrgen.spec.scope import Scope, dependency_order, facts_of, parameters_in, refuse_bare_trigonometry
from wmrgen.spec.text import MAX_BYTES, decode, printable, quoted
from wmrgen.spec.wheels import read_wheels

_DUNDER = re.compile(r"__\w+__")


def read_robot(path: str | Path) -> RobotSpec:
    """The robot file at ``path``. RobotFileError for everything that can be wrong with it."""
    return read_text(_text_of(path), str(path))


def _text_of(path: str | Path) -> str:
    name = printable(str(path))
    try:
        data = read_at_most(path, MAX_BYTES + 1)
    except FileNotFoundError:
        raise RobotFileError(f"{name}: no such file", None, "", "Give the path of a robot file.") from None
    except IsADirectoryError:
        raise RobotFileError(f"{name}: is a directory", None, "", "Give the robot file in it.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RobotFileError(f"{name}: cannot be read: {printable(reason)}") from None
    return decode(data, str(path))


def read_text(text: str, file_name: str) -> RobotSpec:
    """A robot file given as text; ``file_name`` stands in messages."""
    tree, source = read_tree(text, file_name)
    if tree is None or (isinstance(tree, Scalar) and not tree.text):
        raise RobotFileError(
            "the file is empty", source.mark(0, 0), "", f"A robot file begins {ROBOT.example}."
        )
    table = table_of(tree, ROBOT)
    _check_format(table)
    table.require_all("the robot file")
    name = robot_name(scalar_of(table.values["name"], "name"))
    scope = Scope(degrees=table.word("angles"))
    parameters, scope = _parameters(table.get("parameters"), scope)
    wheels = read_wheels(table, scope)
    return RobotSpec(
        name=name,
        description=_free_text(table, "description"),
        source=_free_text(table, "source"),
        snap=table.word("snap"),
        parameters=parameters,
        wheels=wheels,
        couplings=read_couplings(table, wheels),
        limits=read_limits(table.get("limits"), "the robot", scope),
        mark=table.mark,
        virtual=read_virtual(table, wheels, scope),
        trailers=read_trailers(table, wheels, scope),
        slip=table.word("slip"),
        cg=read_point(table.get("cg"), scope),
        gains=read_gains(table.get("gains"), scope),
        functions=read_functions(table),
    )


def _check_format(table: Table) -> None:
    node = scalar_of(table.require("wmrgen", "the robot file"), "wmrgen")
    version = ROBOT.field("wmrgen").value
    assert isinstance(version, Version)
    if node.text != version.number:
        raise node.error(
            f"format version {quoted(node.text)} is not known",
            f"This wmrgen reads version {version.number}; another one may mean the same words differently.",
            f"Write wmrgen: {version.number}.",
        )


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


def _parameters(node: Node | None, scope: Scope) -> tuple[tuple[Parameter, ...], Scope]:
    """Parameters, each after those it uses, and the scope that knows them."""
    if node is None:
        return (), scope
    mapping = mapping_of(node, "parameters", "parameters: and lines such as half_track: 0.1655")
    value = ROBOT.field("parameters").value
    assert isinstance(value, Mapped)
    if len(mapping.entries) > value.most:
        raise mapping.error(f"{len(mapping.entries)} parameters", f"At most {value.most} are read.")
    names = [parameter_name(key) for key, _ in mapping.entries]
    nodes: dict[str, Scalar] = {}
    trees = {}
    tunable = {}
    for name, (_, entry) in zip(names, mapping.entries, strict=True):
        nodes[name], tunable[name] = _entry(name, entry)
        trees[name] = parse_value(nodes[name], names, Kind.ANY, f"parameter {name}")
    order = dependency_order({name: parameters_in(tree) for name, (tree, _) in trees.items()}, nodes)
    found = []
    for name in order:
        expr, has_unit = trees[name]
        facts = facts_of(expr, has_unit, scope, nodes[name])
        scope = replace(scope, facts={**scope.facts, name: facts})
        refuse_bare_trigonometry(expr, scope, nodes[name])
        quantity = Quantity(expr, nodes[name].text.strip(), nodes[name].mark)
        found.append(Parameter(name, quantity, tunable[name]))
    return tuple(found), scope


def _entry(name: str, node: Node) -> tuple[Scalar, bool]:
    """The value node of a parameter and whether it is tunable."""
    what = f"parameter {name}"
    if not isinstance(node, Mapping):
        return scalar_of(node, what), False
    table = table_of(node, PARAMETER, what)
    return scalar_of(table.require("value", what), what), table.word("tunable")
