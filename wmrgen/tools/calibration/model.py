"""The measurement model: predicted reference poses and redundant joint readings of a log, and the residuals.

Unknowns. All logs share the parameters and the mount, which is the place and the heading of the tracked point on the
robot. Each log has a clock offset, and each of its legs a start pose. A leg is a stretch without a slip: where wheels
slip, the path before and behind keeps its shape, and a new leg begins. Shared unknowns are counted in units away from
nominal: 10 % of a parameter, 0.1 m and 0.1 rad of the mount.

Residuals are metres. A heading error is the arc that it makes at `LEVER`. The loss is soft L1 (Huber's in smooth
form), so a few large residuals count by their size and not by their square.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from wmrgen.tools.calibration.logs import Booleans, Log, Poses, steps_at
from wmrgen.tools.calibration.path import Complexes, Increments, Indices, Path, Reals

LEVER = 0.15  # [m] a heading's residual is this times its error: about the half track of small robots
MOUNT = 3  # unknowns of the mount: x [m], y [m], heading [rad]
UNIT_MOUNT = (0.1, 0.1, 0.1)  # [m, m, rad] how far a tracker is about from the robot's point
UNIT_CLOCK = 0.3  # [s] how far the clocks of two computers are about apart
PACE = 1.0  # [s] to both sides, over which a speed is taken: over one step it is the rounding of encoders
WEIGHT = 1.0  # [s] reference poses that follow one another faster count no more than one in this time
SPAN = 4  # thinned steps, about 1 s, over which the disagreement of redundant joints is added up


@dataclass(frozen=True, slots=True)
class Problem:
    """What is estimated from which logs."""

    increments: Increments
    nominal: Reals  # (P,)
    logs: tuple[Log, ...]
    legs: tuple[Reals, ...]  # (L, 2) of each log: first and last time [s] of each leg
    mount: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m, m, rad] of the tracked body, before any log
    # [m] standard deviation of each log's first reference pose from where the robot started.
    start_error: float = np.inf
    scale: float = 0.01  # [m] residuals far above it count by their size
    # (S, k) directions of the shared unknowns that are estimated.
    free: Reals = field(default_factory=lambda: np.zeros((0, 0)))
    clocks: tuple[bool, ...] = ()  # whether the clock of each log is estimated
    clock_spread: float = UNIT_CLOCK  # [s] standard deviation of clock offsets before any log

    @property
    def units(self) -> Reals:
        """One unit of each of the S shared unknowns."""
        return np.array([*map(unit_of, self.nominal), *UNIT_MOUNT])

    @property
    def origin(self) -> Reals:
        """The shared unknowns before any log."""
        return np.array([*self.nominal, *self.mount])


@dataclass(frozen=True, slots=True)
class State:
    """Values of all unknowns."""

    shared: Reals  # (S,) in SI units: parameters, mount
    # Of each log: its clock offset [s], and x, y [m], heading [rad] at the start of each leg.
    own: tuple[Reals, ...]


@dataclass(frozen=True, slots=True)
class Rows:
    """The residuals of one log at its n reference poses that lie in a leg."""

    values: Reals  # (3, n) [m] x, y and heading
    by: Reals  # (3, n, S + 4) derivatives by the shared unknowns, in units, the clock, and the start of its leg
    weights: Reals  # (3, n), 0 if not measured
    known: Booleans  # (n,) whether a pose is the log's first one and `start_error` is given
    place: Complexes  # (n,) [m] of the tracked point
    heading: Reals  # (n,) [rad] of the robot
    leg: Indices  # (n,)
    at: Reals  # (n,) [s] on the log's clock
    joints: Reals  # (m,) [m] what redundant joints are off by
    joints_by: Reals  # (m, P)


def unit_of(nominal: float) -> float:
    """Return 10 % of a parameter, or 0.1 of one that is nominally 0."""
    return 0.1 * abs(nominal) or 0.1


def rows(problem: Problem, index: int, shared: Reals, own: Reals) -> Rows:
    """Return the residuals of a log, with derivatives.

    Args:
        problem: What is estimated.
        index: The log's number.
        shared: (S,) parameters and mount.
        own: The log's clock offset and the starts of its legs.
    """
    log, legs, count, width = problem.logs[index], problem.legs[index], len(problem.nominal), len(shared)
    poses, leg = _in_legs(log, legs, own[0])
    at = poses.t + own[0]
    path = problem.increments.path(log.columns, shared[:count])
    here = path.between(*steps_at(log.t, at))
    base = path.between(*steps_at(log.t, np.clip(legs[:, 0], log.t[0], log.t[-1]))).at(leg)
    start = own[1:].reshape(-1, 3)[leg]

    # In the path's own frame the tracked point goes from `base` to here + arm. `frame` turns this into the world.
    arm = np.exp(1j * here.heading) * complex(shared[count], shared[count + 1])
    frame = np.exp(1j * (start[:, 2] - base.heading))
    reached = frame * (here.position + arm - base.position)
    place = start[:, 0] + 1j * start[:, 1] + reached
    heading = start[:, 2] + here.heading - base.heading

    place_by = np.zeros((width + 4, len(at)), complex)
    heading_by = np.zeros((width + 4, len(at)))
    moved_by = here.position_by + 1j * arm * here.heading_by - base.position_by
    place_by[:count] = frame * moved_by - 1j * reached * base.heading_by
    heading_by[:count] = here.heading_by - base.heading_by
    place_by[count] = np.exp(1j * heading)
    place_by[count + 1] = 1j * place_by[count]
    heading_by[count + 2] = 1.0
    place_by[:width] *= problem.units[:, None]
    heading_by[:width] *= problem.units[:, None]
    if problem.clocks[index]:
        speed, rate = _pace(path, log.t, at)
        place_by[width], heading_by[width] = frame * (speed + 1j * arm * rate), rate
    place_by[width + 1], place_by[width + 2] = 1.0, 1j
    place_by[width + 3], heading_by[width + 3] = 1j * reached, 1.0

    heading_error = heading + shared[count + 2] - poses.theta
    values = np.array([place.real - poses.x, place.imag - poses.y, LEVER * heading_error])
    by = np.array([place_by.real.T, place_by.imag.T, LEVER * heading_by.T])
    measured = np.isfinite(values)
    lasts = np.minimum(np.diff(poses.t, append=poses.t[-1:] + WEIGHT) / WEIGHT, 1.0)
    known = (poses.t == log.poses.t[0]) & (problem.start_error < np.inf)
    lasts[known] = (problem.scale / problem.start_error) ** 2
    joints, joints_by = _joint_rows(problem, log, legs, shared[:count])
    return Rows(
        np.where(measured, values, 0.0), by, measured * lasts, known, place, heading, leg, at, joints,
        joints_by,
    )  # fmt: skip


def _in_legs(log: Log, legs: Reals, clock: float) -> tuple[Poses, Indices]:
    """Return the reference poses that lie in a leg, and the leg of each."""
    leg = np.searchsorted(legs[:, 0], log.poses.t, "right") - 1
    inside = (leg >= 0) & (log.poses.t <= legs[np.maximum(leg, 0), 1]) & log.inside(clock)
    return log.poses.rows(inside), leg[inside]


def _pace(path: Path, t: Reals, at: Reals) -> tuple[Complexes, Reals]:
    """Return velocity [m/s] and yaw rate [rad/s] at times ``at``, over `PACE` to both sides inside the log."""
    inside = np.clip(at, t[0] + 0.5 * PACE, t[-1] - 0.5 * PACE)
    early, late = np.clip(inside - PACE, t[0], t[-1]), np.clip(inside + PACE, t[0], t[-1])
    earlier, later = path.between(*steps_at(t, early)), path.between(*steps_at(t, late))
    lasts = late - early
    return (later.position - earlier.position) / lasts, (later.heading - earlier.heading) / lasts


def _joint_rows(problem: Problem, log: Log, legs: Reals, values: Reals) -> tuple[Reals, Reals]:
    """Return what redundant joints are off by in spans of `SPAN` steps inside of legs, and the derivatives."""
    count = len(values)
    if problem.increments.rows is None:
        return np.zeros(0), np.zeros((0, count))
    middle = 0.5 * (log.t[1:] + log.t[:-1])
    leg = np.searchsorted(legs[:, 0], middle, "right") - 1
    inside = (leg >= 0) & (middle <= legs[np.maximum(leg, 0), 1])
    off = problem.increments.disagreement(log.columns, values) * inside
    spans = np.add.reduceat(off, np.arange(0, off.shape[2], SPAN), axis=2)
    return spans[0].ravel(), (spans[1:] * problem.units[:count, None, None]).reshape(count, -1).T
