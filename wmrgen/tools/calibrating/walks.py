"""How fast slips and noise make errors of odometry grow: what residuals differ by over short and long times.

What a drive's path is off by, it stays off by, so errors are a random walk, and the noise of the truth beside it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.calibrating.fit import LEVER, Residuals
from wmrgen.tools.calibrating.path import Reals

_COMMON = 0.95  # the share of squares that is usual
_GLITCH = 100.0  # how many times larger a glitch counts
_MEAN = 0.5  # [s] over which errors are averaged to be compared
_LATER = (1.0, 2.0, 4.0, 8.0)  # [s] after which they are; a third of the drive at most


def walk_of(every: Sequence[Reals]) -> Reals:
    """How fast the variances of place along and across the heading [m^2/s] and of heading [rad^2/s] grow, and those of
    the truth's noise by axis [m^2] and in headings [rad^2]: from `spans_of` of all drives."""
    if not every:
        return np.zeros(5)
    numbers = np.array([spans[:, 5:] for spans in every])
    spans = np.sum(numbers * [spans[:, :5] for spans in every], axis=0) / numbers.sum(axis=0)
    lasting, rows = spans[:, 0], spans[0, 4]
    grows = [_grows(lasting, spans[:, part]) for part in (1, 2, 3)]
    noise = [rows * noise for _, noise in grows]
    return np.array([*(rate for rate, _ in grows), (noise[0] + noise[1]) / 2, noise[2]])


def _grows(lasting: Reals, squares: Reals) -> tuple[float, float]:
    """The rate at which a variance grows whose ``squares`` are so large when it has grown for so long, and that of the
    noise at each end: a line through them, for which short times tell more."""
    if np.ptp(lasting) < 1e-9:
        return float(squares[-1] / lasting[-1]), 0.0
    rate, both = np.polyfit(lasting, squares, 1, w=1 / lasting)
    if both < 0:
        return float(np.mean(squares / lasting)), 0.0
    return (float(rate), float(both) / 2) if rate > 0 else (0.0, float(np.mean(squares)) / 2)


def spans_of(t: Reals, rows: Residuals, measured: NDArray[np.bool_]) -> Reals | None:
    """What means of errors over a short time differ by a while later, for each of `_LATER` (n, 6): how long that is
    [s], the squares of what the robot moved along and across its heading [m^2] and of what it turned [rad^2], how many
    rows of truth are in a mean, and how many differences there are; None where too little is measured."""
    whole = measured.all(axis=0) if measured[2].any() else measured[:2].all(axis=0)
    if whole.sum() < 4:
        return None
    off, turned = rows.values[0] + 1j * rows.values[1], rows.values[2] / LEVER
    for squares in (np.abs(off) ** 2, turned**2):
        whole &= squares <= _glitch(squares[whole])
    t, off, turned = t[whole], off[whole], turned[whole]
    place, heading = rows.place[whole], rows.heading[whole]
    # What a heading error moves the path by is no error of place.
    steps = np.diff(off) - 1j * np.diff(place) * (turned[1:] + turned[:-1]) / 2
    moved = np.cumsum(np.exp(-0.5j * (heading[1:] + heading[:-1])) * steps)
    columns = np.array([t, [0.0, *moved.real], [0.0, *moved.imag], turned])
    firsts = np.flatnonzero(np.diff(np.floor((t - t[0]) / _MEAN), prepend=-1.0))
    if len(firsts) < 2:
        return None
    counts = np.diff(firsts, append=len(t))
    means = np.add.reduceat(columns, firsts, axis=1) / counts
    width = float(np.mean(t[firsts + counts - 1] - t[firsts]))
    spans = []
    for later in _LATER:
        lag = int(np.clip(np.searchsorted(means[0], means[0, 0] + later), 1, max(1, len(firsts) // 3)))
        lasting, *apart = means[:, lag:] - means[:, :-lag]
        squares = [usual(part**2) for part in apart]
        spans.append([np.mean(lasting) - width / 3, *squares, np.mean(counts), len(lasting)])
    return np.array(spans)


def usual(squares: Reals) -> float:
    """The mean of squares, the few that a tracker's glitches make 100 times as large as the others counted so."""
    return float(np.mean(np.minimum(squares, _glitch(squares))))


def _glitch(squares: Reals) -> float:
    """What squares are at most that no glitch makes."""
    return float(_GLITCH * np.mean(np.sort(squares)[: max(1, round(_COMMON * len(squares)))]))
