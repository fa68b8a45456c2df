"""``<robot>.hpp``: the C functions for C++17, in a namespace, by reference; it copies nothing. And the control loop of
a robot in C++, for its examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from wmrgen.codegen.loop import Loop as Stages
from wmrgen.codegen.loop import Stage, only_read
from wmrgen.codegen.loop import loop as stages_of
from wmrgen.codegen.render import render
from wmrgen.codegen.signature import Argument, arguments, members
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.ports import GYRO
from wmrgen.ir.nodes import Function, Module, Role

_PREPARED = Argument("prepared", "prepared", {}, {})
_PARAMS = Argument("params", "params", {}, {})
_FILLED = {"x": "x"}  # of an argument that a function fills, whatever with


def header(module: Module, scalar: str) -> str:
    """The text of the header."""
    shared = members(module)
    prepare = module.prepare
    kinds = [*shared, *(["prepared"] if prepare else []), *(["params"] if prepare and prepare.inputs else [])]
    return render(
        "package/robot.hpp.j2",
        robot=module.name,
        upper=module.name.upper(),
        scalar=scalar,
        types=[(_name(kind), f"{module.name}_{kind}") for kind in kinds],
        views=[
            (_name(kind), len(ports), ", ".join(f"&of.{port.name}" for port in ports))
            for kind, ports in shared.items()
        ],
        functions=[
            line for name, own in _functions(module).items() for line in _wrapped(module.name, name, own)
        ],
    )


def passed(module: Module, function: Function) -> tuple[Argument, ...]:
    """The arguments of a function of ``module``, what `prepare` gives among them."""
    reads = any(port.role is Role.PREPARED for port in function.inputs)
    return (*([_PREPARED] if reads else []), *arguments(function, module.joints))


def preparing(module: Module) -> dict[str, tuple[Argument, ...]]:
    """Name -> arguments of what is called before functions that read what `prepare` gives."""
    if not module.prepare:
        return {}
    params, prepared = (argument._replace(writes=_FILLED) for argument in (_PARAMS, _PREPARED))
    if not module.prepare.inputs:
        return {"prepare": (prepared,)}
    return {"params_default": (params,), "prepare": (_PARAMS, prepared)}


def _functions(module: Module) -> dict[str, tuple[Argument, ...]]:
    """Name -> arguments of every C function."""
    steps = {function.name: passed(module, function) for function in module.functions if function.outputs}
    return preparing(module) | steps


def _name(kind: str) -> str:
    """``PoseCovariance`` of ``pose_covariance``."""
    return "".join(word.capitalize() for word in kind.split("_"))


def _wrapped(robot: str, name: str, own: tuple[Argument, ...]) -> Iterator[str]:
    declared = ", ".join(_declared(robot, name, argument) for argument in own)
    words = ", ".join(f"{'' if argument.by_value else '&'}{argument.name}" for argument in own)
    yield from (f"inline void {name}({declared}) noexcept", "{", f"    ::{robot}_{name}({words});", "}")
    if any(argument.reads or argument is _PARAMS for argument in own):
        head = f"[[nodiscard]] inline Status {name}_checked({declared}) noexcept"
        yield from (head, "{", f"    return ::{robot}_{name}_checked({words});", "}")


def _declared(robot: str, function: str, argument: Argument) -> str:
    if not argument.kind:
        return f"Scalar &{argument.name}" if argument.writes else f"Scalar {argument.name}"
    kind = f"{robot}_{function}_{argument.kind}" if argument.kind in ("in", "out") else _name(argument.kind)
    return f"{'' if argument.writes else 'const '}{kind} &{argument.name}"


# ---- a control loop of the functions that a robot has: from measured wheels to the pose, and from a twist to commands


class Call(NamedTuple):
    """A call of a function of the robot: its words, and the variables that it takes with their types."""

    function: str
    words: tuple[str, ...]
    variables: Mapping[str, str]

    def text(self, ending: str = "") -> str:
        """The call, of the function whose name has this ``ending``."""
        return f"{self.function}{ending}({', '.join(self.words)})"


class Loop(NamedTuple):
    """``prepare`` once, then ``sense`` and ``act`` in every step. ``covariance``: the pose has one.

    ``keep``: statements before ``act``. ``swivel``: statements that turn castors as they are commanded. ``measured``:
    the joints that must be measured. ``twist``: the variable whose twist is commanded.
    """

    prepare: tuple[Call, ...]
    sense: tuple[Call, ...]
    act: tuple[Call, ...]
    covariance: bool
    keep: tuple[str, ...]
    swivel: tuple[str, ...]
    measured: frozenset[str]
    twist: str

    @property
    def variables(self) -> dict[str, str]:
        """Name -> type, in the order of use."""
        calls = (*self.prepare, *self.sense, *self.act)
        return {name: kind for call in calls for name, kind in call.variables.items()}


def loop(module: Module, scalar: str, covariances: bool = True) -> Loop:
    """The loop of ``module``, with ``covariances`` where it has them. NotDerivableError where it neither drives nor
    senses wheels."""
    functions = {function.name: function for function in module.functions if function.outputs}
    if not {"forward", "inverse"} <= functions.keys():
        raise NotDerivableError(
            f"{module.name} has no loop to write: it neither drives nor senses wheels. Its functions are in the other "
            "packages, cmake for one."
        )

    def call(name: str, arguments: Sequence[Argument], called: Mapping[str, str]) -> Call:
        words, variables = [], {}
        for argument in arguments:
            variable = called.get(argument.name, argument.name)
            words.append(f"{'' if argument.by_value else '&'}{variable}")
            if not argument.by_value or variable == GYRO.name:
                variables[variable] = f"{module.name}_{argument.kind}" if argument.kind else scalar
        return Call(f"{module.name}_{name}", tuple(words), variables)

    def calls(stages: Sequence[Stage]) -> tuple[Call, ...]:
        return tuple(
            call(stage.function, passed(module, functions[stage.function]), stage.variables)
            for stage in stages
        )

    stages = stages_of(module, functions, covariances)
    acts, read = calls(stages.acts), only_read(module)
    kept = [f"commands.{member} = wheels.{member};" for member in read]
    if any("before" in stage.variables.values() for stage in stages.acts):
        kept.insert(0, "before = commands;")
    return Loop(
        tuple(call(name, arguments, {}) for name, arguments in preparing(module).items()),
        calls(stages.senses),
        acts,
        any(stage.function == "odometry_covariance" for stage in stages.senses),
        tuple(kept),
        tuple(
            f"wheels.{member} += dt * commands.{member}_rate;"
            for member in read
            if f"{member}_rate" in (module.joints or ())
        ),
        frozenset((*read, *_measured(module, stages))),
        next(stage.variables["twist"] for stage in stages.acts if stage.function == "inverse"),
    )


def _measured(module: Module, stages: Stages) -> Iterator[str]:
    """The joints that functions of the loop read of ``wheels``."""
    for stage in (*stages.senses, *stages.acts):
        for argument in arguments(module.function(stage.function), module.joints):
            if stage.variables.get(argument.name, argument.name) == "wheels":
                yield from argument.reads.values()
