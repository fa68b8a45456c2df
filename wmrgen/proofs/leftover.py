"""Bounds of what a fit leaves: the slip |R|, R = b - A x at the x that makes it least (see `wmrgen.proofs.fits`).

Let b' be the data that the float program has, with A still exact. What is left of b' differs from what is left of b by
|b' - b| at most: errors of data count as they stand, not as they come back through x. The x of the float program is not
the best for b' and A. That counts by what it adds at right angles, and only where nothing else is left. All other
roundings, of A and of R, count where they occur. And what is left is no longer than b.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.prune import places, prune
from wmrgen.proofs import slopes as sl
from wmrgen.proofs.analysis import Pass
from wmrgen.proofs.fits import Fit
from wmrgen.proofs.interval import GROW, magnitude
from wmrgen.proofs.patterns import terms_below_root
from wmrgen.proofs.records import Claim

_ROUNDED = (Op.ADD, Op.SUB, Op.MUL, Op.DIV)  # by half a unit in the last place of what they give


def left_over(fit: Fit, function: Function, whole: Pass) -> Claim:
    """Range and error of |R|, given the walk through the ``whole`` function over one box."""
    with np.errstate(all="ignore"):
        apart = _apart(fit, function, whole)
        off = {d.node: _data_error(d.node, whole) for d in fit.data}
        own = _rows(apart) + _given(fit, off)
        through = float(np.hypot(_beside(fit, apart), _turned(fit, apart, off, whole)))
        longest = _longest(fit, function, whole)
        # Relative to |R|: the roundings of R, of the sum and of the root. And what may be lost to underflow.
        unit = (max(t.roundings for t in fit.terms) / 2 + 2) * whole.form.unit * (1 + 1e-5)
        lost = float(np.sqrt(2 * len(fit.terms) * whole.form.tiny))
        ends = []  # where nothing is left, and where most is: between them the error is convex
        for size in (0.0, longest):
            computed = float(np.hypot(size, through))
            ends.append(own + (computed - size) + unit * (computed + own) + lost)
        error = float(np.max(ends) * GROW)
    return Claim(0.0, longest + error, error, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class _Apart:
    """The walk through |R| of any x and exact data, N of the same data, and v of any w; where they stand there."""

    walk: Pass
    root: int
    above: int
    v: tuple[int, ...]

    def error(self, k: int) -> float:
        return float(self.walk.result.error(k)[0])


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
    kept, (root, above, *v) = prune(nodes, wanted)
    given = {where[k] for k in exact.values() if k in where}
    cut = Function(function.name, function.inputs, kept, (), (root, above, *v))
    inputs = {**whole.inputs, **{name: whole.range(k) for k, name in names.items()}}
    walk = Pass(cut, inputs, whole.form, whole.library, given=given)
    walk.run()
    return _Apart(walk, root, above, tuple(v))


def _data_error(k: int, p: Pass) -> float:
    """How far a datum is off. The rounding of a product that may be contracted is left to its uses."""
    slope = p.result.slopes[k]
    if k in p.rows:
        slope = sl.without(slope, p.sources[k])
    return float(sl.weighed(slope, p.result.noise, p.boxes)[0])


def _rows(apart: _Apart) -> float:
    """How far R is off by its own roundings and those of A, but for the last of each part, which is relative to it."""
    p, total = apart.walk, 0.0
    for t in terms_below_root(p.nodes, p.nodes[apart.root].args[0]):
        slope = p.result.slopes[t.base]
        if p.nodes[t.base].op in _ROUNDED:
            slope = sl.without(slope, p.sources[t.base])
        off = float(sl.weighed(slope, p.result.noise, p.boxes)[0]) + p.form.tiny
        total += float(t.factor) * off**2
    return float(np.sqrt(total)) * GROW


def _given(fit: Fit, off: Mapping[int, float]) -> float:
    """|b' - b|"""
    by = sum((d.column * off[d.node] for d in fit.data), np.zeros(len(fit.terms)))
    return float(np.sqrt(np.dot([float(t.factor) for t in fit.terms], by**2))) * GROW


def _beside(fit: Fit, apart: _Apart) -> float:
    """sqrt(dv M dv), v beside the best for its w."""
    by = np.array([apart.error(k) for k in apart.v])
    return float(np.sqrt(by @ fit.matrix @ by)) * GROW


def _turned(fit: Fit, apart: _Apart, off: Mapping[int, float], whole: Pass) -> float:
    """sqrt(c D) |dw|: D dw is no more than the errors of N, with its defects, and of D times w, and w's rounding."""
    low, high = (float(end[0]) for end in whole.range(fit.below))
    above = apart.error(apart.above) + sum(off[d.node] * d.defect for d in fit.data)
    below = float(whole.result.error(fit.below)[0])
    size = above + float(magnitude(whole.range(fit.w))[0]) * below
    rounded = float(np.sqrt(high) * whole.result.noise[whole.sources[fit.w]][0])
    return float(np.sqrt(fit.factor) * (size / np.sqrt(low) * (1 + below / low) + rounded) * GROW)


def _longest(fit: Fit, function: Function, whole: Pass) -> float:
    """Upper bound of |b|: |R| where x is zero."""
    builder, place = Builder(), list[int]()
    for i, node in enumerate(function.nodes[: fit.root + 1]):
        args = [place[k] for k in node.args]
        place.append(builder.const(0) if i in (*fit.v, fit.w) else builder.copy(node, args))
    nodes, (root,) = prune(builder.nodes, [place[fit.root]])
    alone = Function(function.name, function.inputs, nodes, (), (root,))
    return float(Pass(alone, whole.inputs, whole.form, whole.library).run().ranges[root][1][0])
