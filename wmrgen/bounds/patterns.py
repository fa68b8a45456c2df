"""Shapes in the node list whose error is far smaller than that of their operations one by one."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from wmrgen.exact.number import ONE, Exact
from wmrgen.ir.nodes import Node, Op

_MOST_ROUNDINGS = 200


@dataclass(frozen=True, slots=True)
class Term:
    """``factor`` times the square of node ``base`` (``squared``) or node ``base`` itself; ``roundings`` on its way."""

    factor: Exact
    base: int
    squared: bool
    roundings: int

    @classmethod
    def whole(cls, root: int) -> Term:
        """The argument of a root as one term."""
        return cls(ONE, root, False, 0)


def terms_below_root(nodes: Sequence[Node], root: int) -> tuple[Term, ...]:
    """The argument of a square root as a sum of terms with positive factors."""
    found: list[Term] = []
    stack = [(root, ONE, 0)]
    while stack:
        i, factor, roundings = stack.pop()
        node = nodes[i]
        product = scaled(nodes, node)
        if node.op is Op.ADD and roundings < _MOST_ROUNDINGS:
            stack += [(a, factor, roundings + 1) for a in reversed(node.args)]
        elif node.op is Op.MUL and (square := _square(nodes, node)) is not None:
            scale, base, extra = square
            found.append(Term(factor * scale, base, True, roundings + extra))
        elif product is not None and product[0].sign > 0:
            # The constant's own rounding counts as one, the product as another.
            stack.append((product[1], factor * product[0], roundings + 2))
        else:
            found.append(Term(factor, i, False, roundings))
    return tuple(found)


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


def sinc_argument(nodes: Sequence[Node], node: Node) -> int | None:
    """x of sin(x) / x, or of a product sin(x) (1/x)."""
    if node.op is Op.DIV:
        sine, x = nodes[node.args[0]], node.args[1]
        return x if sine.op is Op.SIN and sine.args[0] == x else None
    for s, d in (node.args, node.args[::-1]):
        if nodes[s].op is Op.SIN and inverted(nodes, d) == nodes[s].args[0]:
            return nodes[s].args[0]
    return None


def extremum(nodes: Sequence[Node], node: Node) -> tuple[Op, int, int] | None:
    """(MIN or MAX, a, b) of a comparison that chooses between the numbers compared."""
    a, b = node.args[0], node.args[1]
    if node.op in (Op.MIN, Op.MAX):
        return node.op, a, b
    if node.op is Op.SELECT:
        x, y = node.args[2], node.args[3]
        if _same(nodes, x, b) and _same(nodes, y, a):
            return Op.MAX, a, b
        if _same(nodes, x, a) and _same(nodes, y, b):
            return Op.MIN, a, b
    return None


def largest_of(nodes: Sequence[Node], i: int) -> int | None:
    """Node ``i``, or x where it is the larger of x and a constant."""
    if nodes[i].op not in (Op.SELECT, Op.MAX, Op.MIN):
        return i
    found = extremum(nodes, nodes[i])
    choices = [k for k in found[1:] if nodes[k].value is None] if found and found[0] is Op.MAX else []
    return choices[0] if len(choices) == 1 else None


def _same(nodes: Sequence[Node], a: int, b: int) -> bool:
    return a == b or (nodes[a].value is not None and nodes[a].value == nodes[b].value)


def size_of(nodes: Sequence[Node], size: int, value: int) -> tuple[float, bool] | None:
    """(s, squared) where node ``size`` is s z z or s |z|, s > 0, for z the multiple c z that ``value`` is."""
    scale, inner = without_factors(nodes, size)
    factor, base = without_factors(nodes, value)
    node = nodes[inner]
    if scale.sign <= 0 or not factor:
        return None
    squared = node.op is Op.MUL and node.args[0] == node.args[1]
    if node.op is Op.ABS or squared:
        f, z = without_factors(nodes, node.args[0])
        if z == base and f:
            ratio = abs(float(f) / float(factor))
            return float(scale) * (ratio * ratio if squared else ratio), squared
    return None


def without_factors(nodes: Sequence[Node], i: int) -> tuple[Exact, int]:
    """(c, x) where node ``i`` is c x up to rounding, through constant factors and signs."""
    factor = ONE
    while True:
        node = nodes[i]
        product = scaled(nodes, node)
        if product is not None:
            factor, i = factor * product[0], product[1]
        elif node.op is Op.NEG:
            factor, i = -factor, node.args[0]
        else:
            return factor, i


def parity(nodes: Sequence[Node], node: Node) -> bool:
    """Whether the node is w - 2 rint(w / 2), w whole: -1, 0 or 1."""
    if node.op is not Op.SUB or nodes[node.args[0]].op.value != "rint":
        return False
    double = scaled(nodes, nodes[node.args[1]])
    if double is None or double[0] != Exact(2) or nodes[double[1]].op.value != "rint":
        return False
    half = scaled(nodes, nodes[nodes[double[1]].args[0]])
    return half is not None and half[0] == Exact(1) / Exact(2) and half[1] == node.args[0]


def nearest_turn(nodes: Sequence[Node], node: Node) -> tuple[Exact, int, int, int] | None:
    """(s, x, p, r) of x - s rint(r), r = k (x - p), k s within 1e-9 of 1: the x modulo s that is nearest to p."""
    if node.op is not Op.SUB:
        return None
    x = node.args[0]
    steps = scaled(nodes, nodes[node.args[1]])
    if steps is None or nodes[steps[1]].op.value != "rint":
        return None
    r = nodes[steps[1]].args[0]
    share = scaled(nodes, nodes[r])
    if share is None or abs(float(share[0] * steps[0]) - 1) > 1e-9:
        return None
    difference = nodes[share[1]]
    if difference.op is not Op.SUB or difference.args[0] != x:
        return None
    return steps[0], x, difference.args[1], r


def cone(nodes: Sequence[Node], roots: Collection[int], stop: Collection[int] = ()) -> set[int]:
    """Nodes that ``roots`` need, up to those of ``stop``."""
    found, stack = set[int](), list(roots)
    while stack:
        k = stack.pop()
        if k not in found:
            found.add(k)
            stack += () if k in stop else nodes[k].args
    return found


def inverted(nodes: Sequence[Node], k: int) -> int | None:
    """D of 1/D."""
    node = nodes[k]
    return node.args[1] if node.op is Op.DIV and nodes[node.args[0]].value == ONE else None


def quotient(nodes: Sequence[Node], k: int) -> tuple[int, int] | None:
    """(N, D) of N / D, or of N (1/D)."""
    if nodes[k].op is Op.DIV:
        above, below = nodes[k].args
        return above, below
    for above, inverse in (nodes[k].args, nodes[k].args[::-1]) if nodes[k].op is Op.MUL else ():
        divisor = inverted(nodes, inverse)
        if divisor is not None:
            return above, divisor
    return None


def contracted(nodes: Sequence[Node]) -> dict[int, int]:
    """Products with several uses, a sum among them that a compiler may contract with it (fused multiply-add): uses."""
    uses: dict[int, list[Op]] = {}
    for node in nodes:
        for k in set(node.args):
            if nodes[k].op is Op.MUL:
                uses.setdefault(k, []).append(node.op)
    return {k: len(ops) for k, ops in uses.items() if len(ops) > 1 and (Op.ADD in ops or Op.SUB in ops)}
