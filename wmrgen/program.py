"""The program of a robot: every function of its model in symbols, ready to be lowered."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import Kind, declaration
from wmrgen.functions.registry import standard as standard_functions
from wmrgen.kinematics.records import Formula
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


@dataclass(frozen=True, slots=True)
class Program:
    """The formulas of a robot, in the order in which they are emitted."""

    name: str
    formulas: tuple[Formula, ...]

    def formula(self, name: str) -> Formula:
        """The formula called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.formulas}[name]

    def in_c(self, asked: Collection[str]) -> tuple[str, ...]:
        """The functions that C has: those that firmware runs and those ``asked`` for."""
        names = (f.name for f in self.formulas)
        return tuple(n for n in names if n in asked or declaration(n).kind is Kind.FIRMWARE)


def formula(robot: Robot, mobility: Mobility, name: str) -> Formula:
    """One function. RobotFileError for an unknown name, NotDerivableError where the robot does not have it."""
    declared = declaration(name)
    built = replace(declared.build(robot, mobility), source=declared.source, limits=declared.limits)
    _refuse_shared_names(robot, built)
    return built


def _refuse_shared_names(robot: Robot, built: Formula) -> None:
    """NotDerivableError where a tunable parameter has the name of another input: one value would stand for both."""
    names = [p.name.replace(".", "_") for p in built.inputs]
    shared = [p.name for p in robot.tunable if names.count(p.name) > 1]
    if shared:
        raise NotDerivableError(
            f"{robot.name} cannot have the function {built.name}: {shared[0]} is an input of it and a "
            "tunable parameter.\n"
            f"  Give the parameter another name, such as {shared[0]}_0, or delete its tunable: true."
        )


def program(robot: Robot, mobility: Mobility, names: Iterable[str]) -> Program:
    """The named functions of a robot."""
    return Program(robot.name, tuple(formula(robot, mobility, name) for name in names))


def standard(robot: Robot) -> tuple[str, ...]:
    """The functions generated for a robot: the standard ones that it has, then those it asks for."""
    has = [d.name for d in standard_functions() if d.exists(robot)]
    return (*has, *(name for name in asked(robot) if name not in has))


def asked(robot: Robot) -> tuple[str, ...]:
    """The functions beyond the standard ones that a robot file asks for; `slip: true` asks for slip_inverse."""
    slip = ("slip_inverse",) if robot.slip and "slip_inverse" not in robot.functions else ()
    return (*robot.functions, *slip)
