"""An order of evaluation that keeps few values alive at once.

Depth first from the outputs in their order; of an operation's arguments, the one that needs more
registers first (Sethi and Ullman 1970, which is optimal for trees).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wmrgen.ir.nodes import Function, Node, Op

_MANY = 400  # nodes; of more, only those that several need are looked at one by one
LIBRARY = frozenset({Op.SIN, Op.COS, Op.ATAN, Op.ATAN2})


def schedule(function: Function) -> Function:
    """``function`` with its nodes in a new order; unneeded ones are left out."""
    nodes = function.nodes
    needs = _registers(nodes)
    place: dict[int, int] = {}
    order: list[int] = []
    for result in function.results:
        stack = [result]
        while stack:
            i = stack[-1]
            if i in place:
                stack.pop()
                continue
            args = sorted(set(nodes[i].args), key=lambda arg: (-needs[arg], nodes[i].args.index(arg)))
            waiting = [arg for arg in args if arg not in place]
            if waiting:
                stack += reversed(waiting)
            else:
                place[i] = len(order)
                order.append(stack.pop())
    moved = tuple(_renumbered(nodes[i], place) for i in order)
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
    moved = tuple(_renumbered(nodes[i], place) for i in order)
    return replace(function, nodes=moved, results=tuple(place[result] for result in function.results))


def nearest_first(function: Function) -> Function:
    """Next what leaves the fewest values alive: for code that hands its results over as it goes.

    Inputs, constants and results that nothing else needs are not alive: they stand in memory.
    """
    nodes = function.nodes
    left = [0] * len(nodes)  # how many nodes still need it
    for node in nodes:
        for arg in set(node.args):
            left[arg] += 1
    needs = _registers(nodes)
    done = bytearray(node.value is not None for node in nodes)
    order = [i for i, node in enumerate(nodes) if done[i]]
    together: dict[int, list[int]] = {}  # a call and all its results
    for i, node in enumerate(nodes):
        if node.op is Op.PART:
            together.setdefault(node.args[0], []).append(i)
    results = set(function.results)
    every = len(nodes) <= _MANY
    ends = (i for i, n in enumerate(left) if (every and nodes[i].args) or n > 1 or i in results)
    waiting = [i for i in ends if i not in together]
    while waiting := [i for i in waiting if not done[i]]:
        chosen = min((_tried(nodes, left, done, needs, together, i) for i in waiting), key=lambda t: t[0])[1]
        for i in chosen:
            done[i] = 1
            for arg in set(nodes[i].args):
                left[arg] -= 1
        order += chosen
    place = {i: k for k, i in enumerate(order)}
    moved = tuple(_renumbered(nodes[i], place) for i in order)
    named = tuple((name, place[k]) for name, k in function.named)
    moved_results = tuple(place[result] for result in function.results)
    return replace(function, nodes=moved, results=moved_results, named=named)


def _tried(
    nodes: Sequence[Node],
    left: Sequence[int],
    done: Sequence[int],
    needs: Sequence[int],
    together: Mapping[int, list[int]],
    target: int,
) -> tuple[tuple[int, int, int, int], list[int]]:
    """What computing ``target`` next brings: values alive more, at most meanwhile, operations; and those."""
    order: list[int] = []
    seen: set[int] = set()
    stack = [target]
    while stack:
        i = stack[-1]
        waiting = [a for a in nodes[i].args if not done[a] and a not in seen]
        if i in seen:
            stack.pop()
        elif waiting:
            stack += sorted(set(waiting), key=lambda a: (needs[a], -a))
        else:
            stack.pop()
            order += [i, *together.get(i, ())]
            seen.update(order[-1 - len(together.get(i, ())) :])
    alive = most = 0
    now: dict[int, int] = {}
    for i in order:
        alive += left[i] > 0 and i not in together
        for arg in set(nodes[i].args):
            now[arg] = now.get(arg, left[arg]) - 1
            alive -= now[arg] == 0 and nodes[arg].value is None and arg not in together
        most = max(most, alive)
    return (alive, -len(order), most, target), order


def _renumbered(node: Node, place: dict[int, int]) -> Node:
    return Node(node.op, tuple(place[arg] for arg in node.args), node.value, node.name)


def _registers(nodes: tuple[Node, ...]) -> list[int]:
    """Registers that each node needs when nothing is shared; constants need none."""
    needs: list[int] = []
    for node in nodes:
        if not node.args:
            needs.append(0 if node.op is Op.CONST else 1)
            continue
        wanted = sorted((needs[arg] for arg in set(node.args)), reverse=True)
        needs.append(max(1, *(need + k for k, need in enumerate(wanted))))
    return needs
