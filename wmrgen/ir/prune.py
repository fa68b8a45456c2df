"""Dropping what no result needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wmrgen.ir.nodes import Function, Node


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


def prune(nodes: Sequence[Node], results: Sequence[int]) -> tuple[tuple[Node, ...], tuple[int, ...]]:
    """The nodes that ``results`` need, renumbered in their order, and the renumbered results."""
    place = places(nodes, results)
    return _moved(nodes, place), tuple(place[result] for result in results)


def pruned(function: Function) -> Function:
    """``function`` with the nodes that its results need, and the names of these."""
    place = places(function.nodes, function.results)
    return replace(
        function,
        nodes=_moved(function.nodes, place),
        results=tuple(place[result] for result in function.results),
        named=tuple((name, place[k]) for name, k in function.named if k in place),
    )


def _moved(nodes: Sequence[Node], place: dict[int, int]) -> tuple[Node, ...]:
    if len(place) == len(nodes):
        return tuple(nodes)
    kept: list[Node] = []
    for i in place:
        node = nodes[i]
        args = tuple(place[arg] for arg in node.args)
        kept.append(node if args == node.args else Node(node.op, args, node.value, node.name))
    return tuple(kept)
