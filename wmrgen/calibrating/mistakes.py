"""Logs and truths that do not belong together, and which mistake in their columns would explain it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from wmrgen.calibrating.certainty import Fit
from wmrgen.calibrating.logs import Drive
from wmrgen.calibrating.observability import unobservable
from wmrgen.calibrating.path import Reals
from wmrgen.calibrating.starts import nominal_at
from wmrgen.errors import UsageError

_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_TURNED = 0.5  # [rad] the same for headings
_LATE = 5.0  # [s] clocks that are farther apart make half of that strange
_SURE = 3.0  # standard deviations from nominal: a value that is sure to be another
_TIMES = 4.0  # nominal values are nearer than that; units and encoders that are wrong are not
_ABOUT_ZERO = 1.0  # [m, rad] the same for a value that is nominally 0
_BETTER = 0.25  # of the residual: what another reading of the columns has to come to, to be proposed
_LESS = 0.5  # the same where residuals are small, but a length is none that a robot has
_NO_HINT = "do log and truth belong to one drive of this robot?"
_SIMILAR = 1.6  # times nominal values, in the median: half the way from inches to centimetres
_APART = 1.0  # [s] rows of truth that ways and turns are measured between
_MOST = 0.9  # of these; the others may be jumps of headings that wrap
_ALIKE = 1.5  # times the least residuals: a mirrored truth is the same as left and right exchanged
_LIKELY = 8  # readings of the columns that are tried: those whose ways and turns are nearest
_FEW = 6  # drives that are tried alone, to say which of them do not agree
_AHEAD = np.pi / 4  # [rad] a tracked body that is turned by less looks ahead
_TURNS = 10  # of a steering angle, which few make
_MIRRORED = "y and theta of the truth counted the other way, as with x north, y east and theta clockwise"

Change = Callable[[Drive], Drive]


def refuse_strangers(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    strange = _strange(best)
    unlikely = _unlikely(best, _SURE if strange else 0.0)
    if not strange and not unlikely:
        return
    hint = _hint_of_some(best, drives, fitted) if strange else _hint(best, drives[:2], fitted)
    if not strange and hint == _NO_HINT:
        return  # a length that these drives do not tell may come out as it likes
    if unlikely:
        raise UsageError(f"log and truth agree only where {unlikely}: {hint}")
    worst = int(np.argmax(_far(best)))
    of = f" of {best.problem.drives[worst].name}" * (len(drives) > 1)
    place, heading = best.apart[worst]
    if heading > _TURNED:
        raise UsageError(
            f"whatever the parameters are, headings{of} stay {heading:.2g} rad from the truth: {hint}"
        )
    raise UsageError(
        f"whatever the parameters are, positions{of} stay {place:.2g} m from the truth, which extends over "
        f"{_extent(best):.2g} m: {hint}"
    )


def _hint_of_some(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> str:
    """The hint of all drives; else of those that do not agree even alone, where others do, or which truths are
    exchanged."""
    by_name: dict[str, list[Drive]] = {}
    for drive in drives:
        by_name.setdefault(drive.name, []).append(drive)
    hint = _hint(best, drives[:2], fitted)
    if hint != _NO_HINT or not 1 < len(by_name) <= _FEW:
        return hint
    for a, b in combinations(range(len(drives)), 2):
        crossed = list(drives)
        crossed[a], crossed[b] = (replace(drives[i], truth=drives[k].truth) for i, k in ((a, b), (b, a)))
        if _agrees(best, fitted(crossed)):
            return f"they would agree with the truths of {drives[a].name} and {drives[b].name} exchanged"
    alone = {name: fitted(parts) for name, parts in by_name.items()}
    names = [name for name in by_name if _strange(alone[name])]
    if not 0 < len(names) < len(by_name):
        return hint
    hint = _hint(alone[names[0]], by_name[names[0]][:2], fitted)
    return f"the others agree without {' and '.join(names)}: {hint}"


def _hint(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> str:
    """The reading under which joints and truth agree, or two that are alike; of several, as symmetric robots have
    them, those under which the tracked body looks ahead."""
    if still := _still(drives):
        return still
    for name, column in drives[0].columns.items():
        if name.endswith(".steer") and np.max(np.abs(column)) > 2 * np.pi * _TURNS:
            far = np.max(np.abs(column))
            return f"{name} goes as far as {far:.0f} rad: is it in degrees, or exchanged with another?"
    turned, agree, far = best.rms[1] > _TURNED, list[tuple[str, Fit]](), np.inf
    for text, change, apart in _likely(best, drives):
        if apart > far:
            break
        other = fitted([change(drive) for drive in drives])
        if _agrees(best, other):
            agree.append((text, other))
            far = min(far, _ALIKE * apart if abs(other.mount[2]) < _AHEAD else np.inf)
    ahead = [(text, other) for text, other in agree if abs(other.mount[2]) < _AHEAD] or agree[:1]
    if ahead:
        least = min(other.rms[turned] for _, other in ahead)
        alike = [text for text, other in ahead if other.rms[turned] < _ALIKE * least]
        return f"they would agree with {', or with '.join(alike[:2])}"
    farther = _farther(best, drives)
    if np.isnan(farther) or not _agrees(best, fitted([_all_spins(farther)(drive) for drive in drives])):
        return _NO_HINT
    return (
        f"they would agree with wheels that turn {farther:.3g} times as far: are these counts of an encoder, about "
        f"{2 * np.pi / farther:.0f} to a turn, or is a gear another?"
    )


def _agrees(best: Fit, other: Fit) -> bool:
    """Whether another reading of the columns explains the truth, and far better, by parameters near nominal ones."""
    turned, most = best.rms[1] > _TURNED, np.inf if _unlikely(best, _SURE) else _BETTER
    most = most if _strange(best) else _LESS
    return not _strange(other) and _usual(other) and other.rms[turned] < most * best.rms[turned]


def _still(drives: Sequence[Drive]) -> str:
    """Which column never changes, in words, where that is one that has to."""
    drive = drives[0]
    turns = {name: column for name, column in drive.columns.items() if not name.endswith(".steer_rate")}
    moving = [name for name, column in turns.items() if np.ptp(column) or column.any()]
    for name in turns:
        if name not in moving:
            return f"{name} of {drive.name} is 0 from the first reading to the last: is it the column of that joint?"
    for name in ("x", "y", "theta"):
        column = getattr(drive.truth, name)
        if np.isfinite(column).sum() > 1 and np.nanmax(column) == np.nanmin(column):
            return f"{name} of the truth never changes in {drive.name}: leave its cells empty if it was not measured"
    return ""


def _strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together, or a length had to be negative,
    or another length altogether."""
    return bool(np.max(_far(best)) > 1 or _unlikely(best, _SURE))


def _far(best: Fit) -> Reals:
    """How far joints and truth of each drive stay apart; above 1 they do not belong together."""
    places, headings = best.apart.T
    late = np.abs(best.offsets) > _LATE
    return np.asarray(np.maximum(places / max(_FAR * _extent(best), 1e-9), headings / _TURNED) * (1 + late))


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


def _usual(best: Fit) -> bool:
    """Whether parameters are about as large as nominal ones: else the unit is another."""
    rows = zip(best.values, best.problem.nominal, strict=True)
    sizes = [abs(np.log(abs(value / nominal))) for value, nominal in rows if nominal and value]
    return not sizes or bool(np.median(sizes) < np.log(_SIMILAR))


def _likely(best: Fit, drives: Sequence[Drive]) -> list[tuple[str, Change, float]]:
    """The `_readings` under which ways and turns of truth and nominal odometry are nearest, nearest first, and how far
    they are apart."""
    every = _readings(best, drives)
    apart = ((text, change, sum(_apart(best, change(drive)) for drive in drives)) for text, change in every)
    return sorted(apart, key=lambda reading: reading[2])[:_LIKELY]


def _apart(best: Fit, drive: Drive) -> float:
    """What share of the ways, and of the turns, truth and nominal odometry differ by: between 0 and 2."""
    result = 0.0
    for true, own in _moves(best, drive):
        sizes = np.sort(np.abs(true - own))[: int(_MOST * len(true))]
        whole = np.sum(np.abs(true) + np.abs(own))
        result += float(sizes.sum() / whole) if whole else 0.0
    return result


def _moves(best: Fit, drive: Drive) -> tuple[tuple[Reals, Reals], tuple[Reals, Reals]]:
    """Ways [m] in steps of about a second, of the truth and of nominal odometry; and turns [rad], less whole ones."""
    truth = drive.truth
    rows = np.unique(np.searchsorted(truth.t, np.arange(truth.t[0], truth.t[-1], _APART)))
    place, heading = nominal_at(best.problem, drive)
    pairs = ((truth.x + 1j * truth.y, place), (np.exp(1j * truth.theta), np.exp(1j * heading)))
    ways, turns = (np.array([values[rows] for values in pair]) for pair in pairs)
    ways, turns = np.abs(np.diff(ways)), np.angle(turns[:, 1:] / turns[:, :-1])
    ways, turns = (steps[:, np.isfinite(steps).all(axis=0)] for steps in (ways, turns))
    return (ways[0], ways[1]), (turns[0], turns[1])


def _readings(best: Fit, drives: Sequence[Drive]) -> Iterator[tuple[str, Change]]:
    """Mistakes that users make with columns, in words, and what a drive is without them."""
    names = list(drives[0].columns)
    spins = [name for name in names if name.endswith(".spin")]
    steers = [name for name in names if name.endswith(".steer")]
    for a, b in [*combinations(spins, 2), *combinations(steers, 2)]:
        ends = [name.removeprefix(a) for name in names if name.startswith(a)]
        both = {f"{c}{end}": (f"{d}{end}", 1.0) for c, d in ((a, b), (b, a)) for end in ends}
        yield f"the columns of {a} and {b} exchanged", _with_joints(both)
    for name in spins:
        yield f"{name} counted the other way", _with_joints({name: (name, -1)})
    if len(spins) > 1:
        yield "every wheel counted the other way", _scaled(spins, -1)
    for name in steers:
        yield f"{name} counted the other way", _scaled([n for n in names if n.startswith(name)], -1)
    if len(steers) > 1:
        yield "every steering angle counted the other way", _scaled([n for n in names if ".steer" in n], -1)
    yield "theta of the truth counted the other way", _with_truth(theta=-1)
    yield (
        "x and y of the truth exchanged, or one of them counted the other way",
        lambda d: replace(d, truth=replace(d.truth, x=d.truth.y, y=d.truth.x)),
    )
    yield _MIRRORED, lambda d: replace(d, truth=replace(d.truth, y=-d.truth.y, theta=-d.truth.theta))
    for unit, size in (("millimetres", 1e-3), ("centimetres", 1e-2), ("inches", 0.0254)):
        yield f"x and y of the truth in metres, which seem to be in {unit}", _with_truth(place=size)
    counts = f", or counts of an encoder, about {2 * np.pi / _farther(best, drives):.0f} to a turn"
    for unit, size, more in (("degrees", np.pi / 180, counts), ("turns", 2 * np.pi, "")):
        yield f"theta of the truth in radians, which seems to be in {unit}", _with_truth(theta=size)
        yield f"angles of the wheels in radians, which seem to be in {unit}{more}", _scaled(spins, size)
        if steers:
            angles = [name for name in names if ".steer" in name]
            yield f"steering angles in radians, which seem to be in {unit}", _scaled(angles, size)
            yield f"angles of the joints in radians, which seem to be in {unit}", _scaled(names, size)
    yield "speeds of the wheels in rad/s, which seem to be in rpm", _scaled(spins, 2 * np.pi / 60)
    yield (
        "angles of the wheels in columns that are called <wheel>.spin, and should be <wheel>.angle",
        lambda d: replace(d, columns={**d.columns, **{n: _turned(d, n) for n in spins}}),
    )
    yield "times of the truth that last as long as the log: which t is not in seconds?", _as_long


def _farther(best: Fit, drives: Sequence[Drive]) -> float:
    """How many times as far as nominal odometry has it the truth goes; nan where that is not measured."""
    true = sum(float(np.sum(_moves(best, drive)[0][0])) for drive in drives)
    own = sum(
        float(np.sum(np.abs(best.problem.increments(d.columns, best.problem.nominal).position)))
        for d in drives
    )
    return true / own if true and own else np.nan


def _all_spins(factor: float) -> Change:
    """A drive whose wheels turn so many times as far."""
    return lambda d: _scaled([name for name in d.columns if name.endswith(".spin")], factor)(d)


def _turned(drive: Drive, spin: str) -> Reals:
    """Increments of angles that were read for speeds."""
    return np.diff(drive.columns[spin] / np.diff(drive.t), prepend=0.0)


def _as_long(drive: Drive) -> Drive:
    """A drive whose truth begins and ends with the log."""
    t, at = drive.t, drive.truth.t
    return replace(
        drive, truth=replace(drive.truth, t=t[0] + (at - at[0]) * ((t[-1] - t[0]) / (at[-1] - at[0])))
    )


def _with_joints(changed: Mapping[str, tuple[str, float]]) -> Change:
    """A drive with each column that is named from another, times a factor."""
    return lambda d: replace(
        d, columns={**d.columns, **{n: f * d.columns[other] for n, (other, f) in changed.items()}}
    )


def _scaled(names: Sequence[str], factor: float) -> Change:
    """A drive whose joints ``names`` turn so many times as far."""
    return _with_joints({name: (name, factor) for name in names})


def _with_truth(place: float = 1, theta: float = 1) -> Change:
    """A drive whose truth is so many times as large."""
    return lambda d: replace(
        d, truth=replace(d.truth, x=place * d.truth.x, y=place * d.truth.y, theta=theta * d.truth.theta)
    )
