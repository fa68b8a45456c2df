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
from scipy.special import ndtr, stdtrit

from wmrgen.tools.calibrating.arrow import Sums
from wmrgen.tools.calibrating.clocks import ALONE, ONE, shown
from wmrgen.tools.calibrating.fit import (
    LEVER,
    Each,
    Problem,
    Residuals,
    arrow,
    information,
    joint_residuals,
    joint_sums,
    nearest,
    path_sums,
    prior_of_own,
    prior_of_shared,
    residuals,
    solved,
)
from wmrgen.tools.calibrating.logs import Drive
from wmrgen.tools.calibrating.path import Reals
from wmrgen.tools.calibrating.stored import chosen
from wmrgen.tools.calibrating.walks import spans_of, usual, walk_of

_FEWEST = 3  # parts of drives whose spread is a standard deviation
_ALONE = 3.0  # times as uncertain as with all drives: the drives that are left do not tell a parameter


@dataclass(frozen=True, slots=True)
class Fit:
    """What was estimated: ``values`` of the parameters and ``mount`` (x, y [m], heading [rad] of the tracked point on
    the robot); ``covariance`` of both, in `Problem.units`; ``information``: the matrix that the drives alone give,
    own unknowns eliminated; ``noise``: the mean square of residuals in units of the scale; ``rms`` (2,) [m] of
    positions and [rad] of headings, nan where none was measured; ``rms_by_drive`` (drives, 2); ``offsets`` [s] by
    drive; ``spread`` (2, drives): their variances in units, and what these were, if residuals did not depend on each
    other; ``freedom``: measurements less unknowns."""

    problem: Problem
    unknowns: Reals
    values: tuple[float, ...]
    mount: tuple[float, float, float]
    covariance: Reals
    information: Reals
    noise: float
    rms: Reals
    rms_by_drive: Reals
    offsets: tuple[float, ...]
    spread: Reals
    freedom: int

    @property
    def deviations(self) -> Reals:
        """Standard deviations of the parameters [m, rad] that slips and noise in the drives make."""
        sizes = np.sqrt(np.maximum(np.diag(self.covariance), 0.0)) * self.problem.units  # but for rounding
        return np.asarray(sizes[: len(self.values)])


def student(freedom: int) -> float:
    """How many times as far as three standard deviations of a normal distribution Student's goes, that of as many
    degrees of ``freedom``: infinite where there is none."""
    return float(stdtrit(freedom, ndtr(3.0)) / 3) if freedom > 0 else np.inf


def deviations(best: Fit, others: Sequence[Fit]) -> Reals:
    """Standard deviations of the parameters, of the ``others`` without a part of the drives each. Where measurements
    are few, they are so much larger that three of them are as sure as ever; infinite where unknowns are as many."""
    values, without_each = np.array([o.values for o in others]), np.array([o.deviations for o in others])
    return np.asarray(student(best.freedom) * _jackknife(best.deviations, values, without_each))


def _jackknife(inside: Reals, values: Reals, deviations: Reals) -> Reals:
    """Of P parameters the standard deviations ``inside`` (P,) that slips and noise in the drives make, or, where it is
    more, what n parts of the drives differ by, three at least: by ``values`` and ``deviations`` (n, P) without each. A
    part without which a parameter is far less certain alone tells it: what is left says nothing of it."""
    if len(values) < _FEWEST:
        return inside
    tells = deviations < _ALONE * inside
    middle = np.sum(values * tells, axis=0) / np.maximum(1, np.sum(tells, axis=0))
    between = np.sqrt((len(values) - 1) * np.mean(tells * (values - middle) ** 2, axis=0))
    return np.asarray(np.maximum(inside, between))


def bent(best: Fit, coarser: Problem, each: Each) -> Fit:
    """The fit with the covariance that directions make in which parameters are held nominal: such a direction is a
    straight line, where the parameters that explain the truth as well lie along a curve. It is what all move by, where
    it is a unit longer or shorter, and a ``coarser`` problem does for it."""
    if best.problem.held is None:
        return best

    def shared(problem: Problem) -> Reals:
        return problem.shared(nearest(problem, best.unknowns, each)) / best.problem.units

    held = np.pad(best.problem.held, ((0, len(best.covariance) - len(best.values)), (0, 0)))
    others, about = np.eye(len(held)) - held @ held.T, shared(coarser)
    covariance = others @ best.covariance @ others
    for unit in (*held.T, *-held.T):
        moved = shared(replace(coarser, off=unit)) - about
        covariance += np.outer(moved, moved) / 2
    return replace(best, covariance=covariance)


def fit(problem: Problem, each: Each, start: Reals) -> Fit:
    """The parameters under which paths and truth are nearest, from ``start`` on."""
    return fit_at(*solved(problem, each, start), each)


def of_drives(about: Fit, drives: Sequence[Drive]) -> Fit:
    """The fit of a coarser problem as that of the ``drives`` with all their readings."""
    return replace(about, problem=replace(about.problem, drives=drives))


def without(best: Fit, drives: Sequence[int], each: Each) -> Fit:
    """The fit without ``drives``, from that of all on."""
    problem, shared = best.problem, len(best.covariance)
    kept = [i for i in range(len(problem.drives)) if i not in drives]
    own = best.unknowns[shared:].reshape(len(problem.drives), -1)[kept]
    rest = replace(problem, drives=chosen(problem.drives, kept))
    return fit_at(rest, nearest(rest, np.concatenate([best.unknowns[:shared], own.ravel()]), each), each)


def agreeing(best: Fit) -> Problem:
    """The problem in which clocks agree as far as those of ``best``, where each drive tells its own alone, show that
    they do: what is no more than slips and noise make of an offset is taken from it, and little where they truly
    differ. The same problem where something is known of clocks before."""
    if best.problem.clocks != ALONE:
        return best.problem
    own = best.unknowns[len(best.problem.units) :].reshape(len(best.problem.drives), -1)
    return replace(best.problem, clocks=shown(own[:, -1], *best.spread))


@dataclass(frozen=True, slots=True)
class _Evidence:
    """What one drive says of how certain a fit is. ``squares`` [m^2] and ``counts`` of residuals: of x and y, and of
    headings; ``usual``: the mean of squares that are usual; ``spans``: as `spans_of` has them; ``pulls`` (5, k, k),
    of its k unknowns: as `_pulls` has them; ``others`` (k, k): the covariance of its gradient that a first pose whose
    error is known and what joints disagree by make; ``offset`` [s]: of the clock."""

    sums: Sums
    squares: tuple[float, float]
    counts: tuple[int, int]
    usual: float
    spans: Reals | None
    pulls: Reals
    others: Reals
    offset: float


def fit_at(problem: Problem, unknowns: Reals, each: Each) -> Fit:
    """What the ``unknowns`` of least cost say, and how certain they are."""
    count = len(problem.nominal)
    shared = problem.shared(unknowns)
    every = each(problem, unknowns, _evidence)
    squares, counts = np.array([d.squares for d in every]), np.array([d.counts for d in every])
    measured = int(counts.sum())
    # Squares of errors are so much larger than those of residuals, for unknowns take part of them up.
    freedom = measured - len(unknowns) + (len(problem.drives) if problem.clocks == ONE else 0)
    walk = walk_of([drive.spans for drive in every if drive.spans is not None])
    rates = [_independent(drive) if drive.spans is None else walk for drive in every]
    noise = [
        measured / max(1, freedom) * np.tensordot(r, drive.pulls, 1) + drive.others
        for r, drive in zip(rates, every, strict=True)
    ]
    covariance, spread = _spread(problem, every, np.array(noise))
    x, y, heading = shared[count:]
    return Fit(
        problem,
        unknowns,
        tuple(float(v) for v in shared[:count]),
        (float(x), float(y), float(np.angle(np.exp(1j * heading)))),
        covariance,
        information(problem, [drive.sums for drive in every]),
        sum(drive.usual * sum(drive.counts) for drive in every) / measured / problem.scale**2,
        _rms(squares.sum(axis=0), counts.sum(axis=0)),
        _rms(squares, counts),
        tuple(drive.offset for drive in every),
        spread,
        freedom,
    )


def _rms(squares: Reals, counts: NDArray[np.intp]) -> Reals:
    """Root mean squares (..., 2) of positions [m] and of headings [rad], of sums of residuals' squares (..., 2): those
    of x and y, and of headings; nan where there are none."""
    return np.asarray(np.sqrt(squares / np.where(counts, counts, np.nan)) * (2**0.5, 1 / LEVER))


def _independent(drive: _Evidence) -> Reals:
    """The rates, as `walk_of` returns them, of a drive of which too little is measured to tell slips from noise."""
    square = sum(drive.squares) / max(1, sum(drive.counts))
    return np.array([0.0, 0.0, 0.0, square, square / LEVER**2])


def _spread(problem: Problem, every: Sequence[_Evidence], noise: Reals) -> tuple[Reals, Reals]:
    """The covariance of the s shared unknowns (s, s) that the ``noise`` (n, k, k) of each drive's gradient makes; of
    each clock (2, n) the variance that it makes, and that in the inverse of the cost's matrix. Priors make noise, too:
    a shared unknown is a unit off, what a drive has of its own as far as its prior says, and all clocks together by the
    error of their mean."""
    matrix, clocks = arrow(problem, [drive.sums for drive in every]), problem.clocks
    inverse, follows = np.linalg.inv(matrix.reduced), matrix.follows
    s, follow, alone = len(inverse), follows[:, -1], np.linalg.inv(matrix.own)[:, -1]
    noise = noise + np.pad(clocks.counted * prior_of_own(problem), (s, 0))
    # What a drive's gradient moves the shared unknowns by, and what its own clock.
    by_shared = np.broadcast_to(inverse, (len(every), s, s))
    moves = np.concatenate([by_shared, -inverse @ follows.swapaxes(1, 2)], axis=2)
    moves_clock = np.pad(alone, ((0, 0), (s, 0))) - np.einsum("ns,nsk->nk", follow, moves)
    of_each = moves @ noise @ moves.swapaxes(1, 2)
    sizes, axes = np.linalg.eigh(of_each.sum(axis=0))
    slips = (axes * np.maximum(sizes, 0.0)) @ axes.T  # where only the prior tells, rounding may be larger
    off, mean = prior_of_shared(problem) @ inverse, clocks.weight * clocks.error * moves[:, :, -1].sum(axis=0)
    covariance = slips + off.T @ off + np.outer(mean, mean)
    late = clocks.weight * clocks.error * alone[:, -1] - follow @ mean
    others = covariance - np.outer(mean, mean) - of_each
    variances = late**2 + np.einsum("nk,nkl,nl->n", moves_clock, noise, moves_clock)
    variances += np.einsum("ns,nst,nt->n", follow, others, follow)
    return covariance, np.array([variances, alone[:, -1] + np.einsum("ns,st,nt->n", follow, inverse, follow)])


def _evidence(problem: Problem, unknowns: Reals, index: int) -> _Evidence:
    rows = residuals(problem, unknowns, index)
    sums, measured = path_sums(problem, rows), rows.weights > 0
    pull, error = _pull(problem.scale, rows), problem.drives[index].start_error
    known = error < np.inf
    others = error**2 * pull[:, 0].T @ pull[:, 0] if known else np.zeros_like(sums.matrix)
    if problem.untold is not None:
        values, by = joint_residuals(problem, unknowns, index)
        sums, others = sums + joint_sums(problem, values, by), others + _slides(problem, values, by)
    of_axes = [rows.values[part][measured[part]] ** 2 for part in (slice(0, 2), slice(2, 3))]
    t = problem.drives[index].truth.t
    return _Evidence(
        sums,
        (float(of_axes[0].sum()), float(of_axes[1].sum())),
        (len(of_axes[0]), len(of_axes[1])),
        usual(np.concatenate(of_axes)) if measured.any() else 0.0,
        spans_of(t, rows, measured),
        _pulls(pull, t, rows, noisy=int(known)),
        others,
        float(problem.own(unknowns, index)[3]),
    )


def _pull(scale: float, rows: Residuals) -> Reals:
    """The gradient of a drive by its k unknowns that each residual makes (3, n, k), by metre; ``scale`` [m] is that of
    the loss."""
    z = rows.values / scale
    return np.asarray((rows.weights / (scale**2 * (1 + z * z) ** 1.5))[..., None] * rows.by)


def _pulls(pull: Reals, t: Reals, rows: Residuals, noisy: int) -> Reals:
    """The covariances of a drive's gradient by its k unknowns that a unit of each of what `walk_of` returns makes
    (5, k, k); ``noisy``: the first row that has the truth's noise."""
    after = np.cumsum(pull[:, ::-1], axis=1)[:, ::-1]  # of a step along x, y that all that follows takes
    turning = LEVER * pull[2] - pull[0] * rows.place.imag[:, None] + pull[1] * rows.place.real[:, None]
    turned = np.cumsum(turning[::-1], axis=0)[::-1]
    turned += after[0] * rows.place.imag[:, None] - after[1] * rows.place.real[:, None]
    c, s = np.cos(rows.heading)[:, None], np.sin(rows.heading)[:, None]
    steps = (c * after[0] + s * after[1], c * after[1] - s * after[0], turned)
    lasting = np.diff(t, prepend=t[0])[:, None]
    seen = [part[noisy:].T @ part[noisy:] for part in pull]
    return np.array([*((step * lasting).T @ step for step in steps), seen[0] + seen[1], LEVER**2 * seen[2]])


def _slides(problem: Problem, values: Reals, by: Reals) -> Reals:
    """The covariance of a drive's gradient (k, k) that its joints' disagreement makes, as `joint_residuals` has it,
    one span's independent of the next's (White, Econometrica 48:817, 1980)."""
    z = values / problem.slides
    pull = np.einsum("rn,rnk->nk", z / np.sqrt(1 + z * z), by) / problem.slides
    return np.asarray(pull.T @ pull)
