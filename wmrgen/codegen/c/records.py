"""What C functions look like: their parameters, ready to print, and the calls that others make of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from wmrgen.codegen.c.text import Struct, prototype
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Op

PREPARING = ("params_default", "prepare")


class Parameter(NamedTuple):
    """A parameter of a C function. ``type``: of what is passed or pointed to.

    ``reads`` and ``writes``: contract name -> member path, empty of a scalar.
    """

    name: str
    type: str
    reads: Mapping[str, str]
    writes: Mapping[str, str]

    @property
    def by_value(self) -> bool:
        """It is a scalar that is read."""
        return not self.writes and "" in self.reads.values()

    @property
    def declared(self) -> str:
        """As a prototype has it."""
        if self.by_value:
            return f"{self.type} {self.name}"
        return f"{'' if self.writes else 'const '}{self.type} *{self.name}"

    def within(self, member: str) -> str:
        """A member as the function itself has it."""
        if member:
            return f"{self.name}->{member}"
        return self.name if self.by_value else f"*{self.name}"


def of(variable: str, member: str) -> str:
    """A member of a variable; the variable where it is a scalar."""
    return f"{variable}.{member}" if member else variable


class Step(NamedTuple):
    """A C function, ready to print. ``structs``: those that are declared for it alone. ``small``: what stands in the
    place of its ``lines`` where least flash is asked for."""

    name: str
    structs: tuple[Struct, ...]
    comment: tuple[str, ...]
    lines: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    ops: frozenset[Op] = frozenset()
    small: tuple[str, ...] = ()

    @property
    def declared(self) -> list[str]:
        """The parameters as a prototype declares them."""
        return [p.declared for p in self.parameters] or ["void"]

    @property
    def prototype(self) -> str:
        """Its declaration, without a semicolon."""
        return prototype(f"void {self.name}", self.declared)

    @property
    def variables(self) -> dict[str, str]:
        """Variables that a call takes, called as the parameters, and their types."""
        return {p.name: p.type for p in self.parameters}

    @property
    def inputs(self) -> dict[str, str]:
        """Contract name -> member of a variable, of what a caller gives."""
        parts = (p for p in self.parameters if p.name != "prepared")
        return {name: of(p.name, member) for p in parts for name, member in p.reads.items()}

    @property
    def outputs(self) -> dict[str, str]:
        """Contract name -> member of a variable, of what it gives."""
        return {name: of(p.name, member) for p in self.parameters for name, member in p.writes.items()}

    def call(self, variables: Mapping[str, str] | None = None, ending: str = "") -> str:
        """A call with variables that are called as the parameters, or as ``variables`` says; of the function whose
        name has this ``ending``."""
        called = variables or {}
        passed = (("" if p.by_value else "&") + called.get(p.name, p.name) for p in self.parameters)
        return f"{self.name}{ending}({', '.join(passed)})"


class Kernel(NamedTuple):
    """A static function, ready to print. ``struct``: (type, members) of its results where there are collector."""

    guard: str
    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None


class Unit(NamedTuple):
    """All C functions of a robot, in the order they are printed.

    ``shared``: the types that several functions take; ``joints``: contract names of those of wheels, in order.
    ``rounds``: they rely on the rounding of sums of magic numbers. ``written``: operations of the functions before
    kernels were put in. ``counting``: what takes counters of encoders, and their type, which is of whole numbers.
    """

    robot: str
    choice: Choice
    shared: tuple[Struct, ...]
    joints: tuple[str, ...]
    steps: tuple[Step, ...]
    kernels: tuple[Kernel, ...]
    rounds: bool
    written: frozenset[Op]
    counting: tuple[Struct, Step] | None = None

    @property
    def ops(self) -> frozenset[Op]:
        """The operations that are printed."""
        return frozenset().union(*(step.ops for step in self.steps), *(kernel.ops for kernel in self.kernels))

    @property
    def every(self) -> tuple[Step, ...]:
        """All functions that are printed."""
        return (*self.steps, *(() if self.counting is None else self.counting[1:]))

    @property
    def structs(self) -> dict[str, Struct]:
        """Every type that is declared, by name."""
        own = (struct for step in self.steps for struct in step.structs)
        return {struct.name: struct for struct in (*self.shared, *own)}

    @property
    def contract(self) -> dict[str, Step]:
        """By name of the robot's function: all but params_default and prepare."""
        named = {step.name.removeprefix(f"{self.robot}_"): step for step in self.steps}
        return {name: step for name, step in named.items() if name not in PREPARING}

    def variables(self, step: Step) -> dict[str, str]:
        """The variables that a call of ``step`` takes, and what is called before it; with their types."""
        return {name: kind for each in (step, *self.before([step])) for name, kind in each.variables.items()}

    def inputs(self, step: Step) -> dict[str, str]:
        """Contract name -> variable and member, of the inputs of ``step``; the tunables are the last."""
        return {name: place for each in (step, *self.before([step])) for name, place in each.inputs.items()}

    def before(self, steps: Iterable[Step]) -> tuple[Step, ...]:
        """What has to be called before ``steps``: params_default and prepare, where one reads what prepare gives."""
        if not any("prepared" in step.variables for step in steps):
            return ()
        return tuple(step for step in self.steps if step.name.removeprefix(f"{self.robot}_") in PREPARING)
