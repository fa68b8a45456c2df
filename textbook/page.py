"""Writing down a function of the library: inputs, intermediate results and outputs, in the order of a page.

Quantities are described as ``name [unit] text``, several divided by semicolons.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

import sympy

from wmrgen.analysis.kinematics.contacts import quotient
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.functions.space.wheel_motion import Vector
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import Expr, signal

AXES = ("x", "y", "z")
_NEXT = re.compile(r"; (?=\S+ \[)")
_QUANTITY = re.compile(r"(\S+) \[(.*?)\] ?(.*)")


def ports(described: str) -> list[Port]:
    """``x [m] position; theta [rad] heading`` as ports."""
    parts = [_QUANTITY.fullmatch(part) for part in _NEXT.split(described)]
    return [Port(m[1], Role.COMMAND, m[2], m[3]) for m in parts if m]


class Page:
    """One function of the library while it is written down."""

    def __init__(self) -> None:
        self.inputs: list[Port] = []
        self.outputs: list[tuple[Port, Expr]] = []
        self.locals = Locals()

    def read(self, described: str) -> tuple[Expr, ...]:
        """Scalar inputs."""
        new = ports(described)
        self.inputs += new
        return tuple(signal(p.name) for p in new)

    def vectors(self, described: str) -> tuple[Vector, ...]:
        """Inputs that are vectors of space: ``name.x``, ``name.y``, ``name.z``."""
        names = [[f"{p.name}.{a} [{p.unit}] {p.text}" for a in AXES] for p in ports(described)]
        return tuple((x, y, z) for x, y, z in (self.read("; ".join(axes)) for axes in names))

    def matrix(self, name: str, rows: int, columns: int, text: str) -> sympy.Matrix:
        """An input matrix: ``name11``, ``name12`` and so on, row by row."""
        names = [f"{name}{i}{j} [] {text}" for i in range(1, rows + 1) for j in range(1, columns + 1)]
        return sympy.Matrix(rows, columns, self.read("; ".join(names)))

    def let(self, name: str, value: Expr) -> Expr:
        """A named intermediate result."""
        return self.locals.define(name, value)

    def vector_at(self, name: str, size: Expr, angle: Expr) -> tuple[Expr, Expr]:
        """Both components of the vector of this size at this angle, named intermediate results."""
        return self.locals.vector_at(name, size, angle)

    def quotient(self, name: str, above: Expr, below: Expr) -> Expr:
        """above / below, 0 where |below| <= 1e-12."""
        return quotient(self.locals, name, above, below)

    def write(self, described: str, *values: Expr) -> None:
        """Scalar outputs."""
        self.outputs += zip(ports(described), values, strict=True)

    def write_vector(self, described: str, value: Iterable[Expr]) -> None:
        """A vector as output; sums and products that the engine left as they stand are evaluated."""
        (p,) = ports(described)
        self.outputs += [
            (Port(f"{p.name}.{a}", p.role, p.unit, p.text), e.doit())
            for a, e in zip(AXES, value, strict=True)
        ]

    def write_matrix(self, described: str, value: sympy.Matrix) -> None:
        """A matrix as output, row by row."""
        (p,) = ports(described)
        names = [f"{p.name}{i + 1}{j + 1}" for i in range(value.rows) for j in range(value.cols)]
        self.outputs += [(Port(n, p.role, p.unit, p.text), e) for n, e in zip(names, value, strict=True)]


class Chapter:
    """Functions of one subject, by name: ``@chapter(text)`` makes one of a function that writes its page."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.functions: dict[str, Callable[[], Formula]] = {}

    def __call__(
        self, text: str, name: str = ""
    ) -> Callable[[Callable[[Page], None]], Callable[[], Formula]]:
        """``text``: what the function gives and its source; ``name`` where it is not that of the Python function."""

        def add(written: Callable[[Page], None]) -> Callable[[], Formula]:
            called = name or written.__name__

            def build() -> Formula:
                page = Page()
                written(page)
                return page.locals.formula(called, page.inputs, page.outputs, text)

            self.functions[called] = build
            return build

        return add
