"""Fused multiply-add, for processors that have it as an instruction: a product that is only added is not rounded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op, prune

_TWO = Exact(2)


def fuse(function: Function, kernel: bool = False) -> Function:
    """``function`` with sums of a product that nothing else needs as one operation.

    Squares of the inputs of a ``kernel`` stay: its calls have inputs in common, and a compiler shares the squares.
    """
    nodes, results = prune(function.nodes, function.results)
    uses = [0] * len(nodes)
    for i in (*results, *(arg for node in nodes for arg in node.args)):
        uses[i] += 1
    made: list[Node] = []
    place: list[int] = []
    opposites: dict[int, int] = {}

    def opposite(a: int) -> int:
        node = made[a]
        if node.op is Op.NEG:
            return node.args[0]
        if a not in opposites:
            opposites[a] = len(made)
            made.append(Node(Op.NEG, (a,)) if node.value is None else Node(Op.CONST, value=-node.value))
        return opposites[a]

    for i, node in enumerate(nodes):
        args = tuple(place[a] for a in node.args)
        k = _product(nodes, i, uses, kernel) if node.op is Op.ADD or node.op is Op.SUB else None
        if k is not None:
            x, y = (place[a] for a in nodes[node.args[k]].args)
            other = args[1 - k]
            if node.op is Op.SUB:
                x, other = (opposite(x), other) if k else (x, opposite(other))
            node = Node(Op.FMA, (x, y, other))
        elif args != node.args:
            node = Node(node.op, args, node.value, node.name)
        place.append(len(made))
        made.append(node)
    return replace(function, nodes=tuple(made), results=tuple(place[r] for r in results))


def _product(nodes: Sequence[Node], i: int, uses: Sequence[int], kernel: bool) -> int | None:
    """Which of the two arguments of sum ``i`` is a product for it alone. Twice x is better left as x + x."""
    for k, arg in enumerate(nodes[i].args):
        product = nodes[arg]
        if (
            kernel
            and product.op is Op.MUL
            and nodes[product.args[0]].op is Op.INPUT
            and len(set(product.args)) == 1
        ):
            continue
        if product.op is Op.MUL and uses[arg] == 1 and nodes[product.args[0]].value != _TWO:
            return k
    return None
