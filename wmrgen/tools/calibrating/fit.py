"""The parameters under which the paths that joints tell lie nearest to where the robot was.

All poses of a whole drive count: windows of a few seconds are biased where the clocks of log and truth disagree. Each
drive has a start pose and a clock offset of its own, and all share the place of the tracked point on the robot; these
are estimated with the parameters. Residuals are metres, headings by way of a lever of 0.15 m; a robust loss (soft L1)
lets slips count by their size and not by its square. What no drive tells stays near nominal: a weak prior of 10 %.

The sum over drives of cost, gradient and matrix is all that the solver sees, so a drive needs its own
memory only while it is added.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.calibrating.arrow import Arrow, Slope, Sums, least, robust
from wmrgen.tools.calibrating.clocks import ALONE, Clocks
from wmrgen.tools.calibrating.logs import Drive
from wmrgen.tools.calibrating.path import Complexes, Increments, Reals, passed
from wmrgen.tools.calibrating.stored import changed

Result = TypeVar("Result")
Task = Callable[["Problem", Reals, int], Result]  # of one drive, by its number: unknowns are those of all
BEYOND = 1.0  # [s] that clocks may be apart: so far a truth may reach beyond its log
LEVER = 0.15  # [m] a heading's residual is this times its error
_SPACING = 1.0  # [s] truth that is denser than this counts no more than truth at this spacing
_MOUNT = 3  # x, y, heading of the tracked point on the robot
_UNIT_MOUNT = (0.05, 0.05, 0.05)  # [m, m, rad] about what such quantities are, for scaling and the weak prior
UNIT_OWN = np.array([0.1, 0.1, 0.1, 0.1])  # a drive's: x, y [m], heading [rad] of its start; clock offset [s]
_OWN = len(UNIT_OWN)
_PRIOR_OWN = 0.01  # the same for start poses and clocks
_MOST_STEPS = 40  # of the solver; where residuals are small it needs ten
_FEW = 12  # residuals of a drive, three times its own unknowns
FINEST = 1e-4  # [m] the least scale of residuals
_NEAR = 0.03  # standard deviations of Newton's step, with residuals as large as the scale: near enough
_PRIOR = 0.1  # residuals, in units of the loss's scale, that one unit (10 % of a parameter) away from nominal costs


class Untold(NamedTuple):
    """Orthonormal ``directions`` (P, k) of the parameters' unknowns that the truth does not tell, from the ``origin``
    (P,) on."""

    directions: Reals
    origin: Reals


@dataclass(frozen=True, slots=True)
class Problem:
    """What is estimated from which drives. ``nominal``: values of the P parameters; ``scale`` [m]: residuals far above
    it count by their size; ``slides`` [m]: so does what joints disagree by; ``turned`` [rad]: about what the tracked
    body is turned by on the robot; ``clocks``: how far those of drives agree; ``untold``: where the joints'
    disagreement counts; ``held`` (P, k): orthonormal directions in which parameters are nominal, or ``off``."""

    increments: Increments
    nominal: tuple[float, ...]
    drives: Sequence[Drive]
    scale: float = 0.01
    slides: float = 0.01
    turned: float = 0.0
    clocks: Clocks = ALONE
    untold: Untold | None = None
    held: Reals | None = None
    off: Reals | float = 0.0  # units of the shared unknowns

    @property
    def units(self) -> Reals:
        """One unit of each shared unknown: a parameter's, and the mount's."""
        return np.array([*map(unit_of, self.nominal), *_UNIT_MOUNT])

    @property
    def by_unknowns(self) -> Reals:
        """Derivatives of the shared parameters and of the mount by their unknowns: units, less what is held."""
        by, count = np.diag(self.units), len(self.nominal)
        if self.held is not None:
            by[:count, :count] -= by[:count, :count] @ self.held @ self.held.T
        return by

    def shared(self, unknowns: Reals) -> Reals:
        """Parameters and mount in SI units; ``unknowns`` are in units away from nominal."""
        at = np.array([*self.nominal, 0.0, 0.0, self.turned]) + self.units * self.off
        return at + self.by_unknowns @ unknowns[: len(at)]

    def own(self, unknowns: Reals, index: int) -> Reals:
        """Start x, y [m], heading [rad] and clock offset [s] of a drive."""
        first = len(self.nominal) + _MOUNT + _OWN * index
        return np.array([*self.drives[index].start[:3], 0.0]) + UNIT_OWN * unknowns[first : first + _OWN]


@dataclass(frozen=True, slots=True)
class Residuals:
    """Of one drive at n times: ``values`` (3, n) [m] of x, y and heading, and ``by`` (3, n, unknowns of the drive):
    shared ones, then its own, all in their units; ``weights`` (3, n), 0 of what was not measured; ``place`` (n,): where
    the tracked point is, as a complex number; ``heading`` (n,) [rad] of the robot."""

    values: Reals
    by: Reals
    weights: Reals
    place: Complexes
    heading: Reals


def residuals(problem: Problem, unknowns: Reals, index: int) -> Residuals:
    """Where a drive's path, laid at its start pose, differs from the truth, and the derivatives."""
    drive, increments = problem.drives[index], problem.increments
    shared, own = problem.shared(unknowns), problem.own(unknowns, index)
    count = len(problem.nominal)
    mount, mount_heading = complex(shared[count], shared[count + 1]), shared[count + 2]
    at = drive.truth.t + own[3]
    step, length, share = place_at(drive.t, at)
    steps = passed(increments, drive.columns, shared[:count], step)
    path, pace = steps.within(share), steps.pace(share)
    moving = (at >= drive.t[0] - BEYOND) & (at <= drive.t[-1] + BEYOND)
    start = np.exp(1j * own[2])
    turned = start * np.exp(1j * path.heading)
    reached = start * path.position + turned * mount  # from the start
    place_by = start * path.position_by + 1j * turned * mount * path.heading_by
    speed, turn = (poses / length * moving for poses in pace)
    ones, angle = np.ones_like(at), np.zeros((count + _MOUNT + _OWN, len(at)))
    place = angle.astype(complex)
    place[:count], angle[:count] = place_by, path.heading_by
    place[count], place[count + 1], angle[count + 2] = turned, 1j * turned, ones
    place[count + 3], place[count + 4], place[count + 5] = ones, 1j * ones, 1j * reached
    angle[count + 5] = ones
    place[count + 6], angle[count + 6] = start * speed + 1j * turned * mount * turn, turn
    for by in (place.view(float), angle):  # products of real and complex numbers take a hundred times as long
        by[:-_OWN], by[-_OWN:] = problem.by_unknowns.T @ by[:-_OWN], UNIT_OWN[:, None] * by[-_OWN:]
    off = complex(own[0], own[1]) + reached
    heading_error = path.heading + own[2] + mount_heading - drive.truth.theta
    values = np.array([off.real - drive.truth.x, off.imag - drive.truth.y, LEVER * heading_error])
    measured = np.isfinite(values)
    return Residuals(
        np.where(measured, values, 0.0), np.array([place.real.T, place.imag.T, LEVER * angle.T]),
        measured * _weights(drive.truth.t, problem.scale / drive.start_error), off, path.heading + own[2],
    )  # fmt: skip


def place_at(t: Reals, at: Reals) -> tuple[NDArray[np.intp], Reals, Reals]:
    """The step of ``t`` that each time ``at`` falls into, how long it is, and what share of it is over: up to `BEYOND`
    before the first and after the last time the robot is taken to go on as in the nearest step."""
    step = np.clip(np.searchsorted(t, at, "right") - 1, 0, len(t) - 2)
    length = t[step + 1] - t[step]
    return step, length, (np.clip(at, t[0] - BEYOND, t[-1] + BEYOND) - t[step]) / length


def _weights(times: Reals, first: float) -> Reals:
    """How much rows count: as they last, at most `_SPACING`; the first as the scale is ``first`` times its error."""
    weights = np.append(np.minimum(np.diff(times) / _SPACING, 1.0), 1.0)
    weights[0] = max(weights[0], first**2)
    return weights


def sums(problem: Problem, unknowns: Reals, index: int) -> Sums:
    """A drive's part."""
    paths = path_sums(problem, residuals(problem, unknowns, index))
    if problem.untold is None:
        return paths
    return paths + joint_sums(problem, *joint_residuals(problem, unknowns, index))


def path_sums(problem: Problem, rows: Residuals) -> Sums:
    """The part of a drive's residuals."""
    return robust(rows.values.reshape(-1) / problem.scale, rows.by / problem.scale, rows.weights.reshape(-1))


def joint_sums(problem: Problem, values: Reals, by: Reals) -> Sums:
    """The part of what a drive's joints disagree by, as `joint_residuals` has it."""
    z = values.reshape(-1) / problem.slides
    return robust(z, by / problem.slides, np.ones_like(z))


def joint_residuals(problem: Problem, unknowns: Reals, index: int) -> tuple[Reals, Reals]:
    """What R measured rows of a drive's joints are off by [m] in n spans of `_SPACING`, (R, n), and the derivatives by
    its unknowns (R, n, k), in their units: in directions of `untold` alone, so that nothing else follows from it."""
    drive, count = problem.drives[index], len(problem.nominal)
    assert problem.untold is not None
    directions, origin = problem.untold
    along, moved = directions @ directions.T, unknowns.copy()
    moved[:count] = origin + along @ (unknowns[:count] - origin)
    firsts = np.flatnonzero(np.diff(np.floor((drive.t[:-1] - drive.t[0]) / _SPACING), prepend=-1.0))
    rows = problem.increments.joint_residuals(drive.columns, problem.shared(moved)[:count], firsts)
    by = np.zeros((*rows.shape[1:], count + _MOUNT + _OWN))
    by[..., :count] = np.moveaxis(rows[1:], 0, -1) @ problem.by_unknowns[:count, :count] @ along
    return rows[0], by


class Each(Protocol):
    """What does a task for every drive of a problem."""

    def __call__(self, problem: Problem, unknowns: Reals, task: Task[Result]) -> Sequence[Result]: ...


def serial(problem: Problem, unknowns: Reals, task: Task[Result]) -> list[Result]:
    """The results of all drives, one after the other."""
    return [task(problem, unknowns, index) for index in range(len(problem.drives))]


def solved(problem: Problem, each: Each, unknowns: Reals, rounds: int = 3) -> tuple[Problem, Reals]:
    """The unknowns of the least robust cost, by scipy's dogleg method: from a scale at which the ``unknowns`` are good
    in every drive, in two steps to one that the residuals show; and the problem with that scale. The last two
    ``rounds`` do from unknowns on that are near."""
    for most in (np.inf, problem.scale, problem.scale)[-rounds:]:
        problem = replace(problem, drives=during(problem, unknowns))
        typical = float((np.median if most < np.inf else np.max)(each(problem, unknowns, _typical)))
        problem = replace(problem, scale=float(np.clip(1.5 * typical, FINEST, most)))
        unknowns = nearest(problem, unknowns, each)
    return problem, unknowns


def during(problem: Problem, unknowns: Reals) -> Sequence[Drive]:
    """The drives, where enough is left, without what the truth says of times more than a step before the first and
    after the last reading, by the clocks as they are known; where a robot stands then, it stays."""

    def inside(index: int, drive: Drive) -> list[Drive]:
        at = drive.truth.t + problem.own(unknowns, index)[3]
        first, last = 2 * drive.t[0] - drive.t[1], 2 * drive.t[-1] - drive.t[-2]
        seen = ((at >= first) | drive.stands(0)) & ((at <= last) | drive.stands(-1))
        return [drive.seen(seen) if _FEW <= seen.sum() < len(at) else drive]

    return changed(problem.drives, inside)


def _typical(problem: Problem, unknowns: Reals, index: int) -> float:
    rows = residuals(problem, unknowns, index)
    return _middle(np.abs(rows.values[rows.weights > 0]))


def _middle(sizes: Reals) -> float:
    """The median of a drive's residuals; of so few that its own unknowns take them up the root mean square."""
    if not len(sizes):
        return 0.0
    return float(np.median(sizes) if len(sizes) >= _FEW else np.sqrt(np.mean(sizes**2)))


def unit_of(nominal: float) -> float:
    """10 % of a parameter, 0.1 of one that is nominally 0: the prior's standard deviation."""
    return 0.1 * abs(nominal) or 0.1


def start_of(problem: Problem, before: Reals | None = None) -> Reals:
    """Drives from their first poses, by their clocks; parameters and tracked point as they were ``before``, or nominal
    ones and the robot's own."""
    count = len(problem.nominal) + _MOUNT
    shared = np.zeros(count) if before is None else before[:count]
    own = [[0.0, 0.0, 0.0, drive.start[3] / UNIT_OWN[3]] for drive in problem.drives]
    return np.concatenate([shared, np.ravel(own)])


def later(problem: Problem, unknowns: Reals, index: int, seconds: float) -> Reals:
    """The unknowns with the clock of a drive's truth off by so many seconds more."""
    clock = np.arange(len(unknowns)) == own_columns(problem, index)[-1]
    return np.asarray(unknowns + clock * seconds / UNIT_OWN[-1])


def prior_of_shared(problem: Problem) -> Reals:
    """The matrix of the weak prior of the shared unknowns."""
    return np.eye(len(problem.units)) * _PRIOR**2


def prior_of_own(problem: Problem) -> Reals:
    """The same of those of a drive."""
    return np.diag(_PRIOR_OWN**2 + np.array([0.0, 0.0, 0.0, problem.clocks.weight]))


def arrow(problem: Problem, parts: Sequence[Sums]) -> Arrow:
    """The matrix that drives and priors make."""
    return Arrow.of([part.matrix for part in parts], prior_of_shared(problem), prior_of_own(problem))


def information(problem: Problem, parts: Sequence[Sums]) -> Reals:
    """What the drives tell of the shared unknowns, their own ones eliminated."""
    return arrow(problem, parts).reduced - prior_of_shared(problem)


def own_columns(problem: Problem, index: int) -> NDArray[np.intp]:
    """Where a drive's unknowns, shared ones and its own, stand among all."""
    shared = len(problem.nominal) + _MOUNT
    return np.concatenate([np.arange(shared), shared + _OWN * index + np.arange(_OWN)])


def nearest(problem: Problem, start: Reals, each: Each) -> Reals:
    """The unknowns of least cost from ``start`` on, at the problem's scale, but for the roughness of the readings. The
    matrix is positive definite, as the dogleg method needs: what squares of derivatives add up to, and the prior."""
    shared, late = len(problem.units), np.array([0.0, 0.0, 0.0, problem.clocks.late])
    of_shared, of_own = prior_of_shared(problem), prior_of_own(problem)

    def slope(unknowns: Reals) -> Slope:
        parts = each(problem, unknowns, sums)
        off, own = unknowns[:shared], unknowns[shared:].reshape(-1, _OWN) - late
        back, back_own = of_shared @ off, own @ of_own
        gradients = np.array([part.gradient for part in parts])
        cost = sum(part.cost for part in parts) + 0.5 * float(back @ off + np.sum(back_own * own))
        first, rest = gradients[:, :shared].sum(axis=0) + back, gradients[:, shared:] + back_own
        return Slope(cost, np.concatenate([first, rest.ravel()]), arrow(problem, parts))

    return least(slope, start, _NEAR, _MOST_STEPS)
