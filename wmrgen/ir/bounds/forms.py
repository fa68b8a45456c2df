"""Ranges of sums in which a quantity stands twice: linear forms, and polynomials of sines and cosines.

A node that is a sum of multiples of others keeps the multiples. Products are multiplied out where both factors are
made of sines and cosines alone: (cos x, sin x) lies on a circle, so that a cos x + b sin x is no more than |(a, b)|,
and u M v, u and v two such points, no more than the spectral norm of M.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from wmrgen.geometry.exact.interval import Array, Interval, magnitude, plus
from wmrgen.ir.nodes import Node, Op

Monomial: TypeAlias = tuple[int, ...]  # one node or two, in order

_GROW = 1 + 1e-12  # covers the rounding of the coefficients and of the sum
_MOST = 64  # terms of a linear form; longer ones are not worth their time
_MOST_SQUARES = 400  # terms of a product
_UNIT = 1 + 1e-5  # the length of (cos, sin) as computed


class Form(NamedTuple):
    """The sum of coefficient times monomial, plus ``constant``, within ``slack`` (per box)."""

    terms: Mapping[Monomial, float]
    constant: float
    slack: Array

    def scaled(self, by: float) -> Form:
        return Form({m: c * by for m, c in self.terms.items()}, self.constant * by, self.slack * abs(by))

    def widened(self, by: Array | float) -> Form:
        return Form(self.terms, self.constant, self.slack + by)

    @property
    def degree(self) -> int:
        return max(map(len, self.terms), default=0)


class Forms:
    """The forms of the nodes of one walk; ``off``: how far c c + s s may be from 1 as computed."""

    def __init__(self, nodes: Sequence[Node], boxes: int, off: float) -> None:
        self.nodes, self.boxes, self.off = nodes, boxes, off
        self.list: list[Form] = []
        self.angle = {i: n.args[0] for i, n in enumerate(nodes) if n.op in (Op.SIN, Op.COS)}
        self.cosine = {n.args[0]: i for i, n in enumerate(nodes) if n.op is Op.COS}

    def add(self, i: int, ranges: Sequence[Interval], noise: Array | float) -> None:
        """The form of node ``i``, rounded by ``noise``; ``ranges`` of the nodes before."""
        form = self._of(self.nodes[i], ranges)
        self.list.append(
            Form({(i,): 1.0}, 0.0, np.zeros(self.boxes)) if form is None else form.widened(noise)
        )

    def _of(self, node: Node, ranges: Sequence[Interval]) -> Form | None:
        if node.value is not None:
            value = float(node.value)
            return Form({}, value, np.full(self.boxes, abs(value) * 2.0**-52))
        args = [self.list[k] for k in node.args]
        if node.op is Op.NEG:
            return args[0].scaled(-1.0)
        if node.op is Op.RINT:
            return args[0].widened(0.5)
        if node.op in (Op.ADD, Op.SUB, Op.COMPENSATED):
            return combined(args[0], args[1], -1 if node.op is Op.SUB else 1)
        if node.op is Op.MUL:
            for c, x, k in ((args[0], args[1], 1), (args[1], args[0], 0)):
                if not c.terms:
                    return x.scaled(c.constant).widened(c.slack * magnitude(ranges[node.args[k]]))
            return self._product(args[0], args[1], [magnitude(ranges[k]) for k in node.args])
        return None

    def _product(self, a: Form, b: Form, sizes: Sequence[Array]) -> Form | None:
        """a b, multiplied out where both are linear, one in sines and cosines."""
        if a.degree != 1 or b.degree != 1 or (len(a.terms) + 1) * (len(b.terms) + 1) > _MOST_SQUARES:
            return None
        if all(any(k not in self.angle for (k,) in f.terms) for f in (a, b)):
            return None
        constant, size = a.constant * b.constant, 0.0
        terms: dict[Monomial, float] = {}
        for m, c in {**a.terms, (): a.constant}.items():
            for n, d in {**b.terms, (): b.constant}.items():
                if not (m or n):
                    continue
                product, key = c * d, tuple(sorted(m + n))
                size += abs(product)
                other = self.cosine.get(self.angle[key[0]]) if len(key) == 2 and key[0] == key[1] else None
                if other is not None and other != key[0] and other < len(self.list):  # s s = 1 - c c
                    constant, key, product = constant + product, (other, other), -product
                terms[key] = terms.get(key, 0.0) + product
        kept = {m: c for m, c in terms.items() if abs(c) > 1e-13 * size}
        slack = sizes[0] * b.slack + sizes[1] * a.slack + a.slack * b.slack + size * (self.off + 1e-12)
        return Form(kept, constant, slack)

    def overlap(self, a: int, b: int) -> bool:
        """Whether the sum of two nodes knows more than their ranges: a term in common, or one angle."""
        p, q = self.list[a].terms, self.list[b].terms
        if not p.keys().isdisjoint(q):
            return True
        if not self.angle:
            return False
        angles = {self._turning(m) for m in p}
        return any(self._turning(m) in angles for m in q) or any(len(m) == 2 for m in (*p, *q))

    def _turning(self, m: Monomial) -> Monomial:
        """The angles of which a monomial is a product of sines and cosines, -1 - k for a node k that is none."""
        return tuple(sorted(self.angle.get(k, -1 - k) for k in m))

    def range(self, form: Form, ranges: Sequence[Interval]) -> Interval:
        """Where the form lies when the nodes lie in ``ranges``."""
        groups: dict[Monomial, list[tuple[Monomial, float]]] = {}
        for m, c in form.terms.items():
            groups.setdefault(self._turning(m), []).append((m, c))
        lo = hi = np.full(self.boxes, form.constant)
        size = np.full(self.boxes, abs(form.constant))
        for angles, group in groups.items():
            low, high = _plain(group, ranges)
            size = size + np.maximum(-low, high)
            if len(group) > 1 or len(angles) == 2:
                middle, reach = self._reach(angles, group, ranges)
                low, high = np.maximum(low, middle - reach), np.minimum(high, middle + reach)
            lo, hi = lo + low, hi + high
        width = form.slack * _GROW + size * (_GROW - 1)
        return lo - width, hi + width

    def _reach(
        self, angles: Monomial, group: Sequence[tuple[Monomial, float]], ranges: Sequence[Interval]
    ) -> tuple[float, Array | float]:
        """(m, r): the group of one pair of angles, or of one angle and one factor, lies within r of m."""
        if angles[0] < 0:
            if len(angles) == 1 or angles[1] < 0:
                return 0.0, np.inf
            arm = np.zeros(2)
            for m, c in group:
                arm[int(any(self.nodes[k].op is Op.SIN for k in m))] += c
            return 0.0, magnitude(ranges[-1 - angles[0]]) * float(np.linalg.norm(arm)) * _UNIT
        if len(angles) == 1 or angles[0] != angles[1]:
            matrix = np.zeros((2, 2))
            for m, c in group:
                place = [0, 0]
                for k in m:
                    place[angles.index(self.angle[k])] = int(self.nodes[k].op is Op.SIN)
                matrix[place[0], place[1]] += c
            return 0.0, float(np.linalg.norm(matrix, 2)) * _UNIT**2
        square = cross = 0.0
        for m, c in group:
            if m[0] != m[1]:
                cross += c
            elif self.nodes[m[0]].op is Op.COS:
                square += c
            else:
                return 0.0, np.inf  # a sine without its cosine
        # c c = (1 + cos 2x) / 2, c s = (sin 2x) / 2.
        return square / 2, (np.hypot(square, cross) / 2 + abs(square) * 1e-5) * _UNIT**2


def _plain(group: Sequence[tuple[Monomial, float]], ranges: Sequence[Interval]) -> Interval:
    """The sum of the ranges of the terms."""
    low = high = np.zeros(())
    for m, c in group:
        a, b = ranges[m[0]]
        if len(m) == 2:
            x, y = ranges[m[1]]
            products = (a * x, a * y, b * x, b * y)
            a, b = np.minimum.reduce(products), np.maximum.reduce(products)
            if m[0] == m[1]:
                a = np.maximum(a, 0.0)
        low, high = plus((low, high), (c * a, c * b) if c > 0 else (c * b, c * a))
    return low, high


def combined(a: Form, b: Form, sign: int) -> Form | None:
    """a + sign b; None where it grows too long."""
    terms = dict(a.terms)
    for m, c in b.terms.items():
        terms[m] = terms.get(m, 0.0) + sign * c
        if not terms[m]:
            del terms[m]
    if len(terms) > (_MOST if max(a.degree, b.degree) < 2 else _MOST_SQUARES):
        return None
    return Form(terms, a.constant + sign * b.constant, a.slack + b.slack)
