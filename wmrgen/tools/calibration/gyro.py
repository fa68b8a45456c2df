"""Scale and bias of a gyro, from its readings and reference headings.

The yaw rate of the robot is scale * (reading - bias). So headings are linear in the scale and in scale times bias, and
neither wheels nor their parameters matter. Headings are compared in stretches of `STRETCH`, each with a start of its
own, because errors of a gyro add up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.geometry.ports import GYRO
from wmrgen.tools.calibration import start
from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.logs import Log
from wmrgen.tools.calibration.model import unit_of
from wmrgen.tools.calibration.observability import WEAK, Estimate
from wmrgen.tools.calibration.path import Reals

STRETCH = 20.0  # [s] of a stretch
_FEWEST = 4  # stretches, of which two unknowns leave two for their deviations


@dataclass(frozen=True, slots=True)
class GyroEstimate:
    """The yaw rate [rad/s] is scale * (reading - bias)."""

    scale: Estimate
    bias: Estimate  # [rad/s]


def gyro(fit: Fit) -> GyroEstimate | None:
    """Return scale and bias; None if the logs have no readings of a gyro, or too few reference headings.

    Args:
        fit: The estimate, for the clock of each log and for whole turns.
    """
    stretches = list[Reals]()
    for log, own in zip(fit.problem.logs, fit.state.own, strict=True):
        if GYRO.name in log.columns:
            stretches += _stretches(log, float(own[0]))
    if len(stretches) < _FEWEST:
        return None
    # By scale, and by scale times bias.
    values, covariance = _solved([(rows[:, 1:] * (1, -1), rows[:, 0]) for rows in stretches])
    scale, product = values
    if covariance[0, 0] < (WEAK * unit_of(1.0)) ** 2:
        by = np.array([-product / scale, 1.0]) / scale  # of the bias, product / scale
        sigma = float(np.sqrt(by @ covariance @ by))
        return GyroEstimate(
            Estimate(float(scale), float(np.sqrt(covariance[0, 0])), 1.0, True),
            Estimate(float(product / scale), sigma, 0.0, True),
        )
    # The robot hardly turns. So the scale stays 1.
    values, covariance = _solved([(-rows[:, 2:], rows[:, 0] - rows[:, 1]) for rows in stretches])
    return GyroEstimate(
        Estimate(1.0, None, 1.0, False),
        Estimate(float(values[0]), float(np.sqrt(covariance[0, 0])), 0.0, True),
    )


def _stretches(log: Log, clock: float) -> list[Reals]:
    """Return reference heading [rad], integral of the readings [rad] and time [s] in each stretch, less their means.

    Args:
        log: With headings that count whole turns.
        clock: [s] by which times of the log are later.
    """
    integral = np.concatenate([[0.0], np.cumsum(log.columns[GYRO.name])])
    result = []
    for first, last in start.whole(log, STRETCH):
        at = log.poses.t + clock
        rows = np.isfinite(log.poses.theta) & (log.poses.t >= first) & (log.poses.t <= last)
        rows &= (at >= log.t[0]) & (at <= log.t[-1])
        if rows.sum() > 1:
            columns = [log.poses.theta[rows], np.interp(at[rows], log.t, integral), at[rows]]
            result.append(np.column_stack([column - column.mean() for column in columns]))
    return result


def _solved(stretches: list[tuple[Reals, Reals]]) -> tuple[Reals, Reals]:
    """Return the least squares solution, and its covariance if errors of different stretches are independent.

    The covariance is infinite if the solution is not unique.

    Args:
        stretches: Matrix (n, k) and right side (n,) of each.
    """
    count = stretches[0][0].shape[1]
    matrix, right = np.vstack([a for a, _ in stretches]), np.concatenate([b for _, b in stretches])
    values = np.linalg.lstsq(matrix, right, rcond=None)[0]
    if np.linalg.matrix_rank(matrix) < count:  # readings of a robot that does not turn at all
        return values, np.full((count, count), np.inf)
    inverse, meat = np.linalg.inv(matrix.T @ matrix), np.zeros((count, count))
    for a, b in stretches:
        slope = a.T @ (b - a @ values)
        meat += np.outer(slope, slope)
    return values, inverse @ meat @ inverse * len(stretches) / (len(stretches) - count)
