"""What the lemmas ask of the node list: sums of squares below a root, and how far a value counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.ir.nodes import Function, Node, Op, uses_of

_MOST_ROUNDINGS = 200


class Term(NamedTuple):
    """``factor`` times the square of node ``base`` (``squared``) or node ``base`` itself; ``roundings`` on its way."""

    factor: Exact
    base: int
    squared: bool
    roundings: int


def terms_below_root(nodes: Sequence[Node], root: int) -> tuple[Term, ...]:
    """The argument of a square root as a sum of terms with positive factors."""
    terms: list[Term] = []
    stack = [(root, ONE, 0)]
    while stack:
        i, factor, roundings = stack.pop()
        node = nodes[i]
        product = scaled(nodes, node)
        if node.op is Op.ADD and roundings < _MOST_ROUNDINGS:
            stack += [(a, factor, roundings + 1) for a in reversed(node.args)]
        elif node.op is Op.MUL and (square := _square(nodes, node)) is not None:
            scale, base, extra = square
            terms.append(Term(factor * scale, base, True, roundings + extra))
        elif product is not None and product[0].sign > 0:
            # The constant's own rounding counts as one, the product as another.
            stack.append((product[1], factor * product[0], roundings + 2))
        else:
            terms.append(Term(factor, i, False, roundings))
    return tuple(terms)


def scaled(nodes: Sequence[Node], node: Node) -> tuple[Exact, int] | None:
    """(c, x) of a product c x."""
    if node.op is Op.MUL:
        for c, x in (node.args, node.args[::-1]):
            value = nodes[c].value
            if value is not None:
                return value, x
    return None


def _square(nodes: Sequence[Node], node: Node) -> tuple[Exact, int, int] | None:
    """(c, x, roundings) of x x or (c x) x with c > 0."""
    a, b = node.args
    if a == b:
        return ONE, a, 1
    for p, x in ((a, b), (b, a)):
        product = scaled(nodes, nodes[p])
        if product is not None and product[1] == x and product[0].sign > 0:
            return product[0], x, 3
    return None


def contracted(nodes: Sequence[Node]) -> frozenset[int]:
    """Products with several uses, a sum among them that a compiler may contract with it (fused multiply-add)."""
    uses: dict[int, list[Op]] = {}
    for node in nodes:
        for k in set(node.args):
            if nodes[k].op is Op.MUL:
                uses.setdefault(k, []).append(node.op)
    return frozenset(k for k, ops in uses.items() if len(ops) > 1 and (Op.ADD in ops or Op.SUB in ops))


def effective(function: Function) -> dict[int, tuple[float, float]]:
    """(low, high) by node: outside, the node changes nothing, for its one use is the minimum with a number, say."""
    nodes, uses = function.nodes, uses_of(function)
    ranges: dict[int, tuple[float, float]] = {}
    for i in range(len(nodes) - 1, -1, -1):
        op, args, product = nodes[i].op, nodes[i].args, scaled(nodes, nodes[i])
        if op is Op.CLAMP and uses[args[0]] == 1:
            most = float(nodes[args[1]].value or float("inf"))
            ranges[args[0]] = -most, most
        if product is not None and i in ranges and uses[product[1]] == 1 and product[0]:
            ends = sorted(end / float(product[0]) for end in ranges[i])
            ranges[product[1]] = ends[0], ends[1]
        if op not in (Op.MIN, Op.MAX):
            continue
        low, high = ranges.get(i, (-float("inf"), float("inf")))
        for end, x in (args, args[::-1]):
            value = nodes[end].value
            if value is not None and uses[x] == 1:
                least = op is Op.MIN
                ranges[x] = (low, min(high, float(value))) if least else (max(low, float(value)), high)
    return ranges
