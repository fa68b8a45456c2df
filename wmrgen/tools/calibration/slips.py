"""Slips: stretches where odometry and reference differ by far more than their noise.

A slip ends one leg and begins another, so that it moves no pose behind it. A glitch of the reference looks the same,
and does as little harm that way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.model import LEVER
from wmrgen.tools.calibration.noise import Track
from wmrgen.tools.calibration.path import Reals

_FAR = 15.0  # robust standard deviations of a jump; OptiOdom's logs, without a slip, have jumps of 10
_WINDOW = (
    3.0  # [s] before and behind a jump, over which its size is a median: a glitch of the reference is no jump
)
_LASTS = 1.0  # [s] between the two windows: slips are short
_ROWS = 3  # reference poses that a window and a leg must have
_MEDIAN = 1.4826  # standard deviations of a normal distribution in a median absolute value


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
    jumps = np.concatenate([_jumps(track) for track in every]) if every else np.zeros((0, 4))
    if not len(jumps):
        return []
    sizes = np.abs(jumps[:, 2:])
    floor = [fit.problem.scale, fit.problem.scale / LEVER]
    far = (sizes / np.maximum(_MEDIAN * np.median(sizes, axis=0), floor)).max(axis=1)
    result = []
    for index in np.unique(jumps[:, 0]).astype(int):
        of_log = jumps[:, 0] == index
        rows, heights = jumps[of_log], np.where(far[of_log] > _FAR, far[of_log], 0.0)
        while heights.max() > 0:
            worst = int(np.argmax(heights))
            _, t, moved, turned = (float(v) for v in rows[worst])
            result.append((index, Slip(fit.problem.logs[index].name, t, t + _LASTS, moved, turned)))
            heights[np.abs(rows[:, 1] - t) < _WINDOW + _LASTS] = 0.0  # the same jump, seen from beside it
    return result


def _jumps(track: Track) -> Reals:
    """Return, about once a second, the log, the time, and by how much [m], [rad] odometry and reference jump apart."""
    result, t = [], track.t
    error = track.heading - track.theta
    for begin in np.arange(t[0] + _WINDOW, t[-1] - _WINDOW - _LASTS, _LASTS / 2):
        before = np.flatnonzero((t >= begin - _WINDOW) & (t <= begin))
        after = np.flatnonzero((t >= begin + _LASTS) & (t <= begin + _LASTS + _WINDOW))
        count = min(len(before), len(after))
        if count < _ROWS:
            continue
        i, j = before[-count:], after[:count]
        # Seen from the middle heading between both, a rotation in the gap moves nothing to first order.
        own = (track.place[j] - track.place[i]) * np.exp(-0.5j * (track.heading[i] + track.heading[j]))
        seen = (track.seen[j] - track.seen[i]) * np.exp(-0.5j * (track.theta[i] + track.theta[j]))
        off = own - seen
        moved = abs(complex(np.median(off.real), np.median(off.imag)))
        turned = float(np.median(error[after]) - np.median(error[before]))
        result.append((track.log, begin, moved, turned))
    return np.array(result).reshape(-1, 4)


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
