"""Noise levels, and the covariance of the estimate that follows from them.

Odometry errs by a random walk: between two reference poses, place and heading get independent errors with variances
proportional to the distance travelled. Reference poses have white noise. All four variances enter linearly into the
mean square of the difference of odometry and reference between two poses. So they are found by non-negative least
squares over differences at lags from one pose to the whole log.

The estimator treats residuals as independent, but an error of the walk remains in all later poses. So the covariance
is the sandwich of both, B^-1 M B^-1, with the matrix B of the normal equations and the covariance M of their
gradient under this noise.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np
from scipy.optimize import nnls

from wmrgen.tools.calibration.estimator import PRIOR, Fit, Reduced, loss, reduced
from wmrgen.tools.calibration.logs import steps_at
from wmrgen.tools.calibration.model import LEVER
from wmrgen.tools.calibration.path import Complexes, Path, Reals

_ROUNDS = 5  # of weights by expected squares, which follow from the result: it changes by less than 1 % then
_ERRORS = 0.5  # standard errors that a level is taken higher: few logs may show less noise than there is
_ROBUST = 25.0  # times the median of squares: larger ones are slips or outliers, and are limited to this


@dataclass(frozen=True, slots=True)
class Noise:
    """Variances."""

    position_walk: float  # [m^2/m] of x and of y, for each metre travelled
    heading_walk: float  # [rad^2/m]
    position: float  # [m^2] of x and of y of a reference pose
    heading: float  # [rad^2] of a reference pose


# Usual for many robots: 1 cm and 1 deg after 1 m, poses to 5 mm and 0.3 deg.
USUAL = Noise(1e-4, 3e-4, 2.5e-5, 2.5e-5)


@dataclass(frozen=True, slots=True)
class Track:
    """Odometry and reference of one leg, at its n reference poses that have a heading or a place."""

    log: int  # number of the log
    t: Reals  # (n,) [s] on the clock of the reference
    place: Complexes  # (n,) [m] the tracked point by odometry
    heading: Reals  # (n,) [rad]
    seen: Complexes  # (n,) [m] by the reference, nan where it is not measured
    theta: Reals  # (n,) [rad], the same
    travelled: Reals  # (n,) [m] distance, and rotation as an arc at the lever

    @property
    def complete(self) -> Track:
        """The poses that have a place and a heading."""
        rows = np.isfinite(self.seen) & np.isfinite(self.theta)
        return Track(self.log, *(column[rows] for column in astuple(self)[1:]))


@dataclass(frozen=True, slots=True)
class Covariance:
    """What the estimate is uncertain by, under the noise."""

    shared: Reals  # (S, S) in units
    clocks: Reals  # (logs,) [s] standard deviation of each clock offset, the others estimated too


def distance(path: Path) -> Reals:
    """Return the distance travelled at each pose of a path [m], with rotation as an arc at the lever."""
    steps = np.abs(np.diff(path.position)) + LEVER * np.abs(np.diff(path.heading))
    return np.concatenate([[0.0], np.cumsum(steps)])


def tracks(fit: Fit) -> list[Track]:
    """Return the legs of all logs, with odometry by the fitted parameters."""
    result, problem, count = [], fit.problem, len(fit.problem.nominal)
    mount = complex(fit.state.shared[count], fit.state.shared[count + 1])
    for index, log in enumerate(problem.logs):
        legs, clock = problem.legs[index], fit.state.own[index][0]
        path = problem.increments.alone.path(log.columns, fit.state.shared[:count])
        total = distance(path)
        for first, last in legs:
            measured = np.isfinite(log.poses.theta) | np.isfinite(log.poses.x + log.poses.y)
            measured &= log.inside(clock)
            poses = log.poses.rows(measured & (log.poses.t >= first) & (log.poses.t <= last))
            if len(poses.t) < 2:
                continue
            here = path.between(*steps_at(log.t, poses.t + clock))
            place = here.position + np.exp(1j * here.heading) * mount
            travelled = np.interp(poses.t + clock, log.t, total)
            theta = poses.theta - fit.state.shared[count + 2]
            result.append(
                Track(index, poses.t, place, here.heading, poses.x + 1j * poses.y, theta, travelled)
            )
    return result


def differences(track: Track, lag: int) -> tuple[Complexes, Reals]:
    """Return by how much odometry and reference differ between poses ``lag`` rows apart, place [m] and heading [rad].

    Both are seen from the first of the two, by the heading of odometry where the reference has none.
    """
    own = (track.place[lag:] - track.place[:-lag]) * np.exp(-1j * track.heading[:-lag])
    theta = np.where(np.isfinite(track.theta), track.theta, track.heading)
    seen = (track.seen[lag:] - track.seen[:-lag]) * np.exp(-1j * theta[:-lag])
    return own - seen, (track.heading - track.theta)[lag:] - (track.heading - track.theta)[:-lag]


def swings(track: Track, lag: int) -> Reals:
    """Return how a heading walk moves poses ``lag`` rows later [m^3]: the integral of squared distance over travel."""
    step = np.diff(track.travelled)
    middle = 0.5 * (track.place[1:] + track.place[:-1])
    first = np.concatenate([[0], np.cumsum(middle * step)])
    second = np.concatenate([[0], np.cumsum(np.abs(middle) ** 2 * step)])
    end = track.place[lag:]
    moved = np.abs(end) ** 2 * (track.travelled[lag:] - track.travelled[:-lag])
    moved -= 2 * np.real(np.conj(end) * (first[lag:] - first[:-lag]))
    return np.asarray(np.maximum(moved + second[lag:] - second[:-lag], 0.0))


def spare(fit: Fit) -> float:
    """Return the share of the measurements that the unknowns leave for noise, 0 to 1.

    An unknown counts by the share of its information that comes from the logs and not from its prior.
    """
    problem = fit.problem
    measured = sum(int((one.weights > 0).sum()) for one in fit.rows)
    logs = [reduced(normal) for normal in fit.normals]
    matrix = problem.free.T @ sum(log.shared[0] for log in logs) @ problem.free
    unknown = float(np.trace(np.linalg.solve(matrix + PRIOR**2 * np.eye(len(matrix)), matrix)))
    for legs, log in zip(problem.legs, logs, strict=True):
        unknown += 3 * len(legs) + 1 - problem.clock_spread**-2 / log.matrix[-1, -1]
    return max(0.0, 1 - unknown / max(measured, 1))


def of_fit(fit: Fit) -> Noise:
    """Return the variances that the residuals of an estimate show.

    If the reference has one coordinate alone, all residuals are treated as noise of the reference.
    """
    every, share = tracks(fit), spare(fit)
    if every or share == 0:
        return noise(every, share)
    squares = fit.residuals**2
    level = (USUAL.position + float(squares.sum())) / (1 + share * len(squares))
    return Noise(0.0, 0.0, level, level / LEVER**2)


def noise(every: list[Track], share: float = 1.0) -> Noise:
    """Estimate the four variances from the legs of all logs.

    Usual values count as one more difference. So a few poses, which parameters can be fitted to exactly, do not make
    the result look certain.

    Args:
        every: The legs.
        share: Share of the measurements that the unknowns leave for noise, see `spare`.
    """
    matrix, values, counts = [], [], []
    longest = max((len(track.place) for track in every), default=0)
    lags = [2**k for k in range(int(np.log2(max(longest - 1, 1))) + 1)]
    for lag in lags if share > 0 else ():
        some = [track for track in every if len(track.place) > lag]
        if not some:
            continue
        both = [differences(track, lag) for track in some]
        place = np.abs(np.concatenate([d[0] for d in both])) ** 2
        turn = np.concatenate([d[1] for d in both]) ** 2
        travel = np.concatenate([track.travelled[lag:] - track.travelled[:-lag] for track in some])
        chord = np.abs(np.concatenate([track.seen[lag:] - track.seen[:-lag] for track in some])) ** 2
        swing = np.concatenate([swings(track, lag) for track in some])
        # By position walk, heading walk, position and heading noise. A heading error swings the rest of the way.
        none, one = np.zeros_like(travel), np.ones_like(travel)
        by_place = np.array([2 * travel, swing, 4 * one, chord])
        for squares, by in ((place, by_place), (turn, np.array([none, travel, none, 2 * one]))):
            measured = np.isfinite(squares)
            if not measured.any():
                continue
            squares = squares[measured]
            matrix.append(by[:, measured].mean(axis=1))
            values.append(float(np.minimum(squares, _ROBUST * np.median(squares)).mean()) / share)
            counts.append(share * len(squares) / lag)  # independent differences
    usual = np.array([USUAL.position_walk, USUAL.heading_walk, USUAL.position, USUAL.heading])
    rows, means = np.array(matrix).reshape(-1, 4), np.array(values)
    expected, most = rows @ usual, usual
    for _ in range(_ROUNDS if len(rows) else 0):
        weights = np.sqrt(counts) / np.maximum(expected, 1e-12)  # errors of mean squares are relative
        every_row = np.vstack([weights[:, None] * rows, np.diag(1 / usual)])
        sizes = np.linalg.norm(every_row, axis=0)
        found = nnls(every_row / sizes, np.concatenate([weights * means, np.ones(4)]))[0] / sizes
        expected = rows @ found
        # A mean of n squares is uncertain by a share of sqrt(2 / n).
        errors = np.sqrt(2 * np.diag(np.linalg.inv((every_row / sizes).T @ (every_row / sizes)))) / sizes
        most = found + _ERRORS * errors
    return Noise(*map(float, most))


@dataclass(frozen=True, slots=True)
class Share:
    """What one log adds to the covariance."""

    matrix: Reals  # (S, S) of the normal equations, in units, its own unknowns eliminated
    meat: Reals  # (S, S) covariance of the gradient
    # [s^2] variance of its clock for known shared unknowns, and how it follows them (S,).
    clock: tuple[float, Reals]


def shares(fit: Fit, level: Noise) -> list[Share]:
    """Return what each log adds to the covariance, under the noise ``level``."""
    off = np.concatenate([one.joints for one in fit.rows])
    joints = float(off @ off) / max(1, len(off))
    result = []
    for index, normal in enumerate(fit.normals):
        log = reduced(normal)
        gradient = _gradient_covariance(fit, index, log, level, joints)
        eliminate = np.hstack([np.eye(len(gradient) - 1), -log.clock_follows[:, None]])
        own = gradient[-1, -1] / log.matrix[-1, -1] ** 2
        result.append(
            Share(log.shared[0], eliminate @ gradient @ eliminate.T, (float(own), log.clock_follows))
        )
    return result


def combined(every: list[Share], free: Reals) -> Covariance:
    """Return the covariance of an estimate from some logs, in the directions ``free`` (S, k).

    The prior is one more measurement of each shared unknown, with a standard deviation of one unit.
    """
    width = len(free)
    matrix = PRIOR**2 * np.eye(width) + sum((one.matrix for one in every), np.zeros((width, width)))
    meat = PRIOR**4 * np.eye(width) + sum((one.meat for one in every), np.zeros((width, width)))
    bread = free @ np.linalg.solve(free.T @ matrix @ free, free.T)
    shared = bread @ meat @ bread
    clocks = []
    for one in every:
        own, follows = one.clock
        clocks.append(own + float(follows @ shared @ follows))
    return Covariance(shared, np.sqrt(np.maximum(clocks, 0.0)))


def covariance(fit: Fit, level: Noise) -> Covariance:
    """Return the covariance of the shared unknowns and of the clocks, under the noise ``level``."""
    return combined(shares(fit, level), fit.problem.free)


def _gradient_covariance(fit: Fit, index: int, log: Reduced, level: Noise, joints: float) -> Reals:
    """Return the covariance of a log's gradient over shared unknowns and clock, its starts of legs eliminated.

    Args:
        fit: The estimate.
        index: The log's number.
        log: Its normal equations.
        level: Variances of odometry and reference.
        joints: Mean square of the residuals of redundant joints [m^2].
    """
    one, problem, count = fit.rows[index], fit.problem, len(fit.problem.nominal)
    scale, width = problem.scale, len(problem.origin) + 1
    _, _, change = loss(one, scale)
    # (n, S + 1) each: the gradient by an error of one residual.
    x, y, theta = change[..., :width] - np.einsum("cni,nij->cnj", change[..., width:], log.follow[one.leg])
    theta = LEVER * theta
    position = np.where(one.known, problem.start_error**2, level.position)[:, None]
    heading = np.where(one.known, (problem.start_error / LEVER) ** 2, level.heading)[:, None]
    result = x.T @ (position * x) + y.T @ (position * y) + theta.T @ (heading * theta)
    readings = problem.logs[index]
    total = distance(problem.increments.alone.path(readings.columns, fit.state.shared[:count]))
    travelled = np.interp(one.at, readings.t, total)
    for leg in np.unique(one.leg):
        rows = np.flatnonzero(one.leg == leg)
        begin = np.interp(problem.legs[index][leg, 0], readings.t, total)
        travel = np.maximum(np.diff(travelled[rows], prepend=begin), 0.0)[:, None]
        place = one.place[rows]
        after = [_later(part[rows]) for part in (x, y, theta)]
        swing = y[rows] * place.real[:, None] - x[rows] * place.imag[:, None]
        turned = (
            after[2] + _later(swing)
            - after[1] * place.real[:, None] + after[0] * place.imag[:, None]
        )  # fmt: skip
        result += level.position_walk * (after[0].T @ (travel * after[0]) + after[1].T @ (travel * after[1]))
        result += level.heading_walk * (turned.T @ (travel * turned))
    if len(one.joints):
        weighted = one.joints_by / np.sqrt(1 + (one.joints / scale) ** 2)[:, None] ** 3 / scale**2
        result[:count, :count] += joints * (weighted.T @ weighted)
    return np.asarray(result)


def _later(rows: Reals) -> Reals:
    """Return, for each row, the sum of it and all later rows."""
    return np.asarray(np.cumsum(rows[::-1], axis=0)[::-1])
