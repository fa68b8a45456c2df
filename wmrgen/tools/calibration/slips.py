"""Slips: stretches where odometry and reference differ by far more than their noise.

A slip ends one leg and begins another, so that it moves no pose behind it. A glitch of the reference looks the same,
and does as little harm that way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.noise import Noise, Track
from wmrgen.tools.calibration.path import Reals

_FAR = 8.0  # standard deviations: of a million differences with normal noise none is so large
_LASTS = 1.0  # [s] between two poses that are compared
_ROWS = 3  # reference poses that a leg must have


@dataclass(frozen=True, slots=True)
class Slip:
    """A stretch that is left out."""

    log: str
    start: float  # [s] on the clock of the reference
    end: float
    moved: float  # [m] by which odometry and reference differ over it
    turned: float  # [rad]


def find(fit: Fit, level: Noise, every: list[Track]) -> list[tuple[int, Slip]]:
    """Return slips with the number of their logs.

    Args:
        fit: An estimate.
        level: Its noise.
        every: Its legs.
    """
    result = []
    for track in every:
        t = track.t
        ends = np.searchsorted(t, t + _LASTS - 1e-6)
        starts = np.flatnonzero(ends < len(t))
        ends = ends[starts]
        own = (track.place[ends] - track.place[starts]) * np.exp(-1j * track.heading[starts])
        seen = (track.seen[ends] - track.seen[starts]) * np.exp(-1j * track.theta[starts])
        turned = (track.heading - track.theta)[ends] - (track.heading - track.theta)[starts]
        travel = track.travelled[ends] - track.travelled[starts]
        chord = np.abs(own) ** 2
        of_place = 4 * level.position + 2 * level.position_walk * travel + level.heading * chord
        of_turn = 2 * level.heading + level.heading_walk * travel
        far = np.maximum(np.abs(own - seen) ** 2 / of_place, turned**2 / of_turn) > _FAR**2
        for group in np.split(np.flatnonzero(far), np.flatnonzero(np.diff(np.flatnonzero(far)) > 1) + 1):
            if len(group):
                worst = group[np.argmax(np.abs(own - seen)[group] + np.abs(turned)[group])]
                slip = Slip(
                    fit.problem.logs[track.log].name, float(t[starts[group[0]]]), float(t[ends[group[-1]]]),
                    float(np.abs(own - seen)[worst]), float(turned[worst]),
                )  # fmt: skip
                result.append((track.log, slip))
    return result


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
