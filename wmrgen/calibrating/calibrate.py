"""From a robot and its logs to its parameters: what is estimated, how well it holds on drives that were left out, and
what stands in the way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from wmrgen.calibrating.certainty import Fit, fit, without
from wmrgen.calibrating.fit import Each, Problem, drawn, serial
from wmrgen.calibrating.logs import Drive, pairs, read
from wmrgen.calibrating.observability import unobservable
from wmrgen.calibrating.path import Increments, Reals
from wmrgen.calibrating.starts import laid, near
from wmrgen.errors import UsageError
from wmrgen.ir.calls import self_contained
from wmrgen.layout.records import Robot
from wmrgen.robot import Derivation

_FOLDS = 5  # parts that drives are left out in, one after the other
_FEWEST = 3  # parts whose spread is a standard deviation
_ALONE = 3.0  # times as uncertain as with all drives: the drives that are left do not tell a parameter
_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_TURNED = 1.0  # [rad] the same for headings
_SURE = 5.0  # standard deviations from zero: a sign that is sure
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
    best = _fitted(replace(problem, drives=tuple(drives)), each)
    _refuse_strangers(best, drives, each)
    others = _without_each(best, each)
    weak = _unobservable(derivation.robot, best)
    return Calibration(
        _estimates(derivation.robot, best, _deviations(best, others), weak), weak, best,
        _errors(best, best.problem.shared(0 * best.unknowns)), _errors(best, best.problem.shared(best.unknowns)),
        _held_out(best, others),
    )  # fmt: skip


def _fitted(problem: Problem, each: Each) -> Fit:
    """The fit, of drives as they were read."""
    ready = laid(problem)
    return fit(ready, each, near(ready, each))


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


def _without_each(best: Fit, each: Each) -> list[Fit]:
    """The fits without every `_FOLDS`-th drive in turn, of two drives at least."""
    count = len(best.problem.drives)
    folds = range(min(count, _FOLDS)) if count > 1 else ()
    return [without(best, range(fold, count, _FOLDS), each) for fold in folds]


def _held_out(best: Fit, others: Sequence[Fit]) -> Errors | None:
    """Every drive's errors with the parameters that the others give; its clock is that of the ``best`` fit."""
    parts = []
    for fold, rest in enumerate(others):
        shared = rest.problem.shared(rest.unknowns)
        drives = range(fold, len(best.offsets), _FOLDS)
        parts += [drawn(best.problem, shared, best.offsets[index], index) for index in drives]
    return _mean(parts) if parts else None


def _deviations(best: Fit, others: Sequence[Fit]) -> Reals:
    """Standard deviations of the parameters: what slips and noise in the drives make, or, where it is more, what the
    drives differ by (the jackknife, of three parts at least). A part without which a parameter is far less certain
    alone tells it: what is left says nothing of it."""
    inside = best.deviations
    if len(others) < _FEWEST:
        return inside
    values = np.array([rest.values for rest in others])
    tells = np.array([rest.deviations for rest in others]) < _ALONE * inside
    middle = np.sum(values * tells, axis=0) / np.maximum(1, np.sum(tells, axis=0))
    between = np.sqrt((len(others) - 1) * np.mean(tells * (values - middle) ** 2, axis=0))
    return np.asarray(np.maximum(inside, between))


def _refuse_strangers(best: Fit, drives: Sequence[Drive], each: Each) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    if not _strange(best):
        return
    turned, reversed_ = best.rms[1] > _TURNED, _reversed(best)
    hint = "do log and truth belong to one drive of this robot?"
    for text, other in _readings(drives[:2]):
        other_fit = _fitted(replace(best.problem, drives=other, scale=0.01), each)
        better = reversed_ or other_fit.rms[turned] < _BETTER * best.rms[turned]
        if better and not _strange(other_fit):
            hint = f"they would agree with {text}"
            break
    if reversed_:
        raise UsageError(f"log and truth agree only where {reversed_} has the other sign: {hint}")
    if turned:
        raise UsageError(
            f"whatever the parameters are, headings stay {best.rms[1]:.2g} rad from the truth: {hint}"
        )
    raise UsageError(
        f"whatever the parameters are, positions stay {best.rms[0]:.2g} m from the truth, which extends over "
        f"{_extent(best):.2g} m: {hint}"
    )


def _strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together, or a length had to be negative."""
    return best.rms[0] > _FAR * _extent(best) or best.rms[1] > _TURNED or bool(_reversed(best))


def _reversed(best: Fit) -> str:
    """The parameters whose sign is not that of their nominal value, by far."""
    rows = zip(
        best.problem.increments.parameters, best.problem.nominal, best.values, best.deviations, strict=True
    )
    wrong = [
        name for name, nominal, value, sigma in rows if value * nominal < 0 and abs(value) > _SURE * sigma
    ]
    return " and ".join(wrong)


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
