"""Read the parts of a robot file other than wheels: parameters, gyro, trailers, virtual wheels, centre of gravity and
gains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from wmrgen.errors import ErrorCollector, RobotFileError
from wmrgen.robotfile.fields import Mapped
from wmrgen.robotfile.keys import CG, GAINS, GYRO, PARAMETER, ROBOT, TRAILER, VIRTUAL
from wmrgen.robotfile.names import Names, parameter_name, symbol_name, wheel_name
from wmrgen.robotfile.numbers import Kind
from wmrgen.robotfile.quantities import Facts, Scope, check_same_kind, facts_of, parse_value, read_quantity
from wmrgen.robotfile.records import (
    Expr,
    GyroSpec,
    NoiseSpec,
    ParameterSpec,
    PointSpec,
    Quantity,
    TrailerSpec,
    VirtualSpec,
    parameters_in,
)
from wmrgen.robotfile.tables import Table, cut_by_comma, mapping_of, read_number, table_of
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, quoted, scalar_of
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType
from wmrgen.robotfile.wheels import wheel_called

_ROLE, _POINT = VIRTUAL.choices


class Reading(NamedTuple):
    """What is needed to read a part of a robot file."""

    table: Table  # of the whole file
    scope: Scope  # the parameters that expressions may use
    names: Names  # that are taken
    types: Mapping[str, WheelType | None]  # of each wheel; None if its type is unknown
    collector: ErrorCollector  # receives the errors


def read_gyro(reading: Reading) -> GyroSpec | None:
    """Read the yaw-rate sensor; return None if the robot has none."""
    node, what = reading.table.get("gyro"), "the gyro"
    if node is None:
        return None
    with reading.collector:
        table = table_of(node, GYRO, reading.collector)
        constant, proportional, weight = (
            _amount(table, key, what, reading.scope, reading.collector)
            for key in ("constant", "proportional", "weight")
        )
        return GyroSpec(NoiseSpec("gyro", proportional, constant), weight)
    return None


def read_trailers(reading: Reading) -> tuple[TrailerSpec, ...]:
    """Read the trailers, from the robot backwards. Without a name they are called trailer1, trailer2, …"""
    trailers = []
    for number, item in enumerate(reading.table.items("trailers"), 1):
        collector, name = ErrorCollector(), f"trailer{number}"
        with reading.collector:
            table = table_of(item, TRAILER, collector)
            with collector:
                name = _own_name(table, name, reading.names, "a trailer")
            table.require_all(f"the trailer {name}", collector)
            length, hitch = (
                _amount(table, key, name, reading.scope, collector) for key in ("length", "hitch")
            )
            collector.end()
            assert length is not None
            trailers.append(TrailerSpec(name, length, hitch, table.mark))
    return tuple(trailers)


def _amount(table: Table, key: str, of: str, scope: Scope, collector: ErrorCollector) -> Quantity | None:
    """Read the quantity of a key of ``of``; return None if it is absent or wrong."""
    with collector:
        return table.amount(key, of, scope)
    return None


def read_virtual(reading: Reading) -> tuple[VirtualSpec, ...]:
    """Read the virtual wheels, each of which steers or drives several real wheels."""
    virtual = []
    for item in reading.table.items("virtual"):
        collector, name, role = ErrorCollector(), "", ""
        wheels: tuple[str, ...] = ()
        with reading.collector:
            table = table_of(item, VIRTUAL, collector)
            table.require_all("the virtual wheel", collector)
            with collector:
                name = _own_name(table, "", reading.names, "a virtual wheel")
            what = f"the virtual wheel {name}".rstrip()
            with collector:
                (role,) = table.choose(_ROLE, what)
                wheels = _members(table, role, reading.types)
            with collector:
                table.choose(_POINT, what)
            x, y = (_amount(table, key, name, reading.scope, collector) for key in ("x", "y"))
            collector.end()
            virtual.append(VirtualSpec(name, role, wheels, x, y, table.mark))
    return tuple(virtual)


def _members(table: Table, role: str, types: Mapping[str, WheelType | None]) -> tuple[str, ...]:
    """Return the names of the wheels that a virtual wheel ``steers`` or ``drives`` (its ``role``)."""
    collector = ErrorCollector()
    wanted = [k.name for k in WHEEL_TYPES.values() if (k.steers if role == "steers" else k.constrains)]
    scalars = table.scalars(role)
    for scalar in scalars:
        with collector:
            kind = wheel_called(scalar.text, scalar, types)
            if kind is not None and kind.name not in wanted:
                raise scalar.error(
                    f"{scalar.text} is a {kind.name} wheel",
                    f"A virtual wheel that {role} represents {' or '.join(wanted)} wheels.",
                    f"Write the names of {' or '.join(wanted)} wheels.",
                )
    collector.end()
    return tuple(scalar.text for scalar in scalars)


def read_point(node: Node | None, scope: Scope) -> PointSpec | None:
    """Read the centre of gravity: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    collector = ErrorCollector()
    table = table_of(node, CG, collector)
    table.require_all("cg", collector)
    x, y, z = (_amount(table, key, "cg", scope, collector) for key in ("x", "y", "z"))
    collector.end()
    return PointSpec(x, y, z) if x and y and z else None


def read_gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Read the gains of the control laws."""
    if node is None:
        return ()
    collector, gains = ErrorCollector(), []
    for key, value in table_of(node, GAINS, collector).values.items():
        with collector:
            gains.append((key, read_number(value, key, scope)))
    collector.end()
    return tuple(gains)


def _own_name(table: Table, default: str, names: Names, what: str) -> str:
    """Return the name of an entry and add it to ``names``.

    Args:
        table: The entry.
        default: The name of an entry without one; "" if it needs none.
        names: The names that are taken.
        what: What the entry is, such as "a trailer".

    Raises:
        RobotFileError: The name is invalid or taken.
    """
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name:
        names.add(name, what, node or table.node)
    return name


# ---- parameters


class _Entry(NamedTuple):
    """What the file says about a parameter."""

    value: Scalar
    tunable: bool = False
    ends: SequenceNode | None = None  # of the range of a tunable parameter
    symbol: str = ""  # its letter in reports; "" if it has none


class _Declared(NamedTuple):
    """A parameter whose value has been parsed."""

    entry: _Entry
    tree: Expr
    unit: Kind | None  # what the unit after the value measures


def read_parameters(
    node: Node | None, scope: Scope, names: Names, collector: ErrorCollector
) -> tuple[tuple[ParameterSpec, ...], Scope]:
    """Read the parameters.

    Args:
        node: The value of the key ``parameters``, or None if the key is absent.
        scope: Tells whether angles without a unit are degrees.
        names: Receives the names of the parameters.
        collector: Receives the errors.

    Returns:
        The parameters that can be read, each after those that it uses, and the scope with all of them.
    """
    if node is None:
        return (), scope
    mapping = mapping_of(node, "parameters", "parameters: and lines such as half_track: 0.1655")
    value = ROBOT.field("parameters").value
    assert isinstance(value, Mapped)
    if len(mapping.entries) > value.most:
        what = f"{len(mapping.entries)} parameters"
        collector.add(mapping.error(what, f"At most {value.most} are allowed.", "Delete the others."))
    facts: dict[str, Facts | None] = dict.fromkeys(key.text for key, _ in mapping.entries)
    scope = replace(scope, facts=facts)
    declared: dict[str, _Declared] = {}
    for key, entry in _uncut_entries(mapping, collector):
        name = key.text
        with collector:
            names.add(parameter_name(key), "a parameter", key)
        with collector:
            own = _entry(name, entry)
            tree, unit = parse_value(own.value, scope.facts, Kind.ANY, f"parameter {name}")
            declared[name] = _Declared(own, tree, unit)
    parameters: list[ParameterSpec] = []
    order: list[str] = []
    with collector:
        order = _dependency_order(declared)
    for name in order:
        with collector:
            own, tree, unit = declared[name]
            facts[name] = facts_of(tree, unit, scope, own.value)
            quantity = Quantity(tree, own.value.text.strip(), own.value.mark)
            parameters.append(ParameterSpec(name, quantity, own.tunable, symbol=own.symbol))
    # Ranges come last, because they may use any parameter.
    for k, p in enumerate(parameters):
        with collector:
            parameters[k] = p._replace(range=_range(p.name, declared[p.name].entry.ends, scope))
    return tuple(parameters), scope


def _uncut_entries(mapping: MappingNode, collector: ErrorCollector) -> Iterator[tuple[Scalar, Node]]:
    """Yield the entries whose values are complete. A value that a comma has cut is reported."""
    cuts = [cut_by_comma(key, value) for key, value in mapping.entries]
    for number, (key, value) in enumerate(mapping.entries):
        cut = cuts[number]
        if cut:
            collector.add(key.error(f"{quoted(key.text)} is not a key", *cut))
        elif not any(cuts[number + 1 : number + 2]):
            yield key, value


def _range(name: str, node: SequenceNode | None, scope: Scope) -> tuple[Quantity, Quantity] | None:
    """Return the ends [low, high] of the range of a tunable parameter; None if the file has none."""
    if node is None:
        return None
    what = f"the range of parameter {name}"
    if len(node.items) != 2:
        raise node.error(
            f"{what} has {len(node.items)} value{'s' * (len(node.items) != 1)}",
            "A range has two values.",
            "Write tunable: [low, high], or tunable: true for 10 % on either side.",
        )
    own = scope.facts[name]
    assert own is not None
    low, high = (read_quantity(item, Kind.ANY, what, scope) for item in node.items)
    for item in node.items:
        check_same_kind(scalar_of(item, what), what, own, scope)
    return low, high


def _dependency_order(declared: Mapping[str, _Declared]) -> list[str]:
    """Return the names so that each comes after those that it uses, in the order of the file otherwise.

    Raises:
        RobotFileError: Parameters use each other in a circle.
    """
    uses = {name: parameters_in(own.tree) for name, own in declared.items()}
    order: dict[str, None] = {}  # not recursive, because a chain of parameters may be long
    for root in uses:
        path = [root]
        while path:
            name = path[-1]
            missing = [used for used in sorted(uses[name]) if used not in order and used in uses]
            if not missing:
                order[name] = None
                path.pop()
            elif missing[0] in path:
                raise _circle(path[path.index(missing[0]) :], declared[name].entry.value)
            else:
                path.append(missing[0])
    return list(order)


def _circle(names: list[str], node: Scalar) -> RobotFileError:
    """Return the error for parameters that use each other in a circle."""
    if len(names) == 1:
        return node.error(f"parameter {names[0]} refers to itself", "", "Give it a number.")
    chain = " -> ".join([*names[:6], *(["…"] if len(names) > 6 else []), names[0]])
    return node.error(
        f"parameters refer to each other in a circle: {chain}", "", "Give one of them a number."
    )


def _entry(name: str, node: Node) -> _Entry:
    """Read what the file says about a parameter."""
    what = f"parameter {name}"
    if not isinstance(node, MappingNode):
        return _Entry(scalar_of(node, what))
    collector, tunable, symbol = ErrorCollector(), False, ""
    table = table_of(node, PARAMETER, collector, what)
    ends = table.get("tunable")
    with collector:
        tunable = isinstance(ends, SequenceNode) or table.word("tunable")
    with collector:
        value = scalar_of(table.require("value", what), what)
    with collector:
        written = table.get("symbol")
        symbol = symbol_name(scalar_of(written, "symbol"), what) if written else ""
    collector.end()
    return _Entry(value, tunable, ends if isinstance(ends, SequenceNode) else None, symbol)
