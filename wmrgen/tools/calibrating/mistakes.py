"""Logs and truths that do not belong together, and which mistake in their columns explains it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.tools.calibrating.certainty import Fit, fit, of_drives
from wmrgen.tools.calibrating.fit import Each, Problem
from wmrgen.tools.calibrating.joints import astray
from wmrgen.tools.calibrating.logs import Drive
from wmrgen.tools.calibrating.observability import unobservable
from wmrgen.tools.calibrating.outliers import STRANGE
from wmrgen.tools.calibrating.path import Reals
from wmrgen.tools.calibrating.readings import Change, counts, readings
from wmrgen.tools.calibrating.starts import nominal_at

_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_SPARSE = 12  # rows of a truth: fewer do not say how far a drive goes, nor which of two readings is right
_SPOT = 0.5  # [m] which it counts for at least: of a robot that turns on the spot it is a tracker's noise
_MANY = 1e6  # times as far as odometry has it no drive goes, in whatever unit its wheels are counted
_TURNED = 0.5  # [rad] the same for headings
_SURE = 3.0  # standard deviations from nominal: a value that is sure to be another
_TIMES = 3.0  # nominal values are nearer than that; units and encoders that are wrong are not
_UNTOLD = 1.5  # the same of a value that the drives do not tell: five standard deviations of the prior
_ABOUT_ZERO = 1.0  # [m, rad] the same for a value that is nominally 0
_BETTER = 0.25  # of the residual: what another reading of the columns has to come to, to be proposed
_LESS = 0.5  # the same where residuals are small, but a length is none that a robot has
_NO_HINT = "do log and truth belong to one drive of this robot?"
_SIMILAR = 1.3  # times nominal values, in the median: less than half the way from turns to metres at the rim
_APART = 1.0  # [s] rows of truth that ways and turns are measured between
_MOST = 0.9  # of these; the others may be jumps of headings that wrap
_ALIKE = 1.5  # times the least residuals: a mirrored truth is the same as left and right exchanged
_LIKELY = 8  # readings of the columns that are tried: those whose ways and turns are nearest
_FEW = 6  # drives that are tried alone, to say which of them do not agree
_AHEAD = np.pi / 4  # [rad] a tracked body that is turned by less looks ahead
_TURNS = 10  # of a steering angle, which few make

Fitted = Callable[[Sequence[Drive]], Fit]


def refuse_strangers(best: Fit, drives: Sequence[Drive], fitted: Fitted) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    apart = strange(best)
    unlikely = _unlikely(best, _SURE if apart else 0.0)
    if not apart and not unlikely and not _doubtful(best.problem):
        return
    hint = _hint_of_some(best, drives, fitted) if apart else _hint(best, drives[:2], fitted)
    if not apart and hint == _NO_HINT:
        return  # a length that these drives do not tell may come out as it likes
    if unlikely or not apart:
        raise UsageError(f"log and truth agree only {f'where {unlikely}' if unlikely else 'roughly'}: {hint}")
    worst = int(np.argmax(_far(best)))
    of = f" of {best.problem.drives[worst].name}" * (len(drives) > 1)
    place, heading = best.rms_by_drive[worst]
    stay = (
        f"positions{of} stay {place:.2g} m from the truth, of drives that extend over {_extent(best):.2g} m"
    )
    if heading > _TURNED:
        stay = f"headings{of} stay {heading:.2g} rad from the truth"
    raise UsageError(f"whatever the parameters are, {stay}: {hint}")


def _doubtful(problem: Problem) -> bool:
    """Whether parameters were held at nominal values, and poses are many enough to tell another reading by."""
    return problem.held is not None and any(d.truth.measured >= _SPARSE for d in problem.drives)


def refuse_unsettled(best: Fit, first: Fit) -> None:
    """UsageError where the ``best`` fit, in which joints tell what the truth does not, is lost from the ``first`` one
    on, whose parameters alone bring joints and truth together."""
    if (strange(best) or astray(best, first)) and (unlikely := _unlikely(first, 0.0, anyway=True)):
        raise UsageError(f"log and truth agree only where {unlikely}: {_NO_HINT}")


def _hint_of_some(best: Fit, drives: Sequence[Drive], fitted: Fitted) -> str:
    """The hint of all drives; else of those that do not agree, where the others do, or which truths are exchanged."""
    far, two, hint = _by_name(best), drives[:2], _NO_HINT
    if len(drives) == 2 and (exchanged := _exchanged(best, drives, drives, fitted)):
        return exchanged  # columns that are read another way agree about, too
    if len(two) == len(drives) or strange(fitted(two)):  # else they agree under what changes nothing
        hint = _hint(best, two, fitted)
    if hint != _NO_HINT or len(far) == 1:
        return hint
    names = [name for name, size in far.items() if size > 1]
    others = [drive for drive in drives if drive.name not in names]
    if not 0 < 2 * len(names) < len(far) or strange(fitted(others)):  # what is wrong draws others off
        few = far if len(far) <= _FEW else ()
        names = [name for name in few if strange(fitted([drive for drive in drives if drive.name == name]))]
    some = [drive for drive in drives if drive.name in names]
    if len(drives) > 2 and len(some) <= _FEW and (exchanged := _exchanged(best, some, drives, fitted)):
        return exchanged
    if not 0 < len(names) < len(far):
        return hint
    alone = fitted([drive for drive in some if drive.name == some[0].name])
    return f"the others agree without {' and '.join(names)}: {_hint(alone, some[:2], fitted)}"


def _exchanged(best: Fit, some: Sequence[Drive], drives: Sequence[Drive], fitted: Fitted) -> str:
    """Which two of ``some`` of the drives would agree with their truths exchanged, in words."""
    for a, b in combinations(some, 2):
        rest = [drive for drive in drives if drive.name not in (a.name, b.name)]
        if _agrees(best, fitted([replace(a, truth=b.truth), replace(b, truth=a.truth), *rest])):
            return f"they would agree with the truths of {a.name} and {b.name} exchanged"
    return ""


def _by_name(best: Fit) -> dict[str, float]:
    """How `_far` joints and truth of each drive stay apart, in the worst of its parts."""
    far: dict[str, float] = {}
    for drive, size in zip(best.problem.drives, _far(best), strict=True):
        far[drive.name] = max(far.get(drive.name, 0.0), float(size))
    return far


def _hint(best: Fit, drives: Sequence[Drive], fitted: Fitted) -> str:
    """What is odd in the columns, or how they would have to be read for joints and truth to agree."""
    if odd := _odd(drives[0]):
        return odd
    farther = _farther(best, drives)
    alike = _alike(best, drives, fitted, farther)
    if not alike and farther > 0:
        text, change = counts(drives[0], farther)
        alike = [text] if _agrees(best, fitted([change(drive) for drive in drives])) else []
    return f"they would agree with {', or with '.join(alike)}" if alike else _NO_HINT


def _alike(best: Fit, drives: Sequence[Drive], fitted: Fitted, farther: float) -> list[str]:
    """The reading under which joints and truth agree, or two that are alike; of several, as symmetric robots have
    them, those under which the tracked body looks ahead."""
    agree, most = list[tuple[str, float, bool]](), np.inf
    for text, change, differ in _likely(best, drives, farther):
        if differ > most:
            break
        other = fitted([change(drive) for drive in drives])
        if _agrees(best, other):
            ahead = abs(other.mount[2]) < _AHEAD
            agree.append((text, _share(best, other), ahead))
            most = min(most, _ALIKE * differ) if ahead else most
    likely = [reading for reading in agree if reading[2]] or agree[:1]
    least = min((share for _, share, _ in likely), default=0.0)
    return [text for text, share, _ in likely if share < _ALIKE * least][:2]


def _agrees(best: Fit, other: Fit) -> bool:
    """Whether another reading of the columns explains the truth, and far better, by parameters near nominal ones."""
    if best.problem.held is not None and _unlikely(other, 0.0):
        return False  # there parameters ran off, too
    most = np.inf if _unlikely(best, _SURE) else _BETTER if strange(best) else _LESS
    return not strange(other) and _usual(other) and _share(best, other) < most


def _share(best: Fit, other: Fit) -> float:
    """What residuals of the other fit are of those of the best: of headings, where these are far off or nothing else
    is measured, else of positions."""
    kind = int(best.rms[1] > _TURNED or np.isnan(best.rms[0]))
    return float(other.rms[kind] / best.rms[kind])


def _odd(drive: Drive) -> str:
    """Which column never changes though it has to, or goes as far as no joint does, in words."""
    for name, column in drive.columns.items():
        if not (name.endswith(".steer_rate") or column.any()):
            return f"{name} of {drive.name} is 0 from the first reading to the last: is it the column of that joint?"
    for name in ("x", "y", "theta"):
        column = getattr(drive.truth, name)
        if np.isfinite(column).sum() > 1 and np.nanmax(column) == np.nanmin(column):
            return f"{name} of the truth never changes in {drive.name}: leave its cells empty if it was not measured"
    for name, column in drive.columns.items():
        far = np.max(np.abs(column))
        if name.endswith(".steer") and far > 2 * np.pi * _TURNS:
            return f"{name} goes as far as {far:.0f} rad: is it in degrees, or exchanged with another?"
    return ""


def strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together, or a length had to be negative,
    or another length altogether."""
    return bool(np.max(_far(best)) > 1 or _unlikely(best, _SURE))


def _far(best: Fit) -> Reals:
    """How far joints and truth of each drive stay apart; above 1 they do not belong together."""
    places, headings = np.nan_to_num(best.rms_by_drive).T
    late = np.abs(best.offsets) > STRANGE  # makes half of that strange
    return np.asarray(
        np.maximum(places / (_FAR * max(_extent(best), _SPOT)), headings / _TURNED) * (1 + late)
    )


def _unlikely(best: Fit, sure: float, anyway: bool = False) -> str:
    """The parameters whose sign is not that of their nominal value, or whose size is far from it, by so many standard
    deviations, in words; an angle from 0 that drives do not tell may come out as it likes, but where ``anyway``."""
    names, weak = best.problem.increments.parameters, {n for group in unobservable(best) for n in group}
    rows = zip(names, best.problem.nominal, best.values, best.deviations, strict=True)
    return " and ".join(
        f"{name} is {value:.3g}, not about {nominal:g}"
        for name, nominal, value, sigma in rows
        if abs(value - nominal) > sure * sigma
        and unlike(value, nominal, _TIMES, _ABOUT_ZERO)
        and (nominal or anyway or name not in weak)
    )


def unlike(value: float, nominal: float, times: float, zero: float) -> bool:
    """Whether a value is of another sign than the nominal one, or so many times as large or as small; where that is 0,
    whether it is larger than ``zero`` [m, rad]."""
    return not 1 / times < value / nominal < times if nominal else abs(value) > zero


def near_nominal(best: Fit, coarser: Callable[[Problem], Problem], each: Each) -> Fit:
    """The fit where parameters that ran off together stay nominal along their ways, if that explains the truth, too:
    odometry of a robot that turns on the spot goes only where slips take it, so least errors have all lengths 0. A
    ``coarser`` problem does for this."""
    if not _ran_off(best):
        return best
    near, count = replace(best, problem=coarser(best.problem)), len(best.values)
    held = np.empty((count, 0))
    while _ran_off(near) and held.shape[1] < count:
        way = near.unknowns[:count] - held @ held.T @ near.unknowns[:count]
        held = np.column_stack([held, way / np.linalg.norm(way)])
        start = np.concatenate([np.zeros(count), near.unknowns[count:]])
        near = fit(replace(near.problem, held=held), each, start)
    return best if strange(near) else of_drives(near, best.problem.drives)


def _ran_off(best: Fit) -> bool:
    """Whether a parameter is far from its nominal value; one that the drives do not tell, where nobody measures so."""
    rows = zip(best.values, best.problem.nominal, strict=True)
    by_name = dict(zip(best.problem.increments.parameters, rows, strict=True))
    untold = [by_name[name] for group in unobservable(best) for name in group]
    odd = any(nominal and unlike(value, nominal, _UNTOLD, 0.0) for value, nominal in untold)
    return odd or bool(_unlikely(best, 0.0))


def _extent(best: Fit) -> float:
    """How far [m] the truth extends along x or y, or nominal odometry between the few places that the truth has, as
    start and end of a drive; 0 where it has headings alone."""
    every = list[Reals]()
    for drive in best.problem.drives:
        axes = [axis[np.isfinite(axis)] for axis in (drive.truth.x, drive.truth.y)]
        every += axes
        if 0 < max(map(len, axes)) < _SPARSE:
            place, _ = nominal_at(best.problem, drive, drive.t)
            every += [place.real, place.imag]
    return max((float(np.ptp(axis)) for axis in every if len(axis)), default=0.0)


def _usual(best: Fit) -> bool:
    """Whether parameters are about as large as nominal ones: else the unit is another."""
    rows = zip(best.values, best.problem.nominal, strict=True)
    sizes = [abs(np.log(abs(value / nominal))) for value, nominal in rows if nominal and value]
    return not sizes or bool(np.median(sizes) < np.log(_SIMILAR))


def _likely(best: Fit, drives: Sequence[Drive], farther: float) -> list[tuple[str, Change, float]]:
    """The `readings` under which ways and turns of truth and nominal odometry differ least, the least first, and by
    how much."""
    every = readings(drives[0], farther)
    differ = ((text, change, sum(_differ(best, change(drive)) for drive in drives)) for text, change in every)
    return sorted(differ, key=lambda reading: reading[2])[:_LIKELY]


def _differ(best: Fit, drive: Drive) -> float:
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
    place, heading = nominal_at(best.problem, drive, truth.t)
    pairs = ((truth.x + 1j * truth.y, place), (np.exp(1j * truth.theta), np.exp(1j * heading)))
    ways, turns = (np.array([values[rows] for values in pair]) for pair in pairs)
    ways, turns = np.abs(np.diff(ways)), np.angle(turns[:, 1:] / turns[:, :-1])
    ways, turns = (steps[:, np.isfinite(steps).all(axis=0)] for steps in (ways, turns))
    return (ways[0], ways[1]), (turns[0], turns[1])


def _farther(best: Fit, drives: Sequence[Drive]) -> float:
    """How many times as far as nominal odometry has it the truth goes; nan where that is not measured or it stands."""
    true = own = 0.0
    for drive in drives:
        measured = (drive.t[:-1] >= drive.truth.t[0]) & (drive.t[1:] <= drive.truth.t[-1])
        steps = best.problem.increments(drive.columns, best.problem.nominal)
        true += float(np.sum(_moves(best, drive)[0][0]))
        own += float(np.sum(np.abs(steps.position[measured])))
    return true / own if own < _MANY * true < _MANY**2 * own else np.nan
