"""What the sentences and the singular sets are about."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Admissible, Array, Rank
from wmrgen.mobility.unit import Unit

SAME = 1e-9


@dataclass(frozen=True, slots=True)
class Findings:
    """What the sentences are about, in ``unit``. ``at``: rows of C1 at the sample configuration."""

    robot: Robot
    unit: Unit
    admissible: Admissible
    rank_fixed: Rank
    rank: Rank
    mobility: int
    steerability: int
    basis: tuple[int, ...]
    at: Array
    degenerate: bool

    @property
    def basis_wheels(self) -> tuple[Wheel, ...]:
        """The steered wheels among the independent rows."""
        return tuple(self.robot.wheels[i] for i in self.basis)


def listed(names: list[str]) -> str:
    """a, b and c"""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def axle(w: Wheel) -> Array:
    """The sliding row of a fixed wheel: its axle line, unit direction."""
    g = w.nominal
    c, s, x, y = float(g.ch), float(g.sh), float(g.x), float(g.y)
    return np.array([-s, c, x * c + y * s])


def axle_lines(wheels: list[Wheel]) -> list[list[Wheel]]:
    """Fixed wheels grouped by axle line."""
    lines: list[list[Wheel]] = []
    for w in wheels:
        row = axle(w)
        for line in lines:
            first = axle(line[0])
            if min(np.abs(row - first).max(), np.abs(row + first).max()) < SAME:
                line.append(w)
                break
        else:
            lines.append([w])
    return lines
