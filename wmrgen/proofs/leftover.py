"""Bounds of what a fit leaves: the slip |R|, R = b - A x at the x that makes it least (see `wmrgen.proofs.fits`).

Let b' be the data that the float program has, with A still exact. What is left of b' differs from what is left of b by
|b' - b| at most: errors of data count as they stand, not as they come back through x. The x of the float program is not
the best for b' and A. That counts by what it adds at right angles, and only where nothing else is left. All other
roundings, of A and of R, count where they occur. And what is left is no longer than b.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.prune import places, prune
from wmrgen.proofs import slopes as sl
from wmrgen.proofs.analysis import Pass
from wmrgen.proofs.fits import Fit
from wmrgen.proofs.interval import GROW, Array, magnitude
from wmrgen.proofs.patterns import Term, terms_below_root
from wmrgen.proofs.records import Claim


def left_over(fit: Fit, function: Function, whole: Pass) -> Claim:
    """Range and error of |R|, given the walk through the ``whole`` function over one box."""
    with np.errstate(all="ignore"):
        apart = _apart(fit, function, whole)
        fitted = {name: whole.range(k) for k, name in apart.names.items()}
        p = Pass(apart.function, {**whole.inputs, **fitted}, whole.form, whole.library, given=apart.given)
        p.run()
        root, above, *v = apart.function.results
        terms = terms_below_root(p.nodes, p.nodes[root].args[0])
        p.current = root
        off = {d.node: _data_error(d.node, whole) for d in fit.data}
        rows = [_row_error(t.base, p) for t in terms]
        given = [
            sum((off[d.node] * d.column[row] for d in fit.data), np.zeros(1)) for row in range(len(terms))
        ]
        own = _length(terms, rows) + _length(terms, given)
        beside = np.array([p.result.error(k) for k in v])
        defect = sum((off[d.node] * d.defect for d in fit.data), p.result.error(above))
        turned = _turned(fit, whole, defect)
        through = np.hypot(np.sqrt(np.einsum("ib,ij,jb->b", beside, fit.matrix, beside)), turned)
        # Relative to |R|: the roundings of R, of the sum and of the root. And what may be lost to underflow.
        unit = (max(t.roundings for t in terms) / 2 + 2) * p.form.unit * (1 + 1e-5)
        lost = np.sqrt(2 * len(terms) * p.form.tiny)
        longest = _longest(fit, function, whole)
        ends = [
            own + (np.hypot(s, through) - s) + unit * (np.hypot(s, through) + own) + lost
            for s in (np.zeros_like(longest), longest)
        ]  # convex between
        error = float(np.maximum(*ends).max() * GROW)
    return Claim(0.0, float(longest.max()) + error, error, 0.0, 0.0)


def _length(terms: Sequence[Term], parts: Sequence[Array]) -> Array:
    """|R| of the size that its parts have."""
    return np.asarray(np.sqrt(sum(float(t.factor) * x**2 for t, x in zip(terms, parts, strict=True))) * GROW)


def _row_error(k: int, p: Pass) -> Array:
    """How far a part of R is off but for its last rounding, which is relative to it."""
    slope = sl.without(p.result.slopes[k], p.sources[k])
    return sl.weighed(slope, p.result.noise, p.boxes) + p.form.tiny


def _data_error(k: int, p: Pass) -> Array:
    """How far a datum is off. The rounding of a product that may be contracted is left to its uses."""
    slope = p.result.slopes[k]
    if k in p.rows:
        slope = sl.without(slope, p.sources[k])
    return sl.weighed(slope, p.result.noise, p.boxes)


def _turned(fit: Fit, p: Pass, above: Array) -> Array:
    """sqrt(c D) |dw|, where D dw is no more than the error of N and that of D times w."""
    low, high = p.range(fit.below)
    divisor = p.result.error(fit.below)
    size = above + magnitude(p.range(fit.w)) * divisor
    rounded = np.sqrt(high) * p.result.noise[p.sources[fit.w]]
    return np.asarray(np.sqrt(fit.factor) * (size / np.sqrt(low) * (1 + divisor / low) + rounded) * GROW)


@dataclass(frozen=True, slots=True)
class _Apart:
    """|R| of any x, N, and v of any w: a function with x, by ``names``, among its inputs, ``given`` data exact."""

    function: Function
    names: dict[int, str]
    given: frozenset[int]


def _apart(fit: Fit, function: Function, whole: Pass) -> _Apart:
    names = {k: f"fitted {k}" for k in (*fit.v, fit.w)}
    data = {d.node for d in fit.data}
    nodes: list[Node] = []
    place: list[int] = []
    made: list[int] = []
    exact: dict[int, int] = {}
    for i, node in enumerate(function.nodes):
        args = [place[k] for k in node.args]
        if (
            i in data and i in whole.rows
        ):  # a product that may be contracted: its factors are exact, here alone
            for k in node.args:
                if k not in exact:
                    same = function.nodes[k]
                    nodes.append(Node(same.op, tuple(place[a] for a in same.args), same.value, same.name))
                    exact[k] = len(nodes) - 1
            args = [exact[k] for k in node.args]
        nodes.append(Node(node.op, tuple(args), node.value, node.name))
        if i in data and i not in whole.rows:
            exact[i] = len(nodes) - 1
        if i in fit.v:
            made.append(len(nodes) - 1)
        if i in names:
            nodes.append(Node(Op.INPUT, name=names[i]))
        place.append(len(nodes) - 1)
    wanted = [place[fit.root], place[fit.above], *made]
    where = places(nodes, wanted)
    kept, results = prune(nodes, wanted)
    cut = Function(function.name, function.inputs, kept, (), results)
    return _Apart(cut, names, frozenset(where[k] for k in exact.values() if k in where))


def _longest(fit: Fit, function: Function, whole: Pass) -> Array:
    """Upper bound of |b|: |R| where x is zero."""
    builder, place = Builder(), list[int]()
    for i, node in enumerate(function.nodes[: fit.root + 1]):
        args = [place[k] for k in node.args]
        place.append(builder.const(0) if i in (*fit.v, fit.w) else builder.copy(node, args))
    nodes, (root,) = prune(builder.nodes, [place[fit.root]])
    alone = Function(function.name, function.inputs, nodes, (), (root,))
    return Pass(alone, whole.inputs, whole.form, whole.library).run().ranges[root][1]
