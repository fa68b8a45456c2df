"""Arms: products p cos x and p sin x, which lie on a circle of radius |p| together, and sums of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from wmrgen.bounds.interval import Array, Interval, magnitude
from wmrgen.ir.nodes import Node, Op

_MOST = 3  # different p in one sum
# Of arms as computed: sines and cosines are within 3 * 2**-24 of a circle, products within a rounding.
_UNIT = 1 + 1e-6


@dataclass(frozen=True, slots=True)
class Arm:
    """The node is the sine or cosine (``wave``) of node ``angle``, times node ``p`` unless that is None."""

    p: int | None
    wave: Op
    angle: int


def arm(nodes: Sequence[Node], i: int) -> Arm | None:
    """Node ``i`` as an arm."""
    node = nodes[i]
    if node.op in (Op.SIN, Op.COS):
        return Arm(None, node.op, node.args[0])
    if node.op is Op.MUL:
        for k, p in (node.args, node.args[::-1]):
            if nodes[k].op in (Op.SIN, Op.COS):
                return Arm(p, nodes[k].op, nodes[k].args[0])
    return None


def reach(terms: Sequence[tuple[Arm, float]], ranges: Sequence[Interval]) -> Array | None:
    """Upper bound of |sum of c times arm| over arms of one angle: |a cos x + b sin x| is no more than |(a, b)|.

    That length is convex in every p, so greatest where each is at plus or minus its largest value. None of sines
    alone, of cosines alone, of many p, and where nodes repeat: their roundings differ.
    """
    ps = list(dict.fromkeys(a.p for a, _ in terms))
    alike = len({a for a, _ in terms}) < len(terms)
    if len({a.wave for a, _ in terms}) < 2 or len(ps) > _MOST or alike:
        return None
    found = np.zeros(1)
    for signs in product((1.0, -1.0), repeat=len(ps) - 1):
        sign = dict(zip(ps, (1.0, *signs), strict=True))
        sums = {Op.COS: np.zeros(1), Op.SIN: np.zeros(1)}
        for a, c in terms:
            size = np.ones(1) if a.p is None else magnitude(ranges[a.p])
            sums[a.wave] = sums[a.wave] + sign[a.p] * c * size
        found = np.maximum(found, np.hypot(sums[Op.COS], sums[Op.SIN]))
    return np.asarray(found * _UNIT)
