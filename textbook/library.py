"""The library: every function by name, and its code through the same stages as that of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property
from typing import Any

from textbook.canonical import CANONICAL
from textbook.car import CARS
from textbook.castor import CASTORS
from textbook.frames import FRAMES
from textbook.inverses import INVERSES
from textbook.polar import POLAR
from textbook.transforms import PLANE, SPACE
from textbook.wheels import WHEELS
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.ir.lower import kernels_of, lower
from wmrgen.ir.nodes import Module
from wmrgen.ir.pipeline import optimise

NAME = "textbook"

# In the order of the report.
CHAPTERS = (PLANE, SPACE, INVERSES, FRAMES, WHEELS, CASTORS, CANONICAL, POLAR, CARS)
FUNCTIONS = {name: build for chapter in CHAPTERS for name, build in chapter.functions.items()}


@cache
def formula(name: str) -> Formula:
    """A function of the library. KeyError for an unknown name."""
    return FUNCTIONS[name]()


class Textbook:
    """The library, or some of its functions, as backends read it: like a `Derivation`, without a robot."""

    def __init__(self, names: Sequence[str] | None = None) -> None:
        self.names = tuple(FUNCTIONS) if names is None else tuple(names)

    @cached_property
    def formulas(self) -> tuple[Formula, ...]:
        """The functions in symbols."""
        return tuple(formula(name) for name in self.names)

    @cached_property
    def raw_module(self) -> Module:
        """The functions as written, not optimised: what the exact backend evaluates."""
        return Module(NAME, tuple(lower(f) for f in self.formulas))

    @cached_property
    def module(self) -> Module:
        """The functions, optimised."""
        return optimise(self.raw_module.functions, NAME)

    @property
    def array_module(self) -> Module:
        """The functions for the module over arrays: those of `module`, for none has a residual to leave out."""
        return self.module

    @cached_property
    def c_module(self) -> Module:
        """The functions for C: all of them, with calls of kernels where formulas name them."""
        functions = tuple(lower(f, calls=True) for f in self.formulas)
        meaning = self.raw_module.functions
        return optimise(functions, NAME, kernels=kernels_of(self.formulas), meaning=meaning)

    def casadi(self) -> dict[str, Any]:
        """Function name -> casadi.Function."""
        from wmrgen.codegen.casadi import functions

        return functions(self.module)

    def numpy(self) -> Any:
        """The functions, vectorised over NumPy arrays."""
        from wmrgen.codegen.arrays import functions

        return functions(self.module)


def textbook(*names: str) -> Textbook:
    """The library; with names, only those functions. KeyError for an unknown name when it is first read."""
    return Textbook(names or None)
