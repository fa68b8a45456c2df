"""Wheels: one mapping of the file to one WheelSpec."""

from __future__ import annotations

from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.fields import Amount
from wmrgen.spec.joints import limits_of_type, read_joints, read_limits
from wmrgen.spec.keys import WHEEL
from wmrgen.spec.mappings import Table, table_of
from wmrgen.spec.names import wheel_name
from wmrgen.spec.nodes import Node
from wmrgen.spec.quantities import scalar_of
from wmrgen.spec.records import WheelSpec
from wmrgen.spec.scope import Scope
from wmrgen.spec.text import quoted, suggestion
from wmrgen.wheels import WHEEL_TYPES, WheelType

_PLACEMENT, _ORIENTATION = WHEEL.choices
_QUANTITIES = tuple(f.key for f in WHEEL.fields if isinstance(f.value, Amount))


def read_wheels(robot: Table, scope: Scope) -> tuple[WheelSpec, ...]:
    """The list of wheels, names distinct."""
    wheels: dict[str, WheelSpec] = {}
    for item in robot.items("wheels"):
        wheel = _wheel(item, scope)
        if wheel.name in wheels:
            raise RobotFileError(
                f"a second wheel has the name {quoted(wheel.name)}",
                wheel.marks["name"],
                f"The first stands on line {wheels[wheel.name].mark.line}; joints bear their wheel's name.",
                "Give each wheel a name of its own.",
            )
        wheels[wheel.name] = wheel
    return tuple(wheels.values())


def _wheel(node: Node, scope: Scope) -> WheelSpec:
    table = table_of(node, WHEEL)
    name = wheel_name(scalar_of(table.require("name", "the wheel"), "name"))
    kind = _type(table, name)
    what = f"the {kind.name} wheel {name}"
    _refuse_misfits(table, what, kind)
    table.choose(_PLACEMENT, f"the wheel {name}")
    table.choose(_ORIENTATION, what, kind.oriented)
    for key in kind.required:
        table.require(key, what)
    quantities = {key: table.amount(key, name, scope) for key in _QUANTITIES}
    actuated = read_joints(table, "actuated", kind, kind.actuated)
    return WheelSpec(
        name=name,
        type=kind.name,
        mark=table.mark,
        marks=_marks(table),
        **quantities,
        actuated=actuated,
        sensed=read_joints(table, "sensed", kind, actuated),
        limits=read_limits(table.get("limits"), what, scope, limits_of_type(kind)),
    )


def _marks(table: Table) -> dict[str, Mark]:
    return {key: node.mark for key, node in table.keys.items()}


def _type(table: Table, wheel: str) -> WheelType:
    names = " ".join(WHEEL_TYPES)
    if "type" not in table.values:
        why, instead = WHEEL.field("type").missing or ("", "")
        raise table.node.error(f"the wheel {wheel} has no type", why, instead.format(types=names))
    node = scalar_of(table.values["type"], "type")
    if node.text not in WHEEL_TYPES:
        raise node.error(
            f"unknown wheel type {quoted(node.text)}",
            f"The types are {names}.",
            suggestion(node.text, WHEEL_TYPES, _aliases()),
        )
    return WHEEL_TYPES[node.text]


def _aliases() -> dict[str, str]:
    """What people also call wheels, with the type that is meant."""
    return {
        alias: f"Did you mean {kind.name}? {hint}".rstrip()
        for kind in WHEEL_TYPES.values()
        for alias, hint in kind.aliases.items()
    }


def takes(kind: WheelType, key: str) -> bool:
    """A wheel of this type has the key."""
    return WHEEL.field(key).misfit is None or key in kind.keys


def _refuse_misfits(table: Table, what: str, kind: WheelType) -> None:
    for key, node in table.keys.items():
        reason = WHEEL.field(key).misfit
        if reason and key not in kind.keys:
            raise node.error(f"{what} has the key {key}", *kind.misfits.get(key, reason))
