"""Dropping what no result needs."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.ir.nodes import Node


def prune(nodes: Sequence[Node], results: Sequence[int]) -> tuple[tuple[Node, ...], tuple[int, ...]]:
    """The nodes that ``results`` need, renumbered in their order, and the renumbered results."""
    live = bytearray(len(nodes))
    for result in results:
        live[result] = 1
    for i in range(len(nodes) - 1, -1, -1):
        if live[i]:
            for arg in nodes[i].args:
                live[arg] = 1
    renamed: dict[int, int] = {}
    kept: list[Node] = []
    for i, node in enumerate(nodes):
        if live[i]:
            renamed[i] = len(kept)
            args = tuple(renamed[arg] for arg in node.args)
            kept.append(node if args == node.args else Node(node.op, args, node.value, node.name))
    return tuple(kept), tuple(renamed[result] for result in results)
