"""The estimator: robust least squares over whole logs, with every log eliminated by itself.

The parameters and the mount are the border of the normal equations. The rest is block diagonal: clock and start poses
of a log meet those of no other. So each log is reduced to a matrix over the border, and the sum over logs is solved.

Whole paths are compared, and not steps of them: over a second a reference is mostly noise, and clocks are uncertain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wmrgen.tools.calibration.model import Problem, Rows, State, rows
from wmrgen.tools.calibration.path import Reals

PRIOR = 0.1  # residuals, in units of the scale, that one unit (10 % of a parameter) away from nominal costs
FINEST = 1e-4  # [m] the least scale: a tenth of a millimetre is below any reference
_STEPS = 60  # at most; ten are usual
_NEAR = 1e-3  # residuals in units of the scale: a step that changes the cost by its square changes nothing
_DAMP = 1e-3  # of the diagonal: the first damping after a step that failed (Marquardt 1963)
_TYPICAL = 1.5  # times the median residual: the standard deviation of a normal distribution


@dataclass(frozen=True, slots=True)
class Normal:
    """One log's part of the normal equations, over the shared unknowns (S) and its own."""

    cost: float
    gradient: Reals
    matrix: Reals


@dataclass(frozen=True, slots=True)
class Fit:
    """A solution."""

    problem: Problem
    state: State
    rows: tuple[Rows, ...]
    normals: tuple[Normal, ...]
    cost: float


def robust(residuals: Reals, by: Reals, weights: Reals, scale: float) -> Normal:
    """Return the soft L1 cost of residuals, its gradient and its matrix.

    Args:
        residuals: (n,) [m].
        by: (n, k) their derivatives.
        weights: (n,) of the residuals.
        scale: [m] where the loss turns from squares to sizes.
    """
    root = np.sqrt(1 + (residuals / scale) ** 2)
    effective = weights / root / scale**2
    weighted = effective[:, None] * by
    # einsum and not a product of matrices: threads of BLAS wait for one another where other processes use the cores.
    matrix = np.einsum("ni,nj->ij", weighted, by)
    return Normal(float(weights @ (root - 1)), np.einsum("ni,n->i", weighted, residuals), matrix)


def normal(problem: Problem, shared: Reals, own: Reals, one: Rows) -> Normal:
    """Return a log's part of the normal equations, with the prior of its clock."""
    width = len(shared)
    poses = robust(
        one.values.ravel(), one.by.reshape(-1, width + len(own)), one.weights.ravel(), problem.scale
    )
    matrix, gradient, cost = poses.matrix.copy(), poses.gradient.copy(), poses.cost
    if len(one.joints):
        count = one.joints_by.shape[1]
        joints = robust(one.joints, one.joints_by, np.ones(len(one.joints)), problem.scale)
        matrix[:count, :count] += joints.matrix
        gradient[:count] += joints.gradient
        cost += joints.cost
    weight = problem.clock_spread**-2  # a whole standard deviation: else clocks of straight drives run away
    matrix[width, width] += weight
    gradient[width] += weight * own[0]
    # A leg without a reference pose, and a quantity that is never measured, keep their start.
    matrix[np.diag_indices(len(matrix))] += 1e-9
    return Normal(cost + 0.5 * weight * own[0] ** 2, gradient, matrix)


def evaluated(problem: Problem, state: State) -> Fit:
    """Return the cost and the normal equations at a state."""
    every = tuple(rows(problem, i, state.shared, own) for i, own in enumerate(state.own))
    normals = tuple(
        normal(problem, state.shared, own, one) for own, one in zip(state.own, every, strict=True)
    )
    off = (state.shared - problem.origin) / problem.units
    return Fit(
        problem, state, every, normals, sum(n.cost for n in normals) + 0.5 * PRIOR**2 * float(off @ off)
    )


def reduced(problem: Problem, normals: Sequence[Normal], damping: float = 0.0) -> tuple[Reals, Reals]:
    """Return matrix (S, S) and gradient (S,) of the shared unknowns, all others eliminated, without the prior."""
    width = len(problem.origin)
    matrix, gradient = np.zeros((width, width)), np.zeros(width)
    for one in normals:
        damped = one.matrix + damping * np.diag(np.diag(one.matrix))
        coupling = damped[:width, width:]
        solved = np.linalg.solve(damped[width:, width:], np.column_stack([coupling.T, one.gradient[width:]]))
        matrix += damped[:width, :width] - coupling @ solved[:, :-1]
        gradient += one.gradient[:width] - coupling @ solved[:, -1]
    return matrix, gradient


def _step(fit: Fit, damping: float) -> tuple[State, float]:
    """Return the state after one damped Gauss-Newton step, and by how much it should lower the cost."""
    problem, free = fit.problem, fit.problem.free
    width = len(problem.origin)
    off = (fit.state.shared - problem.origin) / problem.units
    matrix, gradient = reduced(problem, fit.normals, damping)
    within = free.T @ (matrix + PRIOR**2 * np.eye(width)) @ free
    along = -np.linalg.solve(within, free.T @ (gradient + PRIOR**2 * off))
    shared = free @ along
    own, gain = [], -0.5 * float(shared @ (PRIOR**2 * off))
    for one, before in zip(fit.normals, fit.state.own, strict=True):
        damped = one.matrix + damping * np.diag(np.diag(one.matrix))
        change = -np.linalg.solve(
            damped[width:, width:], one.gradient[width:] + damped[width:, :width] @ shared
        )
        own.append(before + change)
        gain -= 0.5 * float(one.gradient[:width] @ shared + one.gradient[width:] @ change)
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
    first = evaluated(problem, state)
    sizes = [np.abs(one.values[one.weights > 0]) for one in first.rows]
    widest = float(np.concatenate(sizes).max(initial=FINEST))
    fit = minimised(replace(problem, scale=widest), state)
    for _ in range(2):
        fit = minimised(replace(problem, scale=typical(fit)), fit.state)
    return fit


def typical(fit: Fit) -> float:
    """Return the standard deviation of typical residuals [m], from their median."""
    sizes = np.concatenate([np.abs(one.values[one.weights > 0]) for one in fit.rows])
    return max(_TYPICAL * float(np.median(sizes)), FINEST) if len(sizes) else fit.problem.scale
