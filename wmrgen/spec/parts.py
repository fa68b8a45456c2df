"""Reading what a robot file says beside its wheels and joints: virtual wheels, trailers, centre of gravity, gains."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wmrgen.errors import Several
from wmrgen.spec.names import Names, wheel_name
from wmrgen.spec.numbers import Scope
from wmrgen.spec.part_keys import CG, GAINS, TRAILER, VIRTUAL
from wmrgen.spec.records import PointSpec, Quantity, TrailerSpec, VirtualSpec
from wmrgen.spec.tables import Table, read_number, table_of
from wmrgen.spec.text import Node, scalar_of
from wmrgen.spec.wheels import wheel_called
from wmrgen.wheels import WHEEL_TYPES, WheelType

_ROLE, _POINT = VIRTUAL.choices


class Reading(NamedTuple):
    """What the parts of a robot file are read by: its keys, parameters, names, the types of its wheels, if known, and
    what takes the mistakes."""

    table: Table
    scope: Scope
    names: Names
    types: Mapping[str, WheelType | None]
    several: Several


def read_trailers(reading: Reading) -> tuple[TrailerSpec, ...]:
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


def read_virtual(reading: Reading) -> tuple[VirtualSpec, ...]:
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


def read_point(node: Node | None, scope: Scope) -> PointSpec | None:
    """``cg``: x, y from P in the robot frame, z above the ground."""
    if node is None:
        return None
    several = Several()
    table = table_of(node, CG, several)
    table.require_all("cg", several)
    x, y, z = (_amount(table, key, "cg", scope, several) for key in ("x", "y", "z"))
    several.end()
    return PointSpec(x, y, z) if x and y and z else None


def read_gains(node: Node | None, scope: Scope) -> tuple[tuple[str, Quantity], ...]:
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
