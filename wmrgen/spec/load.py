"""Robot files to RobotSpec: form is checked here, values are computed by the layout."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from wmrgen.errors import RobotFileError
from wmrgen.spec.expressions import parse_value, read_quantity, scalar_of
from wmrgen.spec.fields import Mapped, Text, Version
from wmrgen.spec.keys import CG, GAINS, PARAMETER, ROBOT, TRAILER, VIRTUAL
from wmrgen.spec.numbers import Kind, Scope, facts_of, parameters_in, plain_number
from wmrgen.spec.questions import refuse_questions
from wmrgen.spec.reader import read_tree
from wmrgen.spec.records import (
    FunctionSpec,
    ParameterSpec,
    PointSpec,
    Quantity,
    RobotSpec,
    TrailerSpec,
    VirtualSpec,
    WheelSpec,
)
from wmrgen.spec.tables import Table, mapping_of, parameter_name, robot_name, table_of, wheel_name
from wmrgen.spec.text import (
    MAX_BYTES,
    MappingNode,
    Node,
    Scalar,
    decode,
    printable,
    quoted,
    read_at_most,
    suggestion,
)
from wmrgen.spec.wheels import read_couplings, read_encoders, read_limits, read_noise, read_wheels
from wmrgen.wheels import WHEEL_TYPES

_DUNDER = re.compile(r"__\w+__")
_ROLE, _POINT = VIRTUAL.choices


def read_robot(path: str | Path) -> RobotSpec:
    """The robot file at ``path``. RobotFileError for everything that can be wrong with it."""
    return read_text(text_of(path), str(path))


def text_of(path: str | Path) -> str:
    """The text of a robot file. RobotFileError where it cannot be read."""
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
    refuse_questions(tree)
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
        noise=read_noise(table.get("noise"), "the robot", scope),
        encoders=read_encoders(table.get("encoder"), "the robot", scope),
        virtual=_virtual(table, wheels, scope),
        trailers=_trailers(table, wheels, scope),
        slip=table.word("slip"),
        cg=_point(table.get("cg"), scope),
        gains=_gains(table.get("gains"), scope),
        deadband=table.amount("deadband", "the robot", scope),
        functions=tuple(FunctionSpec(item.text, item.mark) for item in table.scalars("functions")),
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


def _parameters(node: Node | None, scope: Scope) -> tuple[tuple[ParameterSpec, ...], Scope]:
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
    order = _dependency_order({name: parameters_in(tree) for name, (tree, _) in trees.items()}, nodes)
    parameters = []
    for name in order:
        expr, has_unit = trees[name]
        facts = facts_of(expr, has_unit, scope, nodes[name])
        scope = replace(scope, facts={**scope.facts, name: facts})
        quantity = Quantity(expr, nodes[name].text.strip(), nodes[name].mark)
        parameters.append(ParameterSpec(name, quantity, tunable[name]))
    return tuple(parameters), scope


def _dependency_order(uses: Mapping[str, set[str]], nodes: Mapping[str, Scalar]) -> list[str]:
    """Names ordered so that each stands after those it uses, in file order otherwise.

    RobotFileError for a circle. Iterative: a chain of parameters may be long.
    """
    order: dict[str, None] = {}
    for root in uses:
        path = [root]
        while path:
            name = path[-1]
            missing = [used for used in sorted(uses[name]) if used not in order]
            if not missing:
                order[name] = None
                path.pop()
            elif missing[0] in path:
                raise _circle(path[path.index(missing[0]) :], nodes[name])
            else:
                path.append(missing[0])
    return list(order)


def _circle(names: list[str], node: Scalar) -> RobotFileError:
    if len(names) == 1:
        return node.error(f"parameter {names[0]} refers to itself", "", "Give it a number.")
    chain = " -> ".join([*names[:6], *(["…"] if len(names) > 6 else []), names[0]])
    return node.error(
        f"parameters refer to each other in a circle: {chain}", "", "Give one of them a number."
    )


def _entry(name: str, node: Node) -> tuple[Scalar, bool]:
    """The value node of a parameter and whether it is tunable."""
    what = f"parameter {name}"
    if not isinstance(node, MappingNode):
        return scalar_of(node, what), False
    table = table_of(node, PARAMETER, what)
    return scalar_of(table.require("value", what), what), table.word("tunable")


def _trailers(robot: Table, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[TrailerSpec, ...]:
    """Trailers from the robot backwards; without a name they are trailer1, trailer2, …"""
    taken = {w.name: "a wheel" for w in wheels}
    trailers = []
    for number, item in enumerate(robot.items("trailers"), 1):
        table = table_of(item, TRAILER)
        name = _own_name(table, f"trailer{number}", taken, "a trailer")
        table.require_all(f"the trailer {name}")
        length = table.required_amount("length", name, scope)
        trailers.append(TrailerSpec(name, length, table.amount("hitch", name, scope), table.mark))
    return tuple(trailers)


def _virtual(robot: Table, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[VirtualSpec, ...]:
    """Virtual wheels: each steers or drives in place of real ones."""
    taken = {w.name: "a wheel" for w in wheels}
    virtual = []
    for item in robot.items("virtual"):
        table = table_of(item, VIRTUAL)
        table.require_all("the virtual wheel")
        name = _own_name(table, "", taken, "a virtual wheel")
        what = f"the virtual wheel {name}"
        (role,) = table.choose(_ROLE, what)
        table.choose(_POINT, what)
        x, y = (table.amount(key, name, scope) for key in ("x", "y"))
        virtual.append(VirtualSpec(name, role, _members(table, role, wheels), x, y, table.mark))
    return tuple(virtual)


def _members(table: Table, role: str, wheels: Sequence[WheelSpec]) -> tuple[str, ...]:
    types = {w.name: w.type for w in wheels}
    wanted = [k.name for k in WHEEL_TYPES.values() if (k.steers if role == "steers" else k.constrains)]
    scalars = table.scalars(role)
    for scalar in scalars:
        if scalar.text not in types:
            raise scalar.error(f"there is no wheel {quoted(scalar.text)}", "", suggestion(scalar.text, types))
        if types[scalar.text] not in wanted:
            raise scalar.error(
                f"{scalar.text} is a {types[scalar.text]} wheel",
                f"A virtual wheel that {role} stands for {' or '.join(wanted)} wheels.",
            )
    return tuple(scalar.text for scalar in scalars)


def _point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    table = table_of(node, CG)
    table.require_all("cg")
    x, y, z = (table.required_amount(key, "cg", scope) for key in ("x", "y", "z"))
    return PointSpec(x, y, z)


def _gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Gains of the control laws, as expressions over parameters."""
    if node is None:
        return ()
    table = table_of(node, GAINS)
    return tuple((key, _gain(value, key, scope)) for key, value in table.values.items())


def _gain(node: Node, key: str, scope: Scope) -> Quantity:
    scalar = scalar_of(node, key)
    plain = plain_number(scalar)
    if plain and plain[1] is not None:
        raise scalar.error(
            f"{key} is a number per second, and {quoted(scalar.text.strip())} has a unit",
            "",
            f"Write the number alone, as {key}: 3.",
        )
    return read_quantity(scalar, Kind.ANY, key, scope)


def _own_name(table: Table, default: str, taken: dict[str, str], what: str) -> str:
    """The name of an entry, not one that is taken. Entered into ``taken``."""
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name in taken:
        place = node if isinstance(node, Scalar) else table.node
        raise place.error(f"{quoted(name)} is the name of {taken[name]} already", "", "Write another name.")
    taken[name] = what
    return name
