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
    information,
    nearest,
    prior_of_shared,
    residuals,
    serial,
    solved,
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


def fit_at(problem: Problem, unknowns: Reals, each: Each = serial) -> Fit:
    """What the ``unknowns`` that were found say, and how certain they are."""
    count = len(problem.nominal)
    shared = problem.shared(unknowns)
    parts = each(problem, unknowns)
    told = information(problem, parts)
    every = [residuals(problem, unknowns, index) for index in range(len(problem.drives))]
    prior = prior_of_shared(problem)
    inverse = np.linalg.inv(told + prior)
    measured = sum(int((rows.weights > 0).sum()) for rows in every)
    freedom = measured / max(1, measured - len(unknowns))
    spread = sum(
        (
            _spread(problem, rows, through(problem, part), index, freedom)
            for index, (rows, part) in enumerate(zip(every, parts, strict=True))
        ),
        prior @ prior,
    )
    x, y, heading = shared[count:]
    position, turn = _squares(every, slice(0, 2)), _squares(every, slice(2, 3))
    return Fit(
        problem,
        unknowns,
        tuple(float(v) for v in shared[:count]),
        (float(x), float(y), float(np.angle(np.exp(1j * heading)))),
        inverse @ spread @ inverse,
        told,
        _usual(np.concatenate([r.values[r.weights > 0] for r in every]) ** 2) / problem.scale**2,
        (float(np.sqrt(2 * position)), float(np.sqrt(turn)) / LEVER),
        tuple(float(problem.own(unknowns, index)[3]) for index in range(len(problem.drives))),
    )


def _squares(every: list[Residuals], rows: slice) -> float:
    """The mean square of what was measured of x, y, heading; nan where nothing was."""
    values = np.concatenate([r.values[rows][r.weights[rows] > 0] for r in every])
    return float(np.mean(values**2)) if len(values) else float("nan")


def _usual(squares: Reals) -> float:
    """The mean of squares, the few that a tracker's glitches make 100 times as large as the others counted so."""
    lower = np.sort(squares)[: max(1, round(_COMMON * len(squares)))]
    return float(np.mean(np.minimum(squares, _GLITCH * np.mean(lower))))


def _spread(problem: Problem, rows: Residuals, eliminated: Reals, index: int, freedom: float) -> Reals:
    """The covariance of the gradient by the shared unknowns that a drive's slips and the truth's noise make;
    ``freedom``: how much larger squares of errors are than those of residuals, for unknowns take part of them up."""
    t = problem.drives[index].truth.t
    shared = len(eliminated)
    z = rows.values / problem.scale
    gain = (rows.weights / (problem.scale**2 * (1 + z * z) ** 1.5))[..., None]
    pull = gain * (
        rows.by[..., :shared] - rows.by[..., shared:] @ eliminated.T
    )  # (3, n, shared) by metre of residual
    measured = rows.weights > 0
    drift, noise = _walk(t, rows, measured)
    after = np.cumsum(pull[:, ::-1], axis=1)[
        :, ::-1
    ]  # of a step to the right, to the left, of all that follows
    turning = LEVER * pull[2] - pull[0] * rows.place.imag[:, None] + pull[1] * rows.place.real[:, None]
    turned = np.cumsum(turning[::-1], axis=0)[::-1]
    turned += after[0] * rows.place.imag[:, None] - after[1] * rows.place.real[:, None]
    lasting = np.diff(t, prepend=t[0])[:, None]
    total = drift[1] * (turned * lasting).T @ turned
    for axis in range(2):
        total += drift[0] * (after[axis] * lasting).T @ after[axis] + noise[0] * pull[axis].T @ pull[axis]
    return np.asarray(freedom * (total + noise[1] * LEVER**2 * pull[2].T @ pull[2]))


def _walk(
    t: Reals, rows: Residuals, measured: NDArray[np.bool_]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """How fast the variances of position (by axis, [m^2/s]) and heading [rad^2/s] grow, and those of the truth's noise:
    from differences over a short and a long time."""
    place, heading = rows.values[0] + 1j * rows.values[1], rows.values[2] / LEVER
    whole = measured.all(axis=0) if measured[2].any() else measured[:2].all(axis=0)
    t, place, heading, at = t[whole], place[whole], heading[whole], rows.place[whole]
    if len(t) < 4:
        square = float(np.mean(rows.values[measured] ** 2)) if measured.any() else 0.0
        return (0.0, 0.0), (square, square / LEVER**2)
    spans = []
    for wanted in (_SHORT, min(_LONG, (t[-1] - t[0]) / 3)):
        lag = int(np.clip(np.searchsorted(t, t[0] + wanted), 1, len(t) - 1))
        turned, way = heading[lag:] - heading[:-lag], at[lag:] - at[:-lag]
        moved = place[lag:] - place[:-lag] - 1j * way * heading[:-lag]
        spans.append(
            [_usual(part) for part in (t[lag:] - t[:-lag], turned**2, np.abs(moved) ** 2, np.abs(way) ** 2)]
        )
    short, long = spans
    turn, turn_noise = _grows(short[0], short[1], long[0], long[1])
    # What turns on the way and the truth's noise in the first heading add to the place: half of it to each axis.
    aside = [(moved - way * (turn * span / 3 + turn_noise)) / 2 for span, _, moved, way in spans]
    slide, slide_noise = _grows(short[0], aside[0], long[0], aside[1])
    return (slide, turn), (slide_noise, turn_noise)


def _grows(short: float, first: float, long: float, second: float) -> tuple[float, float]:
    """The rate at which a variance grows that is ``first`` over a ``short`` and ``second`` over a ``long`` time, and
    that of the noise at each end."""
    rate = max(0.0, second - first) / (long - short) if long > short else second / long
    return rate, max(0.0, first - rate * short) / 2
