"""Which boxes of inputs an analysis looks at: one where that is enough, else parts of the angles, finer on demand."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds.analysis import Pass
from wmrgen.bounds.directions import directions
from wmrgen.bounds.domain import Range
from wmrgen.bounds.fits import fit_of
from wmrgen.bounds.interval import Interval
from wmrgen.bounds.leftover import left_over
from wmrgen.bounds.patterns import sinc_argument
from wmrgen.bounds.precision import Format, Library
from wmrgen.bounds.records import Claim, Outcome
from wmrgen.ir.nodes import Function, Op

PARTS = 16  # of each angle
MOST_ANGLES = 2  # of more, a grid that one can afford is too coarse to help


def analysed(
    function: Function,
    ranges: Mapping[str, Range],
    form: Format,
    library: Library,
    twice: Collection[int] = (),
) -> Outcome:
    """The analysis of a function over ``ranges``."""
    angles = _angles(function, ranges)
    if not 0 < len(angles) <= MOST_ANGLES or not _divides(function):
        return _outcome(function, boxed(ranges, [], 1), form, library, twice)
    if directions(function.nodes):
        return _outcome(function, boxed(ranges, angles, PARTS), form, library, twice)
    from wmrgen.bounds.refinement import refined  # of few robots

    return refined(function, ranges, angles, form, library, twice)


def _outcome(
    function: Function, boxes: Mapping[str, Interval], form: Format, library: Library, twice: Collection[int]
) -> Outcome:
    """Every result on given boxes."""
    walk = Pass(function, boxes, form, library, twice)
    found = walk.run()
    claims = []
    for k in function.results:
        error, over = found.split_error(k)
        low, high = found.ranges[k]
        claims.append(
            Claim(*map(float, (low.min(), high.max(), error.max(), over.max(), found.lengths(k).max())))
        )
    if (
        walk.boxes == 1 and not twice and _divides(function)
    ):  # more boxes have bounds of their own, nearly sharp
        fit = fit_of(function)
        if fit is not None:
            at = function.results.index(fit.root)
            claims[at] = _closer(claims[at], left_over(fit, function, walk))
    return Outcome(tuple(claims), tuple((i, what) for i, what, _ in found.alarms))


def _closer(a: Claim, b: Claim) -> Claim:
    """Both claims of one result, which depends on no direction."""
    error, high = float(np.fmin(a.error, b.error)), float(np.fmin(a.high, b.high))
    return Claim(max(a.low, b.low), high, error, 0.0, 0.0)


def _divides(function: Function) -> bool:
    """Whether there is a divisor that no known shape accounts for."""
    nodes = function.nodes
    known = {d.quotient for d in directions(nodes).values()}
    return any(
        n.op is Op.DIV and i not in known and sinc_argument(nodes, n) is None for i, n in enumerate(nodes)
    )


def _angles(function: Function, ranges: Mapping[str, Range]) -> list[str]:
    """Inputs of sines."""
    waves = {n.args[0] for n in function.nodes if n.op in (Op.SIN, Op.COS)}
    names = dict.fromkeys(function.nodes[k].name for k in sorted(waves) if function.nodes[k].op is Op.INPUT)
    return [name for name in names if name is not None and name in ranges]


def boxed(ranges: Mapping[str, Range], split: list[str], parts: int) -> dict[str, Interval]:
    """A grid over the inputs in ``split``, the whole range of the others."""
    boxes = parts ** len(split)
    found: dict[str, Interval] = {}
    for name, (lo, hi) in ranges.items():
        if name in split:
            edges = np.linspace(lo, hi, parts + 1)
            place = _place(split.index(name), parts, boxes)
            found[name] = edges[place], edges[place + 1]
        else:
            found[name] = np.full(boxes, lo), np.full(boxes, hi)
    return found


def _place(axis: int, parts: int, boxes: int) -> NDArray[np.int64]:
    return np.asarray((np.arange(boxes) // parts**axis) % parts)
