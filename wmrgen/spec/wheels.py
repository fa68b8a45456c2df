"""Wheels: one mapping of the file to one WheelSpec."""

from __future__ import annotations

from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.fields import COMMON_KEYS, MISFITS, QUANTITIES, WHEEL_KEYS
from wmrgen.spec.joints import limits_of_type, list_of, read_joints, read_limits
from wmrgen.spec.mappings import Table, table_of
from wmrgen.spec.names import wheel_name
from wmrgen.spec.nodes import Node
from wmrgen.spec.quantities import read_quantity, scalar_of
from wmrgen.spec.records import Quantity, WheelSpec
from wmrgen.spec.scope import Scope
from wmrgen.spec.text import quoted, suggestion
from wmrgen.wheels import WHEEL_TYPES, WheelType

MAX_WHEELS = 64
_EXAMPLE = "{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05}"


def read_wheels(node: Node, scope: Scope) -> tuple[WheelSpec, ...]:
    """The list of wheels, names distinct."""
    items = list_of(node, "wheels", f"wheels: and a list of items - {_EXAMPLE}").items
    if not items:
        raise node.error(
            "the list of wheels is empty", "A robot without wheels has no kinematics.", "Add a wheel."
        )
    if len(items) > MAX_WHEELS:
        raise RobotFileError(
            f"{len(items)} wheels",
            items[MAX_WHEELS].mark,
            f"At most {MAX_WHEELS} are derived.",
            "Leave out passive castors and balls: they constrain nothing.",
        )
    wheels: dict[str, WheelSpec] = {}
    for item in items:
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
    table = table_of(node, WHEEL_KEYS, "a wheel", _EXAMPLE)
    name = wheel_name(scalar_of(table.require("name", "the wheel"), "name"))
    kind = _type(table, name)
    what = f"the {kind.name} wheel {name}"
    _refuse_misfits(table, what, kind)
    _check_placement(table, name)
    _check_orientation(table, name, kind)
    for key in kind.required:
        table.require(key, what)
    quantities = {key: _quantity(table, key, name, scope) for key in QUANTITIES}
    actuated = read_joints(table.get("actuated"), "actuated", kind, kind.actuated)
    return WheelSpec(
        name=name,
        type=kind.name,
        mark=table.mark,
        marks=_marks(table),
        **quantities,
        actuated=actuated,
        sensed=read_joints(table.get("sensed"), "sensed", kind, actuated),
        limits=read_limits(table.get("limits"), limits_of_type(kind), what, scope),
    )


def _marks(table: Table) -> dict[str, Mark]:
    return {key: node.mark for key, node in table.keys.items()}


def _quantity(table: Table, key: str, wheel: str, scope: Scope) -> Quantity | None:
    node = table.get(key)
    return None if node is None else read_quantity(node, QUANTITIES[key][0], f"{key} of {wheel}", scope)


def _type(table: Table, wheel: str) -> WheelType:
    names = " ".join(WHEEL_TYPES)
    if "type" not in table.values:
        what, why = f"the wheel {wheel} has no type", "It decides what the wheel constrains."
        raise table.node.error(what, why, f"Write type: and one of {names}.")
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


def _refuse_misfits(table: Table, what: str, kind: WheelType) -> None:
    for key, node in table.keys.items():
        if key not in COMMON_KEYS and key not in kind.keys:
            raise node.error(f"{what} has the key {key}", *(kind.misfits.get(key) or MISFITS[key]))


def _check_placement(table: Table, wheel: str) -> None:
    """Exactly one of (l, alpha) and (x, y), complete."""
    polar = [key for key in ("l", "alpha") if key in table.keys]
    cartesian = [key for key in ("x", "y") if key in table.keys]
    if polar and cartesian:
        later = max(polar[0], cartesian[0], key=list(table.keys).index)
        raise table.keys[later].error(
            f"the wheel {wheel} is placed twice: by {' and '.join(polar)} and by {' and '.join(cartesian)}",
            "They say the same thing and could disagree.",
            "Keep l and alpha, or x and y.",
        )
    if not polar and not cartesian:
        raise table.node.error(
            f"the wheel {wheel} has no place",
            "Kinematics needs the pivot of every wheel in the robot frame, x forward and y left.",
            "Write x: and y:, or l: and alpha: (distance and direction from the origin).",
        )
    for key in ("l", "alpha") if polar else ("x", "y"):
        table.require(key, f"the wheel {wheel}")


def _check_orientation(table: Table, wheel: str, kind: WheelType) -> None:
    """beta or heading, not both; wheels without a working direction need neither."""
    if "beta" in table.keys and "heading" in table.keys:
        later = max("beta", "heading", key=list(table.keys).index)
        raise table.keys[later].error(
            f"the wheel {wheel} has beta and heading",
            "Both give the orientation: heading = alpha + beta - pi/2.",
            "Keep one of them.",
        )
    if kind.oriented and "beta" not in table.keys and "heading" not in table.keys:
        raise table.node.error(
            f"the {kind.name} wheel {wheel} has no beta or heading",
            "The rolling direction decides what the wheel allows; where it steers it is the zero of steer.",
            "Write heading: 0 for a wheel that rolls forward, or beta: as in the literature.",
        )
