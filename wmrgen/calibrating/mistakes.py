"""Logs and truths that do not belong together, and which mistake in their columns would explain it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from wmrgen.calibrating.certainty import Fit
from wmrgen.calibrating.logs import Drive
from wmrgen.calibrating.observability import unobservable
from wmrgen.errors import UsageError

_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_TURNED = 0.5  # [rad] the same for headings
_SURE = 3.0  # standard deviations from nominal: a value that is sure to be another
_TIMES = 4.0  # nominal values are nearer than that; units and encoders that are wrong are not
_ABOUT_ZERO = 1.0  # [m, rad] the same for a value that is nominally 0
_BETTER = 0.25  # of the residual: what another reading of the columns has to come to, to be proposed
_LESS = 0.5  # the same where residuals are small, but a length is none that a robot has
_NO_HINT = "do log and truth belong to one drive of this robot?"
_LIKE = 3.0  # times: how well truth and odometry agree on ways and turns, if units are to be right
_APART = 1.0  # [s] rows of truth that ways and turns are measured between
_MOST = 0.9  # of these; the others may be jumps of headings that wrap
_AHEAD = np.pi / 4  # [rad] a tracked body that is turned by less looks ahead
_TURNS = 10  # of a steering angle, which few make

Change = Callable[[Drive], Drive]


def refuse_strangers(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    strange = _strange(best)
    unlikely = _unlikely(best, _SURE if strange else 0.0)
    if not strange and not unlikely:
        return
    hint = _hint(best, drives[:2], fitted)
    if not strange and hint == _NO_HINT:
        return  # a length that these drives do not tell may come out as it likes
    if unlikely:
        raise UsageError(f"log and truth agree only where {unlikely}: {hint}")
    if best.rms[1] > _TURNED:
        raise UsageError(
            f"whatever the parameters are, headings stay {best.rms[1]:.2g} rad from the truth: {hint}"
        )
    raise UsageError(
        f"whatever the parameters are, positions stay {best.rms[0]:.2g} m from the truth, which extends over "
        f"{_extent(best):.2g} m: {hint}"
    )


def _hint(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> str:
    """The reading under which joints and truth agree; of several, as symmetric robots have them, one under which the
    tracked body looks ahead."""
    for name, column in drives[0].columns.items():
        if name.endswith(".steer") and np.max(np.abs(column)) > 2 * np.pi * _TURNS:
            far = np.max(np.abs(column))
            return f"{name} goes as far as {far:.0f} rad: is it in degrees, or exchanged with another?"
    turned, most = best.rms[1] > _TURNED, np.inf if _unlikely(best, _SURE) else _BETTER
    most = most if _strange(best) else _LESS
    hints = []
    for text, change in _readings(best, drives):
        other = fitted([change(drive) for drive in drives])
        if not _strange(other) and other.rms[turned] < most * best.rms[turned]:
            hints.append(f"they would agree with {text}")
            if abs(other.mount[2]) < _AHEAD:
                return hints[-1]
    return hints[0] if hints else _NO_HINT


def _strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together, or a length had to be negative,
    or another length altogether."""
    return best.rms[0] > _FAR * _extent(best) or best.rms[1] > _TURNED or bool(_unlikely(best, _SURE))


def _unlikely(best: Fit, sure: float) -> str:
    """The parameters whose sign is not that of their nominal value, or whose size is far from it, by so many standard
    deviations, in words; an angle from 0 that drives do not tell may come out as it likes."""
    names, weak = best.problem.increments.parameters, {n for group in unobservable(best) for n in group}
    rows = zip(names, best.problem.nominal, best.values, best.deviations, strict=True)
    return " and ".join(
        f"{name} is {value:.3g}, not about {nominal:g}"
        for name, nominal, value, sigma in rows
        if abs(value - nominal) > sure * sigma
        and (
            not 1 / _TIMES < value / nominal < _TIMES
            if nominal
            else abs(value) > _ABOUT_ZERO and name not in weak
        )
    )


def _extent(best: Fit) -> float:
    """How far [m] the truth extends along x or y; 0 where it has headings alone."""
    every = (axis for drive in best.problem.drives for axis in (drive.truth.x, drive.truth.y))
    axes = (axis[np.isfinite(axis)] for axis in every)
    return max((float(np.ptp(axis)) for axis in axes if len(axis)), default=0.0)


def _readings(best: Fit, drives: Sequence[Drive]) -> Iterator[tuple[str, Change]]:
    """Mistakes that users make with columns, in words, and what a drive is without them. Units first, those that ways
    and turns of truth and nominal odometry tell."""
    ratios = _ratios(best, drives)
    for text, change, *expected in _UNITS:
        off = np.array(
            [np.log(r / e) for r, e in zip(ratios, expected, strict=True) if np.isfinite(r) and r > 0]
        )
        if len(off) and np.all(np.abs(off) < np.log(_LIKE)):
            yield text, change
    names = list(drives[0].columns)
    for a, b in combinations([name for name in names if name.endswith(".spin")], 2):
        yield f"the columns of {a} and {b} exchanged", _with_joints({a: (b, 1), b: (a, 1)})
    for name in names:
        if name.endswith(".spin"):
            yield f"{name} counted the other way", _with_joints({name: (name, -1)})
        if name.endswith(".steer"):
            sides = {n: (n, -1) for n in (name, f"{name}_rate") if n in names}
            yield f"{name} counted the other way", _with_joints(sides)
    steers = {name: (name, np.pi / 180) for name in names if ".steer" in name}
    if steers:
        yield "steering angles in radians, which seem to be in degrees", _with_joints(steers)
    yield "theta of the truth counted the other way", _with_truth(theta=-1)
    yield (
        "x and y of the truth exchanged",
        lambda d: replace(d, truth=replace(d.truth, x=d.truth.y, y=d.truth.x)),
    )


def _with_joints(changed: Mapping[str, tuple[str, float]]) -> Change:
    """A drive with each column that is named from another, times a factor."""
    return lambda d: replace(
        d, columns={**d.columns, **{n: f * d.columns[other] for n, (other, f) in changed.items()}}
    )


def _with_truth(place: float = 1, theta: float = 1) -> Change:
    """A drive whose truth is so many times as large."""
    return lambda d: replace(
        d, truth=replace(d.truth, x=place * d.truth.x, y=place * d.truth.y, theta=theta * d.truth.theta)
    )


def _all_joints(factor: float) -> Change:
    """A drive whose joints turn so many times as far."""
    return lambda d: replace(d, columns={name: factor * column for name, column in d.columns.items()})


# What is meant, and how many times as large as those of nominal odometry ways and turns of the truth are then.
_UNITS: tuple[tuple[str, Change, float, float], ...] = (
    (
        "theta of the truth in radians, which seems to be in degrees",
        _with_truth(theta=np.pi / 180),
        1,
        180 / np.pi,
    ),
    ("x and y of the truth in metres, which seem to be in millimetres", _with_truth(place=1e-3), 1000, 1),
    (
        "angles of the joints in radians, which seem to be in degrees",
        _all_joints(np.pi / 180),
        np.pi / 180,
        np.pi / 180,
    ),
    (
        "angles of the joints in radians, which seem to be in turns",
        _all_joints(2 * np.pi),
        2 * np.pi,
        2 * np.pi,
    ),
)


def _ratios(best: Fit, drives: Sequence[Drive]) -> tuple[float, float]:
    """How many times as far as nominal odometry has it the truth goes, and turns; nan where it is not measured, and for
    turns of steered robots, whose angles may be in other units themselves."""
    sums = np.zeros((2, 2))
    for drive in drives:
        step = best.problem.increments(drive.columns, best.problem.nominal)
        rows = np.searchsorted(drive.truth.t, np.arange(drive.truth.t[0], drive.truth.t[-1], _APART))
        place, theta = (drive.truth.x + 1j * drive.truth.y)[rows], drive.truth.theta[rows]
        for k, (true, own) in enumerate(((place, step.position), (theta, step.heading))):
            steps = np.sort(np.abs(np.diff(true[np.isfinite(true)])))
            sums[k] += steps[: int(_MOST * len(steps))].sum(), _MOST * np.abs(own).sum()
    way, turn = (float(true / own) if own else np.nan for true, own in sums)
    steered = any(name.endswith(".steer") for name in best.problem.increments.joints)
    return way, np.nan if steered else turn
