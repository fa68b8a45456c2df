"""Fits that a function contains: a result |R|, R = b - A x, beside the results x = (v, w) that make it least.

Of sensed joint rates, v is (vx, vy) and w omega, a quotient N / D. Then, with a matrix M and a number c,

    |R(v + dv, w + dw)|^2 = |R(v, w)|^2 + dv M dv + c D dw^2.

b is made of ``data``: velocities of contact points. Given w, v is the best for any data, also for such as no wheel can
have. w is the best for possible data only: N may have been simplified by what is known of them. For others it is off by
a number times a sine or cosine: the ``defect`` of a datum.

Whether a function is such a fit is checked on its nodes (`wmrgen.bounds.identities`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds.identities import POINTS, Forms, Point, same, waved
from wmrgen.bounds.patterns import Term, cone, quotient, terms_below_root
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.residues import Residue

_FORMULA = frozenset({Op.CONST, Op.INPUT, Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.NEG, Op.SIN, Op.COS})
_ROOM = 1 + 1e-6  # of numbers that are known to about 1e-12


@dataclass(frozen=True, slots=True)
class Datum:
    """An error e of ``node`` changes R by ``column`` |e| at most, part by part, and N by ``defect`` |e| too much."""

    node: int
    column: NDArray[np.float64]
    defect: float


@dataclass(frozen=True, slots=True)
class Fit:
    """Nodes of a function: ``root`` is |R|, the root of the sum of ``terms``; ``v``; ``w``, ``dividend`` / ``divisor``.

    ``matrix`` and ``factor``: upper bounds of M and c, in absolute value.
    """

    root: int
    terms: tuple[Term, ...]
    v: tuple[int, ...]
    w: int
    dividend: int
    divisor: int
    matrix: NDArray[np.float64]
    factor: float
    data: tuple[Datum, ...]


def fit_of(function: Function) -> Fit | None:
    """The fit of whose x results are made, None where there is none."""
    nodes, results = function.nodes, function.results
    roots = [k for k in results if nodes[k].op is Op.SQRT]
    if len(roots) != 1:
        return None
    needed = cone(nodes, roots)
    own = {k for k in results if k in needed} - set(roots)
    # A result beside R may be x seen from another point: the sum of a v and a multiple of w.
    seen = {a for k in results if k not in needed for a in nodes[k].args if a in needed}
    for x in (own | seen, own) if seen - own else (own,):
        fit = _fitted(nodes, roots[0], sorted(x))
        if fit is not None:
            return fit
    return None


def _fitted(nodes: Sequence[Node], root: int, x: Sequence[int]) -> Fit | None:
    """The fit of ``x``, which makes ``root`` least."""
    terms = terms_below_root(nodes, nodes[root].args[0])
    formula = cone(nodes, [*x, *(t.base for t in terms)])
    if not all(t.squared for t in terms) or any(nodes[k].op not in _FORMULA for k in formula):
        return None
    quotients = {k: parts for k in x if (parts := quotient(nodes, k)) is not None}
    if len(quotients) != 1:
        return None
    ((w, (dividend, divisor)),) = quotients.items()
    v = tuple(k for k in x if k != w)
    if any(cone(nodes, [k], {w}) & set(x) != {w, k} for k in v):
        return None
    data = _data(nodes, root, x)
    for known in (data, ()) if data else ((),):
        points = [Point(nodes, terms, known, seed) for seed in range(POINTS)]
        found = _settled(points, (p.forms(v, w, dividend, divisor) for p in points))
        if found is not None:
            return Fit(root, terms, v, w, dividend, divisor, *found)
    return None


def _data(nodes: Sequence[Node], root: int, x: Collection[int]) -> tuple[int, ...]:
    """The last nodes that ``root`` has in common with ``x`` beside x itself, of those that depend on rates.

    Rates are inputs of which no sine or cosine is taken.
    """
    angles = {k for n in nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
    rated: set[int] = set()
    for i, n in enumerate(nodes):
        if (n.op is Op.INPUT and i not in angles) or not rated.isdisjoint(n.args):
            rated.add(i)
    common = cone(nodes, [root], x) & cone(nodes, x) & rated - set(x)
    last = {k for i, n in enumerate(nodes) if i not in common for k in n.args if k in common}
    return tuple(sorted(k for k in last if nodes[k].op is not Op.INPUT))


def _settled(
    points: Sequence[Point], found: Iterable[Forms | None]
) -> tuple[NDArray[np.float64], float, tuple[Datum, ...]] | None:
    """M, c and the data, where they are the same at all points; the defects, where they are waves."""
    forms = []
    for f in found:
        if f is None:
            return None
        forms.append(f)
    if not same([f.numbers() for f in forms]):
        return None
    first, data = forms[0], []
    for j, node in enumerate(points[0].data):
        defect = waved([f.defects[j] for f in forms], [p.circle_of(node) for p in points])
        if defect is None:
            return None
        data.append(Datum(node, _sizes(first.columns[j]), defect * _ROOM))
    side = len(first.matrix)
    matrix = _sizes([x for row in first.matrix for x in row]).reshape(side, side)
    return matrix, abs(first.factor.size) * _ROOM, tuple(data)


def _sizes(numbers: Sequence[Residue]) -> NDArray[np.float64]:
    """Upper bounds of absolute values."""
    return np.array([abs(x.size) for x in numbers]) * _ROOM
