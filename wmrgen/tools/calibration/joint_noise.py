"""The noise of measured wheel speeds that the random walk of odometry amounts to, as robot files have it.

A robot file gives the deviation of each wheel speed as a share of the speed, independent between joints and between
steps (`forward_covariance`). Errors that are independent between steps add up to a random walk, and a walk is what the
logs show. So one share is chosen that gives the walk of the logs, in steps of the length that the logs have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.model import LEVER
from wmrgen.tools.calibration.noise import Noise, distance, spare

_SHARE = 0.5  # of the measurements that must be left for noise: else its levels are those that are usual


@dataclass(frozen=True, slots=True)
class JointNoise:
    """Noise of measured speeds."""

    proportional: float  # standard deviation as a share of the speed, of each ``<wheel>.spin``
    step: float  # [s] between readings; the share depends on it


def joint_noise(fit: Fit, level: Noise) -> JointNoise | None:
    """Return the noise of wheel speeds that explains the walk of odometry; None if the logs show no walk.

    Args:
        fit: The estimate.
        level: Its noise.
    """
    if spare(fit) < _SHARE:
        return None
    increments, count = fit.problem.increments.alone, len(fit.problem.nominal)
    values = fit.state.shared[:count]
    walk = squares = seconds = 0.0
    rows = 0
    for log in fit.problem.logs:
        travelled = distance(increments.path(log.columns, values))[-1]
        walk += travelled * (2 * level.position_walk + LEVER**2 * level.heading_walk)
        seconds, rows = seconds + log.seconds, rows + log.rows - 1
        # Readings in each thinned step.
        inside = np.maximum(np.diff(log.t) * (log.rows - 1) / log.seconds, 1.0)
        for joint in log.columns:
            if not joint.endswith(".spin"):
                continue
            alone = {
                name: column if name == joint or name.endswith(".steer") else np.zeros_like(column)
                for name, column in log.columns.items()
            }
            step = increments.steps(alone, values)
            squares += float(np.sum((np.abs(step.position) ** 2 + (LEVER * step.heading) ** 2) / inside))
    if not walk > 0 or not squares > 0:
        return None
    return JointNoise(float(np.sqrt(walk / squares)), seconds / rows)
