"""Ranges of sums in which a quantity occurs twice: linear forms, and polynomials of sines and cosines.

A sum of multiples of other nodes keeps the multiples, so that terms cancel. Products are expanded if both factors are
sums of sines and cosines. The point (cos x, sin x) is on the unit circle. So a cos x + b sin x is at most |(a, b)|, and
u M v, for two such points u and v, is at most the spectral norm of M.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from wmrgen.geometry.exact.interval import Array, Interval, magnitude, plus
from wmrgen.ir.nodes import Node, Op

Monomial: TypeAlias = tuple[int, ...]  # a node, or the product of two nodes in ascending order

_GROW = 1 + 1e-12  # factor for the float64 roundings of coefficients and sums, 400 of 1.1e-16 each
_MOST = 64  # terms of a linear form; longer forms cost more time than they gain
_MOST_SQUARES = 400  # terms of an expanded product; the same
_UNIT = 1 + 1e-5  # upper bound of the length of a computed (cos, sin), whose error is a few 2**-24


class Form(NamedTuple):
    """The value of a node as a polynomial of other nodes, up to an error."""

    terms: Mapping[Monomial, float]  # coefficients by monomial
    constant: float
    slack: Array  # how far the value may be from the polynomial, per box

    def scaled(self, by: float) -> Form:
        """Return the form times a number."""
        return Form({m: c * by for m, c in self.terms.items()}, self.constant * by, self.slack * abs(by))

    def widened(self, by: Array | float) -> Form:
        """Return the form with a larger error."""
        return Form(self.terms, self.constant, self.slack + by)

    @property
    def degree(self) -> int:
        """Return 0 for a constant, 1 for a linear form, 2 if there are products."""
        return max(map(len, self.terms), default=0)


class Forms:
    """The forms of the nodes of one function."""

    def __init__(self, nodes: Sequence[Node], boxes: int, off: float) -> None:
        """Prepare the forms; `add` appends them.

        Args:
            nodes: the nodes of the function.
            boxes: how many boxes are analysed at once.
            off: how far cos**2 + sin**2 of computed values may be from 1.
        """
        self.nodes, self.boxes, self.off = nodes, boxes, off
        self.list: list[Form] = []
        self.angle = {i: n.args[0] for i, n in enumerate(nodes) if n.op in (Op.SIN, Op.COS)}
        self.cosine = {n.args[0]: i for i, n in enumerate(nodes) if n.op is Op.COS}

    def add(self, i: int, ranges: Sequence[Interval], noise: Array | float) -> None:
        """Append the form of a node.

        Args:
            i: the node; the forms of all nodes before it are there.
            ranges: (low, high) of the nodes before it, one entry per box.
            noise: the rounding error of the node, per box.
        """
        form = self._of(self.nodes[i], ranges)
        self.list.append(
            Form({(i,): 1.0}, 0.0, np.zeros(self.boxes)) if form is None else form.widened(noise)
        )

    def _of(self, node: Node, ranges: Sequence[Interval]) -> Form | None:
        """Return the form of a node without its rounding; None if it is best taken as a variable of its own."""
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
        """Return the expanded product if both factors are linear and one of them in sines and cosines, else None."""
        if a.degree != 1 or b.degree != 1 or (len(a.terms) + 1) * (len(b.terms) + 1) > _MOST_SQUARES:
            return None
        waves = {(k,) for k in self.angle}  # sines and cosines
        if not (a.terms.keys() <= waves or b.terms.keys() <= waves):
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
        """Return whether a + b may have a smaller range than the sum of ranges: through a common term or angle."""
        p, q = self.list[a].terms, self.list[b].terms
        if not p.keys().isdisjoint(q):
            return True
        if not self.angle:
            return False
        angles = {self._turning(m) for m in p}
        return any(self._turning(m) in angles for m in q) or any(len(m) == 2 for m in (*p, *q))

    def _turning(self, m: Monomial) -> Monomial:
        """Return by factor of a monomial the angle whose sine or cosine it is, or -1 - k for another node k; sorted."""
        return tuple(sorted(self.angle.get(k, -1 - k) for k in m))

    def range(self, form: Form, ranges: Sequence[Interval]) -> Interval:
        """Return the range of a form for nodes in ``ranges``."""
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
        """Return (m, r): the terms of a pair of angles, or of an angle and a factor, are in [m - r, m + r] together."""
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
    """Return the sum of the ranges of the terms."""
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
    """Return a + sign b, or None if that has too many terms.

    Args:
        a: the first form.
        b: the second form.
        sign: 1 or -1.
    """
    terms = dict(a.terms)
    for m, c in b.terms.items():
        terms[m] = terms.get(m, 0.0) + sign * c
        if not terms[m]:
            del terms[m]
    if len(terms) > (_MOST if max(a.degree, b.degree) < 2 else _MOST_SQUARES):
        return None
    return Form(terms, a.constant + sign * b.constant, a.slack + b.slack)
