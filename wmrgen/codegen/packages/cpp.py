"""``<robot>.hpp``: the C functions for C++17, in a namespace and with references; and a control loop for examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from wmrgen.codegen.loop import Loop as Stages
from wmrgen.codegen.loop import Stage, only_read
from wmrgen.codegen.loop import loop as stages_of
from wmrgen.codegen.render import render
from wmrgen.codegen.signature import IN, OUT, PARAMS, PREPARED, Argument, arguments, members, signatures
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.ports import GYRO
from wmrgen.ir.nodes import Module


def header(module: Module, scalar: str) -> str:
    """Return the text of the header; ``scalar``: ``float`` or ``double``."""
    shared, functions = members(module), _arguments(module)
    kinds = list(shared)
    for kind in (PREPARED, PARAMS):
        if any(argument.kind == kind for own in functions.values() for argument in own):
            kinds.append(kind)
    views = []
    for kind, ports in shared.items():
        views.append((_name(kind), len(ports), ", ".join(f"&of.{port.name}" for port in ports)))
    lines: list[str] = []
    for name, own in functions.items():
        lines += _wrapper(module.name, name, own)
    return render(
        "package/robot.hpp.j2",
        robot=module.name,
        upper=module.name.upper(),
        scalar=scalar,
        types=[(_name(kind), f"{module.name}_{kind}") for kind in kinds],
        views=views,
        functions=lines,
    )


def _arguments(module: Module) -> dict[str, tuple[Argument, ...]]:
    """Return the arguments of every C function by name."""
    found: dict[str, tuple[Argument, ...]] = {}
    for signature in signatures(module):
        for argument in signature.arguments:
            if argument.kind == PARAMS:
                found["params_default"] = (Argument(PARAMS, PARAMS, {}, argument.reads),)
        found[signature.function.name] = signature.arguments
    return found


def _name(kind: str) -> str:
    """Return ``PoseCovariance`` for ``pose_covariance``."""
    return "".join(word.capitalize() for word in kind.split("_"))


def _wrapper(robot: str, name: str, own: tuple[Argument, ...]) -> Iterator[str]:
    """Yield the lines of the C++ function ``name`` and, if it has inputs, of its checked variant."""
    declared = ", ".join(_declared(robot, name, argument) for argument in own)
    words = ", ".join(f"{'' if argument.by_value else '&'}{argument.name}" for argument in own)
    yield from (f"inline void {name}({declared}) noexcept", "{", f"    ::{robot}_{name}({words});", "}")
    if any(argument.reads and argument.kind != PREPARED for argument in own):
        head = f"[[nodiscard]] inline Status {name}_checked({declared}) noexcept"
        yield from (head, "{", f"    return ::{robot}_{name}_checked({words});", "}")


def _declared(robot: str, function: str, argument: Argument) -> str:
    if not argument.kind:
        return f"Scalar &{argument.name}" if argument.writes else f"Scalar {argument.name}"
    kind = f"{robot}_{function}_{argument.kind}" if argument.kind in (IN, OUT) else _name(argument.kind)
    return f"{'' if argument.writes else 'const '}{kind} &{argument.name}"


# ---- a control loop with the functions of the robot: from measured wheels to the pose, and from a twist to commands


class Call(NamedTuple):
    """A call of a function of the robot."""

    function: str  # name in C
    words: tuple[str, ...]  # arguments as written
    variables: Mapping[str, str]  # variables that it takes, with their types

    def text(self, ending: str = "") -> str:
        """Return the call; ``ending`` is appended to the name of the function."""
        return f"{self.function}{ending}({', '.join(self.words)})"


class Loop(NamedTuple):
    """A control loop: ``prepare`` is called once, then ``sense`` and ``act`` in every step."""

    prepare: tuple[Call, ...]
    sense: tuple[Call, ...]
    act: tuple[Call, ...]
    covariance: bool  # whether the pose has a covariance
    keep: tuple[str, ...]  # statements before ``act``
    swivel: tuple[str, ...]  # statements that turn castors by their commanded rates
    measured: frozenset[str]  # joints that must be measured
    twist: str  # variable of the twist that `inverse` commands

    @property
    def variables(self) -> dict[str, str]:
        """Name -> type, in the order of use."""
        calls = (*self.prepare, *self.sense, *self.act)
        return {name: kind for call in calls for name, kind in call.variables.items()}


def call(module: Module, scalar: str, name: str, renamed: Mapping[str, str]) -> Call:
    """Return a call of a function.

    Args:
        module: The functions of the robot.
        scalar: ``float`` or ``double``.
        name: The function.
        renamed: Argument -> variable, where they have different names.
    """
    words, variables = [], {}
    for argument in _arguments(module)[name]:
        variable = renamed.get(argument.name, argument.name)
        words.append(f"{'' if argument.by_value else '&'}{variable}")
        if not argument.by_value or variable == GYRO.name:
            variables[variable] = f"{module.name}_{argument.kind}" if argument.kind else scalar
    return Call(f"{module.name}_{name}", tuple(words), variables)


_PREPARING = ("params_default", "prepare")


def loop(module: Module, scalar: str, covariances: bool = True) -> Loop:
    """Return the control loop of a robot.

    Args:
        module: The functions of the robot.
        scalar: ``float`` or ``double``.
        covariances: Whether the loop computes covariances, if the robot has them.

    Raises:
        NotDerivableError: The robot neither drives nor senses wheels.
    """
    functions = _arguments(module)
    if not {"forward", "inverse"} <= functions.keys():
        raise NotDerivableError(
            f"{module.name} has no loop to write, because it neither drives nor senses wheels. Use another package, "
            "for example cmake."
        )

    def calls(stages: Sequence[Stage]) -> tuple[Call, ...]:
        return tuple(call(module, scalar, stage.function, stage.variables) for stage in stages)

    stages, read = stages_of(module, functions.keys() - set(_PREPARING), covariances), only_read(module)
    kept = [f"commands.{member} = wheels.{member};" for member in read]
    if any("before" in stage.variables.values() for stage in stages.acts):
        kept.insert(0, "before = commands;")
    swivel = []
    for member in read:
        if f"{member}_rate" in (module.joints or ()):
            swivel.append(f"wheels.{member} += dt * commands.{member}_rate;")
    return Loop(
        prepare=tuple(call(module, scalar, name, {}) for name in _PREPARING if name in functions),
        sense=calls(stages.senses),
        act=calls(stages.acts),
        covariance=any(stage.function == "odometry_covariance" for stage in stages.senses),
        keep=tuple(kept),
        swivel=tuple(swivel),
        measured=frozenset((*read, *_measured(module, stages))),
        twist=next(stage.variables["twist"] for stage in stages.acts if stage.function == "inverse"),
    )


def _measured(module: Module, stages: Stages) -> Iterator[str]:
    """Yield the joints of ``wheels`` that functions of the loop read."""
    for stage in (*stages.senses, *stages.acts):
        for argument in arguments(module.function(stage.function), module.joints):
            if stage.variables.get(argument.name, argument.name) == "wheels":
                yield from argument.reads.values()
