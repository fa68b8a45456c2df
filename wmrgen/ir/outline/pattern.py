"""A part that repeats, and what it saves to write it once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from wmrgen.ir.nodes import Node, Op
from wmrgen.ir.outline.graph import Graph
from wmrgen.ir.outline.match import matches
from wmrgen.ir.outline.sizes import LEAST_OPERATIONS, MOST_PARAMETERS, MOST_RESULTS, Sizes
from wmrgen.ir.outline.undo import calls

Place = tuple[int, ...]  # the nodes of one place; the same position in every place: the same operation


@dataclass(frozen=True, slots=True)
class Call:
    """``given``: the nodes handed in. ``results``: number of the result -> the node that it replaces."""

    given: tuple[int, ...]
    results: Mapping[int, int]


@dataclass(frozen=True, slots=True)
class Pattern:
    """``body``: inputs x0, x1, ... first, then constants, then the operations; ``results``: nodes of it."""

    calls: tuple[Call, ...]
    body: tuple[Node, ...]
    results: tuple[int, ...]
    saved: int


def pattern(graph: Graph, places: Sequence[Place], sizes: Sizes) -> Pattern | None:
    """The function that computes what stands at all ``places``; None when it would save nothing."""
    if len(places[0]) < LEAST_OPERATIONS:
        return None
    parameters, body, where = _body(graph, places)
    outputs = _outputs(graph, places)
    if len(parameters) > MOST_PARAMETERS or not 0 < len(outputs) <= MOST_RESULTS:
        return None
    if any(i in graph.together for row in parameters for i in row):
        return None
    if any(place[k] in graph.together for place in places for k in outputs):
        return None
    gone = {i for place in places for i in place}
    inner = calls(graph.nodes[i] for i in gone)  # places may share a call
    if any(count < graph.calls[name] for name, count in inner.items()):
        return None  # a part within a part only where nothing else calls it: it is then written there
    constants = sum(node.op is Op.CONST for node in body)
    once = sizes.frame + sizes.constant * constants + sum(sizes.of(node) for node in body)
    call = sizes.call + sizes.move * (len(parameters) + len(outputs))
    before = sum(sizes.of(graph.nodes[i]) for i in gone) + sizes.constant * _constants(graph, gone)
    saved = before - once - call * len(places)
    if saved <= 0:
        return None
    made = tuple(
        Call(tuple(row[n] for row in parameters), {m: place[k] for m, k in enumerate(outputs)})
        for n, place in enumerate(places)
    )
    if not _in_turn(graph, made, [_mask(place) for place in places]):
        return None
    return Pattern(made, tuple(body), tuple(where[k] for k in outputs), saved)


def widened(graph: Graph, found: Pattern, sizes: Sizes) -> Pattern:
    """``found`` called where only some of its results are needed, too."""
    every, saved = list(found.calls), found.saved
    used = {i for call in every for i in call.results.values()}
    masks = [_mask(call.results.values()) for call in every]
    for given, results, gone in matches(graph, found.body, found.results):
        if used.intersection(results.values()):
            continue
        inner = {i for i in gone if gone.issuperset(graph.users[i])} | set(results.values())
        gain = sum(sizes.of(graph.nodes[i]) for i in inner) + sizes.constant * _constants(graph, inner)
        gain -= sizes.call + sizes.move * (len(given) + len(results))
        more = Call(given, results)
        if gain > 0 and _in_turn(graph, [*every, more], [*masks, _mask(results.values())]):
            every.append(more)
            masks.append(_mask(results.values()))
            used |= set(results.values())
            saved += gain
    return replace(found, calls=tuple(every), saved=saved)


def _mask(nodes: Iterable[int]) -> int:
    return sum(1 << i for i in set(nodes))


def _body(graph: Graph, places: Sequence[Place]) -> tuple[list[tuple[int, ...]], list[Node], dict[int, int]]:
    """Parameters (a node per place each), the nodes of the function, and where each position stands in it."""
    first = places[0]
    position = {i: k for k, i in enumerate(first)}
    given: dict[tuple[int, ...], int] = {}  # the nodes at all places -> parameter
    constants: dict[object, int] = {}
    plans: list[list[tuple[str, int]]] = []
    for k, i in enumerate(first):
        plan = []
        for n, arg in enumerate(graph.nodes[i].args):
            at = tuple(graph.nodes[place[k]].args[n] for place in places)
            inside = position.get(arg)
            value = graph.nodes[arg].value
            if inside is not None and all(a == place[inside] for a, place in zip(at, places, strict=True)):
                plan.append(("inside", inside))
            elif value is not None and all(graph.nodes[a].value == value for a in at):
                plan.append(("constant", constants.setdefault(value, len(constants))))
            else:
                plan.append(("given", given.setdefault(at, len(given))))
        plans.append(plan)
    body = [Node(Op.INPUT, name=f"x{n}") for n in range(len(given))]
    body += [Node(Op.CONST, value=value) for value in constants]  # type: ignore[arg-type]
    base = {"given": 0, "constant": len(given)}
    where: dict[int, int] = {}
    # Arguments first: the order of the nodes in the graph is such an order at every place.
    for k in sorted(range(len(first)), key=first.__getitem__):
        args = tuple(where[n] if kind == "inside" else base[kind] + n for kind, n in plans[k])
        node = graph.nodes[first[k]]
        where[k] = len(body)
        body.append(Node(node.op, args, node.value, node.name))
    return list(given), body, where


def _outputs(graph: Graph, places: Sequence[Place]) -> tuple[int, ...]:
    """Positions that something beyond the places needs, at any of them."""
    gone = {i for place in places for i in place}
    results = {r for row in graph.results for r in row}
    return tuple(
        k
        for k in range(len(places[0]))
        if any(place[k] in results or not gone.issuperset(graph.users[place[k]]) for place in places)
    )


def _constants(graph: Graph, gone: set[int]) -> int:
    """How many constants the functions need no more."""
    used = {a for i in gone for a in graph.nodes[i].args if graph.nodes[a].value is not None}
    return sum(gone.issuperset(graph.users[a]) for a in used)


def _in_turn(graph: Graph, calls: Sequence[Call], masks: Sequence[int]) -> bool:
    """Whether the calls can be put in an order: none is given what is computed from it, not by way of others."""
    needs: list[set[int]] = []
    for call in calls:
        above = 0
        for i in call.given:
            above |= graph.above[i]
        needs.append({k for k, mask in enumerate(masks) if above & mask})
    waiting = set(range(len(calls)))
    while waiting:
        ready = {n for n in waiting if not needs[n] & waiting}
        if not ready:
            return False
        waiting -= ready
    return True
