"""An order of evaluation that keeps few values alive at once.

Depth first from the outputs in their order; of an operation's arguments, the one that needs more
registers first (Sethi and Ullman 1970, which is optimal for trees).
"""

from __future__ import annotations

from dataclasses import replace

from wmrgen.ir.nodes import Function, Node, Op

LIBRARY = frozenset({Op.SIN, Op.COS, Op.ATAN, Op.ATAN2})


def schedule(function: Function) -> Function:
    """``function`` with its nodes in a new order; unneeded ones are left out."""
    nodes = function.nodes
    needs = registers(nodes)
    place: dict[int, int] = {}
    order: list[int] = []
    for result in function.results:
        stack = [result]
        while stack:
            i = stack[-1]
            if i in place:
                stack.pop()
                continue
            waiting = {arg for arg in nodes[i].args if arg not in place}
            if len(waiting) > 1:
                stack += sorted(waiting, key=lambda arg: (needs[arg], -nodes[i].args.index(arg)))
            elif waiting:
                stack += waiting
            else:
                place[i] = len(order)
                order.append(stack.pop())
    moved = tuple(renumbered(nodes[i], place) for i in order)
    return replace(function, nodes=moved, results=tuple(place[result] for result in function.results))


def calls_first(function: Function) -> Function:
    """What library functions need, and they themselves, before the rest: few values then live across a call."""
    nodes = function.nodes
    first = bytearray(node.op in LIBRARY for node in nodes)
    for i in range(len(nodes) - 1, -1, -1):
        if first[i]:
            for arg in nodes[i].args:
                first[arg] = 1
    order = sorted(range(len(nodes)), key=lambda i: not first[i])
    place = {i: k for k, i in enumerate(order)}
    moved = tuple(renumbered(nodes[i], place) for i in order)
    return replace(function, nodes=moved, results=tuple(place[result] for result in function.results))


def renumbered(node: Node, place: dict[int, int]) -> Node:
    """``node`` over arguments that have moved."""
    return Node(node.op, tuple(place[arg] for arg in node.args), node.value, node.name)


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
