"""Which boxes of inputs an analysis looks at: one where that is enough, else parts of the steering angles."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from wmrgen.ir.nodes import Function, Op
from wmrgen.proofs.analysis import analyse
from wmrgen.proofs.directions import directions
from wmrgen.proofs.domain import Range
from wmrgen.proofs.interval import Interval
from wmrgen.proofs.patterns import sinc_argument
from wmrgen.proofs.precision import Format, Library
from wmrgen.proofs.records import Analysis

PARTS = 16  # of each angle
MOST_ANGLES = 2  # of more, a grid that one can afford is too coarse to help


def analysed(
    function: Function,
    ranges: Mapping[str, Range],
    form: Format,
    library: Library,
    twice: Collection[int] = (),
) -> Analysis:
    """The analysis of a function over ``ranges``."""
    return analyse(function, boxed(ranges, _split(function, ranges)), form, library, twice)


def _split(function: Function, ranges: Mapping[str, Range]) -> list[str]:
    """Angles to divide: those of sines, where there is a divisor that no known shape accounts for."""
    nodes = function.nodes
    known = {d.quotient for d in directions(nodes).values()}
    hard = any(
        n.op is Op.DIV and i not in known and sinc_argument(nodes, n) is None for i, n in enumerate(nodes)
    )
    if not hard:
        return []
    waves = {n.args[0] for n in nodes if n.op in (Op.SIN, Op.COS)}
    names = dict.fromkeys(nodes[k].name for k in sorted(waves) if nodes[k].op is Op.INPUT)
    split = [name for name in names if name is not None and name in ranges]
    return split if len(split) <= MOST_ANGLES else []


def boxed(ranges: Mapping[str, Range], split: list[str]) -> dict[str, Interval]:
    """A grid over the inputs in ``split``, the whole range of the others."""
    parts = PARTS
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
