"""Clocks and headings of a truth that drift or jump in a drive.

What a tracker's clock and its heading are off by should be the same from the first row to the last. In pieces of a
drive, each with a start of its own, so that no slip before it counts, both are told anew: linear least squares, one
step from the fit. Where they lie along a line, or are one before a time and another after it, and that explains nearly
all that they differ by, clock or heading drifts or jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.calibrating.fit import LEVER, UNIT_OWN, Each, Problem, residuals
from wmrgen.tools.calibrating.path import Reals

FEWEST = 12  # rows of truth in a piece, or in a part of a drive
_DRIFTS, _JUMPS = (0.2, 0.05), 0.3  # [s], [rad] over a drive; [s] at once: what is less is not told
_PIECES = (6, 12)  # of a drive, in which clock and heading are told anew: so many at least and at most
_AROUND = 2  # pieces before and after a jump at least: one alone may be odd
_PIECE = 3.0  # [s] that each lasts at least
_TOLD = 1e-6  # of the largest singular value: what is less tells nothing
_UNEXPLAINED = (0.1, 0.15)  # of the squares that pieces differ by: what a line and a jump may leave


@dataclass(frozen=True, slots=True)
class Drift:
    """From ``start`` to ``end`` [s] of a drive the truth's clock comes to show ``late`` [s] less, or its headings
    ``turned`` [rad] more; ``at_once``: by a jump somewhere between."""

    drive: str
    start: float
    end: float
    late: float
    turned: float
    at_once: bool = False


def drifts(problem: Problem, unknowns: Reals, each: Each) -> list[list[Drift]]:
    """How clock and heading of each drive's truth drift or jump, where they do."""
    pieces = each(problem, unknowns, _by_piece)
    return [_drifts(drive.name, *of) for drive, of in zip(problem.drives, pieces, strict=True)]


def _by_piece(problem: Problem, unknowns: Reals, index: int) -> tuple[Reals, Reals, Reals]:
    """Edges [s] of the pieces of a drive, by the log's clock, and what clock [s] and heading [rad] are off by in each;
    nothing where too few poses are measured."""
    nothing = (np.empty(0), np.empty(0), np.empty(0))
    rows, late = residuals(problem, unknowns, index), problem.own(unknowns, index)[-1]
    whole = (rows.weights > 0).all(axis=0)
    t = problem.drives[index].truth.t[whole] + late
    count = min(_PIECES[1], len(t) // FEWEST, int(np.ptp(t) / _PIECE) if len(t) else 0)
    if count < _PIECES[0]:
        return nothing
    edges = np.linspace(t[0], t[-1], count + 1)
    by, off = rows.by[:, whole, -len(UNIT_OWN) :], rows.values[:, whole]
    turn = np.broadcast_to(np.array([0.0, 0.0, LEVER])[:, None, None], (*off.shape, 1))
    by = np.concatenate([by, turn], axis=2)
    result = []
    for first, last in pairwise(np.searchsorted(t, edges)):
        columns = by[:, first:last].reshape(-1, by.shape[2])
        size = np.linalg.norm(columns, axis=0)
        if last - first < FEWEST or not size.all():
            return nothing  # it stands, or the truth has a gap
        off_by, _, rank, _ = np.linalg.lstsq(columns / size, -off[:, first:last].ravel(), rcond=_TOLD)
        if rank < len(size):
            return nothing
        result.append(off_by[-2:] / size[-2:])
    clock, heading = np.array(result).T
    return edges, UNIT_OWN[-1] * clock, heading


def _drifts(name: str, edges: Reals, clock: Reals, heading: Reals) -> list[Drift]:
    """What clock and heading in the pieces between ``edges`` tell."""
    if not len(edges):
        return []
    count = len(clock)
    along = (edges[1:] + edges[:-1]) / 2 / np.ptp(edges)
    spread = np.sum((clock - clock.mean()) ** 2), np.sum((heading - heading.mean()) ** 2)
    (line, drift), (line_of_heading, turned) = (_regression([along], values) for values in (clock, heading))
    where = range(_AROUND, count - _AROUND)  # the piece with the jump, which may be anything
    jumps = [_regression([np.arange(count) > k, np.arange(count) == k], clock) for k in where]
    jump = where[int(np.argmin([rest for rest, _ in jumps]))]
    rest, moved = jumps[jump - _AROUND]
    result = []
    if rest < min(_UNEXPLAINED[1] * spread[0], line / 2) and abs(moved) > _JUMPS:
        result.append(Drift(name, float(edges[jump]), float(edges[jump + 1]), moved, 0.0, at_once=True))
    elif line < _UNEXPLAINED[0] * spread[0] and abs(drift) > _DRIFTS[0]:
        result.append(Drift(name, float(edges[0]), float(edges[-1]), drift, 0.0))
    if line_of_heading < _UNEXPLAINED[0] * spread[1] and abs(turned) > _DRIFTS[1]:
        result.append(Drift(name, float(edges[0]), float(edges[-1]), 0.0, turned))
    return result


def _regression(columns: Sequence[Reals | NDArray[np.bool_]], values: Reals) -> tuple[float, float]:
    """The squares of ``values`` that a constant and ``columns`` leave, and how much the first of these counts."""
    matrix = np.array([*columns, np.ones(len(values))], dtype=float).T
    counts = np.linalg.lstsq(matrix, values, rcond=None)[0]
    return float(np.sum((matrix @ counts - values) ** 2)), float(counts[0])
