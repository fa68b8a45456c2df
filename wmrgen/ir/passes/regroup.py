"""Products of three factors bracketed so that their common part is computed once.

c (x y) and c (x z) become (c x) y and (c x) z where nothing else uses x y and x z.
"""

from __future__ import annotations

from collections import Counter, defaultdict

from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Op


def regroup_products(function: Function) -> Function:
    """``function`` with fewer multiplications by constants and geometry-only values."""
    chosen = _choices(function)
    if not chosen:
        return function
    builder = Builder()
    made: list[int] = []
    for i, node in enumerate(function.nodes):
        if i in chosen:
            scalar, common, other = (made[arg] for arg in chosen[i])
            made.append(builder.make(Op.MUL, (_product(builder, scalar, common), other)))
        elif node.op in (Op.CONST, Op.INPUT):
            made.append(builder.copy(node, ()))
        else:
            made.append(builder.again(node, [made[arg] for arg in node.args]))
    results = [made[result] for result in function.results]
    return builder.function(function.name, function.inputs, function.outputs, results, function.text)


def _product(builder: Builder, scalar: int, common: int) -> int:
    return builder.make(Op.MUL, (scalar, common))


def _choices(function: Function) -> dict[int, tuple[int, int, int]]:
    """Node of c (x y) to (c, x, y), for every (c, x) that occurs twice."""
    nodes, known = function.nodes, geometry_only(function)
    uses = Counter(arg for node in nodes for arg in node.args)
    uses.update(function.results)
    found: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for i, node in enumerate(nodes):
        if node.op is not Op.MUL or known[i]:
            continue
        for scalar, product in (node.args, node.args[::-1]):
            inner = nodes[product]
            if known[scalar] and inner.op is Op.MUL and not known[product] and uses[product] == 1:
                a, b = inner.args
                if not known[a] and not known[b]:
                    found[scalar, a].append((i, b))
                    if a != b:
                        found[scalar, b].append((i, a))
    chosen: dict[int, tuple[int, int, int]] = {}
    for (scalar, common), places in sorted(found.items(), key=lambda item: (-len(item[1]), item[0])):
        free = [(i, other) for i, other in places if i not in chosen]
        if len(free) > 1:
            chosen.update({i: (scalar, common, other) for i, other in free})
    return chosen
