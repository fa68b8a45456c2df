"""Writing down a function of the library: inputs, intermediate results and outputs, in the order of a page."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.kinematics.records import Formula, Locals
from wmrgen.kinematics.rollers import quotient
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, signal

AXES = ("x", "y", "z")
Vector = tuple[Expr, Expr, Expr]
Rows = tuple[tuple[Expr, ...], ...]


class Page:
    """One function of the library while it is written down."""

    def __init__(self, name: str, text: str) -> None:
        self.name, self.text = name, text
        self.inputs: list[Port] = []
        self.outputs: list[tuple[Port, Expr]] = []
        self.locals = Locals()

    def given(self, name: str, unit: str = "", text: str = "") -> Expr:
        """A scalar input."""
        self.inputs.append(Port(name, Role.COMMAND, unit, text))
        return signal(name)

    def vector(self, name: str, unit: str, text: str = "") -> Vector:
        """A vector of space: ``name.x``, ``name.y``, ``name.z``."""
        x, y, z = (self.given(f"{name}.{axis}", unit, text) for axis in AXES)
        return x, y, z

    def matrix(self, name: str, rows: int, columns: int, unit: str = "", text: str = "") -> Rows:
        """A matrix: ``name11``, ``name12`` and so on, row by row."""
        return tuple(
            tuple(self.given(f"{name}{i}{j}", unit, text) for j in range(1, columns + 1))
            for i in range(1, rows + 1)
        )

    def let(self, name: str, value: Expr) -> Expr:
        """A named intermediate result."""
        return self.locals.define(name, value)

    def quotient(self, name: str, above: Expr, below: Expr) -> Expr:
        """above / below, 0 where |below| <= 1e-12."""
        return quotient(self.locals, name, above, below)

    def tangent(self, name: str, angle: Expr) -> Expr:
        """tan(angle), 0 where |cos(angle)| <= 1e-12."""
        return self.quotient(name, sympy.sin(angle), self.let(f"{name}_cos", sympy.cos(angle)))

    def gives(self, name: str, unit: str, value: Expr, text: str = "") -> None:
        """A scalar output."""
        self.outputs.append((Port(name, Role.COMMAND, unit, text), value))

    def gives_vector(self, name: str, unit: str, value: Sequence[Expr], text: str = "") -> None:
        """A vector as output."""
        for axis, entry in zip(AXES, value, strict=True):
            self.gives(f"{name}.{axis}", unit, entry, text)

    def gives_matrix(self, name: str, rows: Sequence[Sequence[Expr]], unit: str = "", text: str = "") -> None:
        """A matrix as output, row by row."""
        for i, row in enumerate(rows, 1):
            for j, entry in enumerate(row, 1):
                self.gives(f"{name}{i}{j}", unit, entry, text)

    def formula(self) -> Formula:
        """The finished function."""
        return Formula(
            self.name, tuple(self.inputs), tuple(self.locals.items), tuple(self.outputs), self.text
        )
