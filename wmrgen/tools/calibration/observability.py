"""What the logs determine: an eigen-analysis of the covariance over parameters and mount.

Unknowns are counted in units: how far each is about from its nominal value before any log. A direction that stays more
uncertain than `WEAK` units is not determined. It stays nominal, gets no deviation, and is named.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wmrgen.tools.calibration.model import Problem
from wmrgen.tools.calibration.path import Reals

WEAK = 0.2  # units: 2 % of a parameter, 2 cm and 0.02 rad of the mount; a tape measure is as good
CLOCK = 0.05  # [s] of a clock offset: at 0.5 m/s this is 2.5 cm, the least that matters
_PART = 0.25  # of a direction's largest part: smaller parts are not named
MOUNT = ("mount.x", "mount.y", "mount.theta")


def split(covariance: Reals, free: Reals) -> tuple[Reals, Reals]:
    """Return orthonormal directions that are determined, and those that are not.

    Args:
        covariance: (S, S) in units.
        free: (S, k) directions that were estimated.
    """
    variances, vectors = np.linalg.eigh(free.T @ covariance @ free)
    weak = variances > WEAK**2
    return free @ vectors[:, ~weak], free @ vectors[:, weak]


def groups(problem: Problem, names: Sequence[str], directions: Reals) -> tuple[tuple[str, ...], ...]:
    """Return the unknowns in each direction that is not determined, largest part first.

    Args:
        problem: For the number of unknowns.
        names: (P,) of the parameters.
        directions: (S, k).
    """
    every, left, result = [*names, *MOUNT], directions.copy(), []
    assert len(every) == len(problem.origin)
    while left.shape[1]:
        # The direction with the largest single part, so that an unknown stands alone if it can.
        row = int(np.argmax(np.linalg.norm(left, axis=1)))
        size = np.abs(left @ (left[row] / np.linalg.norm(left[row])))
        result.append(tuple(every[i] for i in np.argsort(-size) if size[i] > _PART * size.max()))
        rotation = np.linalg.qr(np.column_stack([left[row], np.eye(left.shape[1])]))[0]
        left = left @ rotation[:, 1:]
    return tuple(result)
