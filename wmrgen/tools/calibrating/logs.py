"""Logs of drives: joint readings by time, and where the robot was; CSV files with a header, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wmrgen.errors import UsageError
from wmrgen.tools.calibrating.path import Reals
from wmrgen.tools.calibrating.tables import table_of, times_of, without_other_headings

_GAP = 20.0  # times the median step: during a longer one nobody knows how the robot moved
_MOSTLY = 75  # percent of the steps; a fast wheel that wraps makes a jump of every sixth or so
_JUMP = 3.0  # [rad] in one step, where ten times less is usual: a reading that wrapped
_WRAPS = 6.4  # [rad] steering angles that wrap lie within one turn
_STANDS = (1.0, 0.02)  # [s], [rad]
_TRUTH = ("x", "y", "theta")
_SECONDS = {"milliseconds": 1e3, "microseconds": 1e6, "nanoseconds": 1e9}
_UNLIKE = 300.0  # times as long as the log: no truth that belongs to it is
_SPARSE = 5.0  # [s] between readings: nobody logs a drive like that
_PERIODS = {"2 pi": 2 * np.pi, "360: it seems to be in degrees": 360.0, "2^16": 2.0**16, "2^32": 2.0**32}


@dataclass(frozen=True, slots=True)
class Truth:
    """Where the tracked point was: ``x``, ``y`` [m] and ``theta`` [rad] at times ``t`` [s]; nan is not measured."""

    t: Reals
    x: Reals
    y: Reals
    theta: Reals

    @property
    def measured(self) -> int:
        """How often that of x, y and theta was measured which was measured most often."""
        return max(int(np.isfinite(column).sum()) for column in (self.x, self.y, self.theta))


@dataclass(frozen=True, slots=True)
class Drive:
    """One drive. ``t`` [s]: N + 1 times; ``columns``: N increments of each ``<wheel>.spin`` [rad] and, of steered
    wheels, N angles ``<wheel>.steer`` [rad] and increments ``<wheel>.steer_rate`` [rad]; ``start``: about where the
    robot was at the first of them, x, y [m] and heading [rad], and how much later the log's clock is [s];
    ``start_error`` [m]: what the truth's first pose is off by, infinite where that is not known."""

    name: str
    t: Reals
    columns: Mapping[str, Reals]
    truth: Truth
    start: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    start_error: float = np.inf

    def stands(self, end: int) -> bool:
        """Whether no wheel turns in the second next to the first (0) or the last (-1) reading."""
        near = np.abs(self.t[:-1] - self.t[end]) < _STANDS[0]
        turned = (np.abs(v[near]).sum() for k, v in self.columns.items() if not k.endswith(".steer"))
        return all(angle < _STANDS[1] for angle in turned)

    def seen(self, rows: NDArray[np.bool_]) -> Drive:
        """The drive with these ``rows`` of its truth alone."""
        truth = self.truth
        return replace(self, truth=Truth(truth.t[rows], truth.x[rows], truth.y[rows], truth.theta[rows]))

    def part(self, first: int, last: int, offset: float = 0.0) -> Drive:
        """From one reading to another, with what the truth, whose clock is off by ``offset`` [s], says of that time."""
        at, t = self.truth.t + offset, self.t[first : last + 1]
        columns = {joint: column[first:last] for joint, column in self.columns.items()}
        start = (*self.start[:3], offset)
        inside = self.seen((at >= t[0]) & (at <= t[-1]))
        error = self.start_error if first == 0 else np.inf
        return replace(inside, t=t, columns=columns, start=start, start_error=error)

    def coarser(self, times: int, seconds: float) -> Drive:
        """The drive with so many ``times`` fewer readings, increments added and angles averaged, and as many times
        fewer rows of truth, but one in about so many ``seconds`` at least."""
        firsts = np.arange(0, len(self.t) - 1, times)
        counts = np.diff(firsts, append=len(self.t) - 1)
        columns = {
            joint: np.add.reduceat(column, firsts) / (counts if joint.endswith(".steer") else 1)
            for joint, column in self.columns.items()
        }
        often = min(times, max(1, int(seconds / float(np.median(np.diff(self.truth.t))))))
        rows = np.arange(len(self.truth.t)) % often == 0
        return replace(self.seen(rows), t=self.t[[*firsts, -1]], columns=columns)


def read(log: Path, truth: Path, joints: Sequence[str], turns: Mapping[str, float]) -> Drive:
    """A log and its truth. ``joints``: the readings that the robot's `forward` takes; ``turns``: counts per turn by
    joint, of those with an encoder in the robot file. UsageError, with the line, for what is no such log."""
    table = table_of(log, empty=False)
    t = times_of(log, table)
    poses = table_of(truth, empty=True)
    at = times_of(truth, poses)
    without_other_headings(truth, poses)
    if not set(_TRUTH) & set(poses):
        raise UsageError(f"{truth}: none of the columns x, y and theta is there, only {', '.join(poses)}")
    _same_clock(log, t, truth, at)
    _without_gaps(log, t)
    columns = {joint: _increments(log, table, joint, turns, t) for joint in joints}
    missing = np.full(len(at), np.nan)
    x, y, theta = (poses.get(name, missing) for name in _TRUTH)
    result = Drive(log.stem, t, columns, Truth(at, x, y, theta))
    if result.truth.measured < 2:
        raise UsageError(f"{truth}: of x, y and theta one at least has to be measured twice")
    return result


def _increments(
    path: Path, table: Mapping[str, Reals], joint: str, turns: Mapping[str, float], t: Reals
) -> Reals:
    """What the steps of ``joint`` are, from whichever column tells it."""
    wheel, quantity = joint.rsplit(".", 1)
    if quantity in ("steer", "steer_rate"):
        angle = _column(path, table, (f"{wheel}.steer",))
        angle = np.unwrap(angle) if np.ptp(angle) < _WRAPS else angle
        return np.diff(angle) if quantity == "steer_rate" else (angle[1:] + angle[:-1]) / 2
    names = (f"{wheel}.angle", f"{wheel}.counts", joint)
    if names[0] in table:
        _no_jump(path, names[0], table[names[0]])
        return np.diff(table[names[0]])
    if names[1] in table:
        if joint not in turns:
            raise UsageError(
                f"{path}: {names[1]} needs counts per turn: write encoder: of {wheel} in the robot file"
            )
        unit = 2 * np.pi / turns[joint]
        _no_jump(path, names[1], table[names[1]] * unit, unit)
        return np.diff(table[names[1]] * unit)
    rate = _column(path, table, names)
    return (rate[1:] + rate[:-1]) / 2 * np.diff(t)


def _column(path: Path, table: Mapping[str, Reals], names: Sequence[str]) -> Reals:
    """The column that has one of ``names``; the message of the refusal tells them."""
    for name in names:
        if name in table:
            return table[name]
    near = get_close_matches(names[0], list(table), 1)
    raise UsageError(
        f"{path}:1: there is no column {' or '.join(names)}; the header has {', '.join(table)}"
        + (f"; is {near[0]} meant?" if near else "")
    )


def _no_jump(path: Path, name: str, angle: Reals, unit: float = 1.0) -> None:
    """Refuse a reading that wraps, or restarts at 0: one step far above the usual ones. ``angle`` [rad], of a column
    in which 1 is a ``unit`` [rad]."""
    signed = np.diff(angle)
    steps = np.abs(signed)
    at, usual = int(np.argmax(steps)), np.percentile(steps, _MOSTLY)
    back = signed[max(0, at - 1) : at + 2] * np.sign(signed[at])  # a wrap goes against the steps beside it
    if steps[at] > _JUMP and (steps[at] > 10 * usual or (steps[at] > 3 * usual and np.sum(back < 0) >= 2)):
        wraps = [period for period, size in _PERIODS.items() if abs(size * abs(unit) - steps[at]) < 3 * usual]
        raise UsageError(
            f"{path}:{at + 3}: {name} jumps by {(angle[at + 1] - angle[at]) / unit:.4g} in one step, most move by "
            f"{usual / abs(unit):.2g} at most{', as what wraps at ' + wraps[0] if wraps else ''}: readings have to be "
            "cumulative, without wrapping or restarts"
        )


def _without_gaps(path: Path, t: Reals) -> None:
    """Refuse a step so long that nobody knows how the robot moved in it."""
    step = np.diff(t)
    usual = float(np.median(step))
    if step.max() > _GAP * usual:
        row = int(np.argmax(step))
        raise UsageError(
            f"{path}:{row + 3}: {step[row]:g} s without a reading, from t = {t[row]:g} on, where {usual:g} s are "
            "usual; make two logs of it, each with its truth"
        )


def _same_clock(log: Path, t: Reals, truth: Path, at: Reals) -> None:
    """Refuse times of log and truth that do not overlap, or are in other units."""
    lasts = float((at[-1] - at[0]) / (t[-1] - t[0]))
    if not 1 / _UNLIKE < lasts < _UNLIKE:
        path, times = (truth, lasts) if lasts > 1 else (log, 1 / lasts)
        units = min(_SECONDS, key=lambda name: abs(np.log(_SECONDS[name] / times)))
        raise UsageError(
            f"{log} lasts {t[-1] - t[0]:g} and {truth} {at[-1] - at[0]:g}: is t of {path.name} in {units}, or the "
            "other file cut short? t is in seconds"
        )
    step = float(np.median(np.diff(t)))
    if step > _SPARSE:
        units = next((name for name, size in _SECONDS.items() if step < _SPARSE * size), "nanoseconds")
        raise UsageError(f"{log}: readings are {step:g} s apart: is t in {units}? It is in seconds")
    if at[0] > t[-1] or at[-1] < t[0]:
        raise UsageError(
            f"{truth} begins at t = {at[0]:g} and ends at {at[-1]:g}, {log} at {t[0]:g} and {t[-1]:g}: they do not "
            "overlap; both need one clock, up to a second"
        )


def names(logs: Sequence[Path]) -> list[str]:
    """Of drives: those of one name told apart by numbers, for logs of several folders may be called alike."""
    stems = [log.stem for log in logs]
    again = [stems[:i].count(stem) for i, stem in enumerate(stems)]
    return [f"{stem} ({k + 1})" if k else stem for stem, k in zip(stems, again, strict=True)]


def pairs(files: Sequence[Path], truths: Sequence[Path]) -> list[tuple[Path, Path]]:
    """Each log with its truth: ``NAME.truth.csv`` beside ``NAME.csv``, else the next of ``truths``."""
    rest = iter(truths)
    result = []
    for log in files:
        if not log.exists():
            raise UsageError(f"{log}: there is no such file")
        own = log.with_suffix(".truth.csv")
        truth = own if own.is_file() and not truths else next(rest, None)
        if truth is None:
            raise UsageError(f"{log}: no {own.name} is beside it, and no --truth is left for it")
        result.append((log, truth))
    if next(rest, None) is not None:
        raise UsageError(f"there are {len(truths)} --truth for {len(files)} logs")
    return result
