"""What joints tell where they measure more than a twist needs: without any truth, and beside one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import orth

from wmrgen.tools.calibrating.arrow import Sums
from wmrgen.tools.calibrating.certainty import Fit, fit, fit_at
from wmrgen.tools.calibrating.fit import (
    FINEST,
    Each,
    Problem,
    Untold,
    information,
    joint_residuals,
    joint_sums,
    nearest,
    solved,
    sums,
)
from wmrgen.tools.calibrating.observability import uncertain_of
from wmrgen.tools.calibrating.path import Reals

_NOMINAL = 1 - 1e-6  # squared units (10 %) that nominal values are taken to be off, but for rounding
_ROUNDS = 8  # at most, of directions that the truth does not tell: they turn with the parameters
_WIDE = 1e3  # [m] a scale of the loss below which all squares count
_SEEN = 1e-5  # [m] that joints disagree by where a direction is a unit off, to tell it
_FARTHEST = 10.0  # units: joints that take a direction farther only disagree by noise
_TURNED = 0.2  # [rad] about: directions that are nearer than that are one, which turns from round to round
_ASTRAY = 3.0  # times the mean square of usual residuals
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
    held = np.zeros((len(best.values), 0)) if rows or paths.held is None else paths.held
    for _ in range(_ROUNDS if rows else 1):
        before, parts = best.values, each(paths, best.unknowns, sums)
        untold = uncertain_of(paths, information(paths, parts), best.noise)
        if not untold.size:
            best = fit_at(*solved(paths, each, best.unknowns, rounds=2), each) if rows else best
            break
        if rows:
            untold = orth(np.column_stack([held, untold]), _TURNED)
            way = -untold @ untold.T @ best.unknowns[: len(untold)]
            unknowns = _led(paths, untold, best.unknowns, way, each)
            axes, sizes, _ = np.linalg.svd(untold - held @ (held.T @ untold), full_matrices=False)
            free = axes[:, sizes > _TURNED]
            joints = replace(paths, untold=Untold(free, unknowns[: len(untold)]))
            unknowns = _led(paths, untold, unknowns, _agreeing(joints, unknowns, free, each), each)
            problem = replace(best.problem, untold=joints.untold, slides=_slides(joints, unknowns, each))
            best = fit_at(*solved(problem, each, unknowns, rounds=1), each)
        # What is held stays so: else it comes and goes where slips alone tell it.
        covariance = best.covariance[: len(untold), : len(untold)] + held @ held.T
        variances, directions = np.linalg.eigh(covariance)
        held = directions[:, variances > _NOMINAL]
        if held.size:
            way = -held @ held.T @ best.unknowns[: len(held)]
            best = fit(replace(best.problem, held=held), each, _led(paths, held, best.unknowns, way, each))
        if np.all(np.abs(np.subtract(best.values, before)) < _CLOSE * best.deviations):
            break
    return best


def sober(best: Fit, first: Fit, each: Each) -> Fit:
    """The ``best`` fit; where joints led it astray from the ``first`` one, as they do that say next to nothing, with
    what the truth does not tell nominal, if that explains the truth better."""
    if not astray(best, first):
        return best
    paths = replace(first.problem, untold=None)
    untold = uncertain_of(paths, information(paths, each(paths, first.unknowns, sums)), first.noise)
    if not untold.size:
        return best
    way = -untold @ untold.T @ first.unknowns[: len(untold)]
    nominal = fit(replace(paths, held=untold), each, _led(paths, untold, first.unknowns, way, each))
    return min(best, nominal, key=lambda fit: fit.noise)


def astray(best: Fit, first: Fit) -> bool:
    """Whether the truth is not explained as by the ``first`` fit any more."""
    now, before = (fit.noise * fit.problem.scale**2 for fit in (best, first))
    return now > _ASTRAY * before


def _led(paths: Problem, untold: Reals, unknowns: Reals, way: Reals, each: Each) -> Reals:
    """The unknowns where parameters go a ``way`` (P,) among directions that the truth does not tell, a unit at a time,
    and all others, the tracked point's and what drives have of their own, follow the truth."""
    count, along = len(way), untold @ untold.T
    off = along @ unknowns[:count]
    for part in np.linspace(0.0, 1.0, 1 + int(np.ceil(np.linalg.norm(way))))[1:]:
        there = np.pad(off + part * way, (0, len(paths.units) - count))
        unknowns = nearest(replace(paths, held=untold, off=there), unknowns, each)
    return unknowns + np.pad(off + way - along @ unknowns[:count], (0, len(unknowns) - count))


def _agreeing(problem: Problem, unknowns: Reals, untold: Reals, each: Each, seen: float = _SEEN) -> Reals:
    """The way (P,) among ``untold`` directions to where squares of the joints' disagreement are least; what a direction
    that is a unit off moves by less than ``seen`` [m] in all is not told."""
    parts, count = each(replace(problem, slides=_WIDE), unknowns, _of_joints), len(untold)
    gradient = np.sum([part.gradient for part in parts], axis=0)[:count]
    matrix = np.sum([part.matrix for part in parts], axis=0)[:count, :count]
    told, axes = np.linalg.eigh(untold.T @ matrix @ untold)
    steps = -axes.T @ untold.T @ gradient / (np.maximum(told, 0.0) + (seen / _WIDE) ** 2)
    return np.asarray(untold @ axes @ np.where(np.abs(steps) < _FARTHEST, steps, 0.0))


def _of_joints(problem: Problem, unknowns: Reals, index: int) -> Sums:
    return joint_sums(problem, *joint_residuals(problem, unknowns, index))


def _slides(problem: Problem, unknowns: Reals, each: Each) -> float:
    """The scale [m] of what joints disagree by."""
    return max(FINEST, 1.5 * float(np.median(each(problem, unknowns, _sliding))))


def _sliding(problem: Problem, unknowns: Reals, index: int) -> float:
    """The median over spans [m] of what a drive's joints disagree by, the root mean square of all rows."""
    values, _ = joint_residuals(problem, unknowns, index)
    return float(np.median(np.sqrt(np.mean(values**2, axis=0))))
