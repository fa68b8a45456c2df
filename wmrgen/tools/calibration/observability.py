"""What the logs determine: an eigen-analysis of the covariance over parameters and mount.

Unknowns are counted in units: how far each is about from its nominal value before any log. A direction that stays more
uncertain than `WEAK` units is not determined. It stays nominal, gets no deviation, and is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibration.model import Problem
from wmrgen.tools.calibration.path import Reals

WEAK = 0.2  # units: 2 % of a parameter, 2 cm and 0.02 rad of the mount; a tape measure is as good
CLOCK = 0.05  # [s] of a clock offset: at 0.5 m/s this is 2.5 cm, the least that matters
_SAME = 1e-3  # [s] of clocks that agree: 1 mm at 1 m/s
_PART = 0.25  # of a direction's largest part: smaller parts are not named
MOUNT = ("mount.x", "mount.y", "mount.theta")


@dataclass(frozen=True, slots=True)
class Estimate:
    """One unknown in SI units."""

    value: float
    sigma: float | None  # standard deviation; None: the logs do not determine it
    nominal: float
    observable: bool


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
    every, result = [*names, *MOUNT], []
    assert len(every) == len(problem.origin)
    for direction in _sparse(directions):
        size = np.abs(direction)
        result.append(tuple(every[i] for i in np.argsort(-size) if size[i] > _PART * size.max()))
    return tuple(result)


def _sparse(directions: Reals) -> list[Reals]:
    """Return directions that span the same, each with as few unknowns as possible."""
    left, result = directions.copy(), list[Reals]()
    while left.shape[1]:
        # The direction with the largest single part, so that a group has one unknown if possible.
        row = int(np.argmax(np.linalg.norm(left, axis=1)))
        result.append(left @ (left[row] / np.linalg.norm(left[row])))
        rotation = np.linalg.qr(np.column_stack([left[row], np.eye(left.shape[1])]))[0]
        left = left @ rotation[:, 1:]
    return result


def without(free: Reals, directions: Reals) -> Reals:
    """Return the directions that are estimated if others stay nominal, (S, j).

    A parameter that is determined only together with the mount stays nominal, and the mount is estimated: no robot file
    has a mount.

    Args:
        free: (S, k) orthonormal directions that were estimated.
        directions: (S, l) that are not determined.
    """
    kept_nominal = []
    for direction in _sparse(directions):
        parameters = np.append(direction[: -len(MOUNT)], np.zeros(len(MOUNT)))
        shared = np.abs(parameters).max() > _PART * np.abs(direction).max()
        kept_nominal.append(parameters if shared else direction)
    inside = free.T @ np.array(kept_nominal).reshape(-1, len(free)).T
    rank = inside.shape[1]
    return np.asarray(free @ np.linalg.qr(inside, mode="complete")[0][:, rank:])


def clock_spread(clocks: Reals) -> float:
    """Return the standard deviation of clock offsets [s] (empirical Bayes).

    It is the mean square of the offsets less what their noise makes of it. Where it is small, all logs help to say that
    clocks agree, and uncertain offsets move no parameter.

    Args:
        clocks: (logs, 2) [s] offset of each clock and its deviation, each estimated alone.
    """
    offsets, sigmas = clocks.T
    weights = (sigmas**2 + CLOCK**2) ** -2  # errors of squares go by squares; sharp ones count alike
    excess = weights @ (offsets**2 - sigmas**2) / weights.sum()
    return float(np.sqrt(max(excess, _SAME**2)))
