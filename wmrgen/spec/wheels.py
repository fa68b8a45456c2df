"""Wheels and their joints: which are driven, measured, limited or coupled."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from wmrgen.errors import RobotFileError
from wmrgen.spec.expressions import read_quantity, scalar_of
from wmrgen.spec.fields import Amount, Interval, Section
from wmrgen.spec.joint_keys import ENCODER, LIMITS, NOISE
from wmrgen.spec.keys import COUPLING, WHEEL
from wmrgen.spec.numbers import Scope
from wmrgen.spec.records import Coupling, EncoderSpec, Limit, Neg, NoiseSpec, WheelSpec
from wmrgen.spec.tables import Table, table_of, wheel_name
from wmrgen.spec.text import Node, Scalar, SequenceNode, quoted, suggestion
from wmrgen.wheels import WHEEL_TYPES, WheelType

_PLACEMENT, _ORIENTATION = WHEEL.choices
_QUANTITIES = tuple(f.key for f in WHEEL.fields if isinstance(f.value, Amount))


def read_wheels(robot: Table, scope: Scope) -> tuple[WheelSpec, ...]:
    """The list of wheels, names distinct."""
    wheels: dict[str, WheelSpec] = {}
    for item in robot.items("wheels"):
        table = table_of(item, WHEEL)
        wheel = _wheel(table, scope)
        if wheel.name in wheels:
            raise table.keys["name"].error(
                f"a second wheel has the name {quoted(wheel.name)}",
                f"The first stands on line {wheels[wheel.name].mark.line}; joints bear their wheel's name.",
                "Give each wheel a name of its own.",
            )
        wheels[wheel.name] = wheel
    return tuple(wheels.values())


def _wheel(table: Table, scope: Scope) -> WheelSpec:
    name = wheel_name(scalar_of(table.require("name", "the wheel"), "name"))
    kind = _type(table, name)
    what = f"the {kind.name} wheel {name}"
    if unknown := {*kind.keys, *kind.required} - {f.key for f in WHEEL.fields}:
        raise ValueError(f"the wheel type {kind.name} has the key {min(unknown)}, which no wheel has")
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
        **quantities,
        actuated=actuated,
        sensed=read_joints(table, "sensed", kind, actuated),
        limits=read_limits(table.get("limits"), what, scope, keys_of_type(LIMITS, kind)),
        noise=read_noise(table.get("noise"), what, scope, keys_of_type(NOISE, kind)),
        encoders=read_encoders(table.get("encoder"), what, scope, keys_of_type(ENCODER, kind)),
    )


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
    return WHEEL.field(key).misfit is None or kind.takes(key)


def _refuse_misfits(table: Table, what: str, kind: WheelType) -> None:
    for key, node in table.keys.items():
        reason = WHEEL.field(key).misfit
        if reason and not kind.takes(key):
            raise node.error(f"{what} has the key {key}", *kind.misfits.get(key, reason))


def read_joints(table: Table, key: str, kind: WheelType, default: tuple[str, ...]) -> tuple[str, ...]:
    """``actuated`` or ``sensed``, in the order spin, steer."""
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
    """The error for a joint that wheels of this type lack; ``without``: what to write where they have none."""
    if not kind.joints:
        return scalar.error(what, "It has no joint.", without)
    return scalar.error(what, f"Its joints are: {' '.join(kind.joints)}.", suggestion(joint, kind.joints))


def keys_of_type(section: Section, kind: WheelType) -> tuple[str, ...]:
    """The keys of ``section`` that are about joints of a wheel of this type."""
    return tuple(f.key for joint in kind.joints for f in section.fields if f.joint == joint)


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
    if isinstance(node, SequenceNode):
        if len(node.items) != 2:
            raise node.error(
                f"{what} has {len(node.items)} values",
                "A range has two.",
                f"Write {name}: [low, high], or one value.",
            )
        low, high = (read_quantity(item, value.kind, what, scope) for item in node.items)
    else:
        high = read_quantity(node, value.kind, what, scope)
        low = replace(high, expr=Neg(high.expr), text=f"-({high.text})")
    return Limit(name, low, high, node.mark)


def read_noise(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[NoiseSpec, ...]:
    """The noise of joints, of those that are ``valid``."""
    if node is None:
        return ()
    noise = []
    for joint, of in _by_joint(node, NOISE, "noise", what, valid):
        name = f"the noise of {joint}"
        noise.append(
            NoiseSpec(joint, of.amount("proportional", name, scope), of.amount("constant", name, scope))
        )
    return tuple(noise)


def read_encoders(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[EncoderSpec, ...]:
    """The encoders of joints, of those that are ``valid``."""
    if node is None:
        return ()
    encoders = []
    for joint, of in _by_joint(node, ENCODER, "encoder", what, valid):
        name = f"the encoder of {joint}"
        of.require_all(name)
        counts = of.required_amount("counts", name, scope)
        gear, bits = (of.amount(key, name, scope) for key in ("gear", "bits"))
        encoders.append(EncoderSpec(joint, counts, gear, of.word("reversed"), bits))
    return tuple(encoders)


def _by_joint(
    node: Node, section: Section, called: str, what: str, valid: tuple[str, ...] | None
) -> Iterator[tuple[str, Table]]:
    """Each joint of a mapping, with the mapping that stands behind it."""
    for joint, value in table_of(node, section, f"{called} of {what}", valid).values.items():
        of = section.field(joint).value
        assert isinstance(of, Section)
        yield joint, table_of(value, of, f"{joint} of the {called} of {what}")


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
    kind = WHEEL_TYPES[types[name]]
    if joint not in kind.joints:
        what = f"the {kind.name} wheel {name} has no joint {quoted(joint)}"
        if joint == "steer_rate":
            raise scalar.error(what, "Coupled angles have coupled rates.", f"Write {name}.steer.")
        raise _no_joint(scalar, what, joint, kind, "Delete it from the coupling.")
    return name, joint
