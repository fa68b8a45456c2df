"""Fits of many drives: what each has of its own is eliminated, and nothing else changes."""

from __future__ import annotations

import tracemalloc
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from wmrgen.tools.calibrating.arrow import Sums
from wmrgen.tools.calibrating.certainty import _spread
from wmrgen.tools.calibrating.clocks import Clocks
from wmrgen.tools.calibrating.fit import arrow, nearest, prior_of_own, prior_of_shared
from wmrgen.tools.calibrating.observability import deviations

SHARED, OWN, ROWS = 5, 4, 30
CLOCKS = Clocks(late=0.3, error=0.2, apart=0.4, counted=7.0)


def _problem() -> Any:
    return SimpleNamespace(units=np.ones(SHARED), clocks=CLOCKS)


def _columns(index: int) -> np.ndarray:
    """Where the unknowns of a drive stand among all."""
    return np.array([*range(SHARED), *range(SHARED + OWN * index, SHARED + OWN * (index + 1))])


def _dense(problem: Any, parts: Sequence[np.ndarray], prior: bool = True) -> np.ndarray:
    """The matrix of all unknowns, with their prior or without it, entry by entry."""
    matrix = np.zeros((SHARED + OWN * len(parts),) * 2)
    matrix[:SHARED, :SHARED] = prior * prior_of_shared(problem)
    for index, part in enumerate(parts):
        columns = _columns(index)
        matrix[np.ix_(columns, columns)] += part
        matrix[np.ix_(columns[SHARED:], columns[SHARED:])] += prior * prior_of_own(problem)
    return matrix


def _drives(count: int) -> Any:
    """What drives add whose residuals by ten units are bent, as paths are by headings, with the loss of a fit."""
    random = np.random.default_rng(11)
    by, rest = random.normal(size=(count, ROWS, SHARED + OWN)), random.normal(size=(count, ROWS))
    far = random.normal(size=SHARED + OWN)

    def each(problem: Any, unknowns: np.ndarray, task: Any) -> list[Sums]:
        result = []
        for index in range(count):
            way = 3 * by[index] @ (unknowns[_columns(index)] - far)
            z, slopes = rest[index] + way + np.sin(way), 3 * (1 + np.cos(way))[:, None] * by[index]
            root = np.sqrt(1 + z * z)
            result.append(Sums(float(np.sum(root - 1)), slopes.T @ (z / root), (slopes.T / root**3) @ slopes))
        return result

    return each


def test_the_fit_of_drives_is_that_of_all_unknowns_at_once() -> None:
    """By scipy's dogleg method on the whole matrix: the same steps, from far away on."""
    problem, count = _problem(), 6
    each, seen = _drives(count), list[np.ndarray]()
    start, likely = np.zeros((2, SHARED + OWN * count))
    likely[SHARED + OWN - 1 :: OWN] = CLOCKS.late
    weak = _dense(problem, [np.zeros((SHARED + OWN,) * 2)] * count)

    def part(x: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        parts = each(problem, x, None)
        gradient = weak @ (x - likely)
        cost = 0.5 * gradient @ (x - likely) + sum(p.cost for p in parts)
        for index, p in enumerate(parts):
            gradient[_columns(index)] += p.gradient
        return cost, gradient, _dense(problem, [p.matrix for p in parts])

    def halt(x: np.ndarray) -> None:
        _, gradient, matrix = part(x)
        if x.any() and gradient @ np.linalg.solve(matrix, gradient) < 0.03**2:
            raise StopIteration

    whole = minimize(
        lambda x: part(x)[0], start, jac=lambda x: part(x)[1], hess=lambda x: part(x)[2], method="dogleg",
        callback=halt, options={"gtol": 1e-6, "maxiter": 40},
    )  # fmt: skip

    def counted(problem: Any, unknowns: np.ndarray, task: Any) -> Any:
        seen.append(unknowns)
        return each(problem, unknowns, task)

    assert nearest(problem, start, counted) == pytest.approx(whole.x, abs=1e-9)
    assert len(seen) == whole.nfev > 5


@pytest.mark.parametrize("slope", [1.0, 2.0])
def test_the_solver_halts_where_the_cost_is_rough(slope: float) -> None:
    """In each drive's clock by edges of little height, at which the gradient changes its sign, so that Newton's step
    stays as long: steps that gain nothing are not tried until there may be no more, 12 evaluations do and not 37."""
    problem, count, seen = _problem(), 6, list[np.ndarray]()
    smooth, wide = _drives(count), 1e-3
    clocks = SHARED + OWN * np.arange(count) + OWN - 1

    def each(problem: Any, unknowns: np.ndarray, task: Any) -> list[Sums]:
        seen.append(unknowns)
        result = []
        for part, clock in zip(smooth(problem, unknowns, task), clocks, strict=True):
            over = unknowns[clock] / wide % 1.0
            part.gradient[-1] += slope if over < 0.5 else -slope
            result.append(replace(part, cost=part.cost + slope * wide * min(over, 1 - over)))
        return result

    best = nearest(problem, np.zeros(SHARED + OWN * count), each)
    assert len(seen) < 20
    assert best[clocks] == pytest.approx(nearest(problem, best, smooth)[clocks], abs=0.01)


def test_how_certain_unknowns_are_is_told_drive_by_drive() -> None:
    """As the sandwich of all unknowns' matrices says."""
    random, count = np.random.default_rng(12), 4
    problem = _problem()
    roots = random.normal(size=(2, count, SHARED + OWN, SHARED + OWN))
    parts, noise = roots @ roots.swapaxes(2, 3)
    every: Any = [SimpleNamespace(sums=Sums(0.0, np.zeros(SHARED + OWN), part)) for part in parts]
    covariance, spread = _spread(problem, every, noise)
    inverse = np.linalg.inv(_dense(problem, parts))
    mean = np.zeros(SHARED + OWN * count)
    mean[SHARED + OWN - 1 :: OWN] = CLOCKS.weight * CLOCKS.error
    weak = np.diag(_dense(problem, 0 * parts))
    noises = np.diag([*weak[:SHARED] ** 2, *CLOCKS.counted * weak[SHARED:]]) + np.outer(mean, mean)
    whole = inverse @ (_dense(problem, noise, prior=False) + noises) @ inverse
    clocks = slice(SHARED + OWN - 1, None, OWN)
    np.testing.assert_allclose(covariance, whole[:SHARED, :SHARED], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(spread, [np.diag(whole)[clocks], np.diag(inverse)[clocks]], rtol=1e-9)
    vector = random.normal(size=len(mean))
    matrix = arrow(problem, [drive.sums for drive in every])
    assert matrix @ vector == pytest.approx(_dense(problem, parts) @ vector)
    assert matrix.solve(vector) == pytest.approx(inverse @ vector)


@pytest.mark.filterwarnings("error")
def test_directions_that_are_told_to_the_last_bit_are_certain() -> None:
    """Rounding makes the least of such variances negative; no warning of NumPy reaches the user."""
    problem: Any = SimpleNamespace(units=np.ones(SHARED), nominal=(1.0, 1.0, 1.0))
    random = np.random.default_rng(13)
    for _ in range(20):
        rows = random.normal(size=(2, SHARED)) * 1e6
        uncertain, _ = deviations(problem, rows.T @ rows, 1.0)
        assert np.isfinite(uncertain).all() and uncertain[0] > uncertain[-1] >= 0


def test_memory_grows_with_the_number_of_drives_and_not_with_its_square() -> None:
    """A hundred and fifty drives: the matrix of their 605 unknowns alone would have 3 MB."""
    each = _drives(150)
    tracemalloc.start()
    best = nearest(_problem(), np.zeros(SHARED + OWN * 150), each)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1.5e6 and np.isfinite(best).all()
