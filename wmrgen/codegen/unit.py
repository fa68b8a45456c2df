"""Functions of a robot as a language with structs has them: structs, parameters, steps, kernels.

C and Rust print these records. Each language decides how a declaration looks; this module decides which parameters a
function has, where its inputs and outputs are, and what must be called before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from wmrgen.codegen.signature import PREPARED, Argument
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Op, Port

PREPARING = (
    "params_default",
    "prepare",
)  # functions that are called before those that read what `prepare` gives


class Field(NamedTuple):
    """A member of a struct: a scalar, or the struct of a wheel."""

    name: str
    port: Port | None  # of a scalar
    inner: tuple[Field, ...] = ()  # members of the struct of a wheel


class Struct(NamedTuple):
    """A struct whose members are scalars and nested structs of wheels."""

    name: str
    text: str  # of its comment
    fields: tuple[Field, ...]
    members: Mapping[str, str]  # contract name -> path of the member: left.spin

    @property
    def ports(self) -> list[Port]:
        """The ports of all scalars, in the order of declaration."""
        found = []
        for field in self.fields:
            found += [inner.port for inner in field.inner] if field.inner else [field.port]
        return [port for port in found if port is not None]


def struct(name: str, ports: Sequence[Port], text: str, identifier: Callable[[str], str]) -> Struct:
    """Return the struct of ``ports``: a member for each port without a wheel, and a nested struct for each wheel.

    Args:
        name: Name of the struct.
        ports: Members, at least one.
        text: What the struct is.
        identifier: Returns an identifier of the language that resembles a name.
    """
    paths = _paths(ports, identifier)
    fields: dict[str, Field] = {}  # in the order in which ports mention them
    for port in ports:
        wheel, member = paths[port.name]
        field = Field(member, port)
        if wheel:
            before = fields.get(wheel, Field(wheel, None))
            fields[wheel] = before._replace(inner=(*before.inner, field))
        else:
            fields[member] = field
    members = {port.name: ".".join(filter(None, paths[port.name])) for port in ports}
    return Struct(name, text, tuple(fields.values()), members)


def _paths(ports: Sequence[Port], identifier: Callable[[str], str]) -> dict[str, tuple[str, str]]:
    """Return the wheel (or "") and the member of each port by contract name, without clashes at either level."""
    paths: dict[str, tuple[str, str]] = {}
    wheels = {"": ""}
    used: dict[str, set[str]] = {"": set()}
    for port in sorted(ports, key=lambda port: "." in port.name):  # a name without a dot is not changed
        wheel, _, member = port.name.rpartition(".")
        if wheel not in wheels:
            wheels[wheel] = _unused(identifier(wheel), used[""])
            used[wheel] = set()
        paths[port.name] = wheels[wheel], _unused(identifier(member), used[wheel])
    return paths


def _unused(identifier: str, used: set[str]) -> str:
    """Return an identifier with low lines added until it is not among ``used``, and add it to them."""
    while identifier in used:
        identifier += "_"
    used.add(identifier)
    return identifier


def place_of(variable: str, member: str) -> str:
    """Return a member of a variable as code: ``twist.vx``, or the variable if it is a scalar (``member`` is empty)."""
    return f"{variable}.{member}" if member else variable


class Parameter(NamedTuple):
    """A parameter of a function, or a result in a language that returns it."""

    name: str
    type: str  # of the variable: a struct, or the scalar type
    reads: Mapping[str, str]  # contract name -> path of the member that is read; "" if it is a scalar
    writes: Mapping[str, str]  # the same for what is written
    struct: Struct | None = None  # None for a scalar

    @property
    def by_value(self) -> bool:
        """Whether it is a scalar input."""
        return self.struct is None and not self.writes

    def place(self, member: str) -> str:
        """Return the member with this path as code."""
        return place_of(self.name, member)


def parameter(argument: Argument, name: str, struct: Struct | None, scalar: str) -> Parameter:
    """Return the parameter of an argument.

    Args:
        argument: The argument.
        name: Name of the parameter in the language.
        struct: Type of the argument; None for a scalar.
        scalar: The scalar type.
    """
    if struct is None:
        reads, writes = dict.fromkeys(argument.reads, ""), dict.fromkeys(argument.writes, "")
        return Parameter(name, scalar, reads, writes)
    reads = {port: struct.members[member] for port, member in argument.reads.items()}
    writes = {port: struct.members[member] for port, member in argument.writes.items()}
    return Parameter(name, struct.name, reads, writes, struct)


class Step(NamedTuple):
    """A function that users call, ready to print."""

    function: str  # name of the robot's function: inverse
    name: str  # its name in the language: pioneer3dx_inverse
    parameters: tuple[Parameter, ...]
    comment: tuple[str, ...]
    head: tuple[str, ...]  # lines of the declaration
    lines: tuple[str, ...]  # of the body
    structs: tuple[Struct, ...] = ()  # declared for this function alone
    ops: frozenset[Op] = frozenset()
    small: tuple[str, ...] = ()  # C: body for least flash, if there is another

    @property
    def variables(self) -> dict[str, str]:
        """Variables with the names of the parameters, and their types."""
        return {p.name: p.type for p in self.parameters}

    @property
    def inputs(self) -> dict[str, str]:
        """Contract name -> member of a variable, for all that a caller sets."""
        given = (p for p in self.parameters if p.name != PREPARED)
        return {port: p.place(member) for p in given for port, member in p.reads.items()}

    @property
    def outputs(self) -> dict[str, str]:
        """Contract name -> member of a variable, for all that the function gives."""
        return {port: p.place(member) for p in self.parameters for port, member in p.writes.items()}


class Kernel(NamedTuple):
    """A private function that steps call, ready to print."""

    name: str
    comment: tuple[str, ...]
    head: tuple[str, ...]  # lines of the declaration
    lines: tuple[str, ...]  # of the body
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None  # type and members of its results, if there are several


class Unit(NamedTuple):
    """All functions of a robot in one language, in the order in which they are printed."""

    robot: str
    choice: Choice
    shared: tuple[Struct, ...]  # types that several functions have
    steps: tuple[Step, ...]
    kernels: tuple[Kernel, ...]
    joints: tuple[str, ...] = ()  # contract names of the members of the type of wheels
    written: frozenset[Op] = frozenset()  # operations of the functions before kernels were put in
    rounds: bool = False  # C: whether the code relies on the rounding of sums with large constants
    counting: tuple[Struct, Step] | None = (
        None  # C: the type of counters of encoders, and the function that takes them
    )

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
        """The functions of the robot by name, without `PREPARING`."""
        return {step.function: step for step in self.steps if step.function not in PREPARING}

    def before(self, steps: Iterable[Step]) -> tuple[Step, ...]:
        """Return what must be called before ``steps``: `PREPARING`, if one of them reads what `prepare` gives."""
        if not any(PREPARED in step.variables for step in steps):
            return ()
        return tuple(step for step in self.steps if step.function in PREPARING)

    def variables(self, step: Step) -> dict[str, str]:
        """Return the variables of calls of ``step`` and of what is called before it, with their types."""
        return {name: kind for each in (step, *self.before([step])) for name, kind in each.variables.items()}

    def inputs(self, step: Step) -> dict[str, str]:
        """Return the member of a variable for each input of ``step``; tunable parameters are the last."""
        return {name: place for each in (step, *self.before([step])) for name, place in each.inputs.items()}
