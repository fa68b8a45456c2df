"""What joints tell where they measure more than a twist needs: without any truth, and beside one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wmrgen.calibrating.arrow import Arrow, Sums
from wmrgen.calibrating.certainty import Fit, fit, fit_at
from wmrgen.calibrating.fit import (
    FINEST,
    Each,
    Problem,
    Untold,
    arrow,
    information,
    joint_residuals,
    joint_sums,
    prior_of_shared,
    solved,
    sums,
)
from wmrgen.calibrating.observability import uncertain_of
from wmrgen.calibrating.path import Reals

_NOMINAL = 1 - 1e-6  # squared units (10 %) that nominal values are taken to be off, but for rounding
_ROUNDS = 8  # at most, of directions that the truth does not tell: they turn with the parameters
_WIDE = 1e3  # [m] a scale of the loss below which all squares count
_SEEN = 1e-5  # [m] that joints disagree by where a direction is a unit off, to tell it
_CLOSE = 0.1  # standard deviations that a round changes, where it is the last
_FIRST = 3  # rounds in which joints agree before there is a fit


def agreed(problem: Problem, start: Reals, each: Each, lost: bool) -> tuple[Problem, Reals]:
    """Unknowns from ``start`` on under which joints disagree least, and the problem in which they tell what the truth
    does not, as far as can be seen from there, or all where paths are ``lost``; both as they are where joints tell no
    more than a twist."""
    if problem.increments.rows is None:
        return problem, start
    count = len(problem.nominal)
    joints = replace(problem, untold=Untold(np.eye(count), start[:count]))
    for _ in range(_FIRST):
        joints = replace(joints, slides=_slides(joints, start, each))
        way = _agreeing(joints, start, np.eye(count), each, joints.slides)
        start = start + np.pad(way, (0, len(start) - count))
    if lost:
        return replace(joints, untold=Untold(np.eye(count), start[:count])), start
    untold = uncertain_of(problem, information(problem, each(problem, start, sums)), 1.0)
    return replace(joints, untold=Untold(untold, start[:count]) if untold.size else None), start


def settled(best: Fit, each: Each) -> Fit:
    """The fit of paths, with what the truth does not tell as joints disagree least, and directions held in which that
    is no nearer to the truth than nominal values are: they stay nominal. What the truth tells does not follow the
    joints' disagreement, in which wheels that all slip alike do not show."""
    paths, rows = replace(best.problem, untold=None), best.problem.increments.rows is not None
    for _ in range(_ROUNDS if rows else 1):
        before, matrix = best.values, arrow(paths, each(paths, best.unknowns, sums))
        untold = uncertain_of(paths, matrix.reduced - prior_of_shared(paths), best.noise)
        if not untold.size:
            best = fit_at(*solved(paths, each, best.unknowns, rounds=2), each) if rows else best
            break
        if rows:
            unknowns = _moved(matrix, best.unknowns, -untold @ untold.T @ best.unknowns[: len(untold)])
            joints = replace(paths, untold=Untold(untold, unknowns[: len(untold)]))
            unknowns = _moved(matrix, unknowns, _agreeing(joints, unknowns, untold, each))
            problem = replace(best.problem, untold=joints.untold, slides=_slides(joints, unknowns, each))
            best = fit_at(*solved(problem, each, unknowns, rounds=1), each)
        covariance = best.covariance[: len(untold), : len(untold)]
        if paths.held is not None and not rows:  # it stays, whatever rounding leaves of its variance
            covariance = covariance + paths.held @ paths.held.T
        variances, directions = np.linalg.eigh(covariance)
        held = directions[:, variances > _NOMINAL]
        if held.size:
            way = -held @ held.T @ best.unknowns[: len(held)]
            best = fit(replace(best.problem, held=held), each, _moved(matrix, best.unknowns, way))
        if np.all(np.abs(np.subtract(best.values, before)) < _CLOSE * best.deviations):
            break
    return best


def _agreeing(problem: Problem, unknowns: Reals, untold: Reals, each: Each, seen: float = _SEEN) -> Reals:
    """The way (P,) among ``untold`` directions to where squares of the joints' disagreement are least; what a direction
    that is a unit off moves by less than ``seen`` [m] in all is not told."""
    parts, count = each(replace(problem, slides=_WIDE), unknowns, _of_joints), len(untold)
    gradient = np.sum([part.gradient for part in parts], axis=0)[:count]
    matrix = np.sum([part.matrix for part in parts], axis=0)[:count, :count]
    told = untold.T @ matrix @ untold + np.eye(untold.shape[1]) * (seen / _WIDE) ** 2
    return np.asarray(-untold @ np.linalg.solve(told, untold.T @ gradient))


def _of_joints(problem: Problem, unknowns: Reals, index: int) -> Sums:
    return joint_sums(problem, *joint_residuals(problem, unknowns, index))


def _moved(matrix: Arrow, unknowns: Reals, way: Reals) -> Reals:
    """The unknowns where those of the parameters go a ``way`` (P,), and the others, the tracked point's and what drives
    have of their own, follow."""
    count, reduced = len(way), matrix.reduced
    mount = -np.linalg.solve(reduced[count:, count:], reduced[count:, :count] @ way)
    shared = np.concatenate([way, mount])
    return np.asarray(unknowns + np.concatenate([shared, -(matrix.follows @ shared).ravel()]))


def _slides(problem: Problem, unknowns: Reals, each: Each) -> float:
    """The scale [m] of what joints disagree by."""
    return max(FINEST, 1.5 * float(np.median(each(problem, unknowns, _sliding))))


def _sliding(problem: Problem, unknowns: Reals, index: int) -> float:
    """The median over spans [m] of what a drive's joints disagree by, the root mean square of all rows."""
    values, _ = joint_residuals(problem, unknowns, index)
    return float(np.median(np.sqrt(np.mean(values**2, axis=0))))
