"""Parts of drives in which wheels slipped or were lifted, and drives without them.

What a slip moves and turns stays, so errors of the path make a step there; what a clock or a tracker is off by for a
moment comes back. Steps that are far larger than usual are slips. Where joints measure more than a twist needs, what
they disagree by, the residual (I - H H^+) of their rolling equations, tells slips too, without any truth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from wmrgen.tools.calibrating.certainty import Fit
from wmrgen.tools.calibrating.drifts import FEWEST, Drift
from wmrgen.tools.calibrating.fit import BEYOND, LEVER, Problem, Residuals, later, residuals
from wmrgen.tools.calibrating.logs import Drive
from wmrgen.tools.calibrating.path import Reals
from wmrgen.tools.calibrating.stored import changed

_PASSES = 3  # in which slips are looked for: large ones hide smaller ones
_STEP = 0.25  # [s] at which errors are compared
_WINDOW, _BETWEEN = 8, 4  # steps whose median is compared, before and after, and steps between
_PATH = (0.06, 0.15)  # [m], [rad] that a slip in the path is at least: clocks that drift make steps, too
_SEEN, _FAR = 4.0, 7.0  # robust standard deviations: what is farther is a slip, of the path and among joints
_LATE = 1.5  # [s] that a clock may be off by in a drive
STRANGE = 5.0  # [s] that a clock is off by, where log and truth hardly belong to one drive
_CLOCK = 0.5  # of a step: what another clock leaves of it, where the clock makes it
_WORSE = 2.0  # times the smallest usual steps of a drive: a clock under which they are larger is not its own
_LARGE = 2.0  # times the scale of residuals, which a disagreement of joints in one step is at least
_NOTED = 0.02  # [m] a disagreement that is worth telling, however far the drives are off
_PEAK = 0.6  # of the largest step near by, for the slip to be there
_HIDES = 0.4  # of a drive's largest slip: what is smaller may be made by that one
_STILL = 0.02  # [m] of way in all windows: the robot stands
_MOST = 0.25  # of a drive: where more is unusual, nothing is
_SHORTEST = 3.0  # [s] of what is left of a drive between two slips


@dataclass(frozen=True, slots=True)
class Outlier:
    """From ``start`` to ``end`` [s] of a drive, by the log's clock, odometry is off by ``moved`` [m] and ``turned``
    [rad]; both are nan where joints tell it, by what they disagree."""

    drive: str
    start: float
    end: float
    moved: float
    turned: float


def without_slips(
    best: Fit,
    coarser: Callable[[Problem], Problem],
    again: Callable[[Problem, Fit], Fit],
    until: Callable[[Problem, Reals], bool] = lambda *_: False,
) -> tuple[Fit, list[Outlier]]:
    """The fit without what is unusual in the drives, ``until`` it will do, and what that is: large slips hide smaller
    ones, so after some have been taken out, drives are fitted ``again``."""
    slips = list[Outlier]()
    for _ in range(_PASSES):
        coarse = coarser(best.problem)
        unusual = [] if until(coarse, best.unknowns) else outliers(best, coarse)
        if not any(unusual):
            break
        slips += [slip for of_drive in unusual for slip in of_drive]
        best = again(without(best, unusual), best)
    return best, slips


def outliers(best: Fit, coarser: Problem) -> list[list[Outlier]]:
    """What is unusual in each drive, in the order of time: what joints tell, and where they tell nothing, what the path
    tells, for which a ``coarser`` problem of the same drives does."""
    drives = best.problem.drives
    slides = [_disagreement(best, drive) for drive in drives]
    sliding = _wide([size for _, size in slides], _FAR, min(_LARGE * best.problem.scale, _NOTED))
    spans = [
        [(at[k], at[k] + _STEP, nan, nan) for k in np.flatnonzero(size > sliding)] for at, size in slides
    ]
    if not any(spans):
        paths = [_steps(coarser, best.unknowns, index) for index in range(len(drives))]
        wide = [_wide([step[i] for _, step in paths], _SEEN, bound) for i, bound in enumerate(_PATH)]
        peaks = [_peaks(np.maximum(moved / wide[0], turned / wide[1])) for _, (moved, turned) in paths]
        spans = [
            [
                (t[k], t[k] + _BETWEEN * _STEP, moved[k], turned[k])
                for k in _no_clock(coarser, best.unknowns, index, there)
            ]
            for index, (there, (t, (moved, turned))) in enumerate(zip(peaks, paths, strict=True))
        ]
    merged = [_merged(drive.name, of_drive) for drive, of_drive in zip(drives, spans, strict=True)]
    lengths = [sum(slip.end - slip.start for slip in slips) for slips in merged]
    rare = [length < _MOST * (d.t[-1] - d.t[0]) for length, d in zip(lengths, drives, strict=True)]
    likely = [few and abs(late) < STRANGE for few, late in zip(rare, best.offsets, strict=True)]
    return [_large(slips) if so else [] for slips, so in zip(merged, likely, strict=True)]


def _large(slips: Sequence[Outlier]) -> list[Outlier]:
    """Those of a drive's slips that are not far smaller than the largest, to which all its path is bent as long as it
    is there, so that there seem to be others; all that joints tell."""
    sizes = [np.hypot(slip.moved, LEVER * slip.turned) for slip in slips]
    return [slip for slip, size in zip(slips, sizes, strict=True) if not size < _HIDES * max(sizes)]


def _no_clock(problem: Problem, unknowns: Reals, index: int, peaks: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The ``peaks`` that are not much smaller with another clock, under which the drive's usual steps are not far
    larger: where a robot stops or turns, one that is off makes steps, too."""
    at = np.flatnonzero(peaks)
    if not len(at):
        return at
    late = [0.0, *np.arange(-_LATE, _LATE + _STEP, _STEP)]
    sizes = np.array([
        np.hypot(moved, LEVER * turned)
        for _, (moved, turned) in (_steps(problem, unknowns, index, seconds) for seconds in late)
    ])  # fmt: skip
    usual = np.median(sizes, axis=1)
    likely = sizes[usual <= max(_WORSE * usual.min(), usual[0])]
    return np.asarray(at[np.min(likely[:, at], axis=0) > _CLOCK * sizes[0, at]])


def _steps(
    problem: Problem, unknowns: Reals, index: int, seconds: float = 0.0
) -> tuple[Reals, tuple[Reals, Reals]]:
    """The `_steps_of` a drive, if the truth's clock is off by so many seconds more."""
    rows = residuals(problem, later(problem, unknowns, index, seconds), index)
    t, steps = _steps_of(rows, problem.drives[index].truth.t)
    return t + problem.own(unknowns, index)[-1], steps


def _steps_of(rows: Residuals, t: Reals) -> tuple[Reals, tuple[Reals, Reals]]:
    """Times [s], and by how much the median errors of place [m] and heading [rad] differ before and after, of residuals
    at times ``t`` [s]; none where poses are not measured that often. What a heading error moves the path by
    is no error of place."""
    whole, nothing = (rows.weights > 0).all(axis=0), np.empty(0)
    t = t[whole]
    if len(t) < FEWEST or np.median(np.diff(t)) > 2 * _STEP:
        return nothing, (nothing, nothing)
    heading, way = rows.values[2][whole] / LEVER, np.diff(rows.place[whole], prepend=rows.place[whole][:1])
    place = (rows.values[0] + 1j * rows.values[1])[whole] - np.cumsum(way * (1 - np.exp(-1j * heading)))
    grid = np.arange(t[0], t[-1], _STEP)
    if len(grid) < 2 * _WINDOW + _BETWEEN:
        return nothing, (nothing, nothing)
    x, y, angle = (_differences(np.interp(grid, t, column)) for column in (place.real, place.imag, heading))
    gone = np.interp(grid, t, np.cumsum(np.abs(way) + LEVER * np.abs(np.diff(heading, prepend=heading[:1]))))
    moves = (gone[_WINDOW + _BETWEEN :] - gone[: -_WINDOW - _BETWEEN])[: len(x)] > _STILL
    return grid[_WINDOW - 1 :][: len(x)], (np.hypot(x, y) * moves, np.abs(angle) * moves)


def _differences(values: Reals) -> Reals:
    """Medians of the window after less those of the window before each time."""
    medians = np.median(sliding_window_view(values, _WINDOW), axis=1)
    return np.asarray(medians[_WINDOW + _BETWEEN :] - medians[: -_WINDOW - _BETWEEN])


def _disagreement(best: Fit, drive: Drive) -> tuple[Reals, Reals]:
    """Times, and what the joints disagree by [m] in each `_STEP` from them on; none where they cannot."""
    if best.problem.increments.rows is None:
        return np.empty(0), np.empty(0)
    slip = best.problem.increments.slip(drive.columns, best.values)
    starts = np.flatnonzero(np.diff(np.floor((drive.t[:-1] - drive.t[0]) / _STEP), prepend=-1.0))
    return drive.t[starts], np.add.reduceat(slip, starts)


def _wide(steps: list[Reals], far: float, least: float) -> float:
    """What no usual step exceeds: ``far`` robust standard deviations, and ``least`` at least."""
    sizes = np.concatenate(steps)
    sizes = sizes[sizes > 0]
    if not len(sizes):
        return np.inf
    middle = np.median(sizes)
    return float(max(least, middle + far * 1.4826 * np.median(np.abs(sizes - middle))))


def _peaks(unusual: Reals) -> NDArray[np.bool_]:
    """Where a step is unusual, above 1, and not far smaller than the largest near by."""
    if not len(unusual):
        return np.empty(0, dtype=bool)
    near = np.pad(unusual, _WINDOW, constant_values=0.0)
    highest = sliding_window_view(near, 2 * _WINDOW + 1).max(axis=1)
    return np.asarray((unusual > 1) & (unusual > _PEAK * highest))


def _merged(name: str, spans: list[tuple[float, float, float, float]]) -> list[Outlier]:
    """Spans that touch, as one."""
    result: list[Outlier] = []
    for start, end, moved, turned in spans:
        if result and start <= result[-1].end + _STEP:
            last = result[-1]
            sizes = (float(np.fmax(last.moved, moved)), float(np.fmax(last.turned, turned)))
            result[-1] = Outlier(name, last.start, max(last.end, float(end)), *sizes)
        else:
            result.append(Outlier(name, float(start), float(end), float(moved), float(turned)))
    return result


def without(best: Fit, slips: Sequence[Sequence[Outlier | Drift]]) -> Problem:
    """The problem of the drives without their ``slips``, or the times in which a clock jumps: parts between them are
    drives of the same name."""

    def rest(index: int, drive: Drive) -> list[Drive]:
        edges = [drive.t[0], *(edge for slip in slips[index] for edge in (slip.start, slip.end)), drive.t[-1]]
        return cut(drive, edges[::2], edges[1::2], best.offsets[index]) if slips[index] else [drive]

    return replace(best.problem, drives=changed(best.problem.drives, rest))


def cut(drive: Drive, starts: Sequence[float], ends: Sequence[float], offset: float) -> list[Drive]:
    """Parts of a drive, from the times [s] ``starts`` to ``ends``, without those that are too short to tell anything;
    where all are, the drive."""
    offset = float(np.clip(offset, -BEYOND, BEYOND))  # what is farther tells of another drive
    parts = []
    for start, end in zip(starts, ends, strict=True):
        first, last = int(np.searchsorted(drive.t, start)), int(np.searchsorted(drive.t, end, "right")) - 1
        if last > first and drive.t[last] - drive.t[first] >= _SHORTEST:
            parts.append(drive.part(first, last, offset))
    return [part for part in parts if len(part.truth.t) >= FEWEST] or [drive]
