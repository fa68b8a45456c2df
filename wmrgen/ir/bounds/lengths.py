"""Vectors that may vanish: quotients by their lengths have no bound of their own, but one in terms of the length.

A division whose divisor is no smaller than the length h of a vector, and an atan2, have a slope of at most 1/h. What is
multiplied by a value of at most s h on the way has no slope beyond s: `Length` says of which values that is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, magnitude
from wmrgen.ir.bounds.shapes import scaled, terms_below_root
from wmrgen.ir.nodes import Node, Op
from wmrgen.ir.ops.analysis import Noise, Partial, Value, Walk

_SUMS = (Op.ADD, Op.SUB, Op.COMPENSATED)
Parts = tuple[tuple[float, int], ...]  # (f, x): the components f x of a vector
Share = tuple[float, float]  # (s, a): a value is at most s h + a

SMALL_ANGLE = 64.0  # errors are claimed where the vector is this much longer than its own error
SHORT = 2.0**-40  # the error of a length counts as this at least
MOVED = 1.05  # while rounding errors grow from nothing to what they are, values move so much apart from lengths at most
_UNDERFLOW = 2.0**-150  # what a square of floats may lose
_LEAST = 50.0  # times what a length loses by that: divisors are kept above
_MARGIN = 1 + 1e-5  # the roundings of a length
_SHORTENED = 1.1  # of a quotient by a length that underflow may shorten, on the way from no rounding to all


@dataclass(slots=True)
class Length:
    """The length h of the vector with components f x over the ``parts`` (f, x), by which a node divides.

    ``rho``: how far h may be off, once it is known.
    """

    parts: Parts
    rho: float = SHORT
    shares: dict[int, Share | None] = field(default_factory=dict)
    # (x, s): |x| is at most s h where that node counts.
    facts: list[tuple[int, float]] = field(default_factory=list)

    def value(self, nodes: Sequence[np.ndarray]) -> np.ndarray:
        """h, from the values of the nodes."""
        return np.asarray(np.sqrt(sum((f * nodes[x]) ** 2 for f, x in self.parts)))


def lengths(nodes: Sequence[Node]) -> dict[int, Length]:
    """The lengths by which nodes divide, by node."""
    by_node = {}
    for i, node in enumerate(nodes):
        parts: Parts | None = None
        if node.op is Op.ATAN2:
            parts = (1.0, node.args[0]), (1.0, node.args[1])
        elif node.op is Op.DIV:
            parts = _kept_apart(nodes, node.args[1])
        if parts is not None:
            by_node[i] = Length(parts, facts=[fact for f, x in parts for fact in facts(nodes, x, 1 / f)])
    return by_node


def facts(nodes: Sequence[Node], x: int, s: float) -> list[tuple[int, float]]:
    """That |x| is at most s h, and of a product x = c y what that says of y."""
    product = scaled(nodes, nodes[x])
    inner = [(product[1], s / abs(float(product[0])) * _MARGIN)] if product is not None and product[0] else []
    return [(x, s), *inner]


def _kept_apart(nodes: Sequence[Node], divisor: int) -> Parts | None:
    """The vector whose length the divisor is, or more, but for being kept above a number too small to count."""
    node = nodes[divisor]
    if node.op is Op.ADD:  # of one that is kept apart and a size
        for k, other in (node.args, node.args[::-1]):
            if _below(nodes, other) is not None and (parts := _kept_apart(nodes, k)) is not None:
                return parts
    choices: list[tuple[int, Parts | None]] = []
    if node.op is Op.AT_LEAST:
        choices = [(node.args[1], ((1.0, node.args[0]),))]
    elif node.op is Op.MAX:
        choices = [(least, _below(nodes, x)) for least, x in (node.args, node.args[::-1])]
    for least, parts in choices:
        value = nodes[least].value
        if (
            value is not None
            and parts is not None
            and _LEAST * lost(parts) <= float(value) <= SMALL_ANGLE * SHORT
        ):
            return parts
    return None


def lost(parts: Sequence[tuple[float, int]]) -> float:
    """How much of a length underflow may take."""
    return float(np.sqrt(2 * sum(1 + f * f for f, _ in parts) * _UNDERFLOW)) if len(parts) > 1 else 0.0


def _below(nodes: Sequence[Node], i: int) -> Parts | None:
    """A vector whose length node ``i`` is: a length, an absolute value."""
    node = nodes[i]
    if node.op is Op.ABS:
        return ((1.0, node.args[0]),)
    if node.op is Op.SQRT:
        terms = terms_below_root(nodes, node.args[0])
        return (
            tuple((float(t.factor) ** 0.5, t.base) for t in terms) if all(t.squared for t in terms) else None
        )
    return None


def share(w: Walk, length: Length, i: int) -> Share | None:
    """(s, a) where |node i| is at most s h + a; None where nothing is known. Roundings count."""
    if i not in length.shares:
        length.shares[i] = None
        length.shares[i] = _component(length, i) or _computed(w, length, i)
    return length.shares[i]


def _component(length: Length, i: int) -> Share | None:
    """Of a component of the vector."""
    return next(((s * _MARGIN, 0.0) for x, s in length.facts if i == x), None)


def _computed(w: Walk, length: Length, i: int) -> Share | None:
    """Of what an operation makes of such values."""
    node = w.nodes[i]
    if node.value is not None:
        return None if node.value else (0.0, 0.0)
    if node.op in (Op.NEG, Op.ABS, Op.FLIP, Op.WITH_SIGN_OF):
        return share(w, length, node.args[0])
    if node.op is Op.SQRT:
        return (_MARGIN, lost(length.parts)) if _below(w.nodes, i) == length.parts else None
    if node.op is Op.MUL:
        for k, other in (node.args, node.args[::-1]):
            inner = share(w, length, k)
            if inner is not None:
                most = float(magnitude(w.ranges[other]).max()) * _MARGIN
                return inner[0] * most, inner[1] * most + w.form.tiny
        return None
    if node.op not in _SUMS:
        return None
    parts = [p for k in node.args if (p := share(w, length, k)) is not None]
    if len(parts) < 2:
        return None
    return sum(s for s, _ in parts) * _MARGIN, sum(a for _, a in parts) * _MARGIN


# ---- what lemmas ask for


def quotient_by_length(w: Walk, i: int, a: int, b: int) -> Value:
    """n / d with d no smaller than the length h of a vector: d(n / d) is at most (|dn| + |n / d| |dd|) / h."""
    length, least = w.measured(i), w.away[b]
    reach = magnitude(w.ranges[a]) / least
    ratio = share(w, length, a)
    if ratio is not None:
        reach = np.minimum(
            reach, (ratio[0] + (ratio[0] * lost(length.parts) + ratio[1]) / least) * _SHORTENED
        )
    value = -reach, reach
    ends = w.effective.get(i, (-np.inf, np.inf))
    most = np.minimum(reach, max(map(abs, ends)))
    if len(length.parts) == 1 and np.isfinite(most).all():
        # Where a limit that the quotient meets does not take its place, |n| is no larger than the limit times h.
        limit = float(most.max()) * length.parts[0][0] * _MARGIN
        length.facts += facts(w.nodes, a, limit)
        length.shares.clear()
    partials = (
        Partial(a, value, length=i, steep=np.full(w.boxes, MOVED)),
        Partial(b, value, length=i, steep=most * MOVED),
    )
    return Value(value, partials, Noise(w.rounded(value, i).size + w.form.tiny))


def root_of_squares(w: Walk, i: int, a: int) -> Value | None:
    """The root of a sum of squares moves by no more than the length of the errors of what is squared."""
    terms = terms_below_root(w.nodes, a)
    if not all(t.squared for t in terms):
        return None
    factors = np.array([[float(t.factor)] for t in terms])
    bases = [t.base for t in terms]
    longest = np.sqrt(sum(f * magnitude(w.ranges[k]) ** 2 for f, k in zip(factors, bases, strict=True)))
    value = iv.meet(iv.root(w.ranges[a]), (np.zeros(w.boxes), longest * _MARGIN + w.form.tiny**0.5))
    errors = w.errors(bases)
    moved = np.sqrt((factors * errors.plain**2).sum(axis=0)) * iv.GROW
    over = {j: np.sqrt((factors * o**2).sum(axis=0)) * iv.GROW for j, o in errors.over.items()}
    # A term passes this many roundings on its way into the sum, each a relative error of the sum at most.
    own = max(t.roundings for t in terms) * w.form.unit / 2 * _MARGIN * value[1]
    rounded = w.rounded(value, i).size + own + np.sqrt(2 * len(terms) * w.form.tiny)
    noise = Noise(rounded + moved, over, frozenset[int]().union(*errors.divisions))
    widened = iv.widened(value, rounded)
    return Value((np.maximum(widened[0], 0.0), widened[1]), (), noise, widen=False)


def branch(w: Walk, small: int, large: int, value: int) -> tuple[Array, Array, Array]:
    """(low, high, distance from zero) of ``value`` where it is chosen because small <= large, up to their errors."""
    interval, away = w.ranges[value], w.away[value]
    far = np.full(w.boxes, np.inf)
    if value in (small, large):
        slack = w.errors([small, large]).total.sum(axis=0)
        if value == large:
            interval = iv.meet(interval, (w.ranges[small][0] - slack, far))
        else:
            interval = iv.meet(interval, (-far, w.ranges[large][1] + slack))
    return interval[0], interval[1], np.maximum(away, iv.smallest(interval))
