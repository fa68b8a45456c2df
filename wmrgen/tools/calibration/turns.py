"""How many whole turns a robot makes between two reference headings.

Headings that leave a range of one turn are cumulative and are used as they are. Other headings may be wrapped, and the
number of turns between two headings is an unknown integer. Odometry with nominal parameters predicts the rotation. If
nominal parameters may be off by so much that several integers are possible, each integer is a hypothesis about the
parameters.
All logs share the parameters, so a hypothesis gives the integers of all gaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.calibration.logs import Log, steps_at
from wmrgen.tools.calibration.model import Problem
from wmrgen.tools.calibration.path import Reals

_REACH = 2.5  # standard deviations of the rotation by nominal parameters: 99 % of all robots are within
_ROUNDING = 1e-3  # [rad] by which wrapped headings may span more than one turn
_TURN = 2 * np.pi


@dataclass(frozen=True, slots=True)
class Gaps:
    """The rotations between consecutive reference headings of one log."""

    predicted: Reals  # (n,) [rad] by nominal parameters
    by: Reals  # (P, n) derivatives by the parameters, in units
    measured: Reals  # (n,) [rad] up to whole turns
    cumulative: bool

    def counts(self, shift: Reals) -> NDArray[np.int64]:
        """Return the whole turns (n,) that ``measured`` lacks if the parameters are ``shift`` (P,) units off."""
        if self.cumulative:
            return np.zeros(len(self.measured), dtype=np.int64)
        return np.rint((self.predicted + shift @ self.by - self.measured) / _TURN).astype(np.int64)


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """Logs whose headings count whole turns."""

    logs: tuple[Log, ...]
    shift: Reals  # (P,) units by which the parameters are off for it
    turns: float  # of the gap that is least certain; nan if all were certain


def hypotheses(problem: Problem) -> list[Hypothesis]:
    """Return the possible numbers of turns, at least one; the number by nominal parameters is the last.

    Each hypothesis has parameters within `_REACH` standard deviations, along the line on which the most
    uncertain rotation changes most.
    """
    every = [_gaps(problem, log) for log in problem.logs]
    shifts, widest, spread = [np.zeros(len(problem.nominal))], None, 0.0
    for gaps in every:
        sizes = np.linalg.norm(gaps.by, axis=0)
        if not gaps.cumulative and len(sizes) and sizes.max() > spread:
            spread, widest = float(sizes.max()), (gaps, int(np.argmax(sizes)))
    if widest is not None and _REACH * spread > _TURN / 4:
        gaps, index = widest
        reach = np.array([-1, 1]) * _REACH * spread
        low, high = (gaps.predicted[index] + reach - gaps.measured[index]) / _TURN
        for count in range(int(np.ceil(low)), int(np.floor(high)) + 1):
            rotation = gaps.measured[index] + _TURN * count
            shifts.append(gaps.by[:, index] * (rotation - gaps.predicted[index]) / spread**2)
    found: dict[tuple[int, ...], Hypothesis] = {}
    for shift in shifts[::-1]:
        counts = [gaps.counts(shift) for gaps in every]
        key = tuple(int(n) for of_log in counts for n in of_log)
        if key in found:
            continue
        turns = float("nan")
        if widest is not None and len(shifts) > 1:
            gaps, index = widest
            turns = float(gaps.measured[index] / _TURN + gaps.counts(shift)[index])
        logs = tuple(_lifted(log, of_log) for log, of_log in zip(problem.logs, counts, strict=True))
        found[key] = Hypothesis(logs, shift, turns)
    return list(found.values())


def _gaps(problem: Problem, log: Log) -> Gaps:
    """Return the rotations between the reference headings of a log, measured and by odometry."""
    measured = np.isfinite(log.poses.theta)
    theta = log.poses.theta[measured]
    path = problem.increments.path(log.columns, problem.nominal)
    here = path.between(*steps_at(log.t, np.clip(log.poses.t[measured], log.t[0], log.t[-1])))
    by = problem.units[: len(problem.nominal), None] * np.diff(here.heading_by)
    cumulative = bool(len(theta)) and float(np.ptp(theta)) > _TURN + _ROUNDING
    return Gaps(np.diff(here.heading), by, np.diff(theta), cumulative)


def _lifted(log: Log, counts: Sequence[int] | NDArray[np.int64]) -> Log:
    """Return the log with whole turns added to its reference headings."""
    measured, theta = np.isfinite(log.poses.theta), log.poses.theta.copy()
    if measured.any():
        theta[measured] += _TURN * np.concatenate([[0], np.cumsum(counts)])
    return replace(log, poses=replace(log.poses, theta=theta))
