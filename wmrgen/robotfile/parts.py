"""Reading what a robot file says beside its wheels and joints: virtual wheels, trailers, centre of gravity, gains,
parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from wmrgen.errors import ErrorCollector, RobotFileError
from wmrgen.robotfile.fields import Mapped
from wmrgen.robotfile.keys import CG, GAINS, GYRO, PARAMETER, ROBOT, TRAILER, VIRTUAL
from wmrgen.robotfile.names import Names, parameter_name, wheel_name
from wmrgen.robotfile.numbers import Facts, Kind, Scope, facts_of
from wmrgen.robotfile.quantities import of_one_kind, parse_value, read_quantity
from wmrgen.robotfile.records import (
    GyroSpec,
    NoiseSpec,
    ParameterSpec,
    PointSpec,
    Quantity,
    TrailerSpec,
    VirtualSpec,
    parameters_in,
)
from wmrgen.robotfile.tables import Table, mapping_of, read_number, severed, table_of
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, quoted, scalar_of
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType
from wmrgen.robotfile.wheels import wheel_called

_ROLE, _POINT = VIRTUAL.choices


class Reading(NamedTuple):
    """What the parts of a robot file are read by: its keys, parameters, names, the types of its wheels, if known, and
    what takes the mistakes."""

    table: Table
    scope: Scope
    names: Names
    types: Mapping[str, WheelType | None]
    collector: ErrorCollector


def read_gyro(reading: Reading) -> GyroSpec | None:
    """The yaw-rate sensor, where the robot has one."""
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
    """Trailers from the robot backwards; without a name they are trailer1, trailer2, …"""
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
    """A quantity; ``several`` takes what is wrong with it."""
    with collector:
        return table.amount(key, of, scope)
    return None


def read_virtual(reading: Reading) -> tuple[VirtualSpec, ...]:
    """Virtual wheels: each steers or drives in place of real ones."""
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
    collector = ErrorCollector()
    wanted = [k.name for k in WHEEL_TYPES.values() if (k.steers if role == "steers" else k.constrains)]
    scalars = table.scalars(role)
    for scalar in scalars:
        with collector:
            kind = wheel_called(scalar.text, scalar, types)
            if kind is not None and kind.name not in wanted:
                raise scalar.error(
                    f"{scalar.text} is a {kind.name} wheel",
                    f"A virtual wheel that {role} stands for {' or '.join(wanted)} wheels.",
                )
    collector.end()
    return tuple(scalar.text for scalar in scalars)


def read_point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    collector = ErrorCollector()
    table = table_of(node, CG, collector)
    table.require_all("cg", collector)
    x, y, z = (_amount(table, key, "cg", scope, collector) for key in ("x", "y", "z"))
    collector.end()
    return PointSpec(x, y, z) if x and y and z else None


def read_gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Gains of the control laws, as expressions over parameters."""
    if node is None:
        return ()
    collector, gains = ErrorCollector(), []
    for key, value in table_of(node, GAINS, collector).values.items():
        with collector:
            gains.append((key, read_number(value, key, scope)))
    collector.end()
    return tuple(gains)


def _own_name(table: Table, default: str, names: Names, what: str) -> str:
    """The name of an entry, entered into ``names``."""
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name:
        names.add(name, what, node or table.node)
    return name


# ---- parameters, in an order in which each stands after those it uses


def read_parameters(
    node: Node | None, scope: Scope, names: Names, collector: ErrorCollector
) -> tuple[tuple[ParameterSpec, ...], Scope]:
    """Parameters that can be read, each after those it uses, and the scope that knows them."""
    if node is None:
        return (), scope
    mapping = mapping_of(node, "parameters", "parameters: and lines such as half_track: 0.1655")
    value = ROBOT.field("parameters").value
    assert isinstance(value, Mapped)
    if len(mapping.entries) > value.most:
        what = f"{len(mapping.entries)} parameters"
        collector.add(mapping.error(what, f"At most {value.most} are read."))
    facts: dict[str, Facts | None] = dict.fromkeys(key.text for key, _ in mapping.entries)
    scope = replace(scope, facts=facts)
    nodes: dict[str, Scalar] = {}
    trees = {}
    tunable: dict[str, bool] = {}
    ends: dict[str, SequenceNode | None] = {}
    rests = [severed(key, entry) for key, entry in mapping.entries]
    for (key, entry), rest, behind in zip(mapping.entries, rests, [*rests, None][1:], strict=True):
        name = key.text
        if rest:
            collector.add(key.error(f"{quoted(name)} stands where a key is expected", *rest))
        if rest or behind:  # half of a value is not judged
            facts[name] = None
            continue
        with collector:
            names.add(parameter_name(key), "a parameter", key)
        with collector:
            nodes[name], tunable[name], ends[name] = _entry(name, entry)
            trees[name] = parse_value(nodes[name], scope.facts, Kind.ANY, f"parameter {name}")
    parameters: list[ParameterSpec] = []
    order: list[str] = []
    with collector:
        order = _dependency_order({name: parameters_in(tree) for name, (tree, _) in trees.items()}, nodes)
    for name in order:
        with collector:
            expr, unit = trees[name]
            facts[name] = facts_of(expr, unit, scope, nodes[name])
            quantity = Quantity(expr, nodes[name].text.strip(), nodes[name].mark)
            parameters.append(ParameterSpec(name, quantity, tunable[name]))
    for k, p in enumerate(parameters):
        with collector:
            parameters[k] = p._replace(range=_range(p.name, ends[p.name], scope))
    return tuple(parameters), scope


def _range(name: str, node: SequenceNode | None, scope: Scope) -> tuple[Quantity, Quantity] | None:
    """The ends [low, high] of a tunable parameter; any parameter may stand in them, for all have been read."""
    if node is None:
        return None
    what = f"the range of parameter {name}"
    if len(node.items) != 2:
        raise node.error(
            f"{what} has {len(node.items)} value{'s' * (len(node.items) != 1)}",
            "A range has two.",
            "Write tunable: [low, high], or tunable: true for 10 % on either side.",
        )
    own = scope.facts[name]
    assert own is not None
    low, high = (read_quantity(item, Kind.ANY, what, scope) for item in node.items)
    for item in node.items:
        of_one_kind(scalar_of(item, what), what, own, scope)
    return low, high


def _dependency_order(uses: Mapping[str, set[str]], nodes: Mapping[str, Scalar]) -> list[str]:
    """Names ordered so that each stands after those it uses, in file order otherwise.

    RobotFileError for a circle. Iterative: a chain of parameters may be long.
    """
    order: dict[str, None] = {}
    for root in uses:
        path = [root]
        while path:
            name = path[-1]
            missing = [used for used in sorted(uses[name]) if used not in order and used in uses]
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


def _entry(name: str, node: Node) -> tuple[Scalar, bool, SequenceNode | None]:
    """The value node of a parameter, whether it is tunable, and the list of the ends of its range."""
    what = f"parameter {name}"
    if not isinstance(node, MappingNode):
        return scalar_of(node, what), False, None
    collector, tunable = ErrorCollector(), False
    table = table_of(node, PARAMETER, collector, what)
    ends = table.get("tunable")
    with collector:
        tunable = isinstance(ends, SequenceNode) or table.word("tunable")
    with collector:
        value = scalar_of(table.require("value", what), what)
    collector.end()
    return value, tunable, ends if isinstance(ends, SequenceNode) else None
