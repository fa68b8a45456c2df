"""A control loop of the functions that a robot has: from measured wheels to the pose, and from a twist to commands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from wmrgen.backends.packages.cpp import passed, preparing
from wmrgen.errors import NotDerivableError
from wmrgen.interface import Argument
from wmrgen.ir.nodes import Module
from wmrgen.loop import Stage
from wmrgen.loop import loop as stages_of

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
    """``prepare`` once, then ``sense`` and ``act`` in every step. ``command``: of the twist that is driven;
    ``covariance``: the pose has one."""

    prepare: tuple[Call, ...]
    sense: tuple[Call, ...]
    act: tuple[Call, ...]
    command: str
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
            if not argument.by_value:
                variables[variable] = f"{module.name}_{argument.kind}" if argument.kind else scalar
        return Call(f"{module.name}_{name}", tuple(words), variables)

    def calls(stages: Sequence[Stage]) -> tuple[Call, ...]:
        return tuple(
            call(stage.function, passed(module, functions[stage.function]), stage.variables)
            for stage in stages
        )

    stages = stages_of(module, functions.keys() - set(_COMPARE), covariances)
    called = {stage.function for stage in (*stages.senses, *stages.acts)}
    return Loop(
        tuple(call(name, arguments, {}) for name, arguments in preparing(module).items()),
        calls(stages.senses),
        calls(stages.acts),
        "driven" if "limit_acceleration" in called else "wanted",
        "odometry_covariance" in called,
    )
