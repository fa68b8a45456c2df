"""Where a steered wheel with limits should point, by trying every heading: the rule of
`wmrgen.analysis.kinematics.steer`."""

from __future__ import annotations

import math

STAY = math.radians(5)
NARROW = 1.57  # rad between limits: less than a quarter turn, where no stop is a cheap one


def stay(low: float, high: float) -> float:
    """How much further outside its limits [rad] a wheel keeps its heading than it would have the opposite one."""
    if high - low <= NARROW:
        return 0.0
    return min(STAY, max(0.0, math.pi / 2 + STAY - (high - low) / 2))


def right(line: float, low: float, high: float, now: float, rounding: float = 0.0) -> set[float]:
    """The angles inside the limits that are right for a line [rad]: several where ``rounding`` [rad] may decide."""
    return {_right(line + d, low, high, now) for d in (-rounding, 0.0, rounding)}


def _right(line: float, low: float, high: float, now: float) -> float:
    now = min(max(now, low), high)
    tries = [line + k * math.pi for k in range(-12, 13)]

    def outside(angle: float) -> float:
        return max(low - angle, angle - high, 0.0)

    nearest = min(tries, key=lambda t: abs(t - now))
    best = min(tries, key=lambda t: (outside(t), abs(t - now)))
    chosen = nearest if outside(nearest) - outside(best) <= stay(low, high) else best
    return min(max(chosen, low), high)
