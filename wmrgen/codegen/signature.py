"""How a robot's functions look from outside, in any language with structs: which arguments each has.

A port is found by its contract name in one of the types that all functions of a robot share:

    pose              x y theta                       twist              vx vy omega
    pose_covariance   xx xy xtheta yy ytheta thetatheta
    twist_covariance  vxvx vxvy vxomega vyvy vyomega omegaomega
    wheels            <wheel>.spin, .steer, .steer_rate of the joints that are commanded or sensed

and with one of `SUFFIXES` behind (``vx_wanted``, ``left.steer_wanted``) in another variable of that type. What is in
none of them is a scalar of its own; where there are more than `FEW`, or a wheel's, they are a struct of that function
alone.

A variable that is read and written under the same names is changed in place: pose and covariances always, twist and
wheels where the function is declared so (`Function.in_place`). All others may be one variable, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from wmrgen.geometry.ports import JOINTS, POSE, POSE_COVARIANCE, TIMES, TWIST, TWIST_COVARIANCE, Port
from wmrgen.ir.nodes import Function, Module, contract

SUFFIXES = (*TIMES, "rest", "step")
FEW = 4
WHEELS = "wheels"
IN, OUT = "in", "out"  # the types of what one function alone takes and gives


TYPES = {
    "pose": POSE,
    "pose_covariance": POSE_COVARIANCE,
    "twist": TWIST,
    "twist_covariance": TWIST_COVARIANCE,
}
_ALWAYS_IN_PLACE = ("pose", "pose_covariance")


class Argument(NamedTuple):
    """An argument of a function. ``kind``: a shared type, `IN`, `OUT`, or nothing where it is a scalar.

    ``reads`` and ``writes``: contract name of a port -> the contract name of the member that it is, of a shared type
    without the suffix.
    """

    name: str
    kind: str
    reads: Mapping[str, str]
    writes: Mapping[str, str]

    @property
    def by_value(self) -> bool:
        """It is a scalar that is read."""
        return not self.kind and not self.writes


class _Place(NamedTuple):
    kind: str
    suffix: str
    member: str


def members(module: Module) -> dict[str, tuple[Port, ...]]:
    """The shared types that functions of ``module`` take or give, with their members; none where it is no robot's."""
    if module.joints is None:
        return {}
    ports = (port for f in module.functions for port in (*contract(f), *f.outputs))
    used = {place.kind for place in (_place(port, module.joints) for port in ports) if place}
    types = {**TYPES, WHEELS: tuple(_joint(name) for name in module.joints)}
    return {name: own for name, own in types.items() if name in used or (name == WHEELS and own)}


def _joint(name: str) -> Port:
    return replace(JOINTS[name.rpartition(".")[2]], name=name)


def _place(port: Port, joints: Sequence[str]) -> _Place | None:
    """Where ``port`` is a member of a shared type; its unit must be the member's, too."""
    for suffix in ("", *SUFFIXES):
        name = port.name.removesuffix(f"_{suffix}") if suffix else port.name
        if suffix and name == port.name:
            continue
        for kind, own in TYPES.items():
            if any((name, port.unit) == (member.name, member.unit) for member in own):
                return _Place(kind, suffix, name)
        if name in joints:
            return _Place(WHEELS, suffix, name)
    return None


def arguments(function: Function, joints: Sequence[str] | None) -> tuple[Argument, ...]:
    """The arguments of ``function`` in order: what is changed in place, inputs, scalars, outputs.

    ``joints``: the contract names of those that the type `WHEELS` has; None where the function is no robot's, and has
    all its inputs in one struct, and all its outputs.
    """
    inputs, outputs = contract(function), function.outputs
    if joints is None:
        return _own(inputs, IN, 0, set()) + _own(outputs, OUT, 0, set())
    reads, other_inputs = _sorted(inputs, joints)
    writes, other_outputs = _sorted(outputs, joints)
    names: set[str] = set()
    both = {
        (kind, suffix)
        for kind, suffix in reads.keys() & writes.keys()
        if kind in _ALWAYS_IN_PLACE or (function.in_place and not suffix)
    }
    changed = [
        Argument(_unique(suffix or kind, kind, names), kind, reads[kind, suffix], writes[kind, suffix])
        for kind, suffix in _in_order(both)
    ]
    commands = (WHEELS, "") in writes.keys() - both
    read = [
        Argument(_unique(_input_name(*key, commands), key[0], names), key[0], reads[key], {})
        for key in _in_order(reads.keys() - both)
    ]
    scalars = _own(other_inputs, IN, FEW, names)
    written = [
        Argument(_unique(_output_name(*key, key in reads), key[0], names), key[0], {}, writes[key])
        for key in _in_order(writes.keys() - both)
    ]
    return (*changed, *read, *scalars, *written, *_own(other_outputs, OUT, FEW, names))


_Key = tuple[str, str]  # kind, suffix


def _sorted(ports: Iterable[Port], joints: Sequence[str]) -> tuple[dict[_Key, dict[str, str]], list[Port]]:
    """Variable of a shared type -> its ports and the members that they are; and the ports that are in none."""
    variables: dict[_Key, dict[str, str]] = {}
    others: list[Port] = []
    for port in ports:
        place = _place(port, joints)
        if place is None:
            others.append(port)
        else:
            variables.setdefault((place.kind, place.suffix), {})[port.name] = place.member
    return variables, others


def _in_order(keys: Iterable[_Key]) -> Iterator[_Key]:
    types, suffixes = (*TYPES, WHEELS), ("", *SUFFIXES)
    yield from sorted(keys, key=lambda key: (types.index(key[0]), suffixes.index(key[1])))


def _input_name(kind: str, suffix: str, commands: bool) -> str:
    """Wheels as they stand are ``now`` where the function commands others."""
    return suffix or ("now" if kind == WHEELS and commands else kind)


def _output_name(kind: str, suffix: str, read: bool) -> str:
    return suffix or (OUT if kind == WHEELS or read else kind)


def _unique(name: str, kind: str, names: set[str]) -> str:
    """``name``, with the type where an argument is called so already."""
    if name in names:
        name = f"{name}_{kind}"
    names.add(name)
    return name


def _own(ports: Sequence[Port], kind: str, few: int, names: set[str]) -> tuple[Argument, ...]:
    """Up to ``few`` scalars that are no wheel's, or one struct."""
    if not ports:
        return ()
    if len(ports) <= few and not any("." in port.name or port.name in names for port in ports):
        return tuple(_scalar(port.name, kind) for port in ports)
    own = {port.name: port.name for port in ports}
    name = kind if kind not in names else f"more_{kind}"
    names.add(name)
    return (Argument(name, kind, own, {}) if kind == IN else Argument(name, kind, {}, own),)


def _scalar(name: str, kind: str) -> Argument:
    own = {name: name}
    return Argument(name, "", own, {}) if kind == IN else Argument(name, "", {}, own)
