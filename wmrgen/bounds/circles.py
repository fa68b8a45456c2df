"""Polynomials in sines and cosines, which lie on circles: c c + s s = 1.

A node is expanded down to sines, cosines and what is neither sum nor product; squares of sines are replaced. What
remains says what a formula is, however its terms are grouped. ``slack`` bounds all that rounding adds on the way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import interval as iv
from wmrgen.bounds.interval import GROW, Array, Interval
from wmrgen.ir.nodes import Node, Op

if TYPE_CHECKING:
    from wmrgen.bounds.analysis import Pass

Monomial: TypeAlias = tuple[int, ...]  # node numbers, in order

_MOST = 400  # terms of one polynomial
_DEGREE = 4
ROUND = 1e-12  # of the coefficients, relative
UNIT = 1 + 1e-5  # of sines and cosines as computed, whose roundings and whose products' stay below
_STEPS = 200  # multipliers tried


@dataclass(frozen=True, slots=True)
class Poly:
    """Sum of c times the product of a monomial's nodes, within ``slack``."""

    terms: Mapping[Monomial, float]
    slack: float

    def plus(self, other: Poly, by: float = 1.0) -> Poly:
        terms = dict(self.terms)
        for m, c in other.terms.items():
            terms[m] = terms.get(m, 0.0) + by * c
        return Poly(terms, self.slack + abs(by) * other.slack)

    def widened(self, by: float) -> Poly:
        return Poly(self.terms, self.slack + by)

    @property
    def degree(self) -> int:
        return max(map(len, self.terms), default=0)


class Circles:
    """Expansions of the nodes that a walk has reached."""

    def __init__(self, p: Pass) -> None:
        self.p = p
        self.known: dict[int, Poly] = {}
        self.sizes: dict[int, float] = {}
        self._off: float | None = None
        waves: dict[int, dict[Op, int]] = {}
        for i, node in enumerate(p.nodes):
            if node.op in (Op.SIN, Op.COS):
                waves.setdefault(node.args[0], {})[node.op] = i
        self.angle = {i: x for x, found in waves.items() for i in found.values()}
        self.partner = {f[Op.SIN]: f[Op.COS] for f in waves.values() if len(f) == 2}
        self.other = self.partner | {c: s for s, c in self.partner.items()}

    @property
    def whole(self) -> bool:
        """Whether there is one box for all turns of the angles; on small ones intervals show more."""
        return self.p.boxes == 1

    def of(self, i: int) -> Poly:
        """The polynomial that node ``i`` is, its own rounding in the slack."""
        if i not in self.known:
            found = self.made(self.p.nodes[i])
            noisy = found is not None and i in self.p.sources
            noise = float(self.p.result.noise[self.p.sources[i]].max()) if noisy else 0.0
            self.known[i] = Poly({(i,): 1.0}, 0.0) if found is None else self._clean(found).widened(noise)
        return self.known[i]

    def made(self, node: Node) -> Poly | None:
        """The sum or product of the polynomials of a node's arguments; None of what is neither or too long."""
        if node.value is not None:
            return Poly({(): float(node.value)}, abs(float(node.value)) * ROUND)
        if node.op not in (Op.ADD, Op.SUB, Op.NEG, Op.MUL):
            return None
        parts = [self.of(k) for k in node.args]
        if node.op is Op.NEG:
            return Poly({}, 0.0).plus(parts[0], -1.0)
        if node.op is not Op.MUL:
            return parts[0].plus(parts[1], 1.0 if node.op is Op.ADD else -1.0)
        a, b = parts
        if a.degree + b.degree > _DEGREE or len(a.terms) * len(b.terms) > _MOST:
            return None
        x, y = (self.most(k) for k in node.args)
        return self.times(a, b).widened(x * b.slack + y * a.slack + a.slack * b.slack)

    def _clean(self, found: Poly) -> Poly:
        """Without terms that only the rounding of coefficients leaves."""
        least = ROUND / 100 * max(map(abs, found.terms.values()), default=0.0)
        small = sum(abs(c) * self.largest(m) for m, c in found.terms.items() if abs(c) <= least)
        return Poly({m: c for m, c in found.terms.items() if abs(c) > least}, found.slack + small)

    def times(self, a: Poly, b: Poly) -> Poly:
        """The product of two polynomials without their slack."""
        terms: dict[Monomial, float] = {}
        left, right = list(a.terms.items()), list(b.terms.items())
        for k, (m, c) in enumerate(left):
            if a is b:  # either order at once
                self._add(terms, tuple(sorted(m + m)), c * c)
                right, c = left[k + 1 :], 2 * c
            for n, d in right:
                self._add(terms, tuple(sorted(m + n)), c * d)
        # Squares of sines are replaced so often in one monomial, each within what square and square may be off.
        often = 2 ** ((a.degree + b.degree) // 2) - 1
        return Poly(terms, self.size(a) * self.size(b) * (2 * often * self.off + ROUND))

    def _add(self, terms: dict[Monomial, float], m: Monomial, c: float) -> None:
        """Adds c m, squares of sines replaced."""
        before = -1
        for k, sine in enumerate(m):
            if sine == before and sine in self.partner:
                rest, cosine = m[: k - 1] + m[k + 1 :], self.partner[sine]
                self._add(terms, rest, c)
                self._add(terms, tuple(sorted((*rest, cosine, cosine))), -c)
                return
            before = sine
        terms[m] = terms.get(m, 0.0) + c

    @property
    def off(self) -> float:
        """How far the square of a sine or cosine may be off."""
        if self._off is None:
            noise = max(
                (float(self.p.result.noise[self.p.sources[k]].max()) for k in self.angle), default=0.0
            )
            self._off = 2 * noise + noise * noise + ROUND
        return self._off

    def most(self, i: int) -> float:
        """The largest absolute value of a node; of a sine or cosine of any angle."""
        if i not in self.sizes:
            self.sizes[i] = UNIT if i in self.angle else float(iv.magnitude(self.p.range(i)).max())
        return self.sizes[i]

    def largest(self, m: Monomial) -> float:
        """The largest absolute value of a monomial."""
        return math.prod([self.most(k) for k in m])

    def size(self, a: Poly) -> float:
        """Upper bound of the absolute value of a polynomial without its slack."""
        total, sizes = 0.0, self.sizes
        for m, c in a.terms.items():
            each = abs(c)
            for k in m:
                each *= sizes[k] if k in sizes else self.most(k)
            total += each
        return total

    def around(self, node: Node) -> Interval | None:
        """Bounds of a node before its own rounding; None where this shows nothing."""
        found = self.made(node) if self.whole else None
        return None if found is None else self.range(found)

    def range(self, found: Poly) -> Interval | None:
        """Bounds of a polynomial of degree 2 in sines and cosines; None of another."""
        atoms = sorted({k for m in found.terms for k in m})
        if found.degree != 2 or not all(k in self.angle for k in atoms):
            return None
        place = {k: j for j, k in enumerate(atoms)}
        square, line, still = np.zeros((len(atoms), len(atoms))), np.zeros(len(atoms)), 0.0
        for m, c in found.terms.items():
            if len(m) == 2:
                square[place[m[0]], place[m[1]]] += c / 2
                square[place[m[1]], place[m[0]]] += c / 2
            elif m:
                line[place[m[0]]] += c
            else:
                still += c
        turns = [self.angle[k] for k in atoms]
        circle = np.array([sorted(set(turns)).index(x) for x in turns])
        ends = [
            _least(s * square, s * line, s * still, circle, 2 * self.off) - found.slack for s in (1.0, -1.0)
        ]
        return np.full(self.p.boxes, ends[0]), np.full(self.p.boxes, -ends[1])


def _least(square: Array, line: Array, still: float, circle: NDArray[np.int64], off: float) -> float:
    """Lower bound of z A z + g z + k over vectors z whose parts lie on unit circles, ``off`` from them at most.

    For multipliers l that make A + L positive it is at least k - sum of l - g (A + L)^-1 g / 4 (Lagrange). Tried are
    those of g alone, |g| / 2 on each circle, with the same added to all.
    """
    count = int(circle.max()) + 1
    own = np.sqrt(np.bincount(circle, line * line, count)) / 2
    values, vectors = np.linalg.eigh(square + np.diag(own[circle]))
    turned = (vectors.T @ line) ** 2
    size = float(np.abs(values).max()) + float(own.sum())
    more = -values[0] + size * np.logspace(-9, 1, _STEPS)
    if np.bincount(circle).min() < 2:  # a sine alone lies within its circle: no multiplier below 0
        more = more[more + own.min() >= 0]
    each = own[:, None] + more
    # The eigenvalues are known within far less than a share 1e-12 of the largest.
    rest = (turned[:, None] / (values[:, None] + more - size * 1e-12)).sum(axis=0) / 4
    bounds = still - each.sum(axis=0) - np.abs(each).sum(axis=0) * off - rest * GROW
    return float(bounds.max() - (abs(still) + size * count) * (GROW - 1))
