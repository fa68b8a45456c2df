"""What a slope between limits leaves of a vector (a, b): t = c b / a between -m and m; a t; b - a t where c = 1.

a t is no larger than c b, and b - a t no larger than b, however t turns where the vector is short.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from wmrgen.bounds import interval as iv
from wmrgen.bounds import slopes as sl
from wmrgen.bounds.interval import Array, Interval
from wmrgen.bounds.slopes import Slope
from wmrgen.ir.nodes import Node, Op

if TYPE_CHECKING:
    from wmrgen.bounds.analysis import Pass
    from wmrgen.bounds.directions import Direction


def leaning(nodes: Sequence[Node], i: int, found: Mapping[int, Direction]) -> int | None:
    """The slope t between limits of either sign of node ``i``, a t: t is c b / a there, or nearer zero."""
    for t, a in (nodes[i].args, nodes[i].args[::-1]) if nodes[i].op is Op.MUL else ():
        if t in found and found[t].kept and found[t].parts[0][1] == a:
            return t
    return None


def rest_of(nodes: Sequence[Node], node: Node, found: Mapping[int, Direction]) -> int | None:
    """The slope t of a node b - a t, t = b / a between limits of either sign: what is left of b, or nothing."""
    t = leaning(nodes, node.args[1], found) if node.op is Op.SUB else None
    if t is None or found[t].parts[1][1] != node.args[0]:
        return None
    return t if any(found[t].quotient in nodes[k].args for k in nodes[t].args) else None


def turned_by(p: Pass, i: int, value: Interval) -> Interval:
    """``value``, the range of node ``i``: no larger than c b where it is a t."""
    t = leaning(p.nodes, i, p.directions)
    if t is None:
        return value
    factor, b = p.directions[t].parts[1]
    most = factor * iv.magnitude(p.range(b)) * iv.GROW + _excess(p, t)
    return iv.meet(value, (-most, most))


def left(p: Pass, node: Node, value: Interval) -> tuple[Interval, Slope] | None:
    """Range, within ``value``, and slope of a node b - a t; None of others."""
    t = rest_of(p.nodes, node, p.directions)
    if t is None:
        return None
    low, high = p.range(node.args[0])
    excess = _excess(p, t) + p.result.noise[p.sources[node.args[1]]]
    inside = np.minimum(low, 0.0) - excess, np.maximum(high, 0.0) + excess
    return iv.meet(value, inside), _slope(p, t, node.args[1])


def _excess(p: Pass, t: int) -> Array:
    """How much larger a t may be than c b, t the slope c b / a between limits: rounding, and the side of a."""
    d = p.directions[t]
    own = p.result.noise[p.sources[t]] * iv.magnitude(p.range(d.parts[0][1]))
    return np.asarray((own + 2 * d.reach * p.rho[t]) * (1 + 1e-6))


def _slope(p: Pass, t: int, product: int) -> Slope:
    """Slope of b - a t, t the slope b / a between limits -m and m.

    It is what of b is left beyond m |a|: of slope 0 to 1 in b and at most m in a, however t turns; of t and of
    the product only the roundings count. That is continuous where a changes sign, so here the sign of a is what
    it is at each moment of the way, not what the float program decides.
    """
    d = p.directions[t]
    one, wall = np.ones(p.boxes), np.full(p.boxes, d.reach)
    a, b = (p.slope(k) for _, k in d.parts)
    slope = sl.plus(sl.times(b, (0 * one, one)), sl.times(a, (-wall, wall)))
    first, own = p.sources[product], p.sources[t]
    for row in (own, own + 3, *range(first, first + 1 + p.uses.get(product, 0))):
        slope = sl.added(slope, row, p.magnitude(product, row), p.boxes)
    return slope
