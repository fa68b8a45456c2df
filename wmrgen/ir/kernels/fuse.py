"""Fused multiply-add, for processors that have it as an instruction: a product that is only added is not rounded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.prune import prune

_TWO = Exact(2)


def fuse(function: Function) -> Function:
    """``function`` with sums of a product that nothing else needs as one operation."""
    nodes, results = prune(function.nodes, function.results)
    users: list[list[int]] = [[] for _ in nodes]
    for i, node in enumerate(nodes):
        for arg in node.args:
            users[arg].append(i)
    for result in results:
        users[result].append(len(nodes))
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
        k = _product(nodes, i, users) if node.op is Op.ADD or node.op is Op.SUB else None
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


def _product(nodes: Sequence[Node], i: int, users: Sequence[list[int]]) -> int | None:
    """Which of the two arguments of sum ``i`` is a product that pays when it is not rounded.

    The instruction adds to a register: it saves one where the other term is needed no more. Twice x is x + x.
    """
    for k, arg in enumerate(nodes[i].args):
        product, other = nodes[arg], nodes[i].args[1 - k]
        if product.op is not Op.MUL or len(users[arg]) > 1 or nodes[product.args[0]].value == _TWO:
            continue
        if nodes[other].value is not None or _dies(nodes, i, other, users):
            return k
    return None


def _dies(nodes: Sequence[Node], i: int, value: int, users: Sequence[list[int]]) -> bool:
    """True where all other users of ``value`` come before node ``i``, being needed for it."""
    open_ = set(users[value])
    open_.discard(i)
    if open_ and max(open_) > i:
        return False
    stack, seen = list(nodes[i].args), set()
    while stack and open_:
        j = stack.pop()
        if j > value and j not in seen:
            seen.add(j)
            open_.discard(j)
            stack += nodes[j].args
    return not open_
