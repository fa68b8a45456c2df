"""Singular configurations: one of each kind, the robot standing in it."""

from __future__ import annotations

import numpy as np

from wmrgen.backends.drawing.example import Twist, extent, moving
from wmrgen.backends.drawing.figure import WIDTH, Figure, Group, figure
from wmrgen.backends.drawing.instant import instant
from wmrgen.backends.drawing.paper import wrapped
from wmrgen.layout.records import Robot
from wmrgen.mobility.admissible import along
from wmrgen.mobility.ranks import null_basis
from wmrgen.mobility.records import Array, Mobility, Singularity
from wmrgen.notation import listed, plain
from wmrgen.robot import Derivation

FILE = "singular.svg"
_WIDE, _DRAWN, _ROW = WIDTH / 2, 190.0, 15.0
_TITLES = {
    "icr_on_pivot": "ICR on a pivot", "shared_axle": "axles on one line", "drive": "driven wheels stand still",
    "rolling_rank": "a motion turns no wheel",
}  # fmt: skip


def singular(derivation: Derivation) -> Figure | None:
    """``singular.svg``; None where there is nothing to draw: no singularity, or one only at standstill."""
    robot, mobility = derivation.robot, derivation.mobility
    first: dict[str, tuple[Singularity, Twist]] = {}
    for s in mobility.singularities:
        twist = None if s.kind in first else _twist(s, robot, mobility)
        if twist is not None:
            first[s.kind] = s, twist
    if not first:
        return None
    panels = [(_TITLES.get(s.kind, s.kind), _words(s, mobility), moving(robot, t)) for s, t in first.values()]
    groups: list[Group] = []
    height = 0.0
    for k in range(0, len(panels), 2):
        pair = panels[k : k + 2]
        for j, (title, words, shown) in enumerate(pair):
            left = (j if len(pair) == 2 else 0.5) * _WIDE
            area = (left + 8, height + 22, left + _WIDE - 8, height + 22 + _DRAWN)
            groups += instant(robot, shown, area, title, words)
        height += 22 + _DRAWN + 8 + _ROW * max(len(words) for _, words, _ in pair)
    titles = listed([title for title, *_ in panels])
    return figure(FILE, f"{robot.name} in singular configurations: {titles}.", height + 6, groups)


def _words(s: Singularity, mobility: Mobility) -> list[str]:
    others = " (likewise the others)" if sum(o.kind == s.kind for o in mobility.singularities) > 1 else ""
    words = s.meaning.partition(". ")[0]
    return wrapped(plain(words[0].upper() + words[1:] + others), _WIDE - 24)


def _twist(s: Singularity, robot: Robot, mobility: Mobility) -> Twist | None:
    """An admissible motion in the singular configuration; None where only standstill is."""
    wheels = [robot.wheel(name) for name in s.wheels]
    if not mobility.admissible.linear:
        return None
    _, size = extent(robot.wheels)
    # Rows on (vx, vy, size omega).
    forbidden = null_basis(mobility.admissible.basis * np.array([1.0, 1.0, size]))
    if s.kind == "icr_on_pivot":
        return _turning(wheels[0].pivot, forbidden, size)
    if s.kind == "shared_axle":
        a, b = wheels[0].pivot, wheels[1].pivot
        return _turning(a + 0.6 * (a - b), forbidden, size)
    still = [along(w, w.zero_heading * complex(float(w.nominal.cg), float(w.nominal.sg))) for w in wheels]
    free = null_basis(np.vstack([np.array(still) * np.array([1.0, 1.0, 1 / size]), forbidden]))
    if not len(free):
        return None
    vx, vy, turn = max(free.tolist(), key=lambda t: abs(t[2]))
    return (vx, vy, 0.0) if abs(turn) < 1e-9 else (size * vx / turn, size * vy / turn, 1.0)


def _turning(icr: complex, forbidden: Array, size: float) -> Twist | None:
    """1 rad/s about a point, where that is admissible."""
    twist = (icr.imag, -icr.real, 1.0)
    rest = forbidden @ np.array([twist[0], twist[1], size])
    return twist if np.abs(rest).max(initial=0.0) < 1e-9 * max(size, abs(icr)) else None
