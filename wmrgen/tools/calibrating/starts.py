"""Where drives start, before anything is estimated: in closed form, from nominal odometry.

With z where the tracked point was, theta its heading, p and phi those of odometry, m the tracked point on the robot:
theta = s + phi + d and z = z0 + exp(is) (p + exp(i phi) m), where s is the robot's heading at the start and d what the
tracked body is turned by on the robot. Over a short way, seen from the body, exp(-i theta) dz = exp(-id) (exp(-i phi)
dp + (exp(i dphi) - 1) m) has neither s nor what odometry has drifted by. So d is linear least squares, however the
body is turned; where no headings are measured, so is exp(is), over the first part of the drive.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from wmrgen.tools.calibrating.certainty import Fit, fit_at, of_drives
from wmrgen.tools.calibrating.clocks import ALONE
from wmrgen.tools.calibrating.fit import (
    BEYOND,
    LEVER,
    Each,
    Problem,
    nearest,
    place_at,
    residuals,
    start_of,
)
from wmrgen.tools.calibrating.joints import agreed
from wmrgen.tools.calibrating.logs import Drive, Truth
from wmrgen.tools.calibrating.outliers import Outlier, without_slips
from wmrgen.tools.calibrating.path import Complexes, Reals, passed
from wmrgen.tools.calibrating.stored import changed

_WAY = 1.0  # [s] a short way: nominal odometry is right about it, and a pose's noise is small beside it
_SURE = 0.05  # [m] of ways in all, below which the tracked body is taken to look ahead
_LOST = 1.0  # [rad] that nominal odometry may be off by in the end, to be a start
_ASTRAY = 0.2  # the same of places, of how far the drive goes
_PIECE = 5.0  # [s] of a drive in which odometry does not lose its way
_LONGER = 8.0  # times: what pieces tell, odometry over so much longer ones needs
_PIECES = 12  # of all drives, and so many drives at most
_FEWEST = 4  # rows of truth that a piece has
_OFF, _LATE = 0.1, 2.0  # [s] by which clocks are tried, up to so far
_MOST, _ENOUGH = 0.9, 24  # of ways and turns that are compared, so that slips do not count; how many at least
_DOUBT = 0.1  # by so much less have ways and turns to differ, to tell that a clock is off by a second
_TURNS = 2.0  # [rad] that nominal odometry may have turned by, before it is off by too much
_LEAST = 0.3  # [m] of way that an alignment without headings needs, so that it goes on for so long at least


def laid(problem: Problem) -> Problem:
    """The drives with starts, and headings of the truth as many turns on as odometry says between two rows, which may
    be far apart as start and end of a drive are; and the mount's heading."""
    sums = np.array([[_SURE**2, 0, _SURE**2], [0, _SURE**2, 0]], dtype=complex)

    def unwound(_: int, drive: Drive) -> list[Drive]:
        drive = _inside(drive)
        place, heading = _at_truth(problem, drive)
        theta, measured = drive.truth.theta.copy(), np.isfinite(drive.truth.theta)
        theta[measured] = heading[measured] + np.unwrap(theta[measured] - heading[measured])
        truth = replace(drive.truth, theta=theta)
        np.add(sums, _ways(truth, place, heading), out=sums)
        return [replace(drive, truth=truth)]

    def started(_: int, drive: Drive) -> list[Drive]:
        start = _start(problem, drive, turned)
        return [replace(drive, start=(*start, drive.start[3]))]

    drives = changed(problem.drives, unwound)
    turned = float(-np.angle(np.linalg.solve(sums[:, :2], sums[:, 2])[0]))
    return replace(problem, drives=changed(drives, started), turned=turned)


def begun(
    problem: Problem, coarser: Callable[[Problem], Problem], each: Each, lost: bool = False
) -> tuple[Problem, Reals, list[Outlier]]:
    """The problem with drives that are laid by about their own clocks, and unknowns to start from: nominal ones, or
    where odometry with them loses its way, what short pieces of the drives say, in which it does not, and with that
    longer ones. Where it goes on to lose its way, and whole drives do not tell it from there, drives go without slips
    that steps of the path show then, which are returned, too; so they do where it is known to be ``lost``. For all this
    a ``coarser`` problem does."""
    drives = problem.drives
    if problem.clocks == ALONE:
        drives = changed(drives, lambda _, drive: [_in_time(problem, drive)])
    ready, slips, seconds = laid(replace(problem, drives=drives)), list[Outlier](), _PIECE
    start, coarse = start_of(ready), coarser(ready)
    coarse, start = agreed(coarse, start, each, lost or not _finds(coarse, start))
    ready = replace(ready, untold=coarse.untold, slides=coarse.slides)
    longest = max(float(np.ptp(drive.t)) for drive in drives)

    def fit_of(ready: Problem, start: Reals) -> Fit:
        return of_drives(fit_at(coarser(ready), start, each), ready.drives)

    while seconds < longest and (lost or not _finds(coarse, start)):
        start = _in_pieces(coarse, start, seconds, each)
        if not lost and not _finds(coarse, start):
            # Where pieces are off, sound parts of drives look like slips.
            whole = _in_pieces(coarse, start, longest, each)
            start = whole if _finds(coarse, whole) else start
        best, more = without_slips(
            fit_of(ready, start),
            coarser,
            lambda rest, best: fit_of(again := laid(rest), start_of(again, best.unknowns)),
            (lambda *_: False) if lost else _finds,
        )
        ready, start, coarse = best.problem, best.unknowns, coarser(best.problem)
        seconds, slips, lost = seconds * _LONGER, slips + more, False
    return ready, start, slips


def _in_time(problem: Problem, drive: Drive) -> Drive:
    """The drive with about what its clock is off by: where ways and turns of truth and nominal odometry in a short time
    differ least, which slips barely disturb."""
    truth, at = drive.truth, np.arange(drive.t[0], drive.t[-1], _OFF)
    place, heading = nominal_at(problem, drive, at)
    rows = np.unique(np.searchsorted(truth.t, np.arange(truth.t[0], truth.t[-1] - _WAY, _WAY / 4)))
    rows = np.array([rows, np.minimum(np.searchsorted(truth.t, truth.t[rows] + _WAY), len(truth.t) - 1)])
    true, t = np.diff([(truth.x + 1j * truth.y)[rows], truth.theta[rows]], axis=1)[:, 0], truth.t[rows]

    def differ(late: float) -> float:
        inside = (t[0] + late >= at[0]) & (t[1] + late <= at[-1])
        way, turn = (np.diff(np.interp(t + late, at, poses), axis=0)[0] for poses in (place, heading))
        turned = np.angle(np.exp(1j * (turn - true[1].real)))
        off = np.array([np.abs(way) - np.abs(true[0]), LEVER * turned])[:, inside]
        sizes = np.sort(np.abs(off[np.isfinite(off)]))
        usual = sizes[: int(_MOST * len(sizes))]
        return float(np.mean(usual)) * (1 + _DOUBT * abs(late)) if len(usual) > _ENOUGH else np.inf

    late = min((0.0, *np.arange(-_LATE, _LATE + _OFF / 2, _OFF)), key=differ)
    return replace(drive, start=(*drive.start[:3], float(late)))


def _in_pieces(problem: Problem, start: Reals, seconds: float, each: Each) -> Reals:
    """Unknowns from ``start`` on, as pieces of the drives of so many seconds say."""
    some = problem.drives[:: -(-len(problem.drives) // _PIECES)]
    pieces = tuple(piece for drive in some for piece in _pieces(drive, len(some), seconds))
    short = laid(replace(problem, drives=pieces))
    return start_of(problem, nearest(short, start_of(short, start), each))


def _finds(problem: Problem, unknowns: Reals) -> bool:
    """Whether odometry does not lose its way in any drive."""
    return all(_found(problem, unknowns, index) for index in range(len(problem.drives)))


def _found(problem: Problem, unknowns: Reals, index: int) -> bool:
    """Whether headings stay near the truth; where none is measured, whether places do."""
    rows, truth = residuals(problem, unknowns, index), problem.drives[index].truth
    if np.isfinite(truth.theta).any():
        return bool(np.max(np.abs(rows.values[2])) < LEVER * _LOST)
    z = (truth.x + 1j * truth.y)[np.isfinite(truth.x + truth.y)]
    return bool(np.max(np.abs(rows.values[:2])) < _ASTRAY * np.max(np.abs(z - z[:1]), initial=0.0))


def _pieces(drive: Drive, count: int, seconds: float) -> list[Drive]:
    """Parts of so many seconds, as many as `_PIECES` allow of each of ``count`` drives; of sparse truth the whole."""
    firsts = np.searchsorted(drive.t, np.arange(drive.t[0], drive.t[-1], seconds))
    bounds = list(pairwise([*firsts, len(drive.t) - 1]))
    wanted = np.unique(np.linspace(0, len(bounds) - 1, max(1, _PIECES // count)).round().astype(int))
    parts = [drive.part(first, last, drive.start[3]) for first, last in (bounds[k] for k in wanted)]
    return [part for part in parts if part.truth.measured >= _FEWEST] or [drive]


def nominal_at(problem: Problem, drive: Drive, at: Reals) -> tuple[Complexes, Reals]:
    """Nominal odometry's places and headings at times [s] that rise."""
    step, _, share = place_at(drive.t, at)
    path = passed(problem.increments.alone, drive.columns, problem.nominal, step).within(
        np.clip(share, 0.0, 1.0)
    )
    return path.position, path.heading


def _at_truth(problem: Problem, drive: Drive) -> tuple[Complexes, Reals]:
    return nominal_at(problem, drive, drive.truth.t + drive.start[3])


def _inside(drive: Drive) -> Drive:
    """Without what is measured long before the first or after the last reading: nobody knows how the robot moved."""
    t = drive.truth.t
    inside = (t >= drive.t[0] - BEYOND) & (t <= drive.t[-1] + BEYOND)
    return drive if inside.all() else drive.seen(inside)


def _ways(truth: Truth, place: Complexes, heading: Reals) -> Complexes:
    """What a drive adds to the linear equations (2, 2 + 1) of exp(-id), d what the tracked body is turned by on the
    robot [rad], and of exp(-id) m."""
    measured = np.isfinite(truth.x) & np.isfinite(truth.y) & np.isfinite(truth.theta)
    t, z = truth.t[measured], (truth.x + 1j * truth.y)[measured]
    theta, p, phi = truth.theta[measured], place[measured], heading[measured]
    if len(t) < 2:
        return np.zeros((2, 3), complex)
    after = np.clip(np.searchsorted(t, t + _WAY), 1, len(t) - 1)
    before = np.minimum(np.arange(len(t)), after - 1)
    seen = np.exp(-1j * theta[before]) * (z[after] - z[before])
    way = np.exp(-1j * phi[before]) * (p[after] - p[before])
    columns = np.array([way, np.exp(1j * (phi[after] - phi[before])) - 1])
    return np.asarray(columns.conj() @ np.array([*columns, seen]).T / len(t))


def _start(problem: Problem, drive: Drive, turned: float) -> tuple[float, float, float]:
    """Where the robot was, x, y [m] and heading [rad], at the first reading."""
    truth = drive.truth
    z = truth.x + 1j * truth.y
    here, looks = np.flatnonzero(np.isfinite(z)), np.flatnonzero(np.isfinite(truth.theta))
    last = max([looks[0], *here[:1]]) if len(looks) else len(z)  # of the rows that tell it
    place, heading = _at_truth(problem, drive.seen(np.arange(len(z)) <= last))
    if len(looks):
        start = truth.theta[looks[0]] - heading[looks[0]] - turned
    else:
        start = _bearing(z[here], place[here], heading[here])
    if not len(here):
        axes = (truth.x, truth.y)
        x, y = (float(axis[np.isfinite(axis)][0]) if np.isfinite(axis).any() else 0.0 for axis in axes)
        return x, y, float(start)
    origin = z[here[0]] - np.exp(1j * start) * place[here[0]]
    return float(origin.real), float(origin.imag), float(start)


def _bearing(z: Complexes, p: Complexes, phi: Reals) -> float:
    """The heading at the start of a drive whose places alone are measured."""
    if len(z) < 2:
        return 0.0
    far = (np.maximum.accumulate(np.abs(phi - phi[0])) > _TURNS) & (
        np.maximum.accumulate(np.abs(p - p[0])) > _LEAST
    )
    count = max(4, int(np.argmax(far)) if far.any() else len(z))
    columns = np.array([p[:count], np.exp(1j * phi[:count])])
    columns = columns - columns.mean(axis=1, keepdims=True)
    if len(z) < 4:
        columns = columns[:1]
    moved = z[:count] - z[:count].mean()
    weak = np.diag([1e-6] + [1e-2] * (len(columns) - 1))
    return float(np.angle(np.linalg.solve(columns.conj() @ columns.T + weak, columns.conj() @ moved)[0]))
