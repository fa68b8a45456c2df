"""Calls of kernels: operations that keep their meaning, and what they stand for.

A node CALL names a kernel of its module (`Module.kernels`), which is a function over base operations and other calls.
`inlined_calls` puts the meaning in their place, for everything that knows base operations alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wmrgen.exact.number import ONE
from wmrgen.ir.nodes import Function, Module, Node, Op

Kernels = Mapping[str, Function]


def inlined_calls(module: Module) -> Module:
    """``module`` in base operations: every call replaced by what its kernel computes."""
    if not module.kernels:
        return module
    kernels = by_name(module.kernels)
    return replace(module, functions=tuple(inlined(f, kernels) for f in module.functions), kernels=())


def by_name(kernels: Sequence[Function]) -> Kernels:
    """Kernels by name, each without calls."""
    found: dict[str, Function] = {}
    for kernel in kernels:
        found[kernel.name] = inlined(kernel, found)
    return found


def called(functions: Sequence[Function]) -> frozenset[str]:
    """The kernels that ``functions`` call themselves."""
    return frozenset(node.name or "" for f in functions for node in f.nodes if node.op is Op.CALL)


def inlined(function: Function, kernels: Kernels) -> Function:
    """``function`` without calls of ``kernels``, which have none themselves; equal operations once."""
    return with_places(function, kernels)[0]


def with_places(function: Function, kernels: Kernels) -> tuple[Function, Sequence[int]]:
    """As `inlined`, and where the value of each node is then; of a call that of its first result."""
    if not any(node.op is Op.CALL for node in function.nodes):
        return function, range(len(function.nodes))
    nodes: list[Node] = []
    index: dict[Node, int] = {}
    place: list[int] = []
    results: dict[int, tuple[int, ...]] = {}  # a call -> where its results are

    def put(node: Node, args: tuple[int, ...]) -> int:
        if node.op is Op.MUL:
            for factor, other in (args, args[::-1]):
                if nodes[factor].value == ONE:
                    return other  # to the bit
        new = node if args == node.args else Node(node.op, args, node.value, node.name)
        found = index.setdefault(new, len(nodes))
        if found == len(nodes):
            nodes.append(new)
        return found

    for k, node in enumerate(function.nodes):
        if node.op is Op.CALL:
            kernel = kernels[node.name or ""]
            given = dict(zip((p.name for p in kernel.inputs), (place[a] for a in node.args), strict=True))
            inner: list[int] = []
            for step in kernel.nodes:
                name = step.name if step.op is Op.INPUT else None
                inner.append(given[name] if name else put(step, tuple(inner[a] for a in step.args)))
            results[k] = tuple(inner[r] for r in kernel.results)
            place.append(results[k][0])
        elif node.op is Op.RESULT:
            place.append(results[node.args[0]][int(node.name or 0)])
        else:
            place.append(put(node, tuple(place[a] for a in node.args)))
    named = tuple((name, place[k]) for name, k in function.named)
    at = tuple(place[r] for r in function.results)
    return replace(function, nodes=tuple(nodes), results=at, named=named), place
