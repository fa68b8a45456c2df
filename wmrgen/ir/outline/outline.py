"""The functions with their repeated parts replaced by calls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.outline.graph import Graph
from wmrgen.ir.outline.grow import best
from wmrgen.ir.outline.pattern import Pattern
from wmrgen.ir.outline.sizes import Sizes
from wmrgen.ir.outline.undo import calls, inline
from wmrgen.ir.passes.pressure import nearest
from wmrgen.ir.prune import pruned


@dataclass(frozen=True, slots=True)
class Outlined:
    """``parts``: functions of x0, x1, ... that the others call."""

    functions: tuple[Function, ...]
    parts: tuple[Function, ...]


def outline(functions: Sequence[Function], name: str, sizes: Sizes) -> Outlined:
    """``functions`` over parts that are written once, called ``name`` and a number."""
    made, parts, count = list(functions), list[Function](), 0
    while (found := best(graph := Graph(made), sizes)) is not None:
        part = Function(f"{name}_{count}", (), found.body, (), found.results)
        made = _replaced(graph, found, part.name, made)
        inner = calls(part.nodes)
        taken = {p.name: p for p in parts if p.name in inner}
        part, made = _lean(inline(part, taken), made)
        parts = [*(p for p in parts if p.name not in inner), part]
        count += 1
    return _numbered(made, parts, name)


def _lean(part: Function, functions: Sequence[Function]) -> tuple[Function, list[Function]]:
    """``part`` without what no result needs, and calls of it without the arguments that were only for that.

    A part put in the place of a call may have more results than the call had uses for.
    """
    part = pruned(part)
    kept = sorted(_number(node) for node in part.nodes if node.op is Op.INPUT)
    names = {k: f"x{i}" for i, k in enumerate(kept)}
    body = tuple(replace(n, name=names[_number(n)]) if n.op is Op.INPUT else n for n in part.nodes)

    def over(node: Node) -> Node:
        called = node.op is Op.CALL and node.name == part.name
        return replace(node, args=tuple(node.args[k] for k in kept)) if called else node

    changed = [pruned(replace(f, nodes=tuple(map(over, f.nodes)))) for f in functions]
    return replace(part, nodes=body), changed


def _number(node: Node) -> int:
    """Which parameter of a part."""
    return int((node.name or "x0")[1:])


def _numbered(functions: Sequence[Function], parts: Sequence[Function], name: str) -> Outlined:
    """The parts called ``name`` 1, 2, ... in their order."""
    names = {part.name: f"{name}{k}" for k, part in enumerate(parts, 1)}

    def renamed(function: Function) -> Function:
        nodes = (replace(n, name=names[n.name or ""]) if n.op is Op.CALL else n for n in function.nodes)
        return nearest(replace(function, name=names.get(function.name, function.name), nodes=tuple(nodes)))

    return Outlined(tuple(map(renamed, functions)), tuple(map(renamed, parts)))


def _replaced(graph: Graph, found: Pattern, name: str, functions: Sequence[Function]) -> list[Function]:
    nodes = list(graph.nodes)
    instead: dict[int, int] = {}
    for made in found.calls:
        call = len(nodes)
        nodes.append(Node(Op.CALL, made.given, name=name))
        for n, i in made.results.items():
            if len(found.results) == 1:
                instead.setdefault(i, call)
                continue
            instead.setdefault(i, len(nodes))
            nodes.append(Node(Op.PART, (call,), name=str(n)))
    rewritten = []
    for function, results, names in zip(functions, graph.results, graph.names, strict=True):
        place, kept = _in_order(nodes, results, instead)
        known = ((label, place.get(instead.get(i, i))) for label, i in names)
        named = tuple((label, k) for label, k in known if k is not None)
        roots = tuple(place[instead.get(r, r)] for r in results)
        rewritten.append(replace(function, nodes=kept, results=roots, named=named))
    return rewritten


def _in_order(
    nodes: Sequence[Node], results: Sequence[int], instead: dict[int, int]
) -> tuple[dict[int, int], tuple[Node, ...]]:
    """What ``results`` need, arguments first, and where each node stands."""
    place: dict[int, int] = {}
    kept: list[Node] = []
    for result in results:
        stack = [instead.get(result, result)]
        while stack:
            i = stack[-1]
            if i in place:
                stack.pop()
                continue
            args = [instead.get(a, a) for a in nodes[i].args]
            waiting = [a for a in args if a not in place]
            if waiting:
                stack += reversed(waiting)
                continue
            stack.pop()
            place[i] = len(kept)
            kept.append(Node(nodes[i].op, tuple(place[a] for a in args), nodes[i].value, nodes[i].name))
    return place, tuple(kept)
