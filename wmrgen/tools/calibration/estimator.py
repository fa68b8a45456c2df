"""The estimator: robust least squares over whole logs, with every log eliminated by itself.

The parameters and the mount are the border of the normal equations. The rest is block diagonal: clock and start poses
of a log do not couple with any other log. So each log is reduced to a matrix over the border, and the sum over logs
is solved.

Whole paths are compared, and not steps of them: over a second a reference is mostly noise, and clocks are uncertain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wmrgen.tools.calibration.model import Problem, Rows, State, rows
from wmrgen.tools.calibration.path import Reals

PRIOR = 0.1  # residuals, in units of the scale, that one unit (10 % of a parameter) away from nominal costs
# [m] the least scale: below any reference, and far enough from rounding errors of the covariance
FINEST = 5e-4
_STEPS = 60  # at most; ten are usual
_NEAR = 1e-2  # residuals in units of the scale: a smaller change of the cost than its square is negligible
_DAMP = 1e-3  # of the diagonal: the first damping after a step that failed (Marquardt 1963)
_LEAST = 1e-9  # of a start of a leg: far below what one pose says
MEDIAN = 1.5  # times the median residual: the standard deviation of a normal distribution


@dataclass(frozen=True, slots=True)
class Normal:
    """One log's part of the normal equations, over the S shared unknowns and its clock, and its L starts of legs."""

    cost: float
    gradient: Reals  # (S + 1,)
    matrix: Reals  # (S + 1, S + 1)
    start_gradients: Reals  # (L, 3)
    starts: Reals  # (L, 3, 3)
    couplings: Reals  # (L, S + 1, 3)


@dataclass(frozen=True, slots=True)
class Reduced:
    """A log's normal equations without its starts of legs."""

    matrix: Reals  # (S + 1, S + 1)
    gradient: Reals  # (S + 1,)
    follow: Reals  # (L, 3, S + 1) how the starts follow the other unknowns
    alone: Reals  # (L, 3) how they change if the others do not

    @property
    def clock_follows(self) -> Reals:
        """How the clock follows the shared unknowns, (S,)."""
        return np.asarray(self.matrix[:-1, -1] / self.matrix[-1, -1])

    @property
    def shared(self) -> tuple[Reals, Reals]:
        """Matrix (S, S) and gradient (S,) without the clock."""
        column, follows = self.matrix[:-1, -1], self.clock_follows
        matrix = self.matrix[:-1, :-1] - np.outer(column, follows)
        return matrix, self.gradient[:-1] - follows * self.gradient[-1]

    def back(self, shared: Reals) -> Reals:
        """Return the change of the log's own unknowns (1 + 3 L,) for a change of the shared ones."""
        clock = -self.gradient[-1] / self.matrix[-1, -1] - self.clock_follows @ shared
        starts = -self.alone - self.follow @ np.append(shared, clock)
        return np.concatenate([[clock], starts.ravel()])


@dataclass(frozen=True, slots=True)
class Fit:
    """A solution."""

    problem: Problem
    state: State
    rows: tuple[Rows, ...]
    normals: tuple[Normal, ...]
    cost: float

    @property
    def residuals(self) -> Reals:
        """All residuals that were measured [m], x, y and headings as arcs at the lever."""
        return np.concatenate([one.values[one.weights > 0] for one in self.rows])


def loss(one: Rows, scale: float) -> tuple[float, Reals, Reals]:
    """Return the soft L1 loss of residuals, sqrt(1 + (r / scale)^2) - 1, and its derivatives.

    The distance of a place counts, and not x and y apart: else results would depend on the axes of the reference.

    Args:
        one: Residuals of a log.
        scale: [m] where the loss turns from squares to sizes.

    Returns:
        The loss; its derivative by each residual (3, n); and how the gradient changes by an error of each residual,
        (3, n, S + 4), which times the derivatives of the residuals is the second derivative of the loss.
    """
    squares = (one.values / scale) ** 2
    place, heading = np.sqrt(1 + squares[0] + squares[1]), np.sqrt(1 + squares[2])
    root = np.array([place, place, heading])
    # The weights of x and y differ where one coordinate alone was measured.
    weights = np.maximum(one.weights[0], one.weights[1])
    cost = float(weights @ (place - 1) + one.weights[2] @ (heading - 1))
    slope = one.weights / root / scale**2
    x, y, theta = one.values[..., None] * one.by
    along = np.array([x + y, x + y, theta])
    bend = slope * one.values / (root * scale) ** 2
    return cost, slope * one.values, slope[..., None] * one.by - bend[..., None] * along


def normal(problem: Problem, own: Reals, one: Rows) -> Normal:
    """Return a log's part of the normal equations, with the prior of its clock.

    Args:
        problem: For the scale and the prior.
        own: The log's own unknowns.
        one: Its residuals.
    """
    width, legs = len(problem.origin) + 1, len(own) // 3
    cost, slope, change = loss(one, problem.scale)
    matrix, gradient = np.zeros((legs, width + 3, width + 3)), np.zeros((legs, width + 3))
    ends = np.searchsorted(one.leg, np.arange(legs + 1))
    for k in range(legs):
        rows = slice(ends[k], ends[k + 1])
        by = one.by[:, rows]
        # einsum and not a product of matrices: threads of BLAS wait for one another where others use the cores.
        matrix[k] = np.einsum("cni,cnj->ij", change[:, rows], by)
        gradient[k] = np.einsum("cni,cn->i", by, slope[:, rows])
    shared, total = matrix[:, :width, :width].sum(axis=0), gradient[:, :width].sum(axis=0)
    if len(one.joints):
        count, root = one.joints_by.shape[1], np.sqrt(1 + (one.joints / problem.scale) ** 2)
        weighted = one.joints_by / root[:, None] / problem.scale**2
        shared[:count, :count] += np.einsum("ni,nj->ij", weighted / root[:, None] ** 2, one.joints_by)
        total[:count] += np.einsum("ni,n->i", weighted, one.joints)
        cost += float(np.sum(root - 1))
    weight = problem.clock_spread**-2  # a whole standard deviation: else clocks of straight drives run away
    shared[-1, -1] += weight
    total[-1] += weight * own[0]
    # A leg without a reference pose, and a quantity that is never measured, keep their start.
    starts = matrix[:, width:, width:] + _LEAST * np.eye(3)
    couplings = matrix[:, :width, width:]
    return Normal(cost + 0.5 * weight * own[0] ** 2, total, shared, gradient[:, width:], starts, couplings)


def reduced(one: Normal, damping: float = 0.0) -> Reduced:
    """Return a log's normal equations, damped, without its starts of legs."""
    matrix = one.matrix + damping * np.diag(np.diag(one.matrix))
    starts = one.starts * (1 + damping * np.eye(3))
    right = np.concatenate([one.couplings.transpose(0, 2, 1), one.start_gradients[..., None]], axis=2)
    solved = np.linalg.solve(starts, right)
    follow, alone = solved[..., :-1], solved[..., -1]
    matrix = matrix - np.einsum("kij,kjl->il", one.couplings, follow)
    gradient = one.gradient - np.einsum("kij,kj->i", one.couplings, alone)
    return Reduced(matrix, gradient, follow, alone)


def evaluated(problem: Problem, state: State) -> Fit:
    """Return the cost and the normal equations at a state."""
    every = tuple(rows(problem, i, state.shared, own) for i, own in enumerate(state.own))
    normals = tuple(normal(problem, own, one) for own, one in zip(state.own, every, strict=True))
    off = (state.shared - problem.origin) / problem.units
    return Fit(
        problem, state, every, normals, sum(n.cost for n in normals) + 0.5 * PRIOR**2 * float(off @ off)
    )


def _step(fit: Fit, damping: float) -> tuple[State, float]:
    """Return the state after one damped Newton step, and by how much it should lower the cost."""
    problem, free = fit.problem, fit.problem.free
    off = (fit.state.shared - problem.origin) / problem.units
    matrix, gradient = PRIOR**2 * np.eye(len(off)), PRIOR**2 * off
    logs = [reduced(one, damping) for one in fit.normals]
    for log in logs:
        of_log = log.shared
        matrix, gradient = matrix + of_log[0], gradient + of_log[1]
    shared = -free @ np.linalg.solve(free.T @ matrix @ free, free.T @ gradient)
    gain, own = -0.5 * float(shared @ (PRIOR**2 * off)), []
    for log, one, before in zip(logs, fit.normals, fit.state.own, strict=True):
        change = log.back(shared)
        own.append(before + change)
        gain -= 0.5 * float(
            one.gradient @ np.append(shared, change[0]) + one.start_gradients.ravel() @ change[1:]
        )
    return State(fit.state.shared + problem.units * shared, tuple(own)), gain


def minimised(problem: Problem, state: State) -> Fit:
    """Return the fit of least cost near a state, at the problem's scale (Levenberg-Marquardt)."""
    now, damping = evaluated(problem, state), 0.0
    for _ in range(_STEPS):
        new, gain = _step(now, damping)
        if gain < _NEAR**2:
            break
        after = evaluated(problem, new)
        if after.cost <= now.cost:
            now, damping = after, damping / 10 if damping > _DAMP else 0.0
        else:
            damping = max(10 * damping, _DAMP)
            if damping > 1 / _DAMP:
                break
    return now


def solved(problem: Problem, state: State) -> Fit:
    """Return the fit at the scale that its residuals show.

    It begins with a scale at which all residuals count by their squares, so that the start may be far off, and goes on
    with the scale of typical residuals.
    """
    return rescaled(rescaled(near(problem, state)))


def near(problem: Problem, state: State) -> Fit:
    """Return the fit at a scale at which all residuals of the state count by their squares."""
    widest = float(np.abs(evaluated(problem, state).residuals).max(initial=FINEST))
    return minimised(replace(problem, scale=widest), state)


def rescaled(fit: Fit) -> Fit:
    """Return the fit at the scale of its own residuals."""
    return minimised(replace(fit.problem, scale=typical(fit)), fit.state)


def typical(fit: Fit) -> float:
    """Return the standard deviation of typical residuals [m], from their median."""
    sizes = []
    for one in fit.rows:
        measured = one.weights > 0
        coordinates = measured[0].astype(float) + measured[1]
        place = np.hypot(one.values[0], one.values[1])[coordinates > 0]
        sizes += [place / np.sqrt(coordinates[coordinates > 0]), np.abs(one.values[2][measured[2]])]
    every = np.concatenate(sizes)
    return max(MEDIAN * float(np.median(every)), FINEST) if len(every) else fit.problem.scale
