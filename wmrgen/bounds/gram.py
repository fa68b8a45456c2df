"""Quotients of least squares, recognised by what they are as polynomials.

N = sum x h, x spins and rates, h polynomials of sines and cosines. Where some positive matrix G makes h G h the
divisor D, |N| is at most sqrt(x G^-1 x) sqrt(D) (Cauchy and Schwarz), however the terms of N and D are grouped. G is
found by least squares over the coefficients and holds as far as they are seen to agree.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import interval as iv
from wmrgen.bounds.circles import ROUND, UNIT, Circles, Monomial, Poly
from wmrgen.bounds.interval import GROW, Array
from wmrgen.bounds.norms import least_squares
from wmrgen.bounds.patterns import largest_of
from wmrgen.ir.nodes import Op

if TYPE_CHECKING:
    from wmrgen.bounds.analysis import Pass

_AGREE = 1e-3  # of the divisor: what may be left of D - h G h
_MOST = 20  # parts
_POSITIVE = 1e-6  # the least eigenvalue of G over the largest


@dataclass(frozen=True, slots=True)
class _Part:
    """``h`` times the sum of its spins and rates by their factors; of none where h only adds to the divisor."""

    h: Poly
    factors: Mapping[int, float]
    angles: frozenset[int]  # of its linear terms: those of its wheel


def cauchy(p: Pass, above: int, below: int) -> Array | None:
    """Upper bound of |N / D| where it is known as one of least squares."""
    found = least_squares(p, above, below)
    return quotient(p, above, below) if found is None else found


def quotient(p: Pass, above: int, below: int) -> Array | None:
    """Upper bound of |N / D| for the nodes ``above`` and ``below``; None where no G is found."""
    total = largest_of(p.nodes, below)
    circles = p.circles
    if total is None or not circles.whole:
        return None
    n, d = circles.of(above), circles.of(total)
    if d.degree != 2 or any(k not in circles.angle for m in d.terms for k in m):
        return None
    parts, lost = _parts(circles, n)
    if not 1 < len(parts) <= _MOST:
        return None
    wheels = Counter(q.angles for q in parts)
    parts += [_turned(circles, q) for q in parts if wheels[q.angles] == 1]
    found = _gram(circles, parts, d)
    if found is None:
        return None
    inverse, left = found
    least = np.maximum(p.range(below)[0], 0.0)
    with np.errstate(all="ignore"):
        share = _longest(p, parts, inverse) * (1 + (left + d.slack) / least) / least
        # The rounding of 1/D, where N is multiplied by it.
        return np.asarray((np.sqrt(share) + (n.slack + lost) / least) * (1 + 4 * p.form.unit))


def _parts(circles: Circles, n: Poly) -> tuple[list[_Part], float]:
    """The parts of which ``n`` is the sum up to what is returned beside them; nothing where it is another sum.

    Spins and rates with multiples of one h are one part.
    """
    found: dict[int, dict[Monomial, float]] = {}
    for m, c in n.terms.items():
        free = [k for k in m if k not in circles.angle]
        if c and len(free) != 1:
            return [], 0.0
        if c:
            found.setdefault(free[0], {})[tuple(k for k in m if k in circles.angle)] = c
    lost = 0.0
    groups: list[tuple[dict[Monomial, float], dict[int, float]]] = []
    for x, h in found.items():
        for first, factors in groups:
            ratio = _ratio(h, first)
            if ratio is not None:
                factors[x] = ratio
                lost += 2 * ROUND * circles.most(x) * len(h) * max(map(abs, h.values()))
                break
        else:
            groups.append((h, {x: 1.0}))
    parts = [
        _Part(Poly(h, 0.0), factors, frozenset(circles.angle[m[0]] for m in h if len(m) == 1))
        for h, factors in groups
    ]
    return parts, lost


def _ratio(h: Mapping[Monomial, float], first: Mapping[Monomial, float]) -> float | None:
    """h / first where it is a number."""
    top = max(first, key=lambda m: abs(first[m]))
    if h.keys() != first.keys():
        return None
    ratio, room = h[top] / first[top], ROUND * abs(h[top])
    return ratio if all(abs(c - ratio * first[m]) <= room for m, c in h.items()) else None


def _turned(circles: Circles, part: _Part) -> _Part:
    """The derivative of a part's h in the angle of its wheel.

    Of a wheel that moves along one line only it is the other component of its contact, which adds to the divisor.
    """
    terms: dict[Monomial, float] = {}
    for m, c in part.h.terms.items():
        for k, wave in enumerate(m):
            if circles.angle[wave] in part.angles and wave in circles.other:
                new = tuple(sorted((*m[:k], circles.other[wave], *m[k + 1 :])))
                terms[new] = terms.get(new, 0.0) + (-c if circles.p.nodes[wave].op is Op.COS else c)
    return _Part(Poly(terms, 0.0), {}, part.angles)


def _gram(circles: Circles, parts: Sequence[_Part], d: Poly) -> tuple[NDArray[np.float64], float] | None:
    """G^-1, where h G h = D up to what is returned beside it."""
    scale = np.array([max(map(abs, q.h.terms.values()), default=0.0) for q in parts])
    if not scale.all():
        return None
    joined = [j for j, q in enumerate(parts) if q.factors]
    apart = [(j, k) for j, k in combinations(joined, 2) if parts[j].angles == parts[k].angles]
    pairs = [(j, j) for j in range(len(parts))] + apart
    made = [circles.times(parts[j].h, parts[k].h) for j, k in pairs]
    rows = {m: i for i, m in enumerate(dict.fromkeys(m for q in (*made, d) for m in q.terms))}
    matrix, wanted = np.zeros((len(rows), len(pairs))), np.zeros(len(rows))
    for column, ((j, k), q) in enumerate(zip(pairs, made, strict=True)):
        for m, c in q.terms.items():
            matrix[rows[m], column] = c / (scale[j] * scale[k]) * (1 if j == k else 2)
    for m, c in d.terms.items():
        wanted[rows[m]] = c
    found = np.linalg.pinv(matrix.T @ matrix, rcond=1e-9, hermitian=True) @ (matrix.T @ wanted)
    rest = np.abs(matrix @ found - wanted) + ROUND * (np.abs(matrix) @ np.abs(found) + np.abs(wanted))
    left = float(rest.sum()) * UNIT ** max(map(len, rows))
    scaled = np.zeros((len(parts), len(parts)))
    for (j, k), g, q in zip(pairs, found, made, strict=True):
        scaled[j, k] = scaled[k, j] = g
        left += abs(g) / (scale[j] * scale[k]) * q.slack * (1 if j == k else 2)
    values = np.linalg.eigvalsh(scaled)
    if left > _AGREE * float(np.abs(wanted).max()) or values[0] <= _POSITIVE * values[-1]:
        return None
    return np.asarray(np.linalg.inv(scaled) * np.outer(scale, scale), dtype=np.float64), left * GROW


def _longest(p: Pass, parts: Sequence[_Part], inverse: NDArray[np.float64]) -> Array:
    """Upper bound of x G^-1 x over the ranges of the parts' sums x."""
    sums = [
        sum((abs(c) * iv.magnitude(p.range(k)) for k, c in q.factors.items()), np.zeros(p.boxes))
        for q in parts
    ]
    total = np.zeros(p.boxes)
    for j, x in enumerate(sums):
        for k, y in enumerate(sums):
            total = total + abs(inverse[j, k]) * x * y
    return np.asarray(total * GROW)
