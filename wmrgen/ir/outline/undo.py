"""A call replaced by what is called: for parts that only one place still calls, and to see that nothing changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

from wmrgen.ir.nodes import Function, Node, Op


def calls(nodes: Iterable[Node]) -> Counter[str]:
    """How often each part is called."""
    return Counter(node.name or "" for node in nodes if node.op is Op.CALL)


def inline(function: Function, parts: Mapping[str, Function]) -> Function:
    """``function`` without calls of ``parts``, which may call each other."""
    nodes: list[Node] = []
    results: dict[int, tuple[int, ...]] = {}  # call -> where its results are now
    place: list[int] = []
    for k, node in enumerate(function.nodes):
        args = tuple(place[a] for a in node.args)
        part = parts.get(node.name or "") if node.op is Op.CALL else None
        if part is not None:
            inner = inline(part, parts)
            results[k] = _copied(nodes, inner, args)
            place.append(results[k][0])
        elif node.op is Op.PART and node.args[0] in results:
            place.append(results[node.args[0]][int(node.name or 0)])
        else:
            place.append(len(nodes))
            nodes.append(Node(node.op, args, node.value, node.name))
    named = tuple((name, place[k]) for name, k in function.named)
    return replace(
        function, nodes=tuple(nodes), results=tuple(place[r] for r in function.results), named=named
    )


def _copied(nodes: list[Node], part: Function, given: tuple[int, ...]) -> tuple[int, ...]:
    """The nodes of ``part`` over ``given`` at the end of ``nodes``; where its results stand."""
    place: list[int] = []
    for node in part.nodes:
        if node.op is Op.INPUT:
            place.append(given[int((node.name or "x0")[1:])])
            continue
        place.append(len(nodes))
        nodes.append(Node(node.op, tuple(place[a] for a in node.args), node.value, node.name))
    return tuple(place[r] for r in part.results)
