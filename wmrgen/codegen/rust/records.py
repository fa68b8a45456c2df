"""Rust functions, ready to print and to be called: what a crate is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from wmrgen.codegen.rust.types import SCALARS, Struct, identifier
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Op


class Parameter(NamedTuple):
    """What a function is given, changes or returns. ``struct``: nothing for a scalar; ``reads`` and ``writes`` as in
    `wmrgen.codegen.signature.Argument`."""

    name: str
    struct: Struct | None
    reads: Mapping[str, str]
    writes: Mapping[str, str]

    @property
    def port(self) -> str:
        """The contract name of a scalar."""
        return next(iter(self.reads or self.writes))

    def member(self, name: str) -> str:
        """A member by contract name; a scalar is its own."""
        return f"{self.name}.{self.struct.paths[name]}" if self.struct else self.name

    @property
    def returned(self) -> bool:
        """What is written as a whole is returned; of what is written in part, or read too, members change."""
        return not self.reads and (self.struct is None or len(self.writes) == len(self.struct.paths))

    def declared(self, scalar: str) -> str:
        """As a signature declares it."""
        if self.struct is None:
            return f"{self.name}: {scalar}"
        return f"{self.name}: &{'mut ' if self.writes else ''}{self.struct.name}"


class Step(NamedTuple):
    """A Rust function, ready to print. ``parameters`` are given or changed, ``results`` returned."""

    name: str
    docs: tuple[str, ...]
    head: tuple[str, ...]
    lines: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    results: tuple[Parameter, ...]
    ops: frozenset[Op]

    @property
    def outputs(self) -> dict[str, str]:
        """Contract name -> where it stands after a call with variables that are called as the parameters."""
        return {port: p.member(m) for p in (*self.parameters, *self.results) for port, m in p.writes.items()}

    def calling(self, values: Mapping[str, str]) -> list[str]:
        """Statements that call it with ``values`` by contract name: `prepared` is there, parameters are nominal."""
        lines, passed = [], []
        for p in self.parameters:
            if p.struct is None:
                passed.append(values[p.port])
                continue
            passed.append(f"&{'mut ' if p.writes else ''}{p.name}")
            stored = [f"{p.member(m)} = {values[port]};" for port, m in p.reads.items() if port in values]
            if p.name != "prepared":
                mutable = "mut " if stored or p.writes else ""
                lines += [f"let {mutable}{p.name} = {p.struct.name}::default();", *stored]
        names = [p.name for p in self.results]
        bound = f"let {names[0] if len(names) == 1 else '(' + ', '.join(names) + ')'} = " if names else ""
        return [*lines, f"{bound}{self.name}({', '.join(passed)});"]


class Kernel(NamedTuple):
    """A private function, ready to print. ``struct``: name and members of its results where there are collector."""

    docs: str
    head: tuple[str, ...]
    lines: tuple[str, ...]
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None


class Unit(NamedTuple):
    """What a crate is made of. ``nominal``: the tunable parameters by name, where there are any."""

    robot: str
    choice: Choice
    structs: tuple[Struct, ...]
    nominal: Mapping[str, str]
    steps: tuple[Step, ...]
    kernels: tuple[Kernel, ...]

    @property
    def scalar(self) -> str:
        """``f32`` or ``f64``."""
        return SCALARS[self.choice.scalar]

    @property
    def ops(self) -> frozenset[Op]:
        """The operations that are printed."""
        printed = [step.ops for step in self.steps] + [kernel.ops for kernel in self.kernels]
        return frozenset[Op]().union(*printed)

    @property
    def joints(self) -> list[str]:
        """The members of the wheels, where there are such."""
        return [path for struct in self.structs if struct.name == "Wheels" for path in struct.paths.values()]

    def step(self, name: str) -> Step | None:
        """The function called ``name``; None where it has no outputs."""
        return next((step for step in self.steps if step.name == identifier(name)), None)

    def block(
        self, step: Step, values: Mapping[str, str], result: Callable[[Mapping[str, str]], str]
    ) -> list[str]:
        """A block that calls ``step`` with ``values`` by contract name; its value is the ``result`` of the outputs."""
        prepare = self.step("prepare")
        before = (
            prepare.calling(values) if prepare and any(p.name == "prepared" for p in step.parameters) else []
        )
        lines = [*before, *step.calling(values), result(step.outputs)]
        return ["{", *(f"    {line}" for line in lines), "}"]
