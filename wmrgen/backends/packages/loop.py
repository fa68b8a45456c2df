"""A control loop of the functions that a robot has: from measured wheels to the pose, and from a twist to commands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from wmrgen.backends.packages.cpp import passed
from wmrgen.errors import NotDerivableError
from wmrgen.ir.nodes import Module

_COVARIANCE = ("forward_covariance", "odometry_covariance")
# What each argument is in the loop, where it is not called so: one variable has the wheels, measured, then commanded.
_SENSE = {"out": "twist"}
_ACT = {"now": "wheels", "out": "wheels"}
_LIMIT = {"limit_twist": {"twist": "wanted"}, "limit_acceleration": {"twist": "command"}}


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function of the robot: its words, and the variables that it takes with their types."""

    function: str
    words: tuple[str, ...]
    variables: Mapping[str, str]

    def text(self, ending: str = "") -> str:
        """The call, of the function whose name has this ``ending``."""
        return f"{self.function}{ending}({', '.join(self.words)})"


@dataclass(frozen=True, slots=True)
class Loop:
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

    def call(name: str, called: Mapping[str, str]) -> Call:
        words, variables = [], {}
        for argument in passed(module, functions[name]):
            variable = called.get(argument.name, argument.name)
            by_value = not argument.kind and not argument.writes
            words.append(variable if by_value else f"&{variable}")
            if not by_value:
                variables[variable] = f"{module.name}_{argument.kind}" if argument.kind else scalar
        return Call(f"{module.name}_{name}", tuple(words), variables)

    covariance = covariances and all(name in functions for name in _COVARIANCE)
    if covariance:
        takes_slip = any(argument.name == "slip" for argument in passed(module, functions[_COVARIANCE[0]]))
        sense = ["forward_slip" if takes_slip else "forward", *_COVARIANCE]
    else:
        sense = ["forward", "odometry_compensated" if "odometry_compensated" in functions else "odometry"]
    limits = [name for name in ("limit_twist", "limit_acceleration") if name in functions]
    command = "command" if "limit_acceleration" in limits else "wanted"
    act = [name for name in ("inverse", "desaturate") if name in functions]
    return Loop(
        _prepare(module),
        tuple(call(name, _SENSE) for name in sense),
        (
            *(call(name, _LIMIT[name]) for name in limits),
            *(call(name, {**_ACT, "twist": command}) for name in act),
        ),
        command,
        covariance,
    )


def _prepare(module: Module) -> tuple[Call, ...]:
    if not module.prepare:
        return ()
    robot = module.name
    types = {name: f"{robot}_{name}" for name in ("params", "prepared")}
    if not module.prepare.inputs:
        return (Call(f"{robot}_prepare", ("&prepared",), {"prepared": types["prepared"]}),)
    return (
        Call(f"{robot}_params_default", ("&params",), {"params": types["params"]}),
        Call(f"{robot}_prepare", ("&params", "&prepared"), types),
    )
