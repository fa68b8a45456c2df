"""Mistakes in logs that users make, and logs that no parameters explain.

If the residuals of a fit are large compared to the extent of the drives, the fit is refused. Then each rule reads the
logs as if one mistake had been made. If the logs agree under a rule, the refusal names the mistake. Else it has only
figures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.tools.calibration.estimator import Fit
from wmrgen.tools.calibration.logs import Log, Poses
from wmrgen.tools.calibration.model import LEVER

_FAR = 0.05  # of the extent of a drive: the worst of 77 OptiOdom sets comes to 0.036, without one of its drives 0.047
_TURNED = (
    0.25  # [rad] of headings: the worst of 77 OptiOdom sets comes to 0.13, without one of its drives 0.15
)
_MOST = 90  # percent of residuals that are at most so large: the others may be glitches of a tracker
_EXTENT = 0.5  # [m] that drives count for at least: a robot on the spot moves by a tracker's noise
_TIMES = 2.0  # times a nominal length, or half of it: no tape measure is so wrong
_BETTER = 0.5  # of the residuals: another reading must reach this, if parameters are likely
_EQUAL = 1.2  # times residuals: readings that are as good
_LOGS = 3  # that other readings are tried on: each takes a fit

Change = Callable[[Log], Log]


@dataclass(frozen=True, slots=True)
class Rule:
    """One kind of mistake."""

    code: str
    readings: Callable[[Log], Iterator[tuple[str, Change]]]  # in words, and the log without the mistake
    witness: str  # the real log or the report that needs the rule


def _columns(log: Log, changed: dict[str, tuple[str, float]]) -> Log:
    """Return the log with each column that is named from another one, times a factor."""
    return replace(log, columns={**log.columns, **{n: f * log.columns[o] for n, (o, f) in changed.items()}})


def _reference(log: Log, x: float = 1.0, y: float = 1.0, theta: float = 1.0) -> Log:
    """Return the log with other units of the reference."""
    poses = log.poses
    return replace(log, poses=Poses(poses.t, x * poses.x, y * poses.y, theta * poses.theta))


def _wheels(log: Log, ending: str = ".spin") -> list[str]:
    return [name for name in log.columns if name.endswith(ending)]


def _exchanged(log: Log) -> Iterator[tuple[str, Change]]:
    for a, b in combinations(_wheels(log), 2):
        one, other = a.removesuffix("spin"), b.removesuffix("spin")
        ends = [name.removeprefix(one) for name in log.columns if name.startswith(one)]
        both = {f"{c}{end}": (f"{d}{end}", 1.0) for c, d in ((one, other), (other, one)) for end in ends}
        yield (
            f"the columns of {one[:-1]} and {other[:-1]} are exchanged",
            partial(_columns, changed=both),
        )


def _backwards(log: Log) -> Iterator[tuple[str, Change]]:
    spins = _wheels(log)
    for name in spins:
        yield f"{name} counts the other way", partial(_columns, changed={name: (name, -1.0)})
    if len(spins) > 1:
        every = {name: (name, -1.0) for name in spins}
        yield "all wheels count the other way", partial(_columns, changed=every)


def _steering(log: Log) -> Iterator[tuple[str, Change]]:
    columns = [*_wheels(log, ".steer"), *_wheels(log, ".steer_rate")]
    if columns:
        for words, factor in (("count the other way", -1.0), ("are in degrees", np.pi / 180)):
            every = {name: (name, factor) for name in columns}
            yield f"steering angles {words}", partial(_columns, changed=every)


def _wheel_units(log: Log) -> Iterator[tuple[str, Change]]:
    for unit, factor in (("degrees", np.pi / 180), ("turns", 2 * np.pi), ("rpm", 2 * np.pi / 60)):
        every = {name: (name, factor) for name in _wheels(log)}
        yield f"wheels are in {unit}, not in radians", partial(_columns, changed=every)


def _lengths(log: Log) -> Iterator[tuple[str, Change]]:
    del log
    for unit, size in (("millimetres", 1e-3), ("centimetres", 1e-2), ("inches", 0.0254), ("feet", 0.3048)):
        words = f"x and y of the reference are in {unit}, not in metres"
        yield words, partial(_reference, x=size, y=size)


def _degrees(log: Log) -> Iterator[tuple[str, Change]]:
    del log
    words = "theta of the reference is in degrees, not in radians"
    yield words, partial(_reference, theta=np.pi / 180)


def _mirrored(log: Log) -> Iterator[tuple[str, Change]]:
    del log
    yield "theta of the reference counts clockwise", partial(_reference, theta=-1.0)
    words = "the reference has x north, y east and theta clockwise"
    yield words, partial(_reference, y=-1.0, theta=-1.0)


RULES = (
    Rule("wheels-exchanged", _exchanged, "sonyccd/roboclaw_ros, pull request 18: encoders passed as right, left"),
    Rule("wheel-backwards", _backwards, "OptiOdom's mecanum robot: encoders 2 and 4 count backwards"),
    Rule("steering-sign", _steering, "OptiOdom's tricycle: its README in our copy has ticks, its logs have radians"),
    Rule("wheel-unit", _wheel_units, "OptiOdom's mecanum logs: wheels in turns"),
    Rule("reference-length", _lengths, "JdeRobot/base, issue 674: a pose in millimetres"),
    Rule("reference-degrees", _degrees, "Mechanical-Advantage/AdvantageScope, issue 34: headings in the other unit"),
    Rule("reference-mirrored", _mirrored, "OkapiLib's OdomState: y to the right, theta clockwise"),
)  # fmt: skip


def misfit(fit: Fit) -> float:
    """Return the residuals of the worst log, relative to their limits; a fit above 1 is refused.

    The limit of places is a share of the extent of the drive. Headings have a limit of their own.
    """
    worst = 0.0
    for log, one in zip(fit.problem.logs, fit.rows, strict=True):
        extent = max([_EXTENT, *(float(np.ptp(axis[np.isfinite(axis)])) for axis in _axes(log))])
        parts = ((slice(0, 2), _FAR * extent), (slice(2, 3), LEVER * _TURNED))
        for part, limit in parts:
            sizes = np.abs(one.values[part][one.weights[part] > 0])
            if len(sizes):
                worst = max(worst, float(np.percentile(sizes, _MOST)) / limit)
    return worst


def _axes(log: Log) -> list[np.ndarray]:
    return [axis for axis in (log.poses.x, log.poses.y) if np.isfinite(axis).any()]


def unlikely(fit: Fit) -> list[str]:
    """Return the parameters that came out with another sign than nominal, or as another length altogether."""
    result = []
    values = fit.state.shared[: len(fit.problem.nominal)]
    for name, value, nominal in zip(
        fit.problem.increments.parameters, values, fit.problem.nominal, strict=True
    ):
        if nominal and not 1 / _TIMES < value / nominal < _TIMES:
            result.append(f"{name} would be {value:.3g} in place of {nominal:.3g}")
    return result


def refuse(fit: Fit, every: Sequence[Log], fitted: Callable[[Sequence[Log]], Fit]) -> None:
    """Raise UsageError for logs that no likely parameters explain.

    Args:
        fit: The estimate.
        every: The logs as they were read, before turns were counted by odometry that may be wrong.
        fitted: Fits short stretches of other readings of the logs.
    """
    far, odd = misfit(fit), unlikely(fit)
    if far < 1 and not odd:
        return
    logs = every[:_LOGS]
    # Odd parameters may fit as well as likely ones: exchanged wheels are a mirror image.
    limit = (_EQUAL if odd else _BETTER) * _size(fitted(logs))
    found = list[tuple[float, str]]()
    for rule in RULES:
        for words, change in rule.readings(logs[0]):
            other = fitted([change(log) for log in logs])
            if not unlikely(other) and misfit(other) < 1 and _size(other) < limit:
                found.append((_size(other), words))
    best = [words for size, words in found if size < _EQUAL * min(found)[0]]
    figures = "; ".join(odd) or f"odometry stays {_size(fit):.2g} m off"
    hint = " Do log and reference belong to one drive of this robot?"
    if best:
        hint = f" They would agree if {', or if '.join(best)}."
    elif apart := _contradiction([fitted([log]) for log in logs]):
        hint = f" Each drive alone agrees with the robot, but they contradict each other: {apart}."
    raise UsageError(f"no likely parameter values explain these logs: {figures}.{hint}")


def _contradiction(alone: Sequence[Fit]) -> str:
    """Return the parameter that differs most between drives, in words; empty if some drive alone does not fit either.

    Args:
        alone: A fit of each drive.
    """
    if len(alone) < 2 or any(misfit(fit) >= 1 or unlikely(fit) for fit in alone):
        return ""
    problem = alone[0].problem
    count = len(problem.nominal)
    values = np.array([fit.state.shared[:count] for fit in alone])
    most = int(np.argmax(np.ptp(values, axis=0) / problem.units[:count]))
    each = [
        f"{value:.4g} by {fit.problem.logs[0].name}"
        for value, fit in zip(values[:, most], alone, strict=True)
    ]
    return f"{problem.increments.parameters[most]} is {', '.join(each)}"


def _size(fit: Fit) -> float:
    """Return the root mean square of all residuals [m], headings as arcs at the lever."""
    sizes = fit.residuals
    return float(np.sqrt(np.mean(sizes**2))) if len(sizes) else 0.0
