"""Errors of odometry as a robot has it: drawn from the first measured pose of a leg, which no later pose moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.tools.calibration.logs import steps_at
from wmrgen.tools.calibration.model import LEVER, Problem
from wmrgen.tools.calibration.path import Complexes, Reals


@dataclass(frozen=True, slots=True)
class Drawn:
    """Odometry and reference of one log, at the n times [s] of its clock at which whole poses were measured."""

    t: Reals
    place: Complexes  # [m] the tracked point by odometry
    heading: Reals  # [rad] the tracked body by odometry
    seen: Complexes  # [m] by the reference
    theta: Reals  # [rad] by the reference

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
    for first, last in legs:
        poses = log.poses.rows((log.poses.t >= first) & (log.poses.t <= last) & log.poses.complete)
        here = path.between(*steps_at(log.t, poses.t + clock))
        place = here.position + np.exp(1j * here.heading) * complex(shared[count], shared[count + 1])
        heading, seen = here.heading + shared[count + 2], poses.x + 1j * poses.y
        turn = poses.theta[:1] - heading[:1]
        moved = seen[:1] + np.exp(1j * turn) * (place - place[:1])
        parts.append((poses.t + clock, moved, heading + turn, seen, poses.theta))
    return Drawn(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def errors(every: list[Drawn]) -> Errors:
    """Return root mean squares over all poses of some logs."""
    distance = np.concatenate([d.distance for d in every]) if every else np.zeros(0)
    turn = np.concatenate([d.turn for d in every]) if every else np.zeros(0)
    if not len(distance):
        return Errors(float("nan"), float("nan"))
    return Errors(float(np.sqrt(np.mean(distance**2))), float(np.sqrt(np.mean(turn**2))))
