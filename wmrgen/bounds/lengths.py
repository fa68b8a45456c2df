"""Vectors that may vanish: quotients by their lengths have no bound of their own, but one in terms of the length.

A division whose divisor is no smaller than the length h of a vector, and an atan2, have a slope of at most 1/h. What is
multiplied by a value of at most s h on the way has no slope beyond s: `Length` says of which values that is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from wmrgen.bounds.forms import Forms
from wmrgen.bounds.interval import Interval, magnitude
from wmrgen.bounds.precision import Format
from wmrgen.bounds.shapes import extremum, scaled, terms_below_root
from wmrgen.ir.nodes import Node, Op

Share = tuple[float, float]  # (s, a): a value is at most s h + a

SMALL_ANGLE = 64.0  # errors are claimed where the vector is this much longer than its own error
SHORT = 2.0**-40  # the error of a length counts as this at least
MOVED = 1.05  # while rounding errors grow from nothing to what they are, values move so much apart from lengths at most
_UNDERFLOW = 2.0**-150  # what a square of floats may lose
_LEAST = 50.0  # times what a length loses by that: divisors are kept above
_ROOM = 1 + 1e-5  # the roundings of a length


@dataclass(slots=True)
class Length:
    """The length h of the vector with components f x over the ``parts`` (f, x); node ``at`` divides by it.

    ``rho``: how far h may be off, once it is known.
    """

    at: int
    parts: tuple[tuple[float, int], ...]
    rho: float = SHORT
    shares: dict[int, Share | None] = field(default_factory=dict)
    facts: list[tuple[int, float]] = field(
        default_factory=list
    )  # (x, s): |x| is at most s h where `at` counts

    def value(self, nodes: Sequence[np.ndarray]) -> np.ndarray:
        """h, from the values of the nodes."""
        return np.asarray(np.sqrt(sum((f * nodes[x]) ** 2 for f, x in self.parts)))


def lengths(nodes: Sequence[Node]) -> dict[int, Length]:
    """The lengths by which nodes divide, by node."""
    by_node = {}
    for i, node in enumerate(nodes):
        parts: tuple[tuple[float, int], ...] | None = None
        if node.op is Op.ATAN2:
            parts = (1.0, node.args[0]), (1.0, node.args[1])
        elif node.op is Op.DIV:
            parts = _kept_apart(nodes, node.args[1])
        if parts is not None:
            by_node[i] = Length(i, parts, facts=[fact for f, x in parts for fact in facts(nodes, x, 1 / f)])
    return by_node


def facts(nodes: Sequence[Node], x: int, s: float) -> list[tuple[int, float]]:
    """That |x| is at most s h, and of a product x = c y what that says of y."""
    product = scaled(nodes, nodes[x])
    inner = [(product[1], s / abs(float(product[0])) * _ROOM)] if product is not None and product[0] else []
    return [(x, s), *inner]


def _kept_apart(nodes: Sequence[Node], divisor: int) -> tuple[tuple[float, int], ...] | None:
    """The vector whose length the divisor is, or more, but for being kept above a small number."""
    limit = extremum(nodes, nodes[divisor])
    if limit is not None and limit[0] is Op.MAX:
        for least, x in (limit[1:], limit[:0:-1]):
            value = nodes[least].value
            parts = None if value is None else _below(nodes, x)
            if value is not None and parts is not None and float(value) >= _LEAST * lost(parts):
                return parts
    return None


def lost(parts: Sequence[tuple[float, int]]) -> float:
    """How much of a length underflow may take."""
    return float(np.sqrt(2 * sum(1 + f * f for f, _ in parts) * _UNDERFLOW)) if len(parts) > 1 else 0.0


def _below(nodes: Sequence[Node], i: int) -> tuple[tuple[float, int], ...] | None:
    """A vector whose length node ``i`` is at least: a length, an absolute value, a sum of such."""
    node = nodes[i]
    if node.op is Op.ABS:
        return ((1.0, node.args[0]),)
    if node.op is Op.SQRT:
        terms = terms_below_root(nodes, node.args[0])
        return (
            tuple((float(t.factor) ** 0.5, t.base) for t in terms) if all(t.squared for t in terms) else None
        )
    if node.op is Op.ADD:
        parts = [_below(nodes, k) for k in node.args]
        return None if None in parts else max((p for p in parts if p is not None), key=len)
    return None


class Known(Protocol):
    """What a walk knows of the nodes so far: their ranges, and which are multiples of each other."""

    @property
    def nodes(self) -> Sequence[Node]: ...

    @property
    def ranges(self) -> Sequence[Interval]: ...

    forms: Forms
    form: Format


def share(w: Known, length: Length, i: int) -> Share | None:
    """(s, a) where |node i| is at most s h + a; None where nothing is known. Roundings count."""
    if i not in length.shares:
        length.shares[i] = None
        length.shares[i] = _component(w, length, i) or _computed(w, length, i) or _multiple(w, length, i)
    return length.shares[i]


def _component(w: Known, length: Length, i: int) -> Share | None:
    """Of a component of the vector, or of y - x where x - y is one."""
    node = w.nodes[i]
    for x, s in length.facts:
        other = w.nodes[x]
        if i == x or (node.op is other.op is Op.SUB and node.args == other.args[::-1]):
            return s * _ROOM, 0.0
    return None


def _multiple(w: Known, length: Length, i: int) -> Share | None:
    """Of what is a multiple of a component as a formula, but is rounded apart."""
    form = w.forms.list[i]
    for x, s in length.facts:
        other = w.forms.list[x]
        c = form.proportional(other)
        if c is not None:
            return s * abs(c) * _ROOM, float(abs(c) * other.slack.max() + form.slack.max())
    return None


def _computed(w: Known, length: Length, i: int) -> Share | None:
    """Of what an operation makes of such values."""
    node = w.nodes[i]
    if node.value is not None:
        return None if node.value else (0.0, 0.0)
    if node.op in (Op.NEG, Op.ABS, Op.FLIP):
        return share(w, length, node.args[0])
    if node.op is Op.SQRT:
        return (_ROOM, lost(length.parts)) if _below(w.nodes, i) == length.parts else None
    if node.op is Op.MUL:
        for k, other in (node.args, node.args[::-1]):
            inner = share(w, length, k)
            if inner is not None:
                most = float(magnitude(w.ranges[other]).max()) * _ROOM
                return inner[0] * most, inner[1] * most + w.form.tiny
        return None
    if node.op not in (Op.SELECT, Op.MIN, Op.MAX, Op.ADD, Op.SUB):
        return None
    parts = [share(w, length, k) for k in node.args[-2:]]
    both = [p for p in parts if p is not None]
    if len(both) < 2:
        return None
    join = sum if node.op in (Op.ADD, Op.SUB) else max
    return join(s for s, _ in both) * _ROOM, join(a for _, a in both) * _ROOM
