"""The intermediate representation: a flat single-assignment list of scalar operations.

A function is a tuple of nodes; the arguments of a node are indices of earlier nodes. Constants are exact
(`wmrgen.geometry.exact.Exact`, the field Q(sqrt2, sqrt3)); the back end that prints them rounds them once. This module
also has what can be read from the list: uses, needed nodes, an order that keeps few values alive, operation counts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Limits, Port, Role
from wmrgen.ir.ops import Op

T = TypeVar("T")
__all__ = ["Function", "Limits", "Module", "Node", "Op", "Port", "Role"]


class Node(NamedTuple):
    """One operation of a function."""

    op: Op
    args: tuple[int, ...] = ()  # indices of earlier nodes
    value: Exact | None = None  # of CONST
    name: str | None = (
        None  # of INPUT: the input port; of CALL: the kernel; of RESULT: the number of the result
    )

    @property
    def meaning(self) -> tuple[Op, tuple[int, ...]]:
        """Return operation and arguments for analyses, which treat the product of a value with itself as a square."""
        if self.op is Op.MUL and self.args[0] == self.args[1]:
            return Op.SQUARE, self.args[:1]
        return self.op, self.args

    def over(self, args: tuple[int, ...]) -> Node:
        """Return the same operation with other arguments."""
        return self if args == self.args else Node(self.op, args, self.value, self.name)


class Named(NamedTuple):
    """An intermediate result of a formula."""

    name: str
    node: int  # the node that computes it
    quantity: str = ""  # its name in the report; empty if the report does not mention it


@dataclass(frozen=True, slots=True)
class Function:
    """Straight-line code: node ``results[k]`` computes ``outputs[k]``."""

    name: str
    inputs: tuple[Port, ...]
    nodes: tuple[Node, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]  # the node of each output
    text: str = ""  # what the function computes, for comments and reports
    named: tuple[Named, ...] = ()  # intermediate results of the formula that are still computed
    # The function whose inputs and intermediate results this one shares: it has other outputs of the same formula.
    variant_of: str = ""
    limits: Limits = Limits.NONE  # which inputs are within the limits of the robot
    in_place: bool = False  # whether an argument is input and output, see `wmrgen.codegen.signature`
    zeros: tuple[str, ...] = ()  # outputs of the formula that are always 0, and that no function computes

    def outputs_of(self, values: Sequence[T]) -> dict[str, T]:
        """Return the outputs by name, given a value for each node."""
        return {port.name: values[k] for port, k in zip(self.outputs, self.results, strict=True)}


@dataclass(frozen=True, slots=True)
class Module:
    """All functions of a robot."""

    name: str
    functions: tuple[Function, ...]
    # Computes values that depend on tunable parameters alone; None if no geometry is tunable. Its outputs are the
    # PREPARED inputs of the other functions, by name.
    prepare: Function | None = None
    kernels: tuple[
        Function, ...
    ] = ()  # the functions that CALL nodes name; each only calls kernels before it
    # Names of the joints that are commanded or sensed, in the file's order; None if the functions are no robot's.
    joints: tuple[str, ...] | None = None
    # Outputs of ``prepare`` that are negative, or not a number, for parameters that no robot can have.
    needs: tuple[str, ...] = ()

    @property
    def every(self) -> tuple[Function, ...]:
        """Return `prepare`, if there is one, and the functions."""
        return (*((self.prepare,) if self.prepare else ()), *self.functions)

    def function(self, name: str) -> Function:
        """Return the function called ``name``; raise KeyError if there is none."""
        return {f.name: f for f in self.functions}[name]


def contract(function: Function) -> tuple[Port, ...]:
    """Return the inputs that a caller gives at every step, which excludes geometry."""
    return tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))


def uses_of(function: Function) -> Counter[int]:
    """Return how often each node is an argument or a result."""
    uses = Counter(arg for node in function.nodes for arg in node.args)
    uses.update(function.results)
    return uses


class Shared(NamedTuple):
    """The part of a function that a variant of it has as well. Both must compute it with equal bits."""

    nodes: frozenset[int]  # the nodes that common results need
    uses: Counter[int]  # how often each of them is an argument or a result in this part


def shared(function: Function, common: tuple[int, ...]) -> Shared:
    """Return the part of a function that the results with the numbers ``common`` need."""
    results = [function.results[k] for k in common]
    nodes = frozenset(places(function.nodes, results))
    uses = Counter(arg for i in nodes for arg in function.nodes[i].args)
    uses.update(results)
    return Shared(nodes, uses)


def places(nodes: Sequence[Node], results: Sequence[int]) -> dict[int, int]:
    """Return the new index of each node that ``results`` need, when the other nodes are dropped."""
    live = bytearray(len(nodes))
    for result in results:
        live[result] = 1
    for i in range(len(nodes) - 1, -1, -1):
        if live[i]:
            for arg in nodes[i].args:
                live[arg] = 1
    kept = (i for i in range(len(nodes)) if live[i])
    return {i: k for k, i in enumerate(kept)}


def pruned(function: Function) -> Function:
    """Return ``function`` without the nodes that no result needs."""
    return placed(function, places(function.nodes, function.results))


def rebuilt(function: Function, nodes: Sequence[Node], place: Mapping[int, int]) -> Function:
    """Return ``function`` with new nodes.

    Args:
        function: the function before a pass.
        nodes: the nodes that the pass made.
        place: the index in ``nodes`` of the value of each old node. Values that are no longer computed have none, and
            lose their names.

    Returns:
        The function after the pass.
    """
    named = tuple(each for each in renumbered(function.named, place) if nodes[each.node].args)
    results = tuple(place[result] for result in function.results)
    return replace(function, nodes=tuple(nodes), results=results, named=named)


def placed(function: Function, place: Mapping[int, int]) -> Function:
    """Return ``function`` with its nodes moved; ``place`` has the new index of each, in ascending order."""
    return replace(
        function,
        nodes=_moved(function.nodes, place),
        results=tuple(place[result] for result in function.results),
        named=renumbered(function.named, place),
    )


def renumbered(named: Iterable[Named], place: Mapping[int, int]) -> tuple[Named, ...]:
    """Return the intermediate results whose node has a new index in ``place``, with that index."""
    return tuple(each._replace(node=place[each.node]) for each in named if each.node in place)


def _moved(nodes: Sequence[Node], place: Mapping[int, int]) -> tuple[Node, ...]:
    return tuple(nodes[i].over(tuple(map(place.__getitem__, nodes[i].args))) for i in place)


def schedule(function: Function) -> Function:
    """Return ``function`` in an order that keeps few values alive at once, without unneeded nodes.

    The order is depth first from the outputs. The argument of an operation that needs more registers comes first
    (Sethi and Ullman 1970, which is optimal for trees).
    """
    nodes = function.nodes
    needs = registers(nodes)
    scheduled = bytearray(len(nodes))
    order: list[int] = []
    for result in function.results:
        stack = [result]
        while stack:
            i = stack[-1]
            if scheduled[i]:
                stack.pop()
                continue
            waiting = {arg for arg in nodes[i].args if not scheduled[arg]}
            if len(waiting) > 1:
                stack += sorted(waiting, key=lambda arg: (needs[arg], -nodes[i].args.index(arg)))
            elif waiting:
                stack += waiting
            else:
                scheduled[i] = 1
                order.append(stack.pop())
    return placed(function, {i: k for k, i in enumerate(order)})


def registers(nodes: tuple[Node, ...]) -> list[int]:
    """Return how many registers each node needs if no value is shared; constants need none."""
    needs: list[int] = []
    for node in nodes:
        if not node.args:
            needs.append(0 if node.op is Op.CONST else 1)
            continue
        wanted = sorted((needs[arg] for arg in set(node.args)), reverse=True)
        needs.append(max(1, *(need + k for k, need in enumerate(wanted))))
    return needs


class Cost(NamedTuple):
    """The number of operations of each kind in one call."""

    additions: int = 0
    multiplications: int = 0
    divisions: int = 0
    roots: int = 0
    sines: int = 0  # and cosines
    arctangents: int = 0
    comparisons: int = 0  # select, min, max
    signs: int = 0  # negation, absolute value
    roundings: int = 0  # to whole numbers

    @property
    def flops(self) -> int:
        """Return additions plus multiplications, the figure by which robots are compared."""
        return self.additions + self.multiplications

    def __str__(self) -> str:
        """Return ``6 additions, 3 multiplications``, or ``none``."""
        names = (
            ("addition", "additions"), ("multiplication", "multiplications"), ("division", "divisions"),
            ("square root", "square roots"), ("sine or cosine", "sines and cosines"),
            ("arctangent", "arctangents"), ("comparison", "comparisons"),
            ("sign operation", "sign operations"), ("rounding", "roundings"),
        )  # fmt: skip
        counted = zip(self, names, strict=True)
        return ", ".join(f"{n} {name[n != 1]}" for n, name in counted if n) or "none"


def count(function: Function) -> Cost:
    """Count the operations of ``function``, including unused nodes."""
    return Cost(**Counter(node.op.cost for node in function.nodes if node.op.cost))
