"""Parts of the inputs on each of which plain interval arithmetic shows that every operation is defined.

Frama-C Eva does not recognise sums of squares: it cannot see that x is not zero if x x is not small. It can if it
gets the inputs in parts. Each part with an operation that is not shown to be defined is halved along the inputs on
which that operation depends, until there is none or `MOST` parts are reached.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Interval
from wmrgen.ir.bounds.assumptions import SINGLE, Range, constant
from wmrgen.ir.nodes import Function, Node, Op

MOST = 512  # parts of one function: keeps Eva from running for hours
_DEPTH = 24  # halvings of one input: its parts are then a few float32 wide
# Share of the largest number beyond which a part is halved as if there was an overflow. Eva's ranges are wider.
_LARGE = 2.0**-28
_MARGIN = 1e-5  # relative rounding error of a float result that is allowed for [1]; one rounding is 6e-8


def cases(function: Function, ranges: Mapping[str, Range], finer: int = 0) -> list[dict[str, Range]]:
    """Divide the ranges of inputs into parts.

    Args:
        function: the function, without calls.
        ranges: (low, high) by input name.
        finer: how often every part is halved again along the inputs that were divided. If no input was divided, along
            those on which divisors depend.

    Returns:
        The parts, which cover ``ranges``; one part if nothing needs to be divided.
    """
    names = [name for name, (lo, hi) in ranges.items() if lo < hi]
    parts: list[dict[str, Range]] = []
    pending: list[dict[str, Range]] = [dict(ranges)]
    cones = _cones(function)
    for depth in range(_DEPTH):
        first = _first_alarm(function, pending)
        halves: list[dict[str, Range]] = []
        for part, node in zip(pending, first, strict=True):
            along = [n for n in names if node >= 0 and n in cones[node]]
            if not along or len(parts) + len(halves) + len(pending) > MOST:
                parts.append(part)
            else:
                halves += _halved(part, along[depth % len(along)])
        pending = halves
        if not pending:
            break
    parts += pending
    divided = []
    for name in names:
        if any(part[name] != ranges[name] for part in parts):
            divided.append(name)
    if not divided:  # Eva may show less than is shown here
        below = {n for node in function.nodes if node.op is Op.DIV for n in cones[node.args[1]]}
        divided = [n for n in names if n in below]
    for name in divided * finer:
        parts = [half for part in parts for half in _halved(part, name)]
    return parts


def _halved(part: dict[str, Range], name: str) -> list[dict[str, Range]]:
    lo, hi = part[name]
    middle = float(np.float32(lo + (hi - lo) / 2))
    return [{**part, name: (lo, middle)}, {**part, name: (middle, hi)}]


def _cones(function: Function) -> list[frozenset[str]]:
    """Return by node the inputs on which it depends."""
    cones: list[frozenset[str]] = []
    for node in function.nodes:
        own = frozenset({node.name}) if node.op is Op.INPUT and node.name else frozenset[str]()
        cones.append(own.union(*(cones[k] for k in node.args)))
    return cones


def _first_alarm(function: Function, parts: list[dict[str, Range]]) -> list[int]:
    """Return by part the first divisor that may be zero or node that may overflow, -1 if there is none."""
    first = np.full(len(parts), -1)
    values: list[Interval] = []
    with np.errstate(all="ignore"):
        for i, node in enumerate(function.nodes):
            if node.op is Op.INPUT:
                ends = [part[node.name or ""] for part in parts]
                value = np.array([lo for lo, _ in ends]), np.array([hi for _, hi in ends])
            elif node.op is Op.DIV:
                value = _quotient(function.nodes, values, node)
            else:
                value = _value(node, values, len(parts))
            values.append(value)
            bad = ~(iv.magnitude(value) <= SINGLE.largest * _LARGE)
            where = node.args[1] if node.op is Op.DIV else i
            first = np.where((first < 0) & bad, where, first)
    return [int(i) for i in first]


def _value(node: Node, values: Sequence[Interval], count: int) -> Interval:
    if node.value is not None:
        lo, hi, _, _ = constant(node.value)
        return np.full(count, lo), np.full(count, hi)
    op, args = node.meaning
    assert op.interval is not None
    value = op.interval(*(values[k] for k in args))
    return _widened(value) if op.rounds else value


def _quotient(nodes: Sequence[Node], values: Sequence[Interval], node: Node) -> Interval:
    """Return the range of a quotient. If the divisor is a choice of two values, both quotients count, as for Eva."""
    a, b = node.args
    guard = nodes[b]
    if guard.op is Op.AT_LEAST:  # the code moves the sign to the dividend
        divisor, least = (values[k] for k in guard.args)
        first = iv.quotient(values[a], iv.larger(iv.absolute(divisor), least))
        zero = np.zeros(len(divisor[0])), np.zeros(len(divisor[0]))
        return _widened(iv.chosen(divisor, zero, iv.negative(first), first))
    if guard.op is not Op.SELECT:
        return _widened(iv.quotient(values[a], values[b]))
    small, large, x, y = (values[k] for k in guard.args)
    first, second = (iv.quotient(values[a], branch) for branch in (x, y))
    return _widened(iv.chosen(small, large, first, second))


def _widened(value: Interval) -> Interval:
    """Return the range of the rounded results: each end moves by its own rounding, so that its sign does not change."""
    low, high = (np.abs(end) * _MARGIN + SINGLE.tiny for end in value)
    return value[0] - low, value[1] + high
