"""Where else a part stands, perhaps with some of its results alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wmrgen.ir.nodes import Node, Op
from wmrgen.ir.outline.graph import Graph

Match = tuple[tuple[int, ...], dict[int, int], set[int]]  # handed in, result -> node, all its nodes


def matches(graph: Graph, body: Sequence[Node], results: Sequence[int]) -> Iterator[Match]:
    """Every way in which nodes of ``graph`` are results of ``body``, found from each result in turn."""
    count = sum(node.op is Op.INPUT for node in body)
    for first, result in enumerate(results):
        for i, node in enumerate(graph.nodes):
            if node.op is not body[result].op:
                continue
            bound: dict[int, int] = {}
            if not _unified(graph, body, result, i, bound):
                continue
            found = {first: i}
            for n, other in enumerate(results):
                if n != first:
                    more = next(iter(_others(graph, body, other, bound)), None)
                    if more is not None:
                        found[n], bound = more
            if all(k in bound for k in range(count)):
                given = tuple(bound[k] for k in range(count))
                inside = {bound[k] for k in bound if body[k].args}
                yield given, dict(sorted(found.items())), inside


def _others(
    graph: Graph, body: Sequence[Node], result: int, bound: dict[int, int]
) -> Iterator[tuple[int, dict[int, int]]]:
    """Nodes that are ``result`` of the same call: reached upwards from what is known of it."""
    known = [bound[a] for a in body[result].args if a in bound and body[a].value is None]
    for i in dict.fromkeys(u for a in known for u in graph.users[a]):
        trial = dict(bound)
        if graph.nodes[i].op is body[result].op and _unified(graph, body, result, i, trial):
            yield i, trial


def _unified(graph: Graph, body: Sequence[Node], k: int, i: int, bound: dict[int, int]) -> bool:
    """Whether node ``i`` is what node ``k`` of ``body`` is; ``bound``: nodes of the body -> of the graph."""
    if k in bound:
        return bound[k] == i or (graph.nodes[i].value is not None and graph.nodes[i].value == body[k].value)
    wanted, node = body[k], graph.nodes[i]
    same = (wanted.op, wanted.value, wanted.name) == (node.op, node.value, node.name)
    if wanted.op is not Op.INPUT and not same:
        return False
    bound[k] = i
    if wanted.op is Op.INPUT:
        return True
    return all(_unified(graph, body, a, b, bound) for a, b in zip(wanted.args, node.args, strict=True))
