"""Read logs of joint readings and reference poses: CSV files with a header, in SI units and radians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.tools.calibration.logs import Log, Poses
from wmrgen.tools.calibration.path import Reals
from wmrgen.tools.calibration.tables import table_of, times_of, without_other_headings

_GAP = 20.0  # times the median step: during a longer one nobody knows how the robot moved
_JUMP = 3.0  # [rad] in one step, and ten times the usual step: a reading that wrapped or restarted
_TURN = 6.4  # [rad] steering angles that wrap lie within one turn
_SPARSE = 5.0  # [s] between readings: nobody logs a drive like that, so t is in another unit


def read(log: Path, reference: Path, joints: Sequence[str], turns: Mapping[str, float]) -> Log:
    """Read a log and its reference poses.

    Args:
        log: CSV file with the columns t and those of the joints.
        reference: CSV file with the columns t, and any of x, y and theta.
        joints: Readings that the robot's `forward` takes.
        turns: Counts per turn of each joint that has an encoder in the robot file.

    Returns:
        The log. UsageError, with the line, for a file that is no such log.
    """
    table, poses = table_of(log, empty=False), table_of(reference, empty=True)
    without_other_headings(reference, poses)
    times_of(log, table)
    times_of(reference, poses)
    return of_tables(log, table, reference, poses, joints, turns)


def of_tables(
    log: Path,
    table: Mapping[str, Reals],
    reference: Path,
    poses: Mapping[str, Reals],
    joints: Sequence[str],
    turns: Mapping[str, float],
) -> Log:
    """Build a log from columns by name.

    Args:
        log: Where the joint readings come from, for messages.
        table: Their columns.
        reference: Where the reference poses come from, for messages.
        poses: Their columns.
        joints: Readings that the robot's `forward` takes.
        turns: Counts per turn of each joint that has an encoder in the robot file.
    """
    t, at = table["t"], poses["t"]
    if not {"x", "y", "theta"} & set(poses):
        raise UsageError(f"{reference}: none of the columns x, y and theta is there, only {', '.join(poses)}")
    step = np.diff(t)
    usual = float(np.median(step))
    if usual > _SPARSE:
        raise UsageError(
            f"{log}: readings are {usual:g} s apart. t has to be in seconds: is it in milliseconds?"
        )
    if at[0] > t[-1] or at[-1] < t[0]:
        raise UsageError(
            f"{reference} covers t = {at[0]:g} to {at[-1]:g}, {log} covers {t[0]:g} to {t[-1]:g}: they do not overlap. "
            "Both need the same clock up to a second, in seconds"
        )
    if step.max() > _GAP * usual:
        row = int(np.argmax(step))
        raise UsageError(
            f"{log}:{row + 3}: {step[row]:g} s without a reading after t = {t[row]:g}, where {usual:g} s are usual. "
            "Split the log there, each part with its reference poses"
        )
    columns = {joint: _increments(log, table, joint, turns, t) for joint in joints}
    missing = np.full(len(at), np.nan)
    x, y, theta = (poses.get(name, missing) for name in ("x", "y", "theta"))
    result = Log(log.stem, t, columns, Poses(at, x, y, theta))
    if result.poses.measured < 2:
        raise UsageError(f"{reference}: x, y or theta has to be measured at least twice")
    return result


def _increments(
    path: Path, table: Mapping[str, Reals], joint: str, turns: Mapping[str, float], t: Reals
) -> Reals:
    """Return the steps of a joint [rad], from the column that has it."""
    wheel, quantity = joint.rsplit(".", 1)
    if quantity in ("steer", "steer_rate"):
        angle = _column(path, table, (f"{wheel}.steer",))
        angle = np.unwrap(angle) if np.ptp(angle) < _TURN else angle
        return np.diff(angle) if quantity == "steer_rate" else (angle[1:] + angle[:-1]) / 2
    names = (f"{wheel}.angle", f"{wheel}.counts", joint)
    if names[0] in table:
        _refuse_jumps(path, names[0], table[names[0]], 1.0)
        return np.diff(table[names[0]])
    if names[1] in table:
        if joint not in turns:
            raise UsageError(
                f"{path}: {names[1]} needs counts per turn: write encoder: of {wheel} in the robot file"
            )
        unit = 2 * np.pi / turns[joint]
        _refuse_jumps(path, names[1], table[names[1]], unit)
        return np.diff(table[names[1]] * unit)
    rate = _column(path, table, names)
    return (rate[1:] + rate[:-1]) / 2 * np.diff(t)


def _column(path: Path, table: Mapping[str, Reals], names: Sequence[str]) -> Reals:
    """Return the column that has one of the names."""
    for name in names:
        if name in table:
            return table[name]
    near = get_close_matches(names[0], list(table), 1)
    raise UsageError(
        f"{path}:1: there is no column {' or '.join(names)}; the header has {', '.join(table)}"
        + (f". Is {near[0]} meant?" if near else "")
    )


def _refuse_jumps(path: Path, name: str, readings: Reals, unit: float) -> None:
    """Refuse readings that wrap, or restart at 0.

    Args:
        path: The file, for the message.
        name: The column's name.
        readings: In the column's unit.
        unit: [rad] of one in the column.
    """
    signed = np.diff(readings) * unit
    steps = np.abs(signed)
    at, usual = int(np.argmax(steps)), float(np.percentile(steps, 75))
    back = signed[max(0, at - 1) : at + 2] * np.sign(signed[at])  # a wrap goes against the steps beside it
    against = int(np.sum(back < 0))
    if steps[at] > _JUMP and (steps[at] > 10 * usual or (steps[at] > 3 * usual and against >= 2)):
        raise UsageError(
            f"{path}:{at + 3}: {name} jumps by {signed[at] / unit:.4g} in one step, most steps are at most "
            f"{usual / abs(unit):.2g}. Readings have to be cumulative, without wrapping or restarts"
        )


def pairs(files: Sequence[Path], references: Sequence[Path]) -> list[tuple[Path, Path]]:
    """Return each log with its reference poses.

    Args:
        files: CSV files. ``NAME.truth.csv`` beside ``NAME.csv`` counts as its reference and not as a log, because a
            shell's pattern matches both.
        references: Files of reference poses, in the order of the logs; by default ``NAME.truth.csv``.
    """
    logs = [log for log in files if not (log.name.endswith(".truth.csv") and _log_of(log) in files)]
    rest, result = iter(references), []
    for log in logs:
        if not log.exists():
            raise UsageError(f"{log}: there is no such file")
        own = log.with_suffix(".truth.csv")
        reference = own if own.is_file() and not references else next(rest, None)
        if reference is None:
            raise UsageError(f"{log}: no {own.name} is beside it, and no --truth is left for it")
        result.append((log, reference))
    if next(rest, None) is not None:
        raise UsageError(f"there are {len(references)} --truth for {len(logs)} logs")
    return result


def _log_of(reference: Path) -> Path:
    return reference.with_name(reference.name.removesuffix(".truth.csv") + ".csv")
