"""Patterns that the analysis of bounds recognises in a node list.

Sums of squares below a square root, products with a constant, products that a compiler may contract, nodes whose
result is limited afterwards, and divisions by the length of a vector. Every function here reads the node list alone;
`wmrgen.ir.bounds.walk` combines what they find with ranges and errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.ir.nodes import Function, Node, Op, uses_of

Parts = tuple[tuple[float, int], ...]  # (f, x): the components f * (node x) of a vector
# (s, a): the absolute value of a node is at most s h + a, h the length of a vector.
Share = tuple[float, float]

# Errors are claimed where the vector is this many times longer than its own error [1]. Its length then changes by at
# most 1/64 while rounding errors grow from zero to their full size.
SMALL_ANGLE = 64.0
# The error of a length is taken to be at least this [unit of the vector]: a vector of exact components has none.
SHORT = 2.0**-40
# Factor for what the roundings of a length or of a product add to it [1]: far more than 200 roundings of 2**-24.
ROUNDINGS_OF_LENGTH = 1 + 1e-5
_UNDERFLOW = 2.0**-150  # error of the square of a float32 that underflows: half the least subnormal
# A divisor is kept above this many times the length that underflow may lose [1]: the loss is then 2 % of it.
_GUARD_ABOVE_LOSS = 50.0
_MOST_ROUNDINGS = 200  # additions that are followed below a root; what is below more of them is one term


# ---- sums below a square root


class Term(NamedTuple):
    """A term of the sum below a square root."""

    factor: Exact  # positive
    base: int  # the node that is squared, or the term itself
    squared: bool  # whether the term is factor * base**2; otherwise it is factor * base
    roundings: int  # how many roundings the term passes before the root is taken


def terms_below_root(nodes: Sequence[Node], root: int) -> tuple[Term, ...]:
    """Return the argument ``root`` of a square root as a sum of terms with positive factors."""
    terms: list[Term] = []
    stack = [(root, ONE, 0)]
    while stack:
        i, factor, roundings = stack.pop()
        node = nodes[i]
        product = constant_multiple(nodes, node)
        square = _square(nodes, node) if node.op is Op.MUL else None
        if node.op is Op.ADD and roundings < _MOST_ROUNDINGS:
            stack += [(a, factor, roundings + 1) for a in reversed(node.args)]
        elif square is not None:
            scale, base, extra = square
            terms.append(Term(factor * scale, base, True, roundings + extra))
        elif product is not None and product[0].sign > 0:
            # The constant's own rounding counts as one, the product as another.
            stack.append((product[1], factor * product[0], roundings + 2))
        else:
            terms.append(Term(factor, i, False, roundings))
    return tuple(terms)


def constant_multiple(nodes: Sequence[Node], node: Node) -> tuple[Exact, int] | None:
    """Return (c, x) if ``node`` is the product of a constant c and node x, otherwise None."""
    if node.op is Op.MUL:
        for c, x in (node.args, node.args[::-1]):
            value = nodes[c].value
            if value is not None:
                return value, x
    return None


def _square(nodes: Sequence[Node], node: Node) -> tuple[Exact, int, int] | None:
    """Return (c, x, number of roundings) if ``node`` is x x or (c x) x with c > 0, otherwise None."""
    a, b = node.args
    if a == b:
        return ONE, a, 1
    for p, x in ((a, b), (b, a)):
        product = constant_multiple(nodes, nodes[p])
        if product is not None and product[1] == x and product[0].sign > 0:
            return product[0], x, 3
    return None


# ---- how nodes are used


def contracted(nodes: Sequence[Node]) -> frozenset[int]:
    """Return the products with several uses, at least one of them a sum.

    A compiler may contract the product with the sum (fused multiply-add). The sum then sees another rounding of the
    product than the other users do.
    """
    users: dict[int, list[Op]] = {}
    for node in nodes:
        for k in set(node.args):
            if nodes[k].op is Op.MUL:
                users.setdefault(k, []).append(node.op)
    return frozenset(k for k, ops in users.items() if len(ops) > 1 and (Op.ADD in ops or Op.SUB in ops))


def effective(function: Function) -> dict[int, tuple[float, float]]:
    """Return by node the range (low, high) outside which its value changes no result.

    A node has such a range if its only user is the minimum or maximum with a constant, a clamp, or a product with a
    constant that has such a range itself.
    """
    nodes, uses = function.nodes, uses_of(function)
    ranges: dict[int, tuple[float, float]] = {}
    for i in range(len(nodes) - 1, -1, -1):
        op, args, product = nodes[i].op, nodes[i].args, constant_multiple(nodes, nodes[i])
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
                if op is Op.MIN:
                    ranges[x] = low, min(high, float(value))
                else:
                    ranges[x] = max(low, float(value)), high
    return ranges


# ---- divisions by the length of a vector


@dataclass(slots=True)
class Length:
    """The length h of a vector by which a node divides, or whose direction the node is."""

    parts: Parts  # the components of the vector
    error: float = SHORT  # how far h may be off; the walk sets it when it reaches the division
    # By node; filled by the walk as it is needed.
    shares: dict[int, Share | None] = field(default_factory=dict)
    facts: list[tuple[int, float]] = field(default_factory=list)  # (x, s): |node x| is at most s h

    def value(self, nodes: Sequence[np.ndarray]) -> np.ndarray:
        """Return h for the given values of the nodes."""
        return np.asarray(np.sqrt(sum((f * nodes[x]) ** 2 for f, x in self.parts)))


def lengths(nodes: Sequence[Node]) -> dict[int, Length]:
    """Return by node the length by which it divides: of each atan2, and of each division by a guarded length."""
    by_node = {}
    for i, node in enumerate(nodes):
        parts: Parts | None = None
        if node.op is Op.ATAN2:
            parts = (1.0, node.args[0]), (1.0, node.args[1])
        elif node.op is Op.DIV:
            parts = _guarded_length(nodes, node.args[1])
        if parts is not None:
            known: list[tuple[int, float]] = []
            for f, x in parts:
                known += facts(nodes, x, 1 / f)
            by_node[i] = Length(parts, facts=known)
    return by_node


def facts(nodes: Sequence[Node], x: int, s: float) -> list[tuple[int, float]]:
    """Return what |node x| <= s h implies.

    Args:
        nodes: the nodes.
        x: the node.
        s: the factor of the length h.

    Returns:
        (node, factor of h): the fact itself and, if x = c y, the same of y.
    """
    product = constant_multiple(nodes, nodes[x])
    if product is None or not product[0]:
        return [(x, s)]
    return [(x, s), (product[1], s / abs(float(product[0])) * ROUNDINGS_OF_LENGTH)]


def _guarded_length(nodes: Sequence[Node], divisor: int) -> Parts | None:
    """Return the vector to whose length, or more, ``divisor`` is equal; None if it is no guarded length.

    Guarded means that the divisor is kept above a constant that is too small to matter.
    """
    node = nodes[divisor]
    if node.op is Op.ADD:  # a guarded length and another length
        for k, other in (node.args, node.args[::-1]):
            parts = _guarded_length(nodes, k)
            if parts is not None and length_of(nodes, other) is not None:
                return parts
    choices: list[tuple[int, Parts | None]] = []
    if node.op is Op.AT_LEAST:
        choices = [(node.args[1], ((1.0, node.args[0]),))]
    elif node.op is Op.MAX:
        choices = [(least, length_of(nodes, x)) for least, x in (node.args, node.args[::-1])]
    for least, parts in choices:
        value = nodes[least].value
        if value is None or parts is None:
            continue
        if _GUARD_ABOVE_LOSS * underflow(parts) <= float(value) <= SMALL_ANGLE * SHORT:
            return parts
    return None


def underflow(parts: Parts) -> float:
    """Return how much of the length of a vector is lost at most when its squares underflow."""
    if len(parts) == 1:
        return 0.0
    return float(np.sqrt(2 * sum(1 + f * f for f, _ in parts) * _UNDERFLOW))


def length_of(nodes: Sequence[Node], i: int) -> Parts | None:
    """Return the vector whose length node ``i`` is (an absolute value, a root of squares), otherwise None."""
    node = nodes[i]
    if node.op is Op.ABS:
        return ((1.0, node.args[0]),)
    if node.op is Op.SQRT:
        terms = terms_below_root(nodes, node.args[0])
        if all(t.squared for t in terms):
            return tuple((float(t.factor) ** 0.5, t.base) for t in terms)
    return None
