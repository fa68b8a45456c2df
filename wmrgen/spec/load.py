"""Robot files to RobotSpec: form is checked here, values are computed by the layout."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from wmrgen.errors import RobotFileError
from wmrgen.reading import read_at_most
from wmrgen.spec.extras import read_functions, read_gains, read_point, read_trailers, read_virtual
from wmrgen.spec.fields import LIMITS, ROBOT_KEYS, ROBOT_REQUIRED
from wmrgen.spec.joints import read_couplings, read_limits
from wmrgen.spec.mappings import Table, mapping_of, table_of
from wmrgen.spec.names import parameter_name, robot_name
from wmrgen.spec.nodes import Mapping, Node, Scalar
from wmrgen.spec.numbers import Kind
from wmrgen.spec.quantities import parse_value, scalar_of
from wmrgen.spec.reader import read_tree
from wmrgen.spec.records import Parameter, Quantity, RobotSpec
from wmrgen.spec.scope import Scope, dependency_order, facts_of, parameters_in, refuse_bare_trigonometry
from wmrgen.spec.text import MAX_BYTES, decode, printable, quoted, suggestion
from wmrgen.spec.wheels import read_wheels

FORMAT = "1"
MAX_PARAMETERS = 256
MAX_TEXT = 2_000
_EXAMPLE = "wmrgen: 1, then name: and wheels:"
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
        raise RobotFileError("the file is empty", source.mark(0, 0), "", f"A robot file begins {_EXAMPLE}.")
    table = table_of(tree, ROBOT_KEYS, "a robot file", _EXAMPLE)
    _check_format(table)
    for key in ROBOT_REQUIRED:
        table.require(key, "the robot file")
    name = robot_name(scalar_of(table.values["name"], "name"))
    scope = Scope(degrees=_word(table, "angles", {"rad": False, "deg": True}, False))
    parameters, scope = _parameters(table.get("parameters"), scope)
    wheels = read_wheels(table.values["wheels"], scope)
    return RobotSpec(
        name=name,
        description=_free_text(table, "description"),
        source=_free_text(table, "source"),
        snap=_word(table, "snap", {"true": True, "false": False}, True),
        parameters=parameters,
        wheels=wheels,
        couplings=read_couplings(table.get("couplings"), wheels),
        limits=read_limits(table.get("limits"), tuple(LIMITS), "the robot", scope),
        mark=table.mark,
        virtual=read_virtual(table.get("virtual"), wheels, scope),
        trailers=read_trailers(table.get("trailers"), wheels, scope),
        slip=_word(table, "slip", {"true": True, "false": False}, False),
        cg=read_point(table.get("cg"), scope),
        gains=read_gains(table.get("gains"), scope),
        functions=read_functions(table.get("functions")),
    )


def _check_format(table: Table) -> None:
    node = scalar_of(table.require("wmrgen", "the robot file"), "wmrgen")
    if node.text != FORMAT:
        raise node.error(
            f"format version {quoted(node.text)} is not known",
            f"This wmrgen reads version {FORMAT}; another one may mean the same words differently.",
            f"Write wmrgen: {FORMAT}.",
        )


def _choice(node: Node, key: str, words: dict[str, bool]) -> bool:
    scalar = scalar_of(node, key)
    if scalar.text not in words:
        raise scalar.error(
            f"{key}: {quoted(scalar.text)} is not known",
            f"It is {' or '.join(words)}.",
            suggestion(scalar.text, words, {"degrees": "Did you mean deg?", "radians": "Did you mean rad?"}),
        )
    return words[scalar.text]


def _word(table: Table, key: str, words: dict[str, bool], default: bool) -> bool:
    node = table.get(key)
    return default if node is None else _choice(node, key, words)


def _free_text(table: Table, key: str) -> str:
    """A text for people. Writers escape it for the language it lands in."""
    node = table.get(key)
    if node is None:
        return ""
    scalar = scalar_of(node, key)
    text = scalar.text.strip()
    if len(text) > MAX_TEXT:
        raise scalar.error(
            f"{key} has {len(text)} characters", f"At most {MAX_TEXT} are kept.", "Shorten it."
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
    if len(mapping.entries) > MAX_PARAMETERS:
        raise mapping.error(f"{len(mapping.entries)} parameters", f"At most {MAX_PARAMETERS} are read.")
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
    table = table_of(node, ("value", "tunable"), what, f"{name}: {{value: 0.1, tunable: true}}")
    value = scalar_of(table.require("value", what), what)
    return value, _word(table, "tunable", {"true": True, "false": False}, False)
