"""What an analysis finds: ranges, slopes, noise, alarms."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import slopes as sl
from wmrgen.bounds.interval import GROW, Array, Interval
from wmrgen.bounds.slopes import Slope


@dataclass(frozen=True, slots=True)
class Value:
    """A result before its rounding: range, slope, error of the rounding, and a distance from zero if one is known."""

    range: Interval
    slope: Slope = None
    noise: Array | None = None
    away: Array | None = None


@dataclass(frozen=True, slots=True)
class Claim:
    """A result lies in [low, high] and is off by at most error + over / h where h >= `SMALL_ANGLE` rho."""

    low: float
    high: float
    error: float
    over: float
    rho: float


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of a function: a claim per result, and what is not shown (node, what)."""

    claims: tuple[Claim, ...]
    alarms: tuple[tuple[int, str], ...]


@dataclass(frozen=True, slots=True)
class Angle:
    """The direction of a vector whose error is ``rho`` [unit of the vector].

    Where the vector is h long, h >= `SMALL_ANGLE` rho, it moves the result of ``node`` by at most ``factor`` rho / h;
    ``row`` is that source of noise. Row + 1 is the same times h, which has a bound for every h.
    """

    node: int
    row: int
    factor: float
    rho: Array


@dataclass(slots=True)
class Analysis:
    """What is known of every node, on every box.

    ``ranges`` hold the exact and the float value; ``away`` is a lower bound of the absolute value. ``slopes``: rows
    per source; ``noise``: sources x boxes. ``alarms``: (node, what is not shown, on which boxes). ``decisions``:
    comparisons that are no minimum or maximum, and roundings to whole numbers.
    """

    boxes: int
    ranges: list[Interval] = field(default_factory=list)
    away: list[Array] = field(default_factory=list)
    slopes: list[Slope] = field(default_factory=list)
    noise: Array = field(default_factory=lambda: np.zeros((0, 0)))
    angles: list[Angle] = field(default_factory=list)
    alarms: list[tuple[int, str, NDArray[np.bool_]]] = field(default_factory=list)
    decisions: list[int] = field(default_factory=list)

    def error(self, i: int) -> Array:
        """How far the float value of node ``i`` may be from the exact one, per box."""
        return sl.weighed(self.slopes[i], self.noise, self.boxes)

    def split_error(self, i: int) -> tuple[Array, Array]:
        """(e, s): node ``i`` is off by at most e + s / h, h the length of the shortest vector whose angle it has."""
        slope = self.slopes[i]
        if slope is None or not self.angles:
            return self.error(i), np.zeros(self.boxes)
        plain, over = self.noise.copy(), np.zeros(self.boxes)
        for angle in self.angles:
            plain[angle.row] = 0.0
            if angle.row < slope[0].shape[0]:
                size = np.maximum(-slope[0][angle.row], slope[1][angle.row])
                over = over + np.where(size > 0, size * angle.factor * angle.rho, 0.0)
        return sl.weighed(slope, plain, self.boxes), over * GROW

    def lengths(self, i: int) -> Array:
        """The largest rho of the vectors on whose directions node ``i`` depends, per box; 0 without any."""
        slope = self.slopes[i]
        found = np.zeros(self.boxes)
        if slope is not None:
            used = np.maximum(-slope[0], slope[1])
            for angle in self.angles:
                rows = used[angle.row : angle.row + 2]
                if rows.size:
                    found = np.maximum(found, np.where(rows.max(axis=0) > 0, angle.rho, 0.0))
        return found
