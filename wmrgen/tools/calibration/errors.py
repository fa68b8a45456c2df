"""Errors of odometry as a robot has it: drawn from the first measured pose of a leg, which no later pose moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.calibration.logs import steps_at
from wmrgen.tools.calibration.model import LEVER, Problem
from wmrgen.tools.calibration.path import Complexes, Reals


@dataclass(frozen=True, slots=True)
class Drawn:
    """Odometry and reference of one log at the n times [s] of its clock at which a place or a heading was measured.

    What was not measured is nan, and so is odometry in a leg without a place or a heading to draw it from.
    """

    t: Reals
    place: Complexes  # [m] the tracked point by odometry
    heading: Reals  # [rad] the tracked body by odometry
    seen: Complexes  # [m] by the reference
    theta: Reals  # [rad] by the reference

    @property
    def whole(self) -> Drawn:
        """The times at which place and heading were measured."""
        rows = np.isfinite(self.distance) & np.isfinite(self.turn)
        return Drawn(self.t[rows], self.place[rows], self.heading[rows], self.seen[rows], self.theta[rows])

    @property
    def distance(self) -> Reals:
        """How far odometry is from the reference [m]."""
        return np.abs(self.place - self.seen)

    @property
    def turn(self) -> Reals:
        """By how much odometry is turned against the reference [rad]."""
        return self.heading - self.theta


@dataclass(frozen=True, slots=True)
class Errors:
    """Root mean squares over some logs; nan if they were not measured."""

    position: float  # [m]
    heading: float  # [rad]

    @property
    def measured(self) -> bool:
        """Whether there is an error at all."""
        return bool(np.isfinite([self.position, self.heading]).any())

    @property
    def total(self) -> float:
        """One length for both [m]: a heading error is the arc that it makes at the lever of the estimator."""
        parts = np.array([self.position, LEVER * self.heading])
        return float(np.sqrt(np.sum(parts[np.isfinite(parts)] ** 2)))


def drawn(problem: Problem, index: int, shared: Reals, clock: float) -> Drawn:
    """Return a log's odometry and its reference.

    Args:
        problem: Logs and legs.
        index: The log's number.
        shared: (S,) parameters and mount.
        clock: [s] the log's clock offset.
    """
    log, legs, count = problem.logs[index], problem.legs[index], len(problem.nominal)
    path = problem.increments.alone.path(log.columns, shared[:count])
    parts = []
    measured = np.isfinite(log.poses.theta) | np.isfinite(log.poses.x + log.poses.y)
    measured &= log.inside(clock)
    for first, last in legs:
        poses = log.poses.rows((log.poses.t >= first) & (log.poses.t <= last) & measured)
        here = path.between(*steps_at(log.t, poses.t + clock))
        place = here.position + np.exp(1j * here.heading) * complex(shared[count], shared[count + 1])
        heading, seen = here.heading + shared[count + 2], poses.x + 1j * poses.y
        turn = _first(poses.theta - heading)
        moved = np.exp(1j * turn) * place
        parts.append((poses.t + clock, moved + _first(seen - moved), heading + turn, seen, poses.theta))
    return Drawn(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _first(values: NDArray[Any]) -> Any:
    """Return the first value that is not nan; nan if there is none."""
    finite = values[np.isfinite(values)]
    return finite[0] if len(finite) else np.nan


def errors(every: list[Drawn]) -> Errors:
    """Return root mean squares over all poses of some logs."""
    return Errors(_rms([d.distance for d in every]), _rms([d.turn for d in every]))


def _rms(every: list[Reals]) -> float:
    """Return the root mean square of the values that are not nan; nan if there is none."""
    values = np.concatenate([np.zeros(0), *every])
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else float("nan")
