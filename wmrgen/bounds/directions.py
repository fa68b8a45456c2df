"""Operations that give the direction of a vector: where the vector may vanish, their error has no bound of its own.

Three shapes: the angle atan2(y, x) with x >= 0; half the angle of a line, atan(c b / (v + a)) with
v = +-sqrt(a a + c c b b), its sign that of a; and a slope c b / a kept between two limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wmrgen.bounds.interval import Interval, magnitude
from wmrgen.bounds.leaning import rest_of
from wmrgen.bounds.patterns import extremum, scaled, terms_below_root, without_factors
from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.nodes import Node, Op

Part = tuple[float, int]  # (factor, node): the component factor x node of a vector


@dataclass(frozen=True, slots=True)
class Direction:
    """The result moves by at most ``factor`` times the angle by which the vector turns, ``most`` in all.

    ``quotient``: the division that this shape accounts for, with ``roundings`` up to the result; ``reach``: its
    largest value; ``size``: the node of the vector's length; ``least``: the divisor is no smaller. ``kept``: a slope
    between limits of either sign, so that the result times the first part is no larger than the second.
    """

    parts: tuple[Part, Part]
    factor: float
    most: float
    quotient: int | None = None
    roundings: float = 0.0
    reach: float = np.inf
    size: int | None = None
    least: float = 0.0
    kept: bool = False

    @property
    def relative(self) -> float:
        """``roundings`` of a slope between limits, as a share of it."""
        return self.roundings / self.reach


def directions(nodes: Sequence[Node]) -> dict[int, Direction]:
    """The directions among the nodes, by node."""
    found: dict[int, Direction] = {}
    users = [0] * len(nodes)
    for node in nodes:
        for arg in node.args:
            users[arg] += 1
    for i, node in enumerate(nodes):
        direction = None
        if node.op is Op.ATAN2:
            direction = Direction(((1.0, node.args[0]), (1.0, node.args[1])), 1.0, np.pi)
        elif node.op.value == "atan":
            direction = _line(nodes, node, users)
        elif node.op in (Op.MIN, Op.MAX, Op.SELECT):
            direction = _clamped(nodes, node)
        if direction is not None:
            found[i] = direction
    return found


def _factor(nodes: Sequence[Node], i: int) -> tuple[Exact, int]:
    """(c, x) of a product c x; (1, i) otherwise."""
    return scaled(nodes, nodes[i]) or (ONE, i)


def _line(nodes: Sequence[Node], node: Node, users: Sequence[int]) -> Direction | None:
    """atan(c n / d), n = -b where a < 0, else b; d = max(least, size + |a|), size = sqrt(a a + (c b) (c b))."""
    c, quotient = _factor(nodes, node.args[0])
    if nodes[quotient].op is not Op.DIV or any(users[k] > 1 for k in {quotient, node.args[0]}):
        return None
    above, divisor = nodes[quotient].args
    signed, total = nodes[above], _kept_apart(nodes, divisor)
    if signed.op is not Op.SELECT or total is None or nodes[total].op is not Op.ADD:
        return None
    a, zero, _, b = signed.args
    if nodes[zero].value != ZERO or not _opposite(nodes, *signed.args[2:]):
        return None
    for size, beside in (nodes[total].args, nodes[total].args[::-1]):
        if nodes[size].op is Op.SQRT and nodes[beside].op is Op.ABS and nodes[beside].args[0] == a:
            most = _norm(nodes, size, a, b, c)
            if most is not None:
                f = float(c * c)
                # size is off by most/2 + 1 units relatively; sum and quotient add one each, a factor two. An
                # arctangent halves relative errors at the least. Subnormal squares: f q q <= 3 + 2 f.
                rounds = (most / 2 + (3 if c == ONE else 5)) / 2
                parts = ((1.0, a), (float(abs(c)), b))
                return Direction(
                    parts, 0.5, np.pi / 2, quotient, rounds, np.sqrt((3 + 2 * f) / f) * 1.01, size
                )
    return None


def _sides(nodes: Sequence[Node], i: int) -> tuple[int, ...]:
    """The two numbers of a maximum."""
    found = extremum(nodes, nodes[i])
    return found[1:] if found is not None else ()


def _kept_apart(nodes: Sequence[Node], divisor: int) -> int | None:
    """t of max(t, s), s > 0."""
    found = extremum(nodes, nodes[divisor]) if nodes[divisor].op in (Op.MAX, Op.SELECT) else None
    if found is None or found[0] is not Op.MAX:
        return None
    for least, total in (found[1:], found[:0:-1]):
        value = nodes[least].value
        if value is not None and value.sign > 0:
            return total
    return None


def _norm(nodes: Sequence[Node], size: int, a: int, b: int, c: Exact) -> int | None:
    """The number of roundings of ``size`` where it is the length of (a, c b), else None."""
    terms = terms_below_root(nodes, nodes[size].args[0])
    if len(terms) != 2 or not all(t.squared for t in terms):
        return None
    wanted = [_square_of(nodes, a, ONE), _square_of(nodes, b, c)]
    made = []
    for t in terms:
        k, base = without_factors(nodes, t.base)
        made.append((base, t.factor * k * k))
    if wanted == made or wanted == made[::-1]:
        return max(t.roundings for t in terms)
    return None


def _square_of(nodes: Sequence[Node], i: int, c: Exact) -> tuple[int, Exact]:
    k, base = without_factors(nodes, i)
    return base, k * k * c * c


def _clamped(nodes: Sequence[Node], node: Node) -> Direction | None:
    """max(-m, min(m, c n / d)), n = -b where a < 0, else b; d = max(least, |a|)."""
    outer = extremum(nodes, node)
    if outer is None:
        return None
    for limit, inside in (outer[1:], outer[:0:-1]):
        inner = extremum(nodes, nodes[inside]) if nodes[inside].op in (Op.MIN, Op.MAX, Op.SELECT) else None
        if inner is None or inner[0] is outer[0]:
            continue
        for other, ratio in (inner[1:], inner[:0:-1]):
            bounds = nodes[limit].value, nodes[other].value
            c, quotient = _factor(nodes, ratio)
            if bounds[0] is None or bounds[1] is None or nodes[quotient].op is not Op.DIV:
                continue
            above, divisor = nodes[quotient].args
            signed, beside = nodes[above], _kept_apart(nodes, divisor)
            if signed.op is not Op.SELECT or beside is None or nodes[beside].op is not Op.ABS:
                continue
            a, zero, minus, b = signed.args
            if nodes[beside].args[0] == a and nodes[zero].value == ZERO and _opposite(nodes, minus, b):
                m = max(abs(float(v)) for v in bounds if v is not None)
                parts = ((1.0, a), (abs(float(c)), b))
                least = min(float(v) for k in _sides(nodes, divisor) if (v := nodes[k].value) is not None)
                signs = {v.sign for v in bounds if v is not None}
                # A quotient, or the limit that takes its place; or a quotient, c and their product.
                rounds = m if ratio == quotient else 4 * m
                return Direction(
                    parts, 1 + m * m, 2 * m, quotient,
                    roundings=rounds, reach=m, least=least * (1 - 1e-6), kept=signs == {-1, 1},
                )  # fmt: skip
    return None


class Shares:
    """Which values are at most a multiple of the length of a vector: |value| <= share x length."""

    def __init__(
        self, nodes: Sequence[Node], node: int, direction: Direction, ranges: Sequence[Interval]
    ) -> None:
        self.nodes, self.own, self.ranges = nodes, {node: direction}, ranges
        self.known: dict[int, float | None] = {}
        for factor, k in direction.parts:
            for j in _unsigned(nodes, k):
                self.known[j] = 1 / factor
        if direction.size is not None:
            self.known[direction.size] = 1.0

    def of(self, i: int) -> float | None:
        """The share of node ``i``; None where there is none."""
        if i not in self.known:
            self.known[i] = None
            self.known[i] = self._found(self.nodes[i])
        return self.known[i]

    def _found(self, node: Node) -> float | None:
        if node.op is Op.SUB and rest_of(self.nodes, node, self.own) is not None:
            return self.of(node.args[0])
        if node.op.value in ("neg", "abs", "flip"):
            return self.of(node.args[0])
        if node.op in (Op.SELECT, Op.MIN, Op.MAX):
            parts = [self.of(k) for k in node.args[-2:]]
            return None if None in parts else max(p for p in parts if p is not None)
        if node.op in (Op.ADD, Op.SUB):
            parts = [self.of(k) for k in node.args]
            return None if None in parts else sum(p for p in parts if p is not None)
        if node.op is Op.MUL:
            for k, other in (node.args, node.args[::-1]):
                inner = self.of(k)
                if inner is not None:
                    return inner * float(magnitude(self.ranges[other]).max())
        return None


def _unsigned(nodes: Sequence[Node], i: int) -> set[int]:
    """Node ``i`` and those of which it is the absolute value or which it equals up to the sign."""
    found, node = {i}, nodes[i]
    if node.op in (Op.ABS, Op.NEG):
        return found | _unsigned(nodes, node.args[0])
    if node.op is Op.SELECT:
        x, y = node.args[2:]
        for minus, plus in ((x, y), (y, x)):
            if _opposite(nodes, minus, plus):
                return found | {x, y}
    return found


def _opposite(nodes: Sequence[Node], a: int, b: int) -> bool:
    """Whether a = -b by its shape."""
    p, q = nodes[a], nodes[b]
    (f, x), (g, y) = without_factors(nodes, a), without_factors(nodes, b)
    if x == y and f == -g:
        return True
    return p.op is Op.SUB and q.op is Op.SUB and p.args == q.args[::-1]
