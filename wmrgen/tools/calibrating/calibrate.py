"""From a robot and its logs to its parameters: what is estimated, how well it holds on drives that were left out, and
what stands in the way."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path

import numpy as np

from wmrgen.analysis.kinematics.forward import disagreement
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import UsageError
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.calls import self_contained
from wmrgen.ir.lower import lower
from wmrgen.tools.calibrating import certainty
from wmrgen.tools.calibrating.certainty import Fit
from wmrgen.tools.calibrating.clocks import ALONE, ONE
from wmrgen.tools.calibrating.drawn import drawn
from wmrgen.tools.calibrating.drifts import Drift, drifts
from wmrgen.tools.calibrating.fit import (
    UNIT_OWN,
    Each,
    Problem,
    during,
    nearest,
    serial,
    solved,
    start_of,
    unit_of,
)
from wmrgen.tools.calibrating.joints import settled, sober
from wmrgen.tools.calibrating.logs import Drive, names, pairs, read
from wmrgen.tools.calibrating.mistakes import near_nominal, refuse_strangers, refuse_unsettled, strange
from wmrgen.tools.calibrating.observability import unobservable
from wmrgen.tools.calibrating.outliers import Outlier, cut, without, without_slips
from wmrgen.tools.calibrating.path import Increments, Reals
from wmrgen.tools.calibrating.starts import begun, laid
from wmrgen.tools.calibrating.stored import changed, stored

_FOLDS = 5  # parts that drives are left out in, one after the other
_ENOUGH, _COARSE = 100_000, 0.06  # readings, and [s] between them, that tell nearly what all tell
_SEEN = 0.25  # [s] between rows of truth that do
_PART = 200.0  # [s] of a long drive: each part has a start of its own
_ROWS = 24  # of truth in such a part at least: twice as many numbers as it has unknowns of its own, and more
_LARGE = 2**28  # bytes of logs and truths, above which they are read one at a time


@dataclass(frozen=True, slots=True)
class Estimate:
    """A parameter: its ``value`` and standard deviation ``sigma``, in its own unit; ``nominal`` before."""

    value: float
    sigma: float
    nominal: float
    observable: bool


@dataclass(frozen=True, slots=True)
class Errors:
    """Of odometry drawn from the first measured pose of each drive: root mean squares, [m] and [rad]."""

    position: float
    heading: float


@dataclass(frozen=True, slots=True)
class Calibration:
    """``unobservable``: parameters that the drives do not tell, those together that scale together. ``before`` and
    ``after``: errors of all drives with the nominal and the new parameters; ``held_out``: of each drive with the
    parameters of others, or of each part of a drive with those of its others; None where it is too short for parts;
    ``outliers``: what was left out of all this; ``drifts``: how clocks and headings of the truth move in the drives."""

    parameters: Mapping[str, Estimate]
    unobservable: tuple[tuple[str, ...], ...]
    fit: Fit
    before: Errors
    after: Errors
    held_out: Errors | None
    outliers: tuple[Outlier, ...]
    drifts: tuple[Drift, ...]

    @property
    def clocks(self) -> dict[str, float]:
        """What each drive's truth is off by [s], later than the log; of its parts the median."""
        return self._by_name(self.fit.offsets)

    @property
    def clock_deviations(self) -> dict[str, float]:
        """The standard deviations [s] of `clocks`."""
        return self._by_name((UNIT_OWN[-1] * np.sqrt(self.fit.spread[0])).tolist())

    def _by_name(self, values: Sequence[float]) -> dict[str, float]:
        """The median over the parts of each drive."""
        by_name: dict[str, list[float]] = {}
        for drive, value in zip(self.fit.problem.drives, values, strict=True):
            by_name.setdefault(drive.name, []).append(value)
        return {name: float(np.median(parts)) for name, parts in by_name.items()}


def problem_of(derivation: Derivation, one_clock: bool = False) -> Problem:
    """What a robot's `forward` leaves to estimate. UsageError where nothing is tunable."""
    derivation = derivation.without_gyro  # logs have no column for it
    robot = derivation.robot
    if not robot.tunable:
        raise UsageError(
            f"{robot.name} has no tunable parameter, so there is nothing to calibrate: write one as "
            "radius: {value: 0.0975, tunable: true} under parameters, and use its name in the wheels"
        )
    forward = next(f for f in self_contained(derivation.module) if f.name == "forward")
    rows = disagreement(driving(robot, derivation.mobility)[0])
    increments = Increments.of(forward, None if rows is None else lower(rows))
    nominal = {p.name: float(p.nominal) for p in robot.tunable}
    values = tuple(nominal[name] for name in increments.parameters)
    return Problem(increments, values, (), clocks=ONE if one_clock else ALONE)


def counts_per_turn(robot: Robot) -> dict[str, float]:
    """Counts per turn, negative where a counter runs down, of each ``<wheel>.spin`` that has an encoder."""
    encoders = {f"{w.name}.spin": robot.encoder_of(w, "spin") for w in robot.wheels}
    return {joint: float(encoder.turn) for joint, encoder in encoders.items() if encoder is not None}


def calibrate(
    derivation: Derivation, logs: Sequence[Path], truths: Sequence[Path], each: Each = serial,
    one_clock: bool = False, start_error: float = inf,
) -> Calibration:  # fmt: skip
    """The parameters that the logs tell; ``one_clock``: each log and its truth have one, so that no offset is
    estimated; ``start_error`` [m]: the standard error of the first pose of each truth. UsageError for logs that cannot
    be read or do not belong to the robot, and where ``start_error`` is not positive."""
    if not start_error > 0:
        raise UsageError(f"the standard error of a first pose is {start_error:g} m: it has to be above 0")
    problem, turns = problem_of(derivation, one_clock), counts_per_turn(derivation.robot)
    files = pairs(logs, truths)
    every = (
        replace(read(log, truth, problem.increments.joints, turns), name=name, start_error=start_error)
        for name, (log, truth) in zip(names(logs), files, strict=True)
    )
    large = sum(path.stat().st_size for pair in files for path in pair if path.is_file()) > _LARGE
    problem = replace(problem, drives=_parts(stored(every) if large else tuple(every)))
    first, slips = _begun(problem, each)
    first = near_nominal(first, _coarser, each)
    if strange(first):
        first, slips = _begun(problem, each, lost=True)
    again = partial(_again, each)
    moving = drifts(_coarser(first.problem), first.unknowns, each)
    best, more = without_slips(_without_jumps(first, moving, each), _coarser, again)
    slips += more
    refuse_strangers(best, problem.drives, lambda some: _begun(replace(problem, drives=tuple(some)), each)[0])
    first, best = best, _settled(best, each)
    best = sober(best, first, each)
    refuse_unsettled(best, first)
    if best.problem.untold is not None:  # joints that disagree less show more slips
        best, more = without_slips(best, _coarser, again)
        slips += more
    parts = best if len(problem.drives) > 1 else _in_parts(best, each)
    fewer = replace(parts, problem=_coarser(parts.problem))
    others = [certainty.without(fewer, fold, each) for fold in _folds(parts.problem)]
    best = certainty.bent(_finely(best, each), _coarser(best.problem), each)
    sigma = certainty.deviations(best, others if len(problem.drives) > 1 else ())
    weak = _unobservable(derivation.robot, best)
    return Calibration(
        _estimates(derivation.robot, best, sigma, weak), weak, best,
        _errors(best, best.problem.shared(0 * best.unknowns)), _errors(best, best.problem.shared(best.unknowns)),
        _held_out(parts, others), tuple(sorted(slips, key=lambda slip: (slip.drive, slip.start))),
        tuple(drift for of_drive in moving for drift in of_drive),
    )  # fmt: skip


def _parts(drives: Sequence[Drive]) -> Sequence[Drive]:
    """The drives, long ones in parts: what slips adds up, so that in the end a pose tells nothing of the parameters,
    and nominal odometry loses its way."""

    def parts(_: int, drive: Drive) -> list[Drive]:
        return _split(drive, max(1, min(int(np.ptp(drive.t) / _PART), drive.truth.measured // _ROWS)))

    return changed(drives, parts)


def _split(drive: Drive, count: int, offset: float = 0.0) -> list[Drive]:
    """So many parts of a drive, which last equally long; the whole where one would tell nothing."""
    edges = np.linspace(drive.t[0], drive.t[-1], count + 1).tolist()
    parts = cut(drive, edges[:-1], edges[1:], offset)
    return parts if len(parts) == count else [drive]


def _begun(problem: Problem, each: Each, lost: bool = False) -> tuple[Fit, list[Outlier]]:
    """The first fit of drives as they were read, and the slips without which it begins, where odometry is ``lost``."""
    ready, start, slips = begun(problem, _coarser, each, lost)
    return _about(ready, each, start), slips


def _about(ready: Problem, each: Each, start: Reals) -> Fit:
    """The fit from ``start`` on; of large logs about, as a coarser problem has it."""
    about = certainty.fit(coarse := _coarser(ready), each, start)
    return about if coarse is ready else certainty.of_drives(about, during(ready, about.unknowns))


def _again(each: Each, problem: Problem, best: Fit) -> Fit:
    """The fit of parts of the drives of the ``best`` one, from its parameters on."""
    ready = laid(problem)
    return _about(ready, each, start_of(ready, best.unknowns))


def _settled(best: Fit, each: Each) -> Fit:
    """The fit where clocks agree as far as they do, and joints tell what the truth does not: by all readings, for they
    disagree by little; of large logs without such joints about."""
    drives = best.problem.drives
    if best.problem.untold is not None:  # by what joints tell before paths do, clocks would be told, too
        best = certainty.of_drives(settled(replace(best, problem=_coarser(best.problem)), each), drives)
    whole = certainty.agreeing(best)
    coarse = whole if whole.increments.rows is not None else _coarser(whole)
    best = settled(certainty.fit_at(coarse, nearest(coarse, best.unknowns, each), each), each)
    return best if coarse.drives is drives else certainty.of_drives(best, drives)


def _finely(best: Fit, each: Each) -> Fit:
    """The fit of large logs by all readings, from that of a coarser problem on."""
    if _passed_over(best.problem) < 2:
        return best
    return certainty.fit_at(*solved(best.problem, each, best.unknowns, rounds=1), each)


def _coarser(problem: Problem) -> Problem:
    """The problem with about `_ENOUGH` readings, where there are twice as many often enough."""
    if (times := _passed_over(problem)) < 2:
        return problem
    return replace(problem, drives=changed(problem.drives, lambda _, drive: [drive.coarser(times, _SEEN)]))


def _passed_over(problem: Problem) -> int:
    """Of how many readings one tells nearly what all do, where there are more than `_ENOUGH`."""
    step = float(np.median([np.median(np.diff(drive.t)) for drive in problem.drives]))
    return min(sum(len(drive.t) for drive in problem.drives) // _ENOUGH, int(_COARSE / step))


def _unobservable(robot: Robot, best: Fit) -> tuple[tuple[str, ...], ...]:
    """What the fit says, and the parameters that `forward` does not have."""
    absent = [p.name for p in robot.tunable if p.name not in best.problem.increments.parameters]
    return (*unobservable(best), *((name,) for name in absent))


def _estimates(robot: Robot, best: Fit, sigma: Reals, groups: Sequence[Sequence[str]]) -> dict[str, Estimate]:
    weak = {name for group in groups for name in group}
    fitted = dict(zip(best.problem.increments.parameters, zip(best.values, sigma, strict=True), strict=True))
    result = {}
    for p in robot.tunable:
        nominal = float(p.nominal)
        value, deviation = fitted.get(p.name, (nominal, unit_of(nominal)))  # as the prior has it
        result[p.name] = Estimate(value, float(deviation), nominal, p.name not in weak)
    return result


def _errors(best: Fit, shared: Reals) -> Errors:
    return _mean(drawn(best.problem, shared, offset, i).off for i, offset in enumerate(best.offsets))


def _mean(parts: Iterable[tuple[Reals, Reals]]) -> Errors:
    """Root mean squares over all drives; nan where nothing was measured."""
    sums = np.array([(position @ position, heading @ heading, len(position)) for position, heading in parts])
    *squares, count = sums.sum(axis=0)
    return Errors(*(float(np.sqrt(total / count)) if count else float("nan") for total in squares))


def _without_jumps(best: Fit, moving: Sequence[Sequence[Drift]], each: Each) -> Fit:
    """The fit where each drive whose clock jumps is two, with a clock each."""
    jumps = [[drift for drift in of_drive if drift.at_once] for of_drive in moving]
    return _again(each, without(best, jumps), best) if any(jumps) else best


def _in_parts(best: Fit, each: Each) -> Fit:
    """The fit of `_FOLDS` parts of one drive, each with a start of its own."""
    parts = tuple(_split(best.problem.drives[0], _FOLDS, best.offsets[0]))
    return _again(each, replace(best.problem, drives=parts), best) if len(parts) > 1 else best


def _folds(problem: Problem) -> list[list[int]]:
    """Which drives are left out together: every `_FOLDS`-th, all parts of a drive together; of one drive its parts."""
    names = list(dict.fromkeys(drive.name for drive in problem.drives))
    which = [names.index(d.name) if len(names) > 1 else i for i, d in enumerate(problem.drives)]
    count = min(len(set(which)), _FOLDS)
    folds = range(count if count > 1 else 0)
    return [[i for i, k in enumerate(which) if k % _FOLDS == fold] for fold in folds]


def _held_out(best: Fit, others: Sequence[Fit]) -> Errors | None:
    """Every drive's errors with the parameters that the others give; its clock is that of the ``best`` fit."""
    parts = [
        (rest.problem.shared(rest.unknowns), index)
        for fold, rest in zip(_folds(best.problem), others, strict=True)
        for index in fold
    ]
    errors = (drawn(best.problem, shared, best.offsets[index], index).off for shared, index in parts)
    return _mean(errors) if parts else None
