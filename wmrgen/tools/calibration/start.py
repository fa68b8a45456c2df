"""The state before the first step, in closed form from nominal odometry.

Headings of the reference count whole turns. Where two of them are so far apart in time that odometry may be half a turn
off, the number of turns is an unknown, see `turns`.
"""

from __future__ import annotations

import numpy as np

from wmrgen.tools.calibration.logs import Log, steps_at
from wmrgen.tools.calibration.model import Problem, State
from wmrgen.tools.calibration.path import Complexes, Reals

LEG = 200.0  # [s] of a leg at most: later poses say ever less of the parameters, because errors of odometry add up
APART = 2.0  # [s] between reference poses whose displacement is compared with odometry
_SURE = 0.05  # [m] of displacements in all, below which they are the noise of a robot on the spot
_COHERENT = 0.5  # of the displacements' length must agree on one angle, before the tracked body is assumed to be turned


def whole(log: Log, seconds: float = LEG) -> Reals:
    """Return legs (L, 2) [s] of a log, of equal length and at most ``seconds`` long."""
    t = log.poses.t
    count = max(1, int(np.ceil((t[-1] - t[0]) / seconds - 1e-6)))
    count = min(count, max(1, log.poses.measured // 4))
    edges = np.linspace(t[0], t[-1], count + 1)
    edges[-1] += 1e-6
    ends = np.append(edges[1:-1] - 1e-6, edges[-1])
    return np.column_stack([edges[:-1], ends])


def turned(problem: Problem, values: Reals) -> float:
    """Return roughly how far the tracked body is turned on the robot [rad]; 0 if displacements do not agree.

    Over a short distance, the displacement of the tracked point seen from its body differs by this angle from the
    displacement of odometry seen from the robot, however much odometry has drifted before.
    """
    total, length = 0j, _SURE**2
    for log in problem.logs:
        path = problem.increments.alone.path(log.columns, values)
        here = path.between(*steps_at(log.t, log.poses.t))
        place, heading = here.position, here.heading
        seen = log.poses.x + 1j * log.poses.y
        complete = np.flatnonzero(log.poses.complete)
        ends = np.searchsorted(log.poses.t[complete], log.poses.t[complete] + APART)
        starts, ends = complete[ends < len(complete)], complete[ends[ends < len(complete)]]
        own = (place[ends] - place[starts]) * np.exp(-0.5j * (heading[ends] + heading[starts]))
        half = 0.5 * (log.poses.theta[ends] + log.poses.theta[starts])
        products = np.conj(own) * (seen[ends] - seen[starts]) * np.exp(-1j * half)
        total += complex(products.sum())
        length += float(np.abs(products).sum())
    return -float(np.angle(total)) if abs(total) > _COHERENT * length else 0.0


def begun(problem: Problem, shared: Reals, clocks: Reals) -> State:
    """Return the state with each leg laid on its reference poses.

    Args:
        problem: Logs and legs.
        shared: (S,) parameters and mount.
        clocks: [s] offset of each log.
    """
    own, count = [], len(problem.nominal)
    mount = complex(shared[count], shared[count + 1])
    for log, legs, clock in zip(problem.logs, problem.legs, clocks, strict=True):
        path = problem.increments.alone.path(log.columns, shared[:count])
        starts = path.between(*steps_at(log.t, np.clip(legs[:, 0], log.t[0], log.t[-1])))
        here = path.between(*steps_at(log.t, log.poses.t + clock))
        result = [clock]
        for k, (first, last) in enumerate(legs):
            inside = (log.poses.t >= first) & (log.poses.t <= last)
            poses, at = log.poses.rows(inside), here.at(inside)
            point = at.position + np.exp(1j * at.heading) * mount
            result += _laid(
                poses.x + 1j * poses.y, poses.theta - shared[count + 2], point, at.heading,
                complex(starts.position[k]), float(starts.heading[k]),
            )  # fmt: skip
        own.append(np.array(result))
    return State(shared, tuple(own))


def _laid(
    seen: Complexes, theta: Reals, point: Complexes, heading: Reals, first: complex, first_heading: float
) -> tuple[float, float, float]:
    """Return x, y and heading at the start of a leg, so that its path lies on the reference poses.

    Args:
        seen: (K,) [m] measured places, nan where one coordinate is missing.
        theta: (K,) [rad] measured headings of the robot.
        point: (K,) [m] the tracked point in the path's frame.
        heading: (K,) [rad] the path's headings.
        first: [m] where the leg starts in the path's frame.
        first_heading: [rad] the path's heading there.
    """
    placed, headed = np.isfinite(seen.real) & np.isfinite(seen.imag), np.isfinite(theta)
    turn = 0.0
    if headed.any():
        turn = float(np.median((theta - heading)[headed]))
    elif placed.sum() > 1:  # Procrustes: the rotation that lays one set of points on another
        a, b = point[placed], seen[placed]
        turn = float(np.angle(np.sum(np.conj(a - a.mean()) * (b - b.mean()))))
    moved = np.exp(1j * turn) * point
    x = np.nanmean(seen.real - moved.real) if np.isfinite(seen.real).any() else 0.0
    y = np.nanmean(seen.imag - moved.imag) if np.isfinite(seen.imag).any() else 0.0
    start = np.exp(1j * turn) * first + complex(x, y)
    return start.real, start.imag, first_heading + turn
