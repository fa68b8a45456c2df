"""``<robot>.hpp``: the C functions for C++17, in a namespace, by reference; it copies nothing. And the control loop of
a robot in C++, for its examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from wmrgen.errors import NotDerivableError
from wmrgen.interface import Argument, arguments, members
from wmrgen.ir.nodes import Function, Module, Role
from wmrgen.loop import Stage
from wmrgen.loop import loop as stages_of
from wmrgen.ports import GYRO
from wmrgen.render import render

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

# One variable has the wheels, measured, then commanded: what would compare the two has no place in this loop.
_COMPARE = ("compensate_steering", "steer_toward")
_ONE = {"commands": "wheels"}


class Call(NamedTuple):
    """A call of a function of the robot: its words, and the variables that it takes with their types."""

    function: str
    words: tuple[str, ...]
    variables: Mapping[str, str]

    def text(self, ending: str = "") -> str:
        """The call, of the function whose name has this ``ending``."""
        return f"{self.function}{ending}({', '.join(self.words)})"


class Loop(NamedTuple):
    """``prepare`` once, then ``sense`` and ``act`` in every step. ``covariance``: the pose has one."""

    prepare: tuple[Call, ...]
    sense: tuple[Call, ...]
    act: tuple[Call, ...]
    covariance: bool

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
            variable = _ONE.get(variable, variable)
            words.append(f"{'' if argument.by_value else '&'}{variable}")
            if not argument.by_value or variable == GYRO.name:
                variables[variable] = f"{module.name}_{argument.kind}" if argument.kind else scalar
        return Call(f"{module.name}_{name}", tuple(words), variables)

    def calls(stages: Sequence[Stage]) -> tuple[Call, ...]:
        return tuple(
            call(stage.function, passed(module, functions[stage.function]), stage.variables)
            for stage in stages
        )

    stages = stages_of(module, functions.keys() - set(_COMPARE), covariances)
    return Loop(
        tuple(call(name, arguments, {}) for name, arguments in preparing(module).items()),
        calls(stages.senses),
        calls(stages.acts),
        any(stage.function == "odometry_covariance" for stage in stages.senses),
    )
