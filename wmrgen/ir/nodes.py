"""The intermediate representation: a flat single-assignment list of scalar operations.

A function is a tuple of nodes; a node's arguments are indices of earlier nodes. Constants are
exact (`wmrgen.exact.Exact`, the field Q(sqrt2, sqrt3)), rounded once, by the backend that prints them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from wmrgen.exact.number import Exact
from wmrgen.ir.ops import Op
from wmrgen.ports import Limits, Port, Role

__all__ = ["Function", "Limits", "Module", "Node", "Op", "Port", "Role"]


@dataclass(frozen=True, slots=True)
class Node:
    """One operation. CONST carries ``value``; INPUT carries ``name`` (the name of an input port)."""

    op: Op
    args: tuple[int, ...] = ()
    value: Exact | None = None
    name: str | None = None

    @property
    def meaning(self) -> tuple[Op, tuple[int, ...]]:
        """Operation and arguments as analyses take them: a product of a value with itself is its square."""
        if self.op is Op.MUL and self.args[0] == self.args[1]:
            return Op.SQUARE, self.args[:1]
        return self.op, self.args


@dataclass(frozen=True, slots=True)
class Function:
    """Straight-line code: ``outputs[k]`` is computed by node ``results[k]``.

    ``named``: intermediate results of the formula and their nodes, of code as lowered and not optimised.
    ``variant_of``: the function whose inputs and intermediate results this one shares, where it gives other outputs
    of the same formula. ``limits``: which inputs the limits of the robot bound.
    """

    name: str
    inputs: tuple[Port, ...]
    nodes: tuple[Node, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    text: str = ""
    named: tuple[tuple[str, int], ...] = ()
    variant_of: str = ""
    limits: Limits = Limits.NONE


@dataclass(frozen=True, slots=True)
class Module:
    """All functions of a robot. ``prepare`` is None when no geometry is tunable.

    The outputs of ``prepare`` are the PREPARED inputs of the other functions, by name. ``kernels``: what the functions
    call, those that are called before those that call; a call gives their inputs in order.
    """

    name: str
    functions: tuple[Function, ...]
    prepare: Function | None = None
    kernels: tuple[Function, ...] = ()

    def function(self, name: str) -> Function:
        """The function called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.functions}[name]


def uses_of(function: Function) -> Counter[int]:
    """How often each node is an argument or a result."""
    uses = Counter(arg for node in function.nodes for arg in node.args)
    uses.update(function.results)
    return uses
