"""What a robot file may say beyond its wheels: trailers, virtual coordinates, centre of gravity, gains, functions."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.spec.fields import GAINS
from wmrgen.spec.joints import list_of
from wmrgen.spec.mappings import Table, table_of
from wmrgen.spec.names import wheel_name
from wmrgen.spec.nodes import Node, Scalar
from wmrgen.spec.numbers import Kind, plain_number
from wmrgen.spec.quantities import read_quantity, scalar_of
from wmrgen.spec.records import FunctionSpec, PointSpec, Quantity, TrailerSpec, VirtualSpec, WheelSpec
from wmrgen.spec.scope import Scope
from wmrgen.spec.text import quoted, suggestion
from wmrgen.wheels import WHEEL_TYPES

MAX_TRAILERS = 16
_TRAILER = "{length: 1.1, hitch: 0}"
_VIRTUAL = "{name: front, steers: [front_left, front_right]}"


def read_trailers(node: Node | None, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[TrailerSpec, ...]:
    """Trailers from the robot backwards; without a name they are trailer1, trailer2, …"""
    if node is None:
        return ()
    items = list_of(node, "trailers", f"trailers: and a list of items - {_TRAILER}").items
    if len(items) > MAX_TRAILERS:
        raise node.error(f"{len(items)} trailers", f"At most {MAX_TRAILERS} are derived.")
    taken = {w.name: "a wheel" for w in wheels}
    found = []
    for number, item in enumerate(items, 1):
        table = table_of(item, ("name", "length", "hitch"), "a trailer", _TRAILER)
        name = _own_name(table, f"trailer{number}", taken, "a trailer")
        table.require("length", f"the trailer {name}")
        length = _length(table, "length", name, scope)
        hitch = _length(table, "hitch", name, scope) if "hitch" in table.values else None
        found.append(TrailerSpec(name, length, hitch, table.mark))
    return tuple(found)


def read_virtual(node: Node | None, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[VirtualSpec, ...]:
    """Virtual wheels: each steers or drives in place of real ones."""
    if node is None:
        return ()
    taken = {w.name: "a wheel" for w in wheels}
    found = []
    for item in list_of(node, "virtual", f"virtual: and a list of items - {_VIRTUAL}").items:
        table = table_of(item, ("name", "steers", "drives", "x", "y"), "a virtual wheel", _VIRTUAL)
        scalar_of(table.require("name", "the virtual wheel"), "name")
        name = _own_name(table, "", taken, "a virtual wheel")
        roles = [key for key in ("steers", "drives") if key in table.values]
        if len(roles) != 1:
            raise table.node.error(
                f"the virtual wheel {name} has {'steers and drives' if roles else 'neither steers nor drives'}",
                "It stands for wheels that steer together, or for wheels that drive together.",
                "Write steers: [front_left, front_right] or drives: [rear_left, rear_right].",
            )
        if ("x" in table.values) != ("y" in table.values):
            raise table.node.error(f"the virtual wheel {name} has one of x and y", "", "Write both or none.")
        place = [_length(table, key, name, scope) if key in table.values else None for key in ("x", "y")]
        members = _members(table.values[roles[0]], roles[0], wheels)
        found.append(VirtualSpec(name, roles[0], members, place[0], place[1], table.mark))
    return tuple(found)


def _members(node: Node, role: str, wheels: Sequence[WheelSpec]) -> tuple[str, ...]:
    types = {w.name: w.type for w in wheels}
    wanted = [k.name for k in WHEEL_TYPES.values() if (k.steers if role == "steers" else k.constrains)]
    names: list[str] = []
    for item in list_of(node, role, f"{role}: [front_left, front_right]").items:
        scalar = scalar_of(item, f"an item of {role}")
        if scalar.text not in types:
            raise scalar.error(f"there is no wheel {quoted(scalar.text)}", "", suggestion(scalar.text, types))
        if types[scalar.text] not in wanted:
            raise scalar.error(
                f"{scalar.text} is a {types[scalar.text]} wheel",
                f"A virtual wheel that {role} stands for {' or '.join(wanted)} wheels.",
            )
        if scalar.text in names:
            raise scalar.error(f"{quoted(scalar.text)} stands twice in {role}", "", "Delete one of them.")
        names.append(scalar.text)
    if not names:
        raise node.error(f"{role} names no wheel", "", f"Write {role}: [front_left, front_right].")
    return tuple(names)


def read_point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    table = table_of(node, ("x", "y", "z"), "cg", "cg: {x: 0, y: 0, z: 0.3}")
    for key in ("x", "y", "z"):
        table.require(key, "cg")
    x, y, z = (_length(table, key, "cg", scope) for key in ("x", "y", "z"))
    return PointSpec(x, y, z)


def read_gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Gains of the control laws, as expressions over parameters."""
    if node is None:
        return ()
    table = table_of(node, tuple(GAINS), "gains", "gains: {k_rho: 3, k_alpha: 8, k_beta: -1.5}")
    return tuple((key, _gain(value, key, scope)) for key, value in table.values.items())


def _gain(node: Node, key: str, scope: Scope) -> Quantity:
    scalar = scalar_of(node, key)
    found = plain_number(scalar)
    if found and found[1] is not None:
        raise scalar.error(
            f"{key} is a number per second, and {quoted(scalar.text.strip())} has a unit",
            "",
            f"Write the number alone, as {key}: 3.",
        )
    return read_quantity(scalar, Kind.ANY, key, scope)


def read_functions(node: Node | None) -> tuple[FunctionSpec, ...]:
    """Optional functions to be generated, in the order of the file."""
    if node is None:
        return ()
    requests: list[FunctionSpec] = []
    for item in list_of(node, "functions", "functions: [dynamics]").items:
        scalar = scalar_of(item, "an item of functions")
        if scalar.text in (request.name for request in requests):
            raise scalar.error(f"{quoted(scalar.text)} stands twice in functions", "", "Delete one of them.")
        requests.append(FunctionSpec(scalar.text, scalar.mark))
    return tuple(requests)


def _own_name(table: Table, default: str, taken: dict[str, str], what: str) -> str:
    """The name of an entry, not one that is taken. Entered into ``taken``."""
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name in taken:
        place = node if isinstance(node, Scalar) else table.node
        raise place.error(f"{quoted(name)} is the name of {taken[name]} already", "", "Write another name.")
    taken[name] = what
    return name


def _length(table: Table, key: str, name: str, scope: Scope) -> Quantity:
    return read_quantity(table.values[key], Kind.LENGTH, f"{key} of {name}", scope)
