"""Which boxes of inputs an analysis looks at: one where that is enough, else parts of the angles."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds.assumptions import Format, Library, Range
from wmrgen.bounds.linear import errors_one_by_one
from wmrgen.bounds.walk import Walk
from wmrgen.ir.interval import Interval
from wmrgen.ir.nodes import Function, Op

# Parts of each of so many angles; of more, a grid that one can afford is too coarse to help.
PARTS = {1: 128, 2: 36}
_TURN = 3.1416  # half a turn and a little [rad]


@dataclass(frozen=True, slots=True)
class Claim:
    """A result lies in [low, high] and is off by at most error + over / h where h >= `SMALL_ANGLE` rho.

    ``singular``: a divisor on which it depends comes close to zero, so that these numbers mean nothing.
    """

    low: float
    high: float
    error: float
    over: float
    rho: float
    singular: bool = False


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of a function: a claim per result, and what is not shown (node, what)."""

    claims: tuple[Claim, ...]
    alarms: tuple[tuple[int, str], ...]


def analysed(
    function: Function,
    ranges: Mapping[str, Range],
    form: Format,
    library: Library,
    twice: Collection[int] = (),
) -> Outcome:
    """The analysis of a function over ``ranges``."""
    angles = _angles(function, ranges)
    boxes = boxed(ranges, [], 1)
    if len(angles) in PARTS and _divides(function):
        boxes = boxed(_within_a_turn(function, ranges, angles, library), angles, PARTS[len(angles)])
    upper = {}
    if any(len(lo) > 1 for lo, _ in boxes.values()):
        upper = errors_one_by_one(function, boxes, form, library, twice)
    walk = Walk(function, boxes, form, library, twice, upper).run()
    errors = walk.errors(function.results)
    claims = []
    for row, k in enumerate(function.results):
        low, high = walk.ranges[k]
        over = sum(float(v[row].max()) for v in errors.over.values())
        error, divisions = float(errors.plain[row].max()), errors.divisions[row]
        rho = max((walk.lengths[j].rho for j in divisions - walk.singular), default=0.0)
        singular = not divisions.isdisjoint(walk.singular) or not np.isfinite(error + over + rho)
        claims.append(Claim(float(low.min()), float(high.max()), error, over, rho, singular))
    return Outcome(tuple(claims), tuple(dict.fromkeys((i, what) for i, what, _ in walk.alarms)))


def _divides(function: Function) -> bool:
    """Whether a divisor may depend on an input angle: it is neither a length nor guarded by itself."""
    return any(n.op is Op.DIV for n in function.nodes)


def _angles(function: Function, ranges: Mapping[str, Range]) -> list[str]:
    """Inputs of sines."""
    waves = {n.args[0] for n in function.nodes if n.op in (Op.SIN, Op.COS)}
    names = dict.fromkeys(function.nodes[k].name for k in sorted(waves) if function.nodes[k].op is Op.INPUT)
    return [name for name in names if name is not None and name in ranges]


def _within_a_turn(
    function: Function, ranges: Mapping[str, Range], angles: list[str], library: Library
) -> dict[str, Range]:
    """``ranges``; one turn for an angle that has more and of which only sine and cosine are taken."""
    turned = dict(ranges)
    for name in angles:
        users = {n.op for n in function.nodes if any(function.nodes[k].name == name for k in n.args)}
        lo, hi = ranges[name]
        if users <= {Op.SIN, Op.COS} and hi - lo > 2 * _TURN and max(-lo, hi) <= library.reach:
            turned[name] = -_TURN, _TURN
    return turned


def boxed(ranges: Mapping[str, Range], split: list[str], parts: int) -> dict[str, Interval]:
    """A grid over the inputs in ``split``, the whole range of the others."""
    boxes = parts ** len(split)
    grid: dict[str, Interval] = {}
    for name, (lo, hi) in ranges.items():
        if name in split:
            edges = np.linspace(lo, hi, parts + 1)
            place = _place(split.index(name), parts, boxes)
            grid[name] = edges[place], edges[place + 1]
        else:
            grid[name] = np.full(boxes, lo), np.full(boxes, hi)
    return grid


def _place(axis: int, parts: int, boxes: int) -> NDArray[np.int64]:
    return np.asarray((np.arange(boxes) // parts**axis) % parts)
