"""The estimator: what each log has of its own is eliminated, and nothing else changes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.tools.calibration.drives import derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Reals, Tracker
from wmrgen.tools.calibration import estimator, start
from wmrgen.tools.calibration.calibrate import increments_of
from wmrgen.tools.calibration.estimator import PRIOR, Fit
from wmrgen.tools.calibration.logs import thinned
from wmrgen.tools.calibration.model import MOUNT, Problem, State
from wmrgen.tools.calibration.reading import read, recordings


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Three drives in legs of 7 s."""
    layout, folder = LAYOUTS["differential"], tmp_path_factory.mktemp("logs")
    increments, nominal = increments_of(derived(layout.text))
    tracker, encoders = Tracker(0.03, late=0.1, noise=(0.002, 0.003)), Encoders(slip=0.01)
    paths: list[Path] = written(folder, layout, seconds=20, rate=10, tracker=tracker, encoders=encoders)
    logs = tuple(
        thinned(read(recording, increments.joints, {}), increments, nominal)
        for recording in recordings(paths, ())
    )
    legs = tuple(start.whole(log, 7.0) for log in logs)
    return Problem(
        increments, nominal, logs, legs, free=np.eye(len(nominal) + MOUNT), clocks=(True,) * len(logs)
    )


def begun(problem: Problem) -> Fit:
    shared = problem.origin + problem.units * np.linspace(-0.4, 0.5, len(problem.origin))
    return estimator.evaluated(problem, start.begun(problem, shared, np.zeros(len(problem.logs))))


def all_unknowns(fit: Fit) -> Reals:
    """Return shared unknowns, in units off nominal, and all own ones."""
    return np.concatenate([(fit.state.shared - fit.problem.origin) / fit.problem.units, *fit.state.own])


def at(problem: Problem, unknowns: Reals, like: Fit) -> Fit:
    width, own = len(problem.origin), []
    end = width
    for one in like.state.own:
        own.append(unknowns[end : end + len(one)])
        end += len(one)
    return estimator.evaluated(problem, State(problem.origin + problem.units * unknowns[:width], tuple(own)))


def dense(fit: Fit) -> tuple[Reals, Reals]:
    """Return matrix and gradient over all unknowns at once, with the prior."""
    width, sizes = len(fit.problem.origin), [len(own) for own in fit.state.own]
    total = width + sum(sizes)
    matrix, gradient = np.zeros((total, total)), np.zeros(total)
    off = (fit.state.shared - fit.problem.origin) / fit.problem.units
    matrix[:width, :width] = PRIOR**2 * np.eye(width)
    gradient[:width] = PRIOR**2 * off
    first = width
    for one, size in zip(fit.normals, sizes, strict=True):
        border = [*range(width), first]
        matrix[np.ix_(border, border)] += one.matrix
        gradient[border] += one.gradient
        for k, (block, coupling) in enumerate(zip(one.starts, one.couplings, strict=True)):
            here = first + 1 + 3 * k + np.arange(3)
            matrix[np.ix_(here, here)] += block
            matrix[np.ix_(border, here)] += coupling
            matrix[np.ix_(here, border)] += coupling.T
            gradient[here] += one.start_gradients[k]
        first += size
    return matrix, gradient


def test_gradients_are_those_of_the_cost(problem: Problem) -> None:
    """By central differences of the whole cost, except by clocks, whose derivative is a mean over two seconds."""
    fit = begun(problem)
    _, gradient = dense(fit)
    unknowns = all_unknowns(fit)
    clocks = len(problem.origin) + np.cumsum([0, *(len(own) for own in fit.state.own[:-1])])
    for index in set(range(len(unknowns))) - set(clocks.tolist()):
        step = 1e-6 * np.eye(len(unknowns))[index]
        more, less = at(problem, unknowns + step, fit), at(problem, unknowns - step, fit)
        assert (more.cost - less.cost) / 2e-6 == pytest.approx(gradient[index], rel=1e-5, abs=1e-4)


def test_a_step_is_that_of_all_unknowns_at_once(problem: Problem) -> None:
    fit = begun(problem)
    matrix, gradient = dense(fit)
    whole = -np.linalg.solve(matrix, gradient)
    width = len(problem.origin)
    logs = [estimator.reduced(one) for one in fit.normals]
    shared_matrix = PRIOR**2 * np.eye(width) + sum(log.shared[0] for log in logs)
    off = (fit.state.shared - problem.origin) / problem.units
    shared = -np.linalg.solve(shared_matrix, PRIOR**2 * off + sum(log.shared[1] for log in logs))
    own = [log.back(shared) for log in logs]
    assert np.concatenate([shared, *own]) == pytest.approx(whole, rel=1e-6, abs=1e-9)


def test_the_fit_is_a_minimum(problem: Problem) -> None:
    """Random changes of all unknowns cost more, and the solver comes to it from other starts, too."""
    fit = estimator.solved(problem, begun(problem).state)
    assert fit.cost < begun(problem).cost
    other = estimator.solved(problem, start.begun(problem, problem.origin, np.zeros(len(problem.logs))))
    assert (other.state.shared - fit.state.shared) / problem.units == pytest.approx(0.0, abs=1e-3)
    random = np.random.default_rng(1)
    for _ in range(20):
        changed = all_unknowns(fit) + 0.02 * random.standard_normal(len(all_unknowns(fit)))
        assert at(fit.problem, changed, fit).cost > fit.cost


def test_directions_that_are_not_free_stay(problem: Problem) -> None:
    free = np.eye(len(problem.origin))[:, 1:]
    fit = estimator.solved(
        replace(problem, free=free), start.begun(problem, problem.origin, np.zeros(len(problem.logs)))
    )
    assert fit.state.shared[0] == problem.origin[0]
    assert np.all(fit.state.shared[1:] != problem.origin[1:])


def test_clocks_that_are_not_free_stay(problem: Problem) -> None:
    known = replace(problem, clocks=(False, True, False))
    fit = estimator.solved(known, start.begun(problem, problem.origin, np.zeros(3)))
    assert [own[0] == 0 for own in fit.state.own] == [True, False, True]
    assert fit.state.own[1][0] == pytest.approx(0.1, abs=0.05)


def test_typical_residuals_give_the_scale(problem: Problem) -> None:
    fit = begun(problem)
    places = np.concatenate([np.hypot(*one.values[:2]) / np.sqrt(2) for one in fit.rows])
    headings = np.concatenate([np.abs(one.values[2]) for one in fit.rows])
    assert estimator.typical(fit) == pytest.approx(1.5 * np.median([*places, *headings]))
