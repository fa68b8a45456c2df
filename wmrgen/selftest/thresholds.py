"""Points just beside a wall: where a choice at a constant turns, or a rounding to a whole number.

A constant that is off by a thousandth moves the wall across such a point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Op, Port
from wmrgen.ir.prune import prune
from wmrgen.ir.rounding import to_float64

Array = Any
Wall = tuple[int, float]  # node, and its value at the wall
BESIDE = "beside a wall"
_STEP, _ROOM = 5e-4, 2e-4  # of the wall's value: how far beside it, and how well that is met
_LEAST = 1e-2  # smaller constants guard divisors and bound series
_HALVINGS, _MOST, _PAIRS = 40, 11, 4


def near_thresholds(
    function: Function, ports: Sequence[Port], rows: Array, given: Mapping[str, Array]
) -> Iterator[tuple[str, Array]]:
    """Points on segments between ``rows`` (one column per port), both sides of every wall that these cross."""
    if not len(rows) or not any(n.op in (Op.SELECT, Op.MIN, Op.MAX, Op.RINT) for n in function.nodes):
        return

    @np.errstate(all="ignore")
    def at(points: Array, run: Function) -> list[Array]:
        columns = {port.name: points[:, k] for k, port in enumerate(ports)}
        return values_of(run, {**given, **columns}, np.float64)

    found = at(rows, function)
    goals: list[Wall] = []
    ends: list[tuple[int, int]] = []
    for node, goal in _goals(function, found):
        column = np.broadcast_to(found[node], len(rows))
        below, above = np.flatnonzero(column < goal), np.flatnonzero(column > goal)
        if len(below) and len(above) and len(goals) < _MOST * _PAIRS:
            for k in range(_PAIRS):  # on some segments the value jumps over the wall
                goals.append((node, goal))
                ends.append((int(below[k % len(below)]), int(above[-1 - k % len(above)])))
    if not goals:
        return
    needed = tuple(dict.fromkeys(node for node, _ in goals))
    nodes, results = prune(function.nodes, needed)
    short = replace(function, nodes=nodes, results=results)
    place = dict(zip(needed, results, strict=True))
    low, high = (rows[[pair[side] for pair in ends]] for side in (0, 1))
    wanted = np.array([goal for _, goal in goals])
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        values = at(middle, short)
        under = np.array([values[place[node]][k] for k, (node, _) in enumerate(goals)]) < wanted
        low, high = np.where(under[:, None], middle, low), np.where(under[:, None], high, middle)
    points = low.astype(np.float32).astype(np.float64)
    values = at(points, short)
    met: set[Wall] = set()
    for k, (node, goal) in enumerate(goals):
        if (node, goal) not in met and abs(values[place[node]][k] - goal) <= _ROOM * abs(goal):
            met.add((node, goal))
            yield BESIDE, points[k]


def _goals(function: Function, found: Sequence[Array]) -> list[Wall]:
    """Both sides of every wall; first beyond limits and short of roundings, where larger constants show."""
    walls = _walls(function, found)
    first = [(node, wall * (1 - _STEP if half else 1 + _STEP)) for node, wall, half in walls]
    return first + [(node, wall * (1 + _STEP if half else 1 - _STEP)) for node, wall, half in walls]


def _walls(function: Function, found: Sequence[Array]) -> list[tuple[int, float, bool]]:
    """Node, value and whether that is half a whole number."""
    walls: dict[tuple[int, float, bool], None] = {}
    for node in function.nodes:
        if node.op in (Op.SELECT, Op.MIN, Op.MAX):
            for c, other in (node.args[:2], node.args[1::-1]):
                value = function.nodes[c].value
                if value is not None and abs(wall := to_float64(value)) >= _LEAST:
                    walls[other, wall, False] = None
        elif node.op is Op.RINT:
            inner = node.args[0]
            far = np.sort(np.atleast_1d(found[inner]))
            for end in (far[1], far[-2]) if len(far) > 3 else ():
                walls[inner, float(np.trunc(end) + np.copysign(0.5, -end)), True] = None
    return [wall for wall in walls if wall[1]]
