"""Do the axles agree at given steering angles? Rank of C1 there, and which wheels stand wrong (Kelly 4.2.1.2).

rank 1   all axles lie on one line: the ICR may be anywhere on it (Siegwart 3.3.1)
rank 2   all axles meet in the ICR, or all are parallel: crab steering, the ICR at infinity (Jeantaud)
rank 3   the axles do not meet: mobility 0, driving slides
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.ranks import numeric_rank, unit_rows
from wmrgen.mobility.records import Array


@dataclass(frozen=True, slots=True)
class SteeringCheck:
    """``rank``: of C1 at the angles, at the project's tolerance. ``odd``: wheels each of which alone spoils it.

    ``mobility`` = 3 - rank: what the robot can still do at these angles.
    """

    rank: int
    singular_values: tuple[float, ...]
    odd: tuple[str, ...]

    @property
    def mobility(self) -> int:
        """Freedoms of motion at these angles (Siegwart (3.40))."""
        return 3 - self.rank


def check_steering(robot: Robot, steer: Mapping[str, float]) -> SteeringCheck:
    """``steer``: joint angle [rad] by wheel name, 0 where not given."""
    wheels = [w for w in robot.wheels if w.kind.constrains]
    rows = np.array([_row(w, steer) for w in wheels]).reshape(-1, 3)
    rank, singular = _rank(rows)
    odd = [
        w.name
        for i, w in enumerate(wheels)
        if rank == 3 and w.kind.steers and _rank(np.delete(rows, i, axis=0))[0] == 2
    ]
    return SteeringCheck(rank, singular, tuple(odd))


def _rank(rows: Array) -> tuple[int, tuple[float, ...]]:
    return numeric_rank(unit_rows(rows)) if len(rows) else (0, ())


def axle_distances(robot: Robot, steer: Mapping[str, float], point: tuple[float, float]) -> dict[str, float]:
    """How far the axle line of each fixed or steered wheel passes from a point of the robot frame [m]."""
    found = {}
    for w in robot.wheels:
        if w.kind.constrains:
            b, a, k = _row(w, steer)  # (-s, c, x c + y s)
            found[w.name] = abs(a * point[0] - b * point[1] - k)
    return found


def _row(w: Wheel, steer: Mapping[str, float]) -> list[float]:
    """Sliding row of the pivot: [-s, c, x c + y s]."""
    ch, sh, x, y = (float(v) for v in (w.nominal.ch, w.nominal.sh, w.nominal.x, w.nominal.y))
    angle = steer.get(w.name, 0.0) if w.kind.steers else 0.0
    c, s = ch * cos(angle) - sh * sin(angle), sh * cos(angle) + ch * sin(angle)
    return [-s, c, x * c + y * s]
