"""Odometry drawn from where a drive was first measured, as a robot has it: no later pose of the truth moves it; and
what a calibration leaves over, errors of odometry by time and of each joint's readings."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from wmrgen.derivation.facade import Derivation
from wmrgen.tools.calibrating.certainty import Fit
from wmrgen.tools.calibrating.fit import Problem, place_at
from wmrgen.tools.calibrating.path import Complexes, Reals, passed

_PARTS = 10  # of a drive


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
    path = passed(problem.increments.alone, drive.columns, shared[:count], step).within(share)
    place = path.position + np.exp(1j * path.heading) * complex(shared[count], shared[count + 1])
    heading = path.heading + shared[count + 2]
    turn = true_heading[:1] - heading[:1]
    origin = true[:1] - np.exp(1j * turn) * place[:1]
    return Drawn(t, origin + np.exp(1j * turn) * place, heading + turn, true, true_heading)


def by_time(best: Fit) -> dict[str, list[tuple[float, float, float]]]:
    """Of each drive, by name: the middle of each tenth [s] and the root mean squares of what odometry is off by in it,
    [m] and [rad]."""
    shared = best.problem.shared(best.unknowns)
    every = groupby(enumerate(best.problem.drives), lambda numbered: numbered[1].name)
    result = {}
    for name, parts in every:
        told = [drawn(best.problem, shared, best.offsets[index], index) for index, _ in parts]
        result[name] = _tenths(np.concatenate([np.array([d.t, *d.off]) for d in told], axis=1))
    return result


def _tenths(columns: Reals) -> list[tuple[float, float, float]]:
    """Of columns of times and errors of place and heading, a row for each tenth that has any."""
    parts = [part for part in np.array_split(columns, _PARTS, axis=1) if part.size]
    return [(float(t.mean()), _rms(x), _rms(a)) for t, x, a in parts]


def by_joint(derivation: Derivation, best: Fit) -> dict[str, float]:
    """Root mean squares [rad] of what each step of a wheel's spin differs by from the one that the twist of all joints
    makes of it, by `inverse`: 0 where joints tell no more than a twist."""
    inverse = derivation.numpy().inverse
    names = [port.name for port in derivation.program.formula("inverse").inputs]
    sums: dict[str, Reals] = {}
    for drive in best.problem.drives:
        step = best.problem.increments(drive.columns, best.values)
        twist = {"vx": step.position.real, "vy": step.position.imag, "omega": step.heading}
        tunables = dict(zip(best.problem.increments.parameters, best.values, strict=True))
        inputs = {n: v for n, v in {**twist, **drive.columns, **tunables}.items() if n in names}
        missing = {n: 0.0 for n in names if n.endswith(".steer") and n not in inputs}
        commands = inverse(**inputs, **missing)
        for joint, column in drive.columns.items():
            if joint.endswith(".spin") and joint in commands:
                off = np.abs(column) - np.abs(commands[joint])
                sums[joint] = sums.get(joint, np.zeros(2)) + np.array([off @ off, len(off)])
    return {joint: float(np.sqrt(square / count)) for joint, (square, count) in sums.items()}


def _rms(values: Reals) -> float:
    return float(np.sqrt(np.mean(values**2)))
