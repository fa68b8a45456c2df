"""Read logs of joint readings and reference poses: CSV files, mappings or data frames, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.geometry.ports import GYRO
from wmrgen.tools.calibration.logs import BEYOND, Log, Poses
from wmrgen.tools.calibration.path import Reals
from wmrgen.tools.calibration.tables import Table, table_of, without_other_headings

Source = Any  # the path of a CSV file; or a mapping or data frame that gives columns by their names

_GAP = 20.0  # times the median step: during a longer one the motion of the robot is unknown
_JUMP = 3.0  # [rad] in one step, and ten times the usual step: a reading that wrapped or restarted
_TURN = 6.4  # [rad] steering angles that wrap lie within one turn
_REFERENCE = ".truth.csv"  # the end of the name of a reference file next to a log
_SPARSE = 5.0  # [s] between readings: logs are never so slow, so t is in another unit


@dataclass(frozen=True, slots=True)
class Recording:
    """One drive before it is read."""

    name: str
    log: Source
    reference: Source


def recordings(logs: Sequence[Source], references: Sequence[Source]) -> list[Recording]:
    """Return each log with its reference poses.

    Args:
        logs: Paths of CSV files, mappings or data frames. ``NAME.truth.csv`` next to ``NAME.csv`` is its
            reference and not a log, because a shell's pattern matches both.
        references: Reference poses in the order of the logs; by default ``NAME.truth.csv`` of each file.
    """
    paths = {Path(log) for log in logs if isinstance(log, str | PathLike)}
    rest, names, result = list(references), list[str](), list[Recording]()
    for source in logs:
        own = None
        if isinstance(source, str | PathLike):
            path = Path(source)
            if path.with_name(path.name.replace(_REFERENCE, ".csv")) in paths - {path}:
                continue
            if not path.exists():
                raise UsageError(f"{path}: there is no such file")
            own, name = path.with_suffix(_REFERENCE), path.stem
        else:
            name = f"log {len(result) + 1}"
        if rest:
            reference = rest.pop(0)
        elif own is not None and own.is_file() and not references:
            reference = own
        else:
            beside = f", and there is no {own.name} next to it" if own else ""
            raise UsageError(f"{_where(source, name)}: no reference poses are given for it{beside}")
        names.append(name)
        again = names.count(name)  # logs in several folders may have the same name
        result.append(Recording(f"{name} ({again})" if again > 1 else name, source, reference))
    if rest:
        raise UsageError(f"there are {len(references)} files of reference poses for {len(result)} logs")
    return result


def read(recording: Recording, joints: Sequence[str], turns: Mapping[str, float], gyro: bool = False) -> Log:
    """Read a log and its reference poses.

    Args:
        recording: Joint readings, and reference poses with the columns t and any of x, y and theta.
        joints: Readings that the robot's `forward` takes.
        turns: Counts per turn of each joint that has an encoder in the robot file.
        gyro: Whether to read the column of a gyro [rad/s], if there is one.

    Returns:
        The log. UsageError, with the line, if it cannot be read.
    """
    table = table_of(recording.log, _where(recording.log, recording.name), empty=False)
    reference = _where(recording.reference, f"reference of {recording.name}")
    poses = table_of(recording.reference, reference, empty=True)
    without_other_headings(poses)
    t, at = table.columns["t"], poses.columns["t"]
    if not {"x", "y", "theta"} & set(poses.columns):
        raise UsageError(f"{reference}: there is no column x, y or theta, only {', '.join(poses.columns)}")
    _check_times(table, poses)
    columns = {joint: _increments(table, joint, turns, t) for joint in joints}
    if gyro and GYRO.name in table.columns:
        columns[GYRO.name] = _integrated(table.columns[GYRO.name], t)
    missing = np.full(len(at), np.nan)
    x, y, theta = (poses.columns.get(name, missing) for name in ("x", "y", "theta"))
    return Log(recording.name, t, columns, Poses(at, x, y, theta))


def _where(source: Source, name: str) -> str:
    return str(source) if isinstance(source, str | PathLike) else name


def _check_times(table: Table, poses: Table) -> None:
    """Refuse times in another unit, of another drive, or with a gap."""
    t, at = table.columns["t"], poses.columns["t"]
    step = np.diff(t)
    usual = float(np.median(step))
    if usual > _SPARSE:
        raise UsageError(
            f"{table.where}: readings are {usual:g} s apart. t has to be in seconds: is it in milliseconds?"
        )
    inside = int(np.sum((at >= t[0] - BEYOND) & (at <= t[-1] + BEYOND)))
    if inside < 2 or at[0] > t[-1] or at[-1] < t[0]:
        raise UsageError(
            f"{poses.where} covers t = {at[0]:g} to {at[-1]:g}, {table.where} covers {t[0]:g} to {t[-1]:g}: "
            f"{inside} of {len(at)} poses lie in the log or within a second of it. "
            "Both need the same clock up to a second, in seconds"
        )
    if step.max() > _GAP * usual:
        row = int(np.argmax(step))
        raise UsageError(
            f"{table.place(row + 1)}: {step[row]:g} s without a reading after t = {t[row]:g}, where {usual:g} s are "
            "usual. Split the log there, each part with its reference poses"
        )


def _increments(table: Table, joint: str, turns: Mapping[str, float], t: Reals) -> Reals:
    """Return the steps of a joint [rad], from its column."""
    wheel, quantity = joint.rsplit(".", 1)
    if quantity in ("steer", "steer_rate"):
        angle = _column(table, (f"{wheel}.steer",))
        angle = np.unwrap(angle) if np.ptp(angle) < _TURN else angle
        return np.diff(angle) if quantity == "steer_rate" else (angle[1:] + angle[:-1]) / 2
    names = (f"{wheel}.angle", f"{wheel}.counts", joint)
    if names[0] in table.columns:
        _refuse_jumps(table, names[0], 1.0)
        return np.diff(table.columns[names[0]])
    if names[1] in table.columns:
        if joint not in turns:
            raise UsageError(
                f"{table.where}: {names[1]} needs counts per turn: write encoder: of {wheel} in the robot file"
            )
        unit = 2 * np.pi / turns[joint]
        _refuse_jumps(table, names[1], unit)
        return np.diff(table.columns[names[1]] * unit)
    return _integrated(_column(table, names), t)


def _integrated(rate: Reals, t: Reals) -> Reals:
    """Return the increments of a rate, by trapezoids."""
    return (rate[1:] + rate[:-1]) / 2 * np.diff(t)


def _column(table: Table, names: Sequence[str]) -> Reals:
    """Return the column that has one of the names."""
    for name in names:
        if name in table.columns:
            return table.columns[name]
    near = get_close_matches(names[0], list(table.columns), 1)
    raise UsageError(
        f"{table.where}: there is no column {' or '.join(names)}; the columns are {', '.join(table.columns)}"
        + (f". Is {near[0]} meant?" if near else "")
    )


def _refuse_jumps(table: Table, name: str, unit: float) -> None:
    """Refuse readings that wrap, or restart at 0.

    Args:
        table: The log.
        name: The column's name.
        unit: [rad] of one in the column.
    """
    signed = np.diff(table.columns[name]) * unit
    steps = np.abs(signed)
    at, usual = int(np.argmax(steps)), float(np.percentile(steps, 75))
    back = signed[max(0, at - 1) : at + 2] * np.sign(signed[at])  # a wrap is opposite to the steps around it
    against = int(np.sum(back < 0))
    if steps[at] > _JUMP and (steps[at] > 10 * usual or (steps[at] > 3 * usual and against >= 2)):
        raise UsageError(
            f"{table.place(at + 1)}: {name} jumps by {signed[at] / unit:.4g} in one step, most steps are at most "
            f"{usual / abs(unit):.2g}. Readings have to be cumulative, without wrapping or restarts"
        )
