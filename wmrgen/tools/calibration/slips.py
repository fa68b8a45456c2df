"""Slips: stretches where odometry and reference differ by far more than their noise.

A slip ends one leg and begins another, so that it moves no pose behind it. A glitch of the reference looks the same,
and does as little harm that way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from wmrgen.tools.calibration.estimator import MEDIAN, Fit
from wmrgen.tools.calibration.model import LEVER
from wmrgen.tools.calibration.noise import Track
from wmrgen.tools.calibration.path import Reals

# Robust standard deviations of a jump. In 71 of 77 OptiOdom sets there are at most 19.8, in six of the tricycle 29 to
# 37.
_FAR = 20.0
# [s] before and after a jump, over which its size is a median: a glitch of the reference is no jump
_WINDOW = 3.0
_LASTS = 1.0  # [s] between the two windows: slips are short
_ROWS = 3  # reference poses that a window and a leg must have


@dataclass(frozen=True, slots=True)
class Slip:
    """A stretch that is left out."""

    log: str
    start: float  # [s] on the clock of the reference
    end: float
    moved: float  # [m] by which odometry and reference differ over it
    turned: float  # [rad]


def find(fit: Fit, every: list[Track]) -> list[tuple[int, Slip]]:
    """Return slips, each with the number of its log.

    Args:
        fit: An estimate.
        every: Its legs.
    """
    jumps = np.concatenate([_jumps(track.complete) for track in every]) if every else np.zeros((0, 5))
    if not len(jumps):
        return []
    sizes = np.abs(jumps[:, 3:])
    floor = [fit.problem.scale, fit.problem.scale / LEVER]
    far = (sizes / np.maximum(MEDIAN * np.median(sizes, axis=0), floor)).max(axis=1)
    result = []
    for index in np.unique(jumps[:, 0]).astype(int):
        of_log = jumps[:, 0] == index
        rows, heights = jumps[of_log], np.where(far[of_log] > _FAR, far[of_log], 0.0)
        while heights.max() > 0:
            worst = int(np.argmax(heights))
            _, first, last, moved, turned = (float(v) for v in rows[worst])
            result.append((index, Slip(fit.problem.logs[index].name, first, last, moved, turned)))
            # The poses around it see the same jump.
            heights[np.abs(rows[:, 1] - first) < _WINDOW + _LASTS] = 0.0
    return result


def _jumps(track: Track) -> Reals:
    """Return log, first and last time [s], and by how much [m], [rad] odometry and reference jump, at each pose."""
    t, count = track.t, len(track.t)
    if count < 2 * _ROWS:
        return np.zeros((0, 5))
    step = float(np.median(np.diff(t)))
    rows, gap = max(_ROWS, round(_WINDOW / step)), max(1, round(_LASTS / step))
    lag = rows - 1 + gap
    if count < rows + lag or rows * step > 2 * _WINDOW:
        return np.zeros((0, 5))
    # Seen from the middle heading between both, a rotation in the gap moves nothing to first order.
    own = (track.place[lag:] - track.place[:-lag]) * np.exp(
        -0.5j * (track.heading[lag:] + track.heading[:-lag])
    )
    seen = (track.seen[lag:] - track.seen[:-lag]) * np.exp(-0.5j * (track.theta[lag:] + track.theta[:-lag]))
    moved = np.hypot(*(_medians(part, rows) for part in ((own - seen).real, (own - seen).imag)))
    error = _medians(track.heading - track.theta, rows)
    turned = error[lag:] - error[:-lag]
    first, last = t[rows - 1 : count - lag], t[lag : count - rows + 1]
    near = last - first < 2 * max(_LASTS, step)  # no gap in the reference
    return np.column_stack([np.full(len(first), track.log), first, last, moved, turned])[near]


def _medians(values: Reals, rows: int) -> Reals:
    """Return the median of so many values from each one on."""
    return np.asarray(np.median(sliding_window_view(values, rows), axis=1))


def without(fit: Fit, found: list[tuple[int, Slip]]) -> tuple[Reals, ...]:
    """Return the legs of all logs, cut at slips."""
    legs = [leg.copy() for leg in fit.problem.legs]
    for index, slip in found:
        parts = []
        for first, last in legs[index]:
            if slip.end <= first or slip.start >= last:
                parts.append((first, last))
                continue
            parts += [(first, slip.start), (slip.end, last)]
        legs[index] = np.array([part for part in parts if part[1] > part[0]])
    kept = []
    for log, old, new in zip(fit.problem.logs, fit.problem.legs, legs, strict=True):
        t = log.poses.t
        rows = [int(np.sum((t >= first) & (t <= last))) for first, last in new]
        enough = new[np.array(rows) >= _ROWS] if len(new) else new
        kept.append(enough if len(enough) else old)
    return tuple(kept)
