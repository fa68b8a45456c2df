"""Odometry drawn from where a drive was first measured, as a robot has it: no later pose of the truth moves it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.calibrating.fit import Problem, between, place_at
from wmrgen.calibrating.path import Complexes, Reals, passed


@dataclass(frozen=True, slots=True)
class Drawn:
    """Odometry and truth of one drive at n times ``t`` [s] of the log at which whole poses are measured: ``place`` [m]
    and ``heading`` [rad] of the tracked point, and what is ``true``."""

    t: Reals
    place: Complexes
    heading: Reals
    true: Complexes
    true_heading: Reals

    @property
    def off(self) -> tuple[Reals, Reals]:
        """How far odometry is from the truth, [m] and [rad]."""
        return np.abs(self.place - self.true), self.heading - self.true_heading


def drawn(problem: Problem, shared: Reals, offset: float, index: int) -> Drawn:
    """A drive with ``shared`` parameters and mount, its truth's clock being off by ``offset`` [s]."""
    drive, count = problem.drives[index], len(problem.nominal)
    true, true_heading = drive.truth.x + 1j * drive.truth.y, drive.truth.theta
    measured = np.isfinite(true) & np.isfinite(true_heading)
    t, true, true_heading = drive.truth.t[measured] + offset, true[measured], true_heading[measured]
    step, _, share = place_at(drive.t, t)
    path = passed(problem.increments, drive.columns, shared[:count], step)
    heading = between(path.heading, share)
    place = between(path.position, share) + np.exp(1j * heading) * complex(shared[count], shared[count + 1])
    heading = heading + shared[count + 2]
    turn = true_heading[:1] - heading[:1]
    origin = true[:1] - np.exp(1j * turn) * place[:1]
    return Drawn(t, origin + np.exp(1j * turn) * place, heading + turn, true, true_heading)
