"""What a robot file may say beyond its wheels: trailers, virtual coordinates, centre of gravity, gains, functions."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.spec.keys import CG, GAINS, TRAILER, VIRTUAL
from wmrgen.spec.mappings import Table, table_of
from wmrgen.spec.names import wheel_name
from wmrgen.spec.nodes import Node, Scalar
from wmrgen.spec.numbers import Kind, plain_number
from wmrgen.spec.quantities import read_quantity, scalar_of
from wmrgen.spec.records import FunctionSpec, PointSpec, Quantity, TrailerSpec, VirtualSpec, WheelSpec
from wmrgen.spec.scope import Scope
from wmrgen.spec.text import quoted, suggestion
from wmrgen.wheels import WHEEL_TYPES

_ROLE, _POINT = VIRTUAL.choices


def read_trailers(robot: Table, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[TrailerSpec, ...]:
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


def read_virtual(robot: Table, wheels: Sequence[WheelSpec], scope: Scope) -> tuple[VirtualSpec, ...]:
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


def read_point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    table = table_of(node, CG)
    table.require_all("cg")
    x, y, z = (table.required_amount(key, "cg", scope) for key in ("x", "y", "z"))
    return PointSpec(x, y, z)


def read_gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
    """Gains of the control laws, as expressions over parameters."""
    if node is None:
        return ()
    table = table_of(node, GAINS)
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


def read_functions(robot: Table) -> tuple[FunctionSpec, ...]:
    """Optional functions to be generated, in the order of the file."""
    return tuple(FunctionSpec(scalar.text, scalar.mark) for scalar in robot.scalars("functions"))


def _own_name(table: Table, default: str, taken: dict[str, str], what: str) -> str:
    """The name of an entry, not one that is taken. Entered into ``taken``."""
    node = table.get("name")
    name = default if node is None else wheel_name(scalar_of(node, "name"))
    if name in taken:
        place = node if isinstance(node, Scalar) else table.node
        raise place.error(f"{quoted(name)} is the name of {taken[name]} already", "", "Write another name.")
    taken[name] = what
    return name
