"""Bounds of what a fit leaves: the slip |R|, R = b - A x at the x that makes it least (see `wmrgen.bounds.fits`).

Let b' be the data that the float program has, A still exact, and s' what is left of b'. The float program's x is not
the best for b' and A but off by dv, given its w, and by dw: it leaves hypot(s', sqrt(dv M dv + c D dw^2)). To that come
the roundings of A and of R; and s' differs from s by |b' - b| at most. Errors of data so count as they stand, not as
they come back through x, and those of x in full only where s = 0. With t the second leg, the result is off by at most

    roundings + |b' - b| + hypot(s, t) - s, and what is relative to it.

And what is left is no longer than b.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wmrgen.bounds import slopes as sl
from wmrgen.bounds.analysis import Pass
from wmrgen.bounds.fits import Fit
from wmrgen.bounds.interval import GROW, magnitude
from wmrgen.bounds.patterns import terms_below_root
from wmrgen.bounds.records import Claim
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.prune import places, prune

_ROUNDED = (Op.ADD, Op.SUB, Op.MUL, Op.DIV)  # by half a unit in the last place of what they give


def left_over(fit: Fit, function: Function, whole: Pass) -> Claim:
    """Range and error of |R|, given the walk through the ``whole`` function over one box."""
    with np.errstate(all="ignore"):
        parts = parts_of(fit, function, whole)
        # Relative to |R|: the roundings of its parts, of the sum and of the root. And what may be lost to underflow.
        relative = (max(t.roundings for t in fit.terms) / 2 + 2) * whole.form.unit * (1 + 1e-5)
        lost = float(np.sqrt(2 * len(fit.terms) * whole.form.tiny))
        own, through = parts.rows + parts.data, float(np.hypot(parts.beside, parts.turned))
        errors = []  # where nothing is left, and where most is: the error is convex between them
        for left in (0.0, parts.longest):
            computed = float(np.hypot(left, through))
            errors.append(own + (computed - left) + relative * (computed + own) + lost)
        error = float(np.max(errors) * GROW)
    return Claim(0.0, parts.longest + error, error, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Parts:
    """``rows``: roundings of A and R. ``data``: |b' - b|. ``beside``, ``turned``: the roots of dv M dv and c D dw^2.

    ``longest``: |b|.
    """

    rows: float
    data: float
    beside: float
    turned: float
    longest: float


def parts_of(fit: Fit, function: Function, whole: Pass) -> Parts:
    """Upper bounds of what the error is made of."""
    apart = _apart(fit, function, whole)
    # The rounding of a product that may be contracted is left to its uses.
    off = {d.node: _error(d.node, whole, rounded=d.node not in whole.rows) for d in fit.data}
    return Parts(
        _rows(apart) + _uneven(fit, whole), _data(fit, off), _beside(fit, apart), _turned(fit, apart, off, whole),
        _longest(fit, function, whole),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Apart:
    """A walk through |R| of any x and exact data, N of the same data, and v of any w: their nodes there."""

    walk: Pass
    root: int
    dividend: int
    v: tuple[int, ...]

    def error(self, k: int) -> float:
        return float(self.walk.result.error(k)[0])


def _apart(fit: Fit, function: Function, whole: Pass) -> _Apart:
    """``function`` taken apart: x is an input of |R|, w of v; data count as exact, products of them by their factors.

    A product may be contracted with each sum that it stands in: what is common to its uses are its factors alone.
    """
    names = {k: f"fitted {k}" for k in (*fit.v, fit.w)}
    data = {d.node for d in fit.data}
    nodes: list[Node] = []
    place: list[int] = []
    computed: list[int] = []
    exact: list[int] = []
    factors: dict[int, int] = {}

    def made(node: Node, args: list[int]) -> int:
        nodes.append(Node(node.op, tuple(args), node.value, node.name))
        return len(nodes) - 1

    for i, node in enumerate(function.nodes):
        args = [place[k] for k in node.args]
        if i in data and i in whole.rows:
            for k in node.args:
                if k not in factors:
                    factors[k] = made(function.nodes[k], [place[a] for a in function.nodes[k].args])
            args = [factors[k] for k in node.args]
        place.append(made(node, args))
        if i in data and i not in whole.rows:
            exact.append(place[i])
        if i in fit.v:
            computed.append(place[i])
        if i in names:
            place[i] = made(Node(Op.INPUT, name=names[i]), [])
    wanted = [place[fit.root], place[fit.dividend], *computed]
    where = places(nodes, wanted)
    kept, (root, dividend, *v) = prune(nodes, wanted)
    given = {where[k] for k in (*exact, *factors.values()) if k in where}
    cut = Function(function.name, function.inputs, kept, (), (root, dividend, *v))
    inputs = {**whole.inputs, **{name: whole.range(k) for k, name in names.items()}}
    walk = Pass(cut, inputs, whole.form, whole.library, given=given)
    walk.run()
    return _Apart(walk, root, dividend, tuple(v))


def _error(k: int, p: Pass, *, rounded: bool) -> float:
    """How far node ``k`` is off, with its own rounding or without."""
    slope = p.result.slopes[k]
    return float(
        sl.weighed(slope if rounded else sl.without(slope, p.sources[k]), p.result.noise, p.boxes)[0]
    )


def _rows(apart: _Apart) -> float:
    """How far R is off by its own roundings and those of A, but for the last of each part, which is relative to it."""
    p, total = apart.walk, 0.0
    for t in terms_below_root(p.nodes, p.nodes[apart.root].args[0]):
        off = _error(t.base, p, rounded=p.nodes[t.base].op not in _ROUNDED) + p.form.tiny
        total += float(t.factor) * off**2
    return float(np.sqrt(total)) * GROW


def _uneven(fit: Fit, p: Pass) -> float:
    """What it adds that a product among x may be rounded in one of its uses and not in another."""

    def rounding(k: int) -> float:
        return float(p.result.noise[p.sources[k]][0]) if k in p.rows else 0.0

    by = np.array([rounding(k) for k in fit.v])
    high = float(p.range(fit.divisor)[1][0])
    return float(np.sqrt(by @ fit.matrix @ by) + np.sqrt(fit.factor * high) * rounding(fit.w)) * GROW


def _data(fit: Fit, off: Mapping[int, float]) -> float:
    """|b' - b|"""
    by = sum((d.column * off[d.node] for d in fit.data), np.zeros(len(fit.terms)))
    return float(np.sqrt(np.dot([float(t.factor) for t in fit.terms], by**2))) * GROW


def _beside(fit: Fit, apart: _Apart) -> float:
    """sqrt(dv M dv), v beside the best for its w."""
    by = np.array([apart.error(k) for k in apart.v])
    return float(np.sqrt(by @ fit.matrix @ by)) * GROW


def _turned(fit: Fit, apart: _Apart, off: Mapping[int, float], whole: Pass) -> float:
    """sqrt(c D) |dw|: D dw is no more than the errors of N, with its defects, and of D times w, and w's rounding."""
    low, high = (float(end[0]) for end in whole.range(fit.divisor))
    dividend = apart.error(apart.dividend) + sum(off[d.node] * d.defect for d in fit.data)
    divisor = float(whole.result.error(fit.divisor)[0])
    size = dividend + float(magnitude(whole.range(fit.w))[0]) * divisor
    rounded = float(np.sqrt(high) * whole.result.noise[whole.sources[fit.w]][0])
    return float(np.sqrt(fit.factor) * (size / np.sqrt(low) * (1 + divisor / low) + rounded) * GROW)


def _longest(fit: Fit, function: Function, whole: Pass) -> float:
    """Upper bound of |b|: |R| where x is zero."""
    builder, place = Builder(), list[int]()
    for i, node in enumerate(function.nodes[: fit.root + 1]):
        args = [place[k] for k in node.args]
        place.append(builder.const(0) if i in (*fit.v, fit.w) else builder.copy(node, args))
    nodes, (root,) = prune(builder.nodes, [place[fit.root]])
    alone = Function(function.name, function.inputs, nodes, (), (root,))
    return float(Pass(alone, whole.inputs, whole.form, whole.library).run().ranges[root][1][0])
