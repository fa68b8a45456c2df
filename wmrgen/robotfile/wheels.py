"""Read the wheels and couplings of a robot file: position, radius, type, and which joints are driven and measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from wmrgen.errors import Code, ErrorCollector, RobotFileError
from wmrgen.robotfile.fields import Amount
from wmrgen.robotfile.joints import read_of_joints
from wmrgen.robotfile.keys import COUPLING, WHEEL
from wmrgen.robotfile.names import Names, numbered_names, wheel_name
from wmrgen.robotfile.numbers import Kind
from wmrgen.robotfile.quantities import Scope, read_quantity
from wmrgen.robotfile.records import Coupling, Quantity, WheelSpec
from wmrgen.robotfile.tables import Table, read_number, table_of
from wmrgen.robotfile.text import (
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    lookalike,
    quoted,
    scalar_of,
    suggestion,
)
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType

_PLACEMENT, _ORIENTATION = WHEEL.choices
_QUANTITIES = tuple(f.key for f in WHEEL.fields if isinstance(f.value, Amount))


def declared_types(robot: Table) -> dict[str, WheelType | None]:
    """Return the names that joints begin with, each with the type of its wheel; None if the type is unknown."""
    return {name: kind for _, name, kind in _declared(robot)}


def every_wheel_is_named(robot: Table) -> bool:
    """Return whether each wheel has a name of its own."""
    node = robot.get("wheels")
    named = {wheel for wheel, _, _ in _declared(robot)}
    return not isinstance(node, SequenceNode) or len(named) == len(node.items)


def _declared(robot: Table) -> Iterator[tuple[str, str, WheelType | None]]:
    """Yield for each wheel its name, the name that its joints begin with, and its type.

    A ball that is driven in two directions is yielded twice, with the names ``name_1`` and ``name_2`` of its joints.
    """
    node = robot.get("wheels")
    for item in node.items if isinstance(node, SequenceNode) else ():
        entries = {key.text: value for key, value in item.entries} if isinstance(item, MappingNode) else {}
        name, type_, driven = (entries.get(key) for key in ("name", "type", "driven"))
        if not isinstance(name, Scalar):
            continue
        kind = WHEEL_TYPES.get(type_.text) if isinstance(type_, Scalar) else None
        count = len(driven.items) if kind and kind.powered and isinstance(driven, SequenceNode) else 0
        owners = [f"{name.text}_{k + 1}" for k in range(count)] if count > 1 else [name.text]
        for owner in owners:
            yield name.text, owner, kind.powered if kind and count else kind


def read_wheels(robot: Table, scope: Scope, names: Names, collector: ErrorCollector) -> tuple[WheelSpec, ...]:
    """Read the wheels.

    Args:
        robot: The table of the robot file.
        scope: The parameters that expressions may use.
        names: Receives the names of the wheels.
        collector: Receives the errors.

    Returns:
        The wheels whose type is valid, without the values that are wrong.
    """
    wheels: list[WheelSpec] = []
    for item in robot.items("wheels"):
        with collector:
            wheels += _wheel(item, scope, names, collector)
    return tuple(wheels)


def _wheel(item: Node, scope: Scope, names: Names, collector: ErrorCollector) -> list[WheelSpec]:
    """Read one entry of ``wheels``: one record, or one for each direction in which a ball is driven."""
    name, table = "", table_of(item, WHEEL, collector)
    with collector:
        node = scalar_of(table.require("name", "the wheel"), "name")
        name = wheel_name(node)
        names.add(name, "a wheel", node)
    kind, what = None, f"the wheel {name}".rstrip()
    with collector:
        kind = _type(table, what)
    facts: dict[str, Any] = {}
    for key in _QUANTITIES:
        with collector:
            facts[key] = table.amount(key, name or "the wheel", scope)
    with collector:
        table.choose(_PLACEMENT, what)
    if kind is None:
        return []
    what = f"the {kind.name} wheel {name}".rstrip()
    directions: list[Quantity] = []
    if kind.powered:
        with collector:
            of = f"driven of {name or 'the wheel'}"
            directions = [read_quantity(d, Kind.ANGLE, of, scope) for d in table.items("driven")]
    powered = kind.powered if directions else None
    _check_keys(table, kind, what, collector)
    if not powered:
        facts |= _joint_facts(table, kind, what, scope, collector)
        return [WheelSpec(name=name, type=kind.name, mark=table.mark, **facts)]
    with collector:
        _check_driven(table, powered, what)
    facts |= _joint_facts(table, powered, what, scope, collector) | {"beta": None}
    drives = []
    with collector:
        owners = numbered_names(node, len(directions)) if name else [""] * len(directions)
        for owner, direction in zip(owners, directions, strict=True):
            if owner != name:
                names.add(owner, f"a drive of the ball {name}", node)
            facts["heading"] = direction
            ball = name or owner
            drives.append(WheelSpec(name=owner, type=kind.name, mark=table.mark, ball=ball, **facts))
    return drives


def _check_driven(table: Table, powered: WheelType, what: str) -> None:
    """Check that a driven ball has the keys that its drives need, and no orientation of its own."""
    for key in ("beta", "heading"):
        if key in table.keys:
            raise table.keys[key].error(
                f"{what} has driven as well as {key}",
                "The directions of driven are in the robot frame; the ball itself has no orientation.",
                f"Delete {key}.",
                code=Code.TWICE,
            )
    for key in powered.required:
        table.require(key, what)


def _check_keys(table: Table, kind: WheelType, what: str, collector: ErrorCollector) -> None:
    """Check that a wheel has the keys that its type requires, and none that its type does not have."""
    if unknown := {*kind.keys, *kind.required} - {f.key for f in WHEEL.fields}:
        raise ValueError(f"the wheel type {kind.name} has the unknown key {min(unknown)}")
    for key, node in table.keys.items():
        reason = WHEEL.field(key).misfit
        if reason and not kind.takes(key) and key not in table.excused:
            why, instead = kind.misfits.get(key, reason)
            collector.add(node.error(f"{what} has the key {key}", why, instead, code=Code.TWICE))
    with collector:
        table.choose(_ORIENTATION, what, kind.oriented)
    for key in kind.required:
        with collector:
            table.require(key, what)


def _joint_facts(
    table: Table, kind: WheelType, what: str, scope: Scope, collector: ErrorCollector
) -> dict[str, tuple[Any, ...]]:
    """Return the fields of a WheelSpec that belong to joints: driven, measured, limits, noise, encoders, lag, names."""
    facts: dict[str, tuple[Any, ...]] = {"actuated": kind.actuated}
    for key in ("actuated", "sensed"):
        with collector:
            facts[key] = read_joints(table, key, kind, facts["actuated"])
    keys = {"limits": "limits", "noise": "noise", "encoders": "encoder", "lag": "lag", "joints": "joints"}
    for part, key in keys.items():
        with collector:
            facts[part] = read_of_joints(key, table, what, scope, collector, kind.joints)
    return facts


def _type(table: Table, what: str) -> WheelType:
    """Return the type of a wheel; raise RobotFileError if it is missing or unknown."""
    names = " ".join(WHEEL_TYPES)
    if "type" not in table.values:
        why, instead = WHEEL.field("type").missing or ("", "")
        raise table.missing("type", what, why, instead.format(types=names))
    node = scalar_of(table.values["type"], "type")
    if node.text not in WHEEL_TYPES:
        hint = suggestion(node.text, WHEEL_TYPES, _aliases())
        why = lookalike(node.text) or ("" if hint.startswith("Valid") else f"The types are {names}.")
        raise node.error(f"unknown wheel type {quoted(node.text)}", why, hint)
    return WHEEL_TYPES[node.text]


def _aliases() -> dict[str, str]:
    """Return other names of wheel types, each with a hint."""
    hints = {}
    for kind in WHEEL_TYPES.values():
        for alias, hint in kind.aliases.items():
            hints[alias] = f"Did you mean {kind.name}? {hint}".rstrip()
    return hints


def takes(kind: WheelType, key: str) -> bool:
    """Return whether wheels of this type may have the key."""
    return WHEEL.field(key).misfit is None or kind.takes(key)


def read_joints(table: Table, key: str, kind: WheelType, default: tuple[str, ...]) -> tuple[str, ...]:
    """Read which joints of a wheel are driven or measured.

    Args:
        table: The wheel.
        key: ``actuated`` or ``sensed``.
        kind: The type of the wheel.
        default: The joints if the key is absent.

    Returns:
        The joints in the order spin, steer.
    """
    if table.get(key) is None:
        return default
    names = []
    for scalar in table.scalars(key):
        names.append(scalar.text)
        if scalar.text not in kind.joints:
            what = f"a {kind.name} wheel has no joint {quoted(scalar.text)}"
            raise _no_joint(scalar, what, scalar.text, kind, f"Write {key}: [] or delete the key.")
    return tuple(joint for joint in kind.joints if joint in names)


def _no_joint(scalar: Scalar, what: str, joint: str, kind: WheelType, without: str) -> RobotFileError:
    """Return the error for a joint that wheels of this type lack; ``without``: what to write if they have none."""
    if not kind.joints:
        return scalar.error(what, "A wheel of this type has no joint.", without)
    return scalar.error(what, "", suggestion(joint, kind.joints))


def read_couplings(
    robot: Table, types: Mapping[str, WheelType | None], scope: Scope, collector: ErrorCollector
) -> tuple[Coupling, ...]:
    """Read the couplings, each of which couples one joint of at least two wheels.

    Args:
        robot: The table of the robot file.
        types: The type of each wheel, None if it is unknown.
        scope: The parameters that ratios may use.
        collector: Receives the errors.
    """
    couplings: dict[tuple[str, frozenset[str]], Coupling] = {}
    for item in robot.items("couplings"):
        with collector:
            table = table_of(item, COUPLING, collector)
            coupling = _coupling(table, types, scope)
            key = coupling.joint, frozenset(coupling.wheels)
            if key in couplings:
                what = f"the same coupling is on line {couplings[key].mark.line}"
                raise table.node.error(what, "", "Delete one of them.", code=Code.TWICE)
            couplings[key] = coupling
    return tuple(couplings.values())


def _coupling(table: Table, types: Mapping[str, WheelType | None], scope: Scope) -> Coupling:
    """Read one entry of ``couplings``."""
    table.require("equal", "a coupling")
    collector, joint, names = ErrorCollector(), "", list[str]()
    for scalar in table.scalars("equal"):
        with collector:
            name, this = _joint(scalar, types)
            if joint and this != joint:
                raise scalar.error(
                    f"{quoted(scalar.text)} is not a {joint} joint like the first",
                    "A coupling has joints of one kind.",
                    f"Write {name}.{joint}, or another coupling.",
                )
            joint = this
            names.append(name)
    ratios = list[Quantity]()
    with collector:
        ratios += (read_number(item, "a ratio of the coupling", scope) for item in table.items("ratios"))
    collector.end()
    if ratios and len(ratios) != len(names):
        raise table.values["ratios"].error(
            f"{len(ratios)} ratio{'s' * (len(ratios) != 1)} of {len(names)} joints", "Each joint has one.",
            f"Write ratios: [{', '.join(['1'] * len(names))}], the turns of each joint per turn of the shaft.",
        )  # fmt: skip
    return Coupling(joint, tuple(names), table.mark, tuple(ratios))


def _joint(scalar: Scalar, types: Mapping[str, WheelType | None]) -> tuple[str, str]:
    """Return the wheel and the joint of a text such as ``left.spin``."""
    name, dot, joint = scalar.text.strip().partition(".")
    if not dot:
        wheel = name if name in types else "wheel"
        raise scalar.error(
            f"{quoted(scalar.text)} is not a joint", "", f"Write {wheel}.spin or {wheel}.steer."
        )
    kind = wheel_called(name, scalar, types)
    if kind is not None and joint not in kind.joints:
        what = f"the {kind.name} wheel {name} has no joint {quoted(joint)}"
        if joint == "steer_rate":
            raise scalar.error(what, "Coupled angles have coupled rates.", f"Write {name}.steer.")
        raise _no_joint(scalar, what, joint, kind, "Delete it from the coupling.")
    return name, joint


def wheel_called(name: str, scalar: Scalar, types: Mapping[str, WheelType | None]) -> WheelType | None:
    """Return the type of the wheel with a name; None if its type is unknown, which has been reported.

    Args:
        name: The name of the wheel.
        scalar: The text that has the name, for the place of errors.
        types: The type of each wheel.

    Raises:
        RobotFileError: There is no wheel of this name.
    """
    if name not in types:
        what = f"there is no wheel {quoted(name)}"
        raise scalar.error(what, "", suggestion(name, types), code=Code.UNDECLARED)
    return types[name]
