"""From a robot and its logs to its parameters: what is estimated, how well it holds on drives that were left out, and
what stands in the way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from wmrgen.calibrating.certainty import Fit, fit
from wmrgen.calibrating.fit import Each, Problem, drawn, serial
from wmrgen.calibrating.logs import Drive, pairs, read
from wmrgen.calibrating.observability import unobservable
from wmrgen.calibrating.path import Increments, Reals
from wmrgen.calibrating.starts import laid
from wmrgen.errors import UsageError
from wmrgen.ir.calls import self_contained
from wmrgen.layout.records import Robot
from wmrgen.robot import Derivation

_FOLDS = 5  # parts that drives are left out in, one after the other
_FEWEST = 3  # parts whose spread is a standard deviation
_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_TURNED = 1.0  # [rad] the same for headings
_BETTER = 0.25  # of the residual: what another reading of the columns has to come to, to be proposed


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
    parameters of others, None where there is one drive alone."""

    parameters: Mapping[str, Estimate]
    unobservable: tuple[tuple[str, ...], ...]
    fit: Fit
    before: Errors
    after: Errors
    held_out: Errors | None


def problem_of(derivation: Derivation, drives: Sequence[Drive] = ()) -> Problem:
    """What a robot's `forward` leaves to estimate. UsageError where nothing is tunable."""
    robot = derivation.robot
    if not robot.tunable:
        raise UsageError(
            f"{robot.name} has no tunable parameter, so there is nothing to calibrate: write one as "
            "radius: {value: 0.0975, tunable: true} under parameters, and use its name in the wheels"
        )
    forward = next(f for f in self_contained(derivation.module) if f.name == "forward")
    increments = Increments.of(forward)
    nominal = {p.name: float(p.nominal) for p in robot.tunable}
    return Problem(increments, tuple(nominal[name] for name in increments.parameters), tuple(drives))


def counts_per_turn(robot: Robot) -> dict[str, float]:
    """Counts per turn, negative where a counter runs down, of each ``<wheel>.spin`` that has an encoder."""
    encoders = {f"{w.name}.spin": robot.encoder_of(w, "spin") for w in robot.wheels}
    return {joint: float(encoder.turn) for joint, encoder in encoders.items() if encoder is not None}


def calibrate(
    derivation: Derivation, logs: Sequence[Path], truths: Sequence[Path], each: Each = serial
) -> Calibration:
    """The parameters that the logs tell. UsageError for logs that cannot be read or do not belong to the robot."""
    problem = problem_of(derivation)
    turns = counts_per_turn(derivation.robot)
    drives = [read(log, truth, problem.increments.joints, turns) for log, truth in pairs(logs, truths)]
    best = fit(laid(replace(problem, drives=tuple(drives))), each)
    _refuse_strangers(best, drives, each)
    without = _without_each(best.problem, each)
    weak = _unobservable(derivation.robot, best)
    return Calibration(
        _estimates(derivation.robot, best, _deviations(best, without), weak), weak, best,
        _errors(best, best.problem.shared(0 * best.unknowns)), _errors(best, best.problem.shared(best.unknowns)),
        _held_out(best, without),
    )  # fmt: skip


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
        value, deviation = fitted.get(p.name, (nominal, 0.1 * abs(nominal) or 0.1))  # as the prior has it
        result[p.name] = Estimate(value, float(deviation), nominal, p.name not in weak)
    return result


def _errors(best: Fit, shared: Reals) -> Errors:
    return _mean([drawn(best.problem, shared, offset, index) for index, offset in enumerate(best.offsets)])


def _mean(parts: Sequence[tuple[Reals, Reals]]) -> Errors:
    """Root mean squares over all drives; nan where nothing was measured."""

    def rms(columns: Sequence[Reals]) -> float:
        all_of = np.concatenate(columns)
        return float(np.sqrt(np.mean(all_of**2))) if len(all_of) else float("nan")

    return Errors(rms([position for position, _ in parts]), rms([heading for _, heading in parts]))


def _without_each(problem: Problem, each: Each) -> list[Fit]:
    """The fits without every `_FOLDS`-th drive in turn, of two drives at least."""
    count = len(problem.drives)
    folds = range(min(count, _FOLDS)) if count > 1 else ()
    others = [tuple(d for i, d in enumerate(problem.drives) if i % _FOLDS != fold) for fold in folds]
    return [fit(replace(problem, drives=rest), each) for rest in others]


def _held_out(best: Fit, without: Sequence[Fit]) -> Errors | None:
    """Every drive's errors with the parameters that the others give; its clock is that of the ``best`` fit."""
    parts = []
    for fold, rest in enumerate(without):
        shared = rest.problem.shared(rest.unknowns)
        drives = range(fold, len(best.offsets), _FOLDS)
        parts += [drawn(best.problem, shared, best.offsets[index], index) for index in drives]
    return _mean(parts) if parts else None


def _deviations(best: Fit, without: Sequence[Fit]) -> Reals:
    """Standard deviations of the parameters: what slips and noise in the drives make, or, where it is more, what the
    drives differ by (the jackknife, of three parts at least)."""
    inside = (np.sqrt(np.diag(best.covariance)) * best.problem.units)[: len(best.values)]
    if len(without) < _FEWEST:
        return np.asarray(inside)
    values = np.array([rest.values for rest in without])
    between = np.sqrt((len(without) - 1) * np.mean((values - values.mean(axis=0)) ** 2, axis=0))
    return np.asarray(np.maximum(inside, between))


def _refuse_strangers(best: Fit, drives: Sequence[Drive], each: Each) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    if not _strange(best):
        return
    turned = best.rms[1] > _TURNED
    hint = "do log and truth belong to one drive of this robot?"
    for text, other in _readings(drives[:2]):
        other_fit = fit(laid(replace(best.problem, drives=other, scale=0.01)), each)
        if not _strange(other_fit) and other_fit.rms[turned] < _BETTER * best.rms[turned]:
            hint = f"they would agree with {text}"
            break
    if turned:
        raise UsageError(
            f"whatever the parameters are, headings stay {best.rms[1]:.2g} rad from the truth: {hint}"
        )
    raise UsageError(
        f"whatever the parameters are, positions stay {best.rms[0]:.2g} m from the truth, which extends over "
        f"{_extent(best):.2g} m: {hint}"
    )


def _strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together."""
    return best.rms[0] > _FAR * _extent(best) or best.rms[1] > _TURNED


def _extent(best: Fit) -> float:
    """How far [m] the truth extends along x or y; 0 where it has headings alone."""
    every = [axis for drive in best.problem.drives for axis in (drive.truth.x, drive.truth.y)]
    axes = [axis[np.isfinite(axis)] for axis in every]
    return max((float(np.ptp(axis)) for axis in axes if len(axis)), default=0.0)


def _readings(drives: Sequence[Drive]) -> Iterator[tuple[str, tuple[Drive, ...]]]:
    """Mistakes that users make with columns, in words, and the drives without them."""
    yield (
        "theta of the truth in radians, which seems to be in degrees",
        tuple(replace(d, truth=replace(d.truth, theta=np.radians(d.truth.theta))) for d in drives),
    )
    spins = [name for name in drives[0].columns if name.endswith(".spin")]
    for a, b in combinations(spins, 2):
        swapped = tuple(replace(d, columns={**d.columns, a: d.columns[b], b: d.columns[a]}) for d in drives)
        yield f"the columns of {a} and {b} exchanged", swapped
    for name in drives[0].columns:
        yield (
            f"{name} counted the other way",
            tuple(replace(d, columns={**d.columns, name: -d.columns[name]}) for d in drives),
        )
    yield (
        "x and y of the truth exchanged",
        tuple(replace(d, truth=replace(d.truth, x=d.truth.y, y=d.truth.x)) for d in drives),
    )
    yield (
        "theta of the truth counted the other way",
        tuple(replace(d, truth=replace(d.truth, theta=-d.truth.theta)) for d in drives),
    )
    yield (
        "x and y of the truth in metres, which seem to be in millimetres",
        tuple(replace(d, truth=replace(d.truth, x=d.truth.x / 1000, y=d.truth.y / 1000)) for d in drives),
    )
    yield (
        "angles of the joints in radians, which seem to be in degrees",
        tuple(replace(d, columns={k: np.radians(v) for k, v in d.columns.items()}) for d in drives),
    )
