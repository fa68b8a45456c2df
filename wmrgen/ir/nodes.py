"""The intermediate representation: a flat single-assignment list of scalar operations.

A function is a tuple of nodes; a node's arguments are indices of earlier nodes. Constants are exact
(`wmrgen.geometry.exact.Exact`, the field Q(sqrt2, sqrt3)), rounded once, by the backend that prints them. What is
read off the
list stands here, too: uses, what results need, an order that keeps few values alive, counts of operations.
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

    def over(self, args: tuple[int, ...]) -> Node:
        """The same operation of other arguments."""
        return self if args == self.args else Node(self.op, args, self.value, self.name)


class Named(NamedTuple):
    """An intermediate result of a formula, the node that computes it, and what the report calls it, where it does."""

    name: str
    node: int
    quantity: str = ""


@dataclass(frozen=True, slots=True)
class Function:
    """Straight-line code: ``outputs[k]`` is computed by node ``results[k]``.

    ``named``: intermediate results of the formula; passes keep them as long as they compute them.
    ``variant_of``: the function whose inputs and intermediate results this one shares, where it gives other outputs
    of the same formula. ``limits``: which inputs the limits of the robot bound. ``in_place``: see
    `wmrgen.codegen.signature`.
    ``zeros``: outputs of the formula that are 0 whatever the inputs, and that no function computes.
    """

    name: str
    inputs: tuple[Port, ...]
    nodes: tuple[Node, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    text: str = ""
    named: tuple[Named, ...] = ()
    variant_of: str = ""
    limits: Limits = Limits.NONE
    in_place: bool = False
    zeros: tuple[str, ...] = ()

    def outputs_of(self, values: Sequence[T]) -> dict[str, T]:
        """The outputs by name; ``values``: one of each node."""
        return {port.name: values[k] for port, k in zip(self.outputs, self.results, strict=True)}


@dataclass(frozen=True, slots=True)
class Module:
    """All functions of a robot. ``prepare`` is None when no geometry is tunable.

    The outputs of ``prepare`` are the PREPARED inputs of the other functions, by name. ``kernels``: what the functions
    call, those that are called before those that call; a call gives their inputs in order. ``joints``: contract names
    of those that a robot commands or senses, in the file's order; None where the functions are no robot's. ``needs``:
    the outputs of ``prepare`` that are negative, or no numbers, for parameters that no robot can have.
    """

    name: str
    functions: tuple[Function, ...]
    prepare: Function | None = None
    kernels: tuple[Function, ...] = ()
    joints: tuple[str, ...] | None = None
    needs: tuple[str, ...] = ()

    @property
    def every(self) -> tuple[Function, ...]:
        """`prepare`, where there is one, and the functions."""
        return (*((self.prepare,) if self.prepare else ()), *self.functions)

    def function(self, name: str) -> Function:
        """The function called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.functions}[name]


def contract(function: Function) -> tuple[Port, ...]:
    """The inputs that a caller gives at every step: no geometry."""
    return tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))


def uses_of(function: Function) -> Counter[int]:
    """How often each node is an argument or a result."""
    uses = Counter(arg for node in function.nodes for arg in node.args)
    uses.update(function.results)
    return uses


class Shared(NamedTuple):
    """The part of a function that its variant has too, and that both compute alike: to the bit.

    ``nodes``: those that common results need; ``uses``: how often each is an argument or a result among them.
    """

    nodes: frozenset[int]
    uses: Counter[int]


def shared(function: Function, common: tuple[int, ...]) -> Shared:
    """What the results of these numbers need."""
    results = [function.results[k] for k in common]
    nodes = frozenset(places(function.nodes, results))
    uses = Counter(arg for i in nodes for arg in function.nodes[i].args)
    uses.update(results)
    return Shared(nodes, uses)


def places(nodes: Sequence[Node], results: Sequence[int]) -> dict[int, int]:
    """Where each node that ``results`` need stands when the others are dropped."""
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
    """``function`` with the nodes that its results need, and the names of these."""
    return placed(function, places(function.nodes, function.results))


def rebuilt(function: Function, nodes: Sequence[Node], place: Mapping[int, int]) -> Function:
    """``function`` over ``nodes``, where the value of its node k stands at ``place[k]``.

    A pass that no longer computes a value gives it no place; a name of it is gone then.
    """
    named = tuple(each for each in renumbered(function.named, place) if nodes[each.node].args)
    results = tuple(place[result] for result in function.results)
    return replace(function, nodes=tuple(nodes), results=results, named=named)


def placed(function: Function, place: Mapping[int, int]) -> Function:
    """``function`` with the nodes that have a ``place``, each there; it lists them in that order."""
    return replace(
        function,
        nodes=_moved(function.nodes, place),
        results=tuple(place[result] for result in function.results),
        named=renumbered(function.named, place),
    )


def renumbered(named: Iterable[Named], place: Mapping[int, int]) -> tuple[Named, ...]:
    """Those whose node has a ``place``, there."""
    return tuple(each._replace(node=place[each.node]) for each in named if each.node in place)


def _moved(nodes: Sequence[Node], place: Mapping[int, int]) -> tuple[Node, ...]:
    return tuple(nodes[i].over(tuple(map(place.__getitem__, nodes[i].args))) for i in place)


def schedule(function: Function) -> Function:
    """``function`` with its nodes in an order that keeps few values alive at once; unneeded ones are left out.

    Depth first from the outputs in their order; of an operation's arguments, the one that needs more registers first
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
    """Registers that each node needs when nothing is shared; constants need none."""
    needs: list[int] = []
    for node in nodes:
        if not node.args:
            needs.append(0 if node.op is Op.CONST else 1)
            continue
        wanted = sorted((needs[arg] for arg in set(node.args)), reverse=True)
        needs.append(max(1, *(need + k for k, need in enumerate(wanted))))
    return needs


class Cost(NamedTuple):
    """How many operations of each kind one call takes."""

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
        """Additions and multiplications: the figure that robots are compared by."""
        return self.additions + self.multiplications

    def __str__(self) -> str:
        """``6 additions, 3 multiplications``; ``none``."""
        names = (
            ("addition", "additions"), ("multiplication", "multiplications"), ("division", "divisions"),
            ("square root", "square roots"), ("sine or cosine", "sines and cosines"),
            ("arctangent", "arctangents"), ("comparison", "comparisons"),
            ("sign operation", "sign operations"), ("rounding", "roundings"),
        )  # fmt: skip
        counted = zip(self, names, strict=True)
        return ", ".join(f"{n} {name[n != 1]}" for n, name in counted if n) or "none"


def count(function: Function) -> Cost:
    """The operations in the list of ``function``; unused nodes count too."""
    return Cost(**Counter(node.op.cost for node in function.nodes if node.op.cost))
