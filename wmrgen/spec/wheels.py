"""Wheels: one mapping of the file to one WheelSpec."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.expressions import read_quantity, scalar_of
from wmrgen.spec.fields import Amount, Interval
from wmrgen.spec.keys import COUPLING, LIMITS, WHEEL
from wmrgen.spec.numbers import Scope
from wmrgen.spec.records import Binary, Coupling, Limit, Neg, Num, Pi, Quantity, WheelSpec
from wmrgen.spec.tables import Table, table_of, wheel_name
from wmrgen.spec.text import Node, Scalar, SequenceNode, quoted, suggestion
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


def read_joints(table: Table, key: str, kind: WheelType, default: tuple[str, ...]) -> tuple[str, ...]:
    """``actuated`` or ``sensed``, in the order spin, steer."""
    if table.get(key) is None:
        return default
    joints = kind.joints
    scalars = table.scalars(key)
    for scalar in scalars:
        if scalar.text not in joints:
            raise scalar.error(
                f"a {kind.name} wheel has no joint {quoted(scalar.text)}",
                f"Its joints are: {' '.join(joints)}." if joints else "It has no joint.",
                suggestion(scalar.text, joints) if joints else f"Write {key}: [] or delete the key.",
            )
    names = [scalar.text for scalar in scalars]
    return tuple(joint for joint in joints if joint in names)


def limits_of_type(kind: WheelType) -> tuple[str, ...]:
    """Names of the limits that a wheel of this type can have."""
    return tuple(f.key for joint in kind.joints for f in LIMITS.fields if f.joint == joint)


def read_limits(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[Limit, ...]:
    """Limits in the order of the file, of those that are ``valid``. A single value v means [-v, v]."""
    if node is None:
        return ()
    table = table_of(node, LIMITS, f"limits of {what}", valid)
    return tuple(_limit(name, table, scope) for name in table.values)


def _limit(name: str, table: Table, scope: Scope) -> Limit:
    node, value, what = table.values[name], LIMITS.field(name).value, f"limit {name}"
    assert isinstance(value, Interval)
    kind = value.kind
    if isinstance(node, SequenceNode):
        if len(node.items) != 2:
            raise node.error(
                f"{what} has {len(node.items)} values",
                "A range has two.",
                f"Write {name}: [low, high], or one value.",
            )
        low, high = (read_quantity(item, kind, what, scope) for item in node.items)
    else:
        high = read_quantity(node, kind, what, scope)
        low = replace(high, expr=Neg(high.expr), text=f"-({high.text})")
    if _sign_of_difference(low, high) < 0:
        raise node.error(
            f"{what} runs from {low.text} to {high.text}", "The lower end is above the upper end.",
            f"Write {name}: [low, high]; one positive value v means [-v, v].",
        )  # fmt: skip
    return Limit(name, low, high)


def _sign_of_difference(low: Quantity, high: Quantity) -> int:
    """-1 when both are plain numbers and high < low, else 0: anything else is left to the layout."""
    ends = []
    for quantity in (low, high):
        match quantity.expr:
            case Num(value) | Binary("*", Num(value), Pi()):
                ends.append(value)
            case Neg(Num(value)) | Neg(Binary("*", Num(value), Pi())):
                ends.append(-value)
    if len(ends) < 2 or ("pi" in _form(low)) != ("pi" in _form(high)):
        return 0
    return -1 if ends[1] < ends[0] else 0


def _form(quantity: Quantity) -> str:
    expr = quantity.expr.arg if isinstance(quantity.expr, Neg) else quantity.expr
    return "pi" if isinstance(expr, Binary) else ""


def read_couplings(robot: Table, wheels: Iterable[WheelSpec]) -> tuple[Coupling, ...]:
    """Sets of joints that move alike: each names one joint of at least two wheels."""
    types = {wheel.name: wheel.type for wheel in wheels}
    couplings: dict[tuple[str, frozenset[str]], Coupling] = {}
    for item in robot.items("couplings"):
        table = table_of(item, COUPLING)
        coupling = _coupling(table, types)
        key = coupling.joint, frozenset(coupling.wheels)
        if key in couplings:
            line = couplings[key].mark.line
            raise table.node.error(f"this coupling stands on line {line} already", "", "Delete one of them.")
        couplings[key] = coupling
    return tuple(couplings.values())


def _coupling(table: Table, types: dict[str, str]) -> Coupling:
    table.require_all("a coupling")
    joint, names = "", list[str]()
    for scalar in table.scalars("equal"):
        name, this = _joint(scalar, types)
        if joint and this != joint:
            raise scalar.error(
                f"{quoted(scalar.text)} is not a {joint} joint like the first",
                "A coupling makes angles of one kind equal.",
                f"Write {name}.{joint}, or a coupling of its own.",
            )
        joint = this
        names.append(name)
    return Coupling(joint, tuple(names), table.mark)


def _joint(scalar: Scalar, types: dict[str, str]) -> tuple[str, str]:
    name, dot, joint = scalar.text.strip().partition(".")
    if not dot:
        raise scalar.error(f"{quoted(scalar.text)} is not a joint", "", "Write wheel.steer or wheel.spin.")
    if name not in types:
        raise scalar.error(f"there is no wheel {quoted(name)}", "", suggestion(name, types))
    joints = WHEEL_TYPES[types[name]].joints
    if joint not in joints:
        what = f"the {types[name]} wheel {name} has no joint {quoted(joint)}"
        if joint == "steer_rate":
            raise scalar.error(what, "Coupled angles have coupled rates.", f"Write {name}.steer.")
        why = f"Its joints are: {' '.join(joints)}." if joints else "It has no joint."
        raise scalar.error(what, why, suggestion(joint, joints) if joints else "Delete it from the coupling.")
    return name, joint
