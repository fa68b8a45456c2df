"""From a robot and its logs to parameters: the fit, what it determines, and a verdict on logs that were left out.

Steps. Read and thin every log. Try each possible number of turns. Fit short legs, which nominal odometry follows, then
whole ones. Cut legs at slips. Leave undetermined clocks and directions nominal. Then leave logs out, fit the others,
and compare odometry on the logs that were left out with nominal odometry.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf

import numpy as np

from wmrgen.analysis.kinematics.forward import disagreement
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import UsageError
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.calls import self_contained
from wmrgen.ir.lower import lower
from wmrgen.tools.calibration import diagnoses, estimator, noise, observability, slips, start, turns
from wmrgen.tools.calibration.errors import drawn, errors
from wmrgen.tools.calibration.estimator import PRIOR, Fit
from wmrgen.tools.calibration.gyro import gyro
from wmrgen.tools.calibration.joint_noise import joint_noise
from wmrgen.tools.calibration.logs import Log, check, thinned
from wmrgen.tools.calibration.model import MOUNT, Problem
from wmrgen.tools.calibration.noise import Covariance, Noise
from wmrgen.tools.calibration.observability import CLOCK, Estimate, groups, split
from wmrgen.tools.calibration.path import Increments, Reals
from wmrgen.tools.calibration.reading import Recording, Source, read, recordings
from wmrgen.tools.calibration.result import Alternative, Calibration, Verdict
from wmrgen.tools.calibration.slips import Slip
from wmrgen.tools.calibration.turns import Hypothesis
from wmrgen.tools.workers import Map, serial

FOLDS = 5  # parts that logs are left out in, one after the other
SHORT = 20.0  # [s] of a leg in the first fit: odometry with parameters 10 % off still follows it
_BRIEF = 6.0  # [s] of a leg in which slips are looked for: a slip is in one of many
_ODDS = 100.0  # to one against a number of turns, above which it is not reported
_ROUNDS = 3  # of cutting slips: a large one hides small ones


@dataclass(frozen=True, slots=True)
class Determined:
    """A fit with its noise, its covariance, and the directions that it leaves open."""

    fit: Fit
    noise: Noise
    covariance: Covariance
    open: Reals  # (S, k) directions that stay nominal
    clocks: Reals  # (logs, 2) [s] offset and deviation of each clock, estimated alone
    slips: tuple[Slip, ...] = ()


def increments_of(derivation: Derivation, gains: Sequence[str] = ()) -> tuple[Increments, Reals]:
    """Return what a robot's `forward` leaves to estimate, and the nominal values.

    Args:
        derivation: The robot's.
        gains: Joints whose readings get an unknown factor.

    Returns:
        The increments, and the nominal value of each unknown. UsageError if there is none.
    """
    derivation = derivation.without_gyro  # it is calibrated by itself, see `gyro`
    robot = derivation.robot
    if not robot.tunable and not gains:
        raise UsageError(
            f"{robot.name} has no tunable parameter, so there is nothing to calibrate. Write one as "
            "radius: {value: 0.0975, tunable: true} under parameters, and use its name in the wheels"
        )
    forward = next(f for f in self_contained(derivation.module) if f.name == "forward")
    rows = disagreement(driving(robot, derivation.mobility)[0])
    joints = [port.name for port in forward.inputs if port.name.endswith((".spin", ".steer"))]
    for joint in gains:
        if joint not in joints:
            raise UsageError(f"{joint} is no measured joint of {robot.name}: there are {', '.join(joints)}")
    increments = Increments.of(forward, None if rows is None else lower(rows), tuple(dict.fromkeys(gains)))
    nominal = {p.name: float(p.nominal) for p in robot.tunable} | {f"{joint}.gain": 1.0 for joint in gains}
    return increments, np.array([nominal[name] for name in increments.parameters])


def counts_per_turn(robot: Robot) -> dict[str, float]:
    """Return counts per turn, negative where a counter runs down, of each ``<wheel>.spin`` that has an encoder."""
    encoders = {f"{w.name}.spin": robot.encoder_of(w, "spin") for w in robot.wheels}
    return {joint: float(encoder.turn) for joint, encoder in encoders.items() if encoder is not None}


def calibrate(
    robot: Robot | Derivation,
    logs: Sequence[Source],
    references: Sequence[Source] = (),
    *,
    one_clock: bool = False,
    mount: tuple[float, float, float] | None = None,
    start_error: float = inf,
    gains: Sequence[str] = (),
    mapped: Map = serial,
) -> Calibration:
    """Estimate the tunable parameters of a robot from logs of drives.

    Args:
        robot: The robot, or its derivation.
        logs: Joint readings of each drive: the path of a CSV file, or a mapping or data frame with the same columns,
            ``t`` [s] and ``<wheel>.angle`` [rad], ``.counts`` or ``.spin`` [rad/s], ``<wheel>.steer`` [rad], and
            ``gyro`` [rad/s] if the robot has one.
        references: Reference poses of each drive, with the columns ``t`` [s] and any of ``x``, ``y`` [m] and ``theta``
            [rad]; by default the files ``NAME.truth.csv`` beside the logs.
        one_clock: Whether each log and its reference poses have the same clock.
        mount: Place x, y [m] and heading [rad] of the tracked body on the robot, if they are known.
        start_error: Standard deviation [m] of each first reference pose, if the robot started at a mark.
        gains: Joints such as ``front.steer`` whose readings have an unknown scale, the parameter ``front.steer.gain``.
        mapped: Where the logs are read: `serial`, or what `pool` or `cluster` of `workers` yields.

    Returns:
        The calibration.

    Raises:
        UsageError: A log cannot be read, or no likely parameters explain the logs.
    """
    if not start_error > 0:
        raise UsageError(f"the deviation of a first pose is {start_error:g} m: it has to be above 0")
    derivation = robot if isinstance(robot, Derivation) else Derivation(robot)
    increments, nominal = increments_of(derivation, gains)
    load = partial(
        _loaded, increments=increments, nominal=nominal, counts=counts_per_turn(derivation.robot),
        gyro=derivation.robot.gyro is not None,
    )  # fmt: skip
    every = tuple(map(check, mapped(load, recordings(logs, references))))
    free = np.eye(len(nominal) + MOUNT)
    problem = Problem(
        increments, nominal, every, tuple(start.whole(log) for log in every), mount=mount or (0.0, 0.0, 0.0),
        start_error=start_error, free=free if mount is None else free[:, :-MOUNT],
        clocks=(not one_clock,) * len(every),
    )  # fmt: skip
    return of_problem(derivation.robot, problem)


def _loaded(
    recording: Recording, increments: Increments, nominal: Reals, counts: Mapping[str, float], gyro: bool
) -> Log:
    """Return a log, read and thinned."""
    return thinned(read(recording, increments.joints, counts, gyro), increments, nominal)


def of_problem(robot: Robot, problem: Problem) -> Calibration:
    """Estimate a robot's parameters from thinned logs."""
    tried = [(settled(begun(replace(problem, logs=h.logs), h.shift)), h) for h in turns.hypotheses(problem)]
    # One scale for all, and the largest: a fit of few poses may meet them by chance, and that is no evidence.
    scale = max(found.fit.problem.scale for found, _ in tried)
    deviances = [_deviance(found.fit, scale) for found, _ in tried]
    found, chosen = tried[int(np.argmin(deviances))]
    diagnoses.refuse(found.fit, problem.logs, partial(_refitted, problem))
    alternatives = _alternatives(tried, deviances, chosen)
    parameters, mount, clocks = _estimates(robot, found)
    count = len(problem.nominal)
    spread = found.fit.problem.units[:count]
    return Calibration(
        found.fit, parameters, mount, clocks, _unobservable(robot, found),
        found.covariance.shared[:count, :count] * spread * spread[:, None], found.noise,
        joint_noise(found.fit, found.noise), gyro(found.fit), found.slips,
        chosen.turns, alternatives, verdict(found),
    )  # fmt: skip


def begun(problem: Problem, shift: Reals | None = None) -> Fit:
    """Return the fit of whole legs, from short ones on.

    Args:
        problem: Logs with headings that count whole turns.
        shift: (P,) units by which the parameters start off nominal.
    """
    count = len(problem.nominal)
    values = problem.nominal.copy() if shift is None else problem.nominal + problem.units[:count] * shift
    problem = _turned(problem, values)
    near = _short(problem, np.concatenate([values, problem.origin[count:]]))
    return estimator.solved(problem, start.begun(problem, near.state.shared, np.zeros(len(problem.logs))))


def _turned(problem: Problem, values: Reals) -> Problem:
    """Return the problem with the heading of the tracked body that displacements show, unless the mount is known."""
    if not problem.free[len(problem.nominal) :].any():
        return problem
    return replace(problem, mount=(0.0, 0.0, start.turned(problem, values)))


def _short(problem: Problem, shared: Reals) -> Fit:
    """Return the fit of short legs, from values of the shared unknowns on."""
    legs = tuple(start.whole(log, SHORT) for log in problem.logs)
    short = replace(problem, legs=legs, clocks=(False,) * len(problem.logs))
    return estimator.near(short, start.begun(short, shared, np.zeros(len(problem.logs))))


def _refitted(problem: Problem, logs: Sequence[Log]) -> Fit:
    """Return the fit of short legs of other readings of the logs."""
    changed = replace(problem, logs=tuple(logs))
    changed = _turned(replace(changed, logs=turns.hypotheses(changed)[-1].logs), problem.nominal)
    return _short(changed, changed.origin)


def settled(fit: Fit) -> Determined:
    """Return the fit without slips, and with everything nominal that the logs do not determine."""
    found: list[Slip] = []
    # Parameters bend around large slips, so that whole legs explain nothing. Brief legs show where it is.
    seen = _in_brief_legs(fit) if diagnoses.misfit(fit) >= 1 else fit
    for _ in range(_ROUNDS):
        new = slips.find(seen, noise.tracks(seen))
        if not new:
            break
        found += [slip for _, slip in new]
        seen = fit = _again(replace(fit.problem, legs=slips.without(fit, new)), seen)
    level = noise.of_fit(fit)
    covariance = noise.covariance(fit, level)
    clocks = np.column_stack([[own[0] for own in fit.state.own], covariance.clocks])
    spread = observability.clock_spread(clocks)
    fit = estimator.minimised(replace(fit.problem, clock_spread=spread), fit.state)
    covariance = noise.covariance(fit, level)
    nominal = split(covariance.shared, fit.problem.free)[1]
    if nominal.shape[1]:
        kept = observability.without(fit.problem.free, nominal)
        weak = groups(fit.problem, fit.problem.increments.parameters, nominal)
        if ("mount.theta",) in weak:  # nothing says how the tracked body is turned
            fit = replace(fit, problem=replace(fit.problem, mount=(0.0, 0.0, 0.0)))
        off = (fit.state.shared - fit.problem.origin) / fit.problem.units
        shared = fit.problem.origin + fit.problem.units * (kept @ (kept.T @ off))
        problem = replace(fit.problem, free=kept)
        fit = _again(problem, replace(fit, state=replace(fit.state, shared=shared)))
        fit = _with_nominal(fit, weak)
        level = noise.of_fit(fit)
        covariance = noise.covariance(fit, level)
    return Determined(
        fit, level, covariance, nominal, clocks, tuple(sorted(found, key=lambda s: (s.log, s.start)))
    )


def _with_nominal(fit: Fit, open_groups: Sequence[Sequence[str]]) -> Fit:
    """Return the fit with each unknown nominal that is alone in its group, or is the only parameter there.

    A direction that stays nominal has small parts of other unknowns too, so the fit may have moved these a little.
    """
    names, shared = [*fit.problem.increments.parameters, *observability.MOUNT], fit.state.shared.copy()
    for group in open_groups:
        parameters = [name for name in group if name not in observability.MOUNT]
        if len(group) == 1 or len(parameters) == 1:
            index = names.index((parameters or group)[0])
            shared[index] = fit.problem.origin[index]
    return estimator.evaluated(fit.problem, replace(fit.state, shared=shared))


def _in_brief_legs(fit: Fit) -> Fit:
    """Return the same legs with parameters that are fitted to brief legs."""
    problem = replace(fit.problem, legs=tuple(start.whole(log, _BRIEF) for log in fit.problem.logs))
    no_clocks = np.zeros(len(problem.logs))
    short = estimator.solved(problem, start.begun(problem, problem.origin, no_clocks))
    clocks = np.array([own[0] for own in short.state.own])
    state = start.begun(fit.problem, short.state.shared, clocks)
    return estimator.evaluated(replace(fit.problem, scale=short.problem.scale), state)


def _again(problem: Problem, fit: Fit) -> Fit:
    """Return the fit of a changed problem, from the shared unknowns of a fit on."""
    clocks = [own[0] if free else 0.0 for own, free in zip(fit.state.own, problem.clocks, strict=True)]
    return estimator.solved(problem, start.begun(problem, fit.state.shared, np.array(clocks)))


def _deviance(fit: Fit, scale: float) -> float:
    """Return minus twice the logarithm of the likelihood at a scale [m], with the whole prior of the parameters."""
    at = estimator.evaluated(replace(fit.problem, scale=scale), fit.state)
    off = (fit.state.shared - fit.problem.origin) / fit.problem.units
    return 2 * at.cost + (1 - PRIOR**2) * float(off @ off)


def _alternatives(
    tried: Sequence[tuple[Determined, Hypothesis]], deviances: Sequence[float], chosen: Hypothesis
) -> tuple[Alternative, ...]:
    result = []
    for (found, hypothesis), deviance in zip(tried, deviances, strict=True):
        odds = float(np.exp(min(0.5 * (deviance - min(deviances)), 99.0)))
        if hypothesis is not chosen and odds < _ODDS:
            names = found.fit.problem.increments.parameters
            values = dict(zip(names, found.fit.state.shared[: len(names)].tolist(), strict=True))
            result.append(Alternative(hypothesis.turns, odds, values))
    return tuple(sorted(result, key=lambda a: a.odds))


def _unobservable(robot: Robot, found: Determined) -> tuple[tuple[str, ...], ...]:
    """Return the groups, and the parameters that `forward` does not have."""
    names = found.fit.problem.increments.parameters
    absent = tuple((p.name,) for p in robot.tunable if p.name not in names)
    return (*groups(found.fit.problem, names, found.open), *absent)


def _estimates(
    robot: Robot, found: Determined
) -> tuple[dict[str, Estimate], dict[str, Estimate], dict[str, Estimate]]:
    """Return parameters, mount and clocks."""
    fit, problem = found.fit, found.fit.problem
    names = (*problem.increments.parameters, "x", "y", "theta")
    weak = {name.removeprefix("mount.") for group in _unobservable(robot, found) for name in group}
    sigmas = np.sqrt(np.diag(found.covariance.shared)) * problem.units
    every = {}
    for name, value, sigma, nominal in zip(names, fit.state.shared, sigmas, problem.origin, strict=True):
        seen = name not in weak
        every[name] = Estimate(float(value), float(sigma) if seen else None, float(nominal), seen)
    parameters = {}
    for p in robot.tunable:
        parameters[p.name] = Estimate(float(p.nominal), None, float(p.nominal), False)
    parameters |= {name: every[name] for name in problem.increments.parameters}
    mount = {name: every[name] for name in ("x", "y", "theta")}
    clocks = {}
    for index, log in enumerate(problem.logs):
        value, sigma = map(float, found.clocks[index])
        sure = problem.clocks[index] and sigma < CLOCK
        clocks[log.name] = Estimate(value if sure else 0.0, sigma if sure else None, 0.0, sure)
    return parameters, mount, clocks


def verdict(found: Determined) -> Verdict | None:
    """Return the verdict on logs that are left out, in at most `FOLDS` folds; of one log its legs are left out."""
    problem, state = found.fit.problem, found.fit.state
    pieces = _pieces(problem)
    count = min(FOLDS, len(pieces))
    if count < 2:
        return None
    nominal, held, blind = [], [], set[str]()
    for fold in range(count):
        inside = pieces[fold::count]
        rest = [piece for piece in pieces if piece not in inside]
        if len(problem.logs) == 1:
            inside, rest = [_joined(inside)], [_joined(rest)]
        other = _part(problem, rest)
        own = tuple(_of_piece(state.own[index], legs) for index, legs in rest)
        fit = estimator.minimised(other, replace(state, own=own))
        _, weak = split(noise.covariance(fit, found.noise).shared, other.free)
        if weak.shape[1]:
            every = groups(other, other.increments.parameters, weak)
            blind |= {name for group in every for name in group}
            continue
        left = _part(problem, inside)
        for k, (index, _) in enumerate(inside):
            clock = float(state.own[index][0])
            nominal.append(drawn(left, k, problem.origin, clock))
            held.append(drawn(left, k, fit.state.shared, clock))
    result = Verdict(errors(nominal), errors(held), count, tuple(sorted(blind)))
    return result if result.held_out.measured else None


def _pieces(problem: Problem) -> list[tuple[int, tuple[int, ...]]]:
    """Return what can be left out: logs, or the legs of a single log, as the number of the log and its legs."""
    if len(problem.logs) > 1:
        return [(index, tuple(range(len(legs)))) for index, legs in enumerate(problem.legs)]
    return [(0, (k,)) for k in range(len(problem.legs[0]))]


def _joined(pieces: Sequence[tuple[int, tuple[int, ...]]]) -> tuple[int, tuple[int, ...]]:
    """Return pieces of one log as one."""
    return pieces[0][0], tuple(leg for _, legs in pieces for leg in legs)


def _of_piece(own: Reals, legs: Sequence[int]) -> Reals:
    """Return a log's clock, and the starts of some of its legs."""
    return np.append(own[0], own[1:].reshape(-1, 3)[list(legs)])


def _part(problem: Problem, pieces: Sequence[tuple[int, tuple[int, ...]]]) -> Problem:
    """Return the problem of some pieces, each as a log."""
    return replace(
        problem,
        logs=tuple(problem.logs[index] for index, _ in pieces),
        legs=tuple(problem.legs[index][list(legs)] for index, legs in pieces),
        clocks=tuple(problem.clocks[index] for index, _ in pieces),
    )
