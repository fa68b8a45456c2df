"""The fit of a robot's parameters, and how certain it is.

What a drive's path is off by, it stays off by: a slip turns all that follows. So errors of poses are no noise of their
own, but the sum of all slips before, a random walk, and of the noise of the truth. How large both are is read off the
residuals, over short and long times; how they move the parameters follows from the derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wmrgen.calibrating.fit import (
    LEVER,
    Each,
    Problem,
    Residuals,
    Sums,
    information,
    nearest,
    prior_of_shared,
    residuals,
    serial,
    solved,
    summed,
    through,
)
from wmrgen.calibrating.path import Reals

_COMMON = 0.95  # the share of squares that is usual
_GLITCH = 100.0  # how many times larger a glitch counts
_SHORT, _LONG = 1.0, 10.0  # [s] over which errors are compared; the long one is a third of the drive at most


@dataclass(frozen=True, slots=True)
class Fit:
    """What was estimated: ``values`` of the parameters and ``mount`` (x, y [m], heading [rad] of the tracked point on
    the robot); ``covariance`` of both, in `Problem.units`; ``information``: the matrix that the drives alone give,
    own unknowns eliminated; ``noise``: the mean square of residuals in units of the scale; ``rms`` [m] of positions
    and [rad] of headings; ``offsets`` [s] by drive."""

    problem: Problem
    unknowns: Reals
    values: tuple[float, ...]
    mount: tuple[float, float, float]
    covariance: Reals
    information: Reals
    noise: float
    rms: tuple[float, float]
    offsets: tuple[float, ...]

    @property
    def deviations(self) -> Reals:
        """Standard deviations of the parameters [m, rad] that slips and noise in the drives make."""
        sizes = np.sqrt(np.diag(self.covariance)) * self.problem.units
        return np.asarray(sizes[: len(self.values)])


def fit(problem: Problem, each: Each = serial, start: Reals | None = None) -> Fit:
    """The parameters under which paths and truth are nearest, from ``start`` on."""
    return fit_at(*solved(problem, each, start), each)


def without(best: Fit, drives: Sequence[int], each: Each = serial) -> Fit:
    """The fit without ``drives``, from that of all on."""
    problem, shared = best.problem, len(best.covariance)
    kept = [i for i in range(len(problem.drives)) if i not in drives]
    own = best.unknowns[shared:].reshape(len(problem.drives), -1)[kept]
    rest = replace(problem, drives=tuple(problem.drives[i] for i in kept))
    return fit_at(rest, nearest(rest, np.concatenate([best.unknowns[:shared], own.ravel()]), each), each)


@dataclass(frozen=True, slots=True)
class _Evidence:
    """What one drive says of how certain a fit is. ``squares`` [m^2] and ``counts`` of residuals: of x and y, and of
    headings; ``usual``: the mean of squares that are usual; ``spans``: as `_spans` has them; ``pulls`` (4, shared,
    shared): as `_pulls` has them; ``offset`` [s]: of the clock."""

    sums: Sums
    squares: tuple[float, float]
    counts: tuple[int, int]
    usual: float
    spans: Reals | None
    pulls: Reals
    offset: float


def fit_at(problem: Problem, unknowns: Reals, each: Each = serial) -> Fit:
    """What the ``unknowns`` that were found say, and how certain they are."""
    count = len(problem.nominal)
    shared = problem.shared(unknowns)
    every = each(problem, unknowns, _evidence)
    told = information(problem, [drive.sums for drive in every])
    prior = prior_of_shared(problem)
    inverse = np.linalg.inv(told + prior)
    counts = np.sum([drive.counts for drive in every], axis=0)
    squares = np.sum([drive.squares for drive in every], axis=0) / np.where(counts, counts, np.nan)
    measured = int(counts.sum())
    # Squares of errors are so much larger than those of residuals, for unknowns take part of them up.
    freedom = measured / max(1, measured - len(unknowns))
    walk = _walk([drive.spans for drive in every if drive.spans is not None])
    spread = prior @ prior
    for drive in every:
        square = sum(drive.squares) / max(1, sum(drive.counts))
        rates = np.array([0.0, 0.0, square, square / LEVER**2]) if drive.spans is None else walk
        spread = spread + freedom * np.tensordot(rates, drive.pulls, 1)
    x, y, heading = shared[count:]
    return Fit(
        problem,
        unknowns,
        tuple(float(v) for v in shared[:count]),
        (float(x), float(y), float(np.angle(np.exp(1j * heading)))),
        inverse @ spread @ inverse,
        told,
        sum(drive.usual * sum(drive.counts) for drive in every) / measured / problem.scale**2,
        (float(np.sqrt(2 * squares[0])), float(np.sqrt(squares[1])) / LEVER),
        tuple(drive.offset for drive in every),
    )


def _evidence(problem: Problem, unknowns: Reals, index: int) -> _Evidence:
    rows = residuals(problem, unknowns, index)
    sums, measured = summed(problem, rows), rows.weights > 0
    of_axes = [rows.values[part][measured[part]] ** 2 for part in (slice(0, 2), slice(2, 3))]
    t = problem.drives[index].truth.t
    return _Evidence(
        sums,
        (float(of_axes[0].sum()), float(of_axes[1].sum())),
        (len(of_axes[0]), len(of_axes[1])),
        _usual(np.concatenate(of_axes)) if measured.any() else 0.0,
        _spans(t, rows, measured),
        _pulls(problem, t, rows, through(problem, sums)),
        float(problem.own(unknowns, index)[3]),
    )


def _usual(squares: Reals) -> float:
    """The mean of squares, the few that a tracker's glitches make 100 times as large as the others counted so."""
    lower = np.sort(squares)[: max(1, round(_COMMON * len(squares)))]
    return float(np.mean(np.minimum(squares, _GLITCH * np.mean(lower))))


def _pulls(problem: Problem, t: Reals, rows: Residuals, eliminated: Reals) -> Reals:
    """The covariances of a drive's gradient by the shared unknowns, ``eliminated`` own ones following them, that a unit
    of each of what `_walk` returns makes (4, shared, shared)."""
    shared = len(eliminated)
    z = rows.values / problem.scale
    gain = (rows.weights / (problem.scale**2 * (1 + z * z) ** 1.5))[..., None]
    by = rows.by[..., :shared] - rows.by[..., shared:] @ eliminated.T
    pull = gain * by  # (3, n, shared) by metre of residual
    after = np.cumsum(pull[:, ::-1], axis=1)[:, ::-1]  # of a step along x, y that all that follows takes
    turning = LEVER * pull[2] - pull[0] * rows.place.imag[:, None] + pull[1] * rows.place.real[:, None]
    turned = np.cumsum(turning[::-1], axis=0)[::-1]
    turned += after[0] * rows.place.imag[:, None] - after[1] * rows.place.real[:, None]
    lasting = np.diff(t, prepend=t[0])[:, None]
    slid = [(after[axis] * lasting).T @ after[axis] for axis in range(2)]
    seen = [pull[axis].T @ pull[axis] for axis in range(3)]
    return np.array([slid[0] + slid[1], (turned * lasting).T @ turned, seen[0] + seen[1], LEVER**2 * seen[2]])


def _spans(t: Reals, rows: Residuals, measured: NDArray[np.bool_]) -> Reals | None:
    """Over a short and over a long time, the means (2, 5) of that time [s], of its squared turn [rad^2], move [m^2] and
    way [m^2], and how many such times there are; None where too little is measured."""
    place, heading = rows.values[0] + 1j * rows.values[1], rows.values[2] / LEVER
    whole = measured.all(axis=0) if measured[2].any() else measured[:2].all(axis=0)
    t, place, heading, at = t[whole], place[whole], heading[whole], rows.place[whole]
    if len(t) < 4:
        return None
    spans = []
    for wanted in (_SHORT, min(_LONG, (t[-1] - t[0]) / 3)):
        lag = int(np.clip(np.searchsorted(t, t[0] + wanted), 1, len(t) - 1))
        lasting, turned, way = t[lag:] - t[:-lag], heading[lag:] - heading[:-lag], at[lag:] - at[:-lag]
        moved = place[lag:] - place[:-lag] - 1j * way * heading[:-lag]
        squares = [_usual(part) for part in (lasting, turned**2, np.abs(moved) ** 2, np.abs(way) ** 2)]
        spans.append([*squares, len(lasting)])
    return np.array(spans)


def _walk(every: Sequence[Reals]) -> Reals:
    """How fast the variances of position (by axis, [m^2/s]) and heading [rad^2/s] grow, and those of the truth's noise
    [m^2, rad^2]: from differences over a short and a long time in all drives, `_spans` of each."""
    if not every:
        return np.zeros(4)
    counts = np.array([spans[:, 4:] for spans in every])
    short, long = np.sum(counts * [spans[:, :4] for spans in every], axis=0) / counts.sum(axis=0)
    turn, turn_noise = _grows(short[0], short[1], long[0], long[1])
    # What turns on the way and the truth's noise in the first heading add to the place: half of it to each axis.
    aside = [(moved - way * (turn * span / 3 + turn_noise)) / 2 for span, _, moved, way in (short, long)]
    slide, slide_noise = _grows(short[0], aside[0], long[0], aside[1])
    return np.array([slide, turn, slide_noise, turn_noise])


def _grows(short: float, first: float, long: float, second: float) -> tuple[float, float]:
    """The rate at which a variance grows that is ``first`` over a ``short`` and ``second`` over a ``long`` time, and
    that of the noise at each end."""
    rate = max(0.0, second - first) / (long - short) if long > short else second / long
    return rate, max(0.0, first - rate * short) / 2
