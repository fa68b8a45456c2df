"""The arguments of a robot's functions, for every language that has structs.

All functions of a robot share these types:

    pose              x y theta                       twist              vx vy omega
    pose_covariance   xx xy xtheta yy ytheta thetatheta
    twist_covariance  vxvx vxvy vxomega vyvy vyomega omegaomega
    wheels            <wheel>.spin, .steer, .steer_rate of the joints that are commanded or sensed

A port belongs to a type if the type has a member of that name and unit. A name with a suffix of `SUFFIXES`
(``vx_wanted``, ``left.steer_wanted``) is a member of another variable of the type. Each other port is a scalar
argument. If there are more than `MOST_SCALARS` such ports, or if one of them belongs to a wheel, they form a struct
that only this function has.

A variable that a function reads and writes is one argument, which is changed in place: always for poses and their
covariances, and for twists and wheels if `Function.in_place` says so. All other inputs and outputs are separate
arguments, for which a caller may still pass the same variable.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from wmrgen.geometry.ports import JOINTS, POSE, POSE_COVARIANCE, TIMES, TWIST, TWIST_COVARIANCE, Port
from wmrgen.ir.nodes import Function, Module, Role, contract

SUFFIXES = (*TIMES, "rest", "step")
MOST_SCALARS = 4  # arguments: a call with more of them in a row is easy to get wrong
WHEELS = "wheels"
IN, OUT = "in", "out"  # structs that only one function has: its inputs, its outputs
PARAMS, PREPARED = "params", "prepared"  # the tunable parameters, and the results of `prepare`


TYPES = {
    "pose": POSE,
    "pose_covariance": POSE_COVARIANCE,
    "twist": TWIST,
    "twist_covariance": TWIST_COVARIANCE,
}
_ALWAYS_IN_PLACE = ("pose", "pose_covariance")


class Argument(NamedTuple):
    """An argument of a function."""

    name: str
    kind: str  # a shared type, IN, OUT, PARAMS or PREPARED; "" for a scalar
    reads: Mapping[str, str]  # contract name of a port -> contract name of the member, without a suffix
    writes: Mapping[str, str]  # the same for outputs

    @property
    def by_value(self) -> bool:
        """Whether it is a scalar input."""
        return not self.kind and not self.writes


class Signature(NamedTuple):
    """A function with its arguments, in the order in which they are declared."""

    function: Function
    arguments: tuple[Argument, ...]
    # Kind -> members of the structs that are declared for this function.
    own_types: Mapping[str, tuple[Port, ...]]


class _Place(NamedTuple):
    kind: str
    suffix: str
    member: str


def members(module: Module) -> dict[str, tuple[Port, ...]]:
    """Return the shared types that functions of ``module`` use, with their members; none if it has no robot."""
    if module.joints is None:
        return {}
    ports = (port for f in module.functions for port in (*contract(f), *f.outputs))
    places = [_place(port, module.joints) for port in ports]
    used = {place.kind for place in places if place}
    types = {**TYPES, WHEELS: tuple(_joint(name) for name in module.joints)}
    return {name: own for name, own in types.items() if name in used or (name == WHEELS and own)}


def signatures(module: Module) -> tuple[Signature, ...]:
    """Return the signatures of `prepare`, if it has outputs, and of every function that has outputs."""
    found = []
    if module.prepare is not None and module.prepare.outputs:
        found.append(_signature_of_prepare(module.prepare))
    for function in module.functions:
        if function.outputs:
            found.append(_signature(function, module.joints))
    return tuple(found)


def _signature_of_prepare(prepare: Function) -> Signature:
    reads = {port.name: port.name for port in prepare.inputs}
    writes = {port.name: port.name for port in prepare.outputs}
    prepared = Argument(PREPARED, PREPARED, {}, writes)
    if not reads:
        return Signature(prepare, (prepared,), {PREPARED: prepare.outputs})
    params = Argument(PARAMS, PARAMS, reads, {})
    return Signature(prepare, (params, prepared), {PARAMS: prepare.inputs, PREPARED: prepare.outputs})


def _signature(function: Function, joints: Sequence[str] | None) -> Signature:
    passed = arguments(function, joints)
    own_types = {}
    for argument in passed:
        if argument.kind in (IN, OUT):
            ports = function.inputs if argument.kind == IN else function.outputs
            names = argument.reads if argument.kind == IN else argument.writes
            own_types[argument.kind] = tuple(port for port in ports if port.name in names)
    prepared = {port.name: port.name for port in function.inputs if port.role is Role.PREPARED}
    if prepared:
        passed = (Argument(PREPARED, PREPARED, prepared, {}), *passed)
    return Signature(function, passed, own_types)


def _joint(name: str) -> Port:
    return replace(JOINTS[name.rpartition(".")[2]], name=name)


def _place(port: Port, joints: Sequence[str]) -> _Place | None:
    """Return the member of a shared type that ``port`` is; None if there is no member of its name and unit."""
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
    """Return the arguments of ``function``, without what it reads of `prepare`.

    Args:
        function: A function of a robot. joints: Contract names of the members of the type `WHEELS`. None if the
        function belongs to no robot: it then has
            one struct of inputs and one of outputs.

    Returns:
        The arguments in this order: variables that are changed in place, inputs of shared types, scalar inputs,
        outputs.
    """
    inputs, outputs = contract(function), function.outputs
    if joints is None:
        return _own(inputs, IN, 0, set()) + _own(outputs, OUT, 0, set())
    reads, other_inputs = _by_variable(inputs, joints)
    writes, other_outputs = _by_variable(outputs, joints)
    names: set[str] = set()
    both = {
        (kind, suffix)
        for kind, suffix in reads.keys() & writes.keys()
        if kind in _ALWAYS_IN_PLACE or (function.in_place and not suffix)
    }
    changed = []
    for key in _in_order(both):
        kind, suffix = key
        changed.append(Argument(_unique(suffix or kind, kind, names), kind, reads[key], writes[key]))
    commands = (WHEELS, "") in writes.keys() - both
    read = []
    for key in _in_order(reads.keys() - both):
        kind, suffix = key
        name = _unique(_input_name(kind, suffix, commands), kind, names)
        read.append(Argument(name, kind, reads[key], {}))
    scalars = _own(other_inputs, IN, MOST_SCALARS, names)
    written = []
    for key in _in_order(writes.keys() - both):
        kind, suffix = key
        name = _unique(_output_name(kind, suffix, key in reads), kind, names)
        written.append(Argument(name, kind, {}, writes[key]))
    return (*changed, *read, *scalars, *written, *_own(other_outputs, OUT, MOST_SCALARS, names))


_Key = tuple[str, str]  # kind, suffix


def _by_variable(
    ports: Iterable[Port], joints: Sequence[str]
) -> tuple[dict[_Key, dict[str, str]], list[Port]]:
    """Return the ports of each variable of a shared type, with the members that they are, and the other ports."""
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
    """Return the name of an input. Present wheels are called ``now`` if the function also commands wheels."""
    return suffix or ("now" if kind == WHEELS and commands else kind)


def _output_name(kind: str, suffix: str, read: bool) -> str:
    return suffix or (OUT if kind == WHEELS or read else kind)


def _unique(name: str, kind: str, names: set[str]) -> str:
    """Add ``name`` to ``names`` and return it; if it is taken, append the type."""
    if name in names:
        name = f"{name}_{kind}"
    names.add(name)
    return name


def _own(ports: Sequence[Port], kind: str, most: int, names: set[str]) -> tuple[Argument, ...]:
    """Return ``ports`` as scalar arguments, or as one struct if there are more than ``most`` or one is a wheel's."""
    if not ports:
        return ()
    if len(ports) <= most and not any("." in port.name or port.name in names for port in ports):
        return tuple(_scalar(port.name, kind) for port in ports)
    own = {port.name: port.name for port in ports}
    name = kind if kind not in names else f"more_{kind}"
    names.add(name)
    return (Argument(name, kind, own, {}) if kind == IN else Argument(name, kind, {}, own),)


def _scalar(name: str, kind: str) -> Argument:
    own = {name: name}
    return Argument(name, "", own, {}) if kind == IN else Argument(name, "", {}, own)
