"""Arms: products p cos x and p sin x, which lie on a circle of radius |p| together, and sums of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from wmrgen.ir.nodes import Node, Op
from wmrgen.proofs.circles import UNIT
from wmrgen.proofs.interval import GROW, Array, Interval, magnitude

_MOST = 3  # arms of one angle


@dataclass(frozen=True, slots=True)
class Arm:
    """The node is ``p`` (None: 1) times the sine or cosine (``wave``) of node ``angle``."""

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


def reach(terms: Mapping[Arm, float], ranges: Sequence[Interval]) -> Array | None:
    """Upper bound of |sum of c times arm| over arms of one angle; None where plain sums are no worse.

    It is |a cos x + b sin x|, a and b sums of the p, and so no more than the length of (a, b).
    """
    ps = list(dict.fromkeys(a.p for a in terms))
    if len({a.wave for a in terms}) < 2 or len(ps) > _MOST:
        return None
    found = np.zeros(1)
    for signs in product((1.0, -1.0), repeat=len(ps) - 1):
        sign = dict(zip(ps, (1.0, *signs), strict=True))
        sums = {Op.COS: np.zeros(1), Op.SIN: np.zeros(1)}
        for a, c in terms.items():
            size = np.ones(1) if a.p is None else magnitude(ranges[a.p])
            sums[a.wave] = sums[a.wave] + sign[a.p] * c * size
        found = np.maximum(found, np.hypot(sums[Op.COS], sums[Op.SIN]))
    return np.asarray(found * UNIT * GROW)
