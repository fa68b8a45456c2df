"""Logs of drives: joint readings, and reference poses of a tracked point.

A log is thinned as soon as it is read: its increments are added up to steps of a quarter of a second, or of 0.05 rad,
whatever ends first. That keeps what the estimator needs. Everything after reading works on the small log.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wmrgen.errors import UsageError
from wmrgen.tools.calibration.path import Increments, Indices, Reals

Booleans = NDArray[np.bool_]

STEP = 0.25  # [s] of a thinned step: shorter ones change parameters of real logs by less than a tenth of a deviation
TURN = 0.05  # [rad] by which the robot and its steered wheels turn in a thinned step: the same
BEYOND = 1.0  # [s] by which reference poses may lie outside of a log, because clocks differ
POSES = 0.5  # [s] between reference poses that are kept: the same


@dataclass(frozen=True, slots=True)
class Poses:
    """Where the tracked point was; nan is not measured."""

    t: Reals  # (K,) [s]
    x: Reals  # (K,) [m]
    y: Reals  # (K,) [m]
    theta: Reals  # (K,) [rad]

    @property
    def measured(self) -> int:
        """How often the quantity was measured that was measured most often."""
        return max(int(np.isfinite(column).sum()) for column in (self.x, self.y, self.theta))

    @property
    def complete(self) -> Booleans:
        """Which rows have x, y and theta, (K,)."""
        return np.isfinite(self.x) & np.isfinite(self.y) & np.isfinite(self.theta)

    def rows(self, which: Booleans | Indices) -> Poses:
        """Return some of the rows."""
        return Poses(self.t[which], self.x[which], self.y[which], self.theta[which])


@dataclass(frozen=True, slots=True)
class Log:
    """One drive."""

    name: str
    t: Reals  # (N + 1,) [s]
    # (N,) of each joint [rad]: increments of `<wheel>.spin` and `<wheel>.steer_rate`, the angle of `<wheel>.steer`.
    # Increments of `gyro` [rad], if the robot has one and the log has its readings.
    columns: Mapping[str, Reals]
    poses: Poses
    rows: int = 0  # readings before thinning

    def inside(self, clock: float) -> Booleans:
        """Return which reference poses lie in the log, or as little outside as clocks differ, (K,).

        Args:
            clock: [s] by which times of the log are later.
        """
        at = self.poses.t + clock
        return np.asarray((at >= self.t[0] - BEYOND) & (at <= self.t[-1] + BEYOND))

    @property
    def seconds(self) -> float:
        """How long the log is [s]."""
        return float(self.t[-1] - self.t[0])


def thinned(log: Log, increments: Increments, nominal: Reals) -> Log:
    """Add up the steps of a log, and drop reference poses that follow others closely.

    Args:
        log: As it was read.
        increments: The robot's odometry.
        nominal: (P,) parameters, for the rotation of each step.
    """
    turned = np.abs(increments.alone.steps(log.columns, nominal).heading)
    for joint, column in log.columns.items():
        if joint.endswith(".steer"):
            turned += np.abs(np.diff(column, prepend=column[:1]))
    firsts = _firsts(log.t, np.cumsum(turned))
    columns = {}
    for joint, column in log.columns.items():
        if not joint.endswith(".steer"):
            columns[joint] = np.add.reduceat(column, firsts)
            continue
        # A steering angle is averaged over the rotation of its wheel, or over time if the wheel does not roll.
        rolled = np.abs(log.columns.get(f"{joint.removesuffix('.steer')}.spin", np.zeros_like(column)))
        weight = rolled + 1e-9 * np.diff(log.t)
        columns[joint] = np.add.reduceat(weight * column, firsts) / np.add.reduceat(weight, firsts)
    t = log.t[[*firsts, -1]]
    return replace(log, t=t, columns=columns, poses=_fewer(log.poses), rows=len(log.t))


def _firsts(t: Reals, turned: Reals) -> Indices:
    """Return the first row of each thinned step."""
    slots = np.floor((t[:-1] - t[0]) / STEP + 1e-6)
    angles = np.floor(turned / TURN)
    changed = (np.diff(slots, prepend=-1.0) != 0) | (np.diff(angles, prepend=-1.0) != 0)
    changed[0] = True
    return np.flatnonzero(changed)


def _fewer(poses: Poses) -> Poses:
    """Return one row in `POSES` of those that measure the same quantities, and the first and the last row."""
    kind = 1 * np.isfinite(poses.x) + 2 * np.isfinite(poses.y) + 4 * np.isfinite(poses.theta)
    slot = 8 * np.floor((poses.t - poses.t[0]) / POSES + 1e-6) + kind
    kept = np.unique(slot[kind > 0], return_index=True)[1]
    where = np.flatnonzero(kind > 0)
    return poses.rows(np.union1d(where[kept], where[-1:]))


def steps_at(t: Reals, at: Reals) -> tuple[Indices, Reals]:
    """Return the step of a log that each time ``at`` falls into, and the share of the step that is over."""
    step = np.clip(np.searchsorted(t, at, "right") - 1, 0, len(t) - 2)
    return step, (at - t[step]) / (t[step + 1] - t[step])


def check(log: Log) -> Log:
    """Return the log; UsageError if its poses cannot say anything about its joints."""
    if log.poses.measured < 2:
        raise UsageError(f"{log.name}: x, y or theta of the reference has to be measured at least twice")
    return log
