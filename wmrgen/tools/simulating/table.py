"""Tables of commands and of drives, as CSV."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.geometry.ports import TWIST_NAMES, Port, Role
from wmrgen.robotfile.text import quoted, suggestion

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.tools.simulating.drive import Drive
    from wmrgen.tools.simulating.model import Reals

_DIGITS = 10  # significant digits of a drive: more than any sensor has
_COLUMN = "t"


class Table(NamedTuple):
    """Commands by time."""

    kind: str  # twist, joints (inputs of `forward`) or inputs (of the state space)
    t: Reals  # (K,) [s], ascending
    columns: Mapping[str, Reals]  # (K,) by name, SI units


def read_table(text: str, file: str, derivation: Derivation) -> Table:
    """Read the commands of a CSV file.

    Args:
        text: its content: a header with ``t`` and the names of quantities, then rows of numbers in SI units.
        file: its name, for messages.
        derivation: the robot that is commanded.

    Returns:
        The commands.

    Raises:
        UsageError: if the text is no such table, or its columns are not the inputs of one kind.
    """
    try:
        rows = [row for row in csv.reader(io.StringIO(text)) if "".join(row).strip()]
    except csv.Error as error:
        raise UsageError(f"{file} is not CSV: {error}. Write t,vx,omega, then rows of numbers.") from None
    if len(rows) < 3:
        raise UsageError(
            f"{file} needs a header, such as t,vx,omega, and at least two rows: each row holds until the time of the "
            "next one, and the last one ends the drive."
        )
    header = [cell.strip() for cell in rows[0]]
    if len(set(header)) < len(header):
        raise UsageError(f"{file}: a column occurs twice in its header: {', '.join(header)}")
    if _COLUMN not in header:
        hint = " Separate columns by commas." if len(header) == 1 and re.search(r"[;\t ]", header[0]) else ""
        raise UsageError(
            f"{file} has no column t, the time in seconds. Its header is: {', '.join(header)[:200]}.{hint}"
        )
    values = np.array([_numbers(row, header, f"{file}, row {k}") for k, row in enumerate(rows[1:], 1)])
    columns = {name: values[:, k] for k, name in enumerate(header)}
    t = columns.pop(_COLUMN)
    backwards = np.flatnonzero(np.diff(t) <= 0)
    if len(backwards):
        raise UsageError(f"{file}, row {int(backwards[0]) + 2}: t is not later than in the row before")
    return Table(_kind(columns, derivation, file), t - t[0], columns)


def _numbers(row: Sequence[str], header: Sequence[str], place: str) -> list[float]:
    """Return the numbers of a row."""
    if len(row) != len(header):
        raise UsageError(f"{place} has {len(row)} values, and the header has {len(header)} names")
    numbers = []
    for name, cell in zip(header, row, strict=True):
        try:
            number = float(cell)
        except ValueError:
            raise UsageError(
                f"{place}: {name} = {cell.strip()[:60]!r} is not a number. Write SI units without their names."
            ) from None
        if not isfinite(number):
            raise UsageError(f"{place}: {name} = {cell.strip()[:60]!r} is not finite")
        numbers.append(number)
    return numbers


def _kind(columns: Mapping[str, Reals], derivation: Derivation, file: str) -> str:
    """Return the kind of inputs that the columns are; a twist may leave out components that are 0."""
    forward = _names(derivation.formula("forward").inputs)
    space = derivation.default_state_space
    inputs = _names(space.inputs) if space else []
    if columns and set(columns).issubset(TWIST_NAMES):
        return "twist"
    for kind, names in (("joints", forward), ("inputs", inputs)):
        if names and set(columns) == set(names):
            return kind
    kinds = {"a twist": list(TWIST_NAMES), "joints": forward}
    if set(inputs) != set(forward):
        kinds["inputs of the model"] = inputs
    texts = [f"{what} ({', '.join(names)})" for what, names in kinds.items() if names]
    known = dict.fromkeys((*TWIST_NAMES, *forward, *inputs))
    unknown = next((name for name in columns if name not in known), None)
    hint = f" There is no {quoted(unknown)}. {suggestion(unknown, list(known))}" if unknown else ""
    raise UsageError(f"{file}: the columns next to t must be {' or '.join(texts)}.{hint}")


def _names(ports: Sequence[Port]) -> list[str]:
    return [port.name for port in ports if port.role is not Role.GEOMETRY]


def written(drives: Sequence[Drive]) -> str:
    """Return drives as CSV: a row for each step, with columns for robot and start if there are several."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = list(dict.fromkeys(name for drive in drives for name in drive.columns))
    several, many = len(drives) > 1, any(drive.starts > 1 for drive in drives)
    writer.writerow([*(["robot"] * several), *(["start"] * many), _COLUMN, *names])
    for drive in drives:
        for start in range(drive.starts):
            for row, t in enumerate(drive.t[:, start]):
                values = [
                    drive.columns[name][row, start] if name in drive.columns else None for name in names
                ]
                cells = ["" if value is None else f"{value + 0.0:.{_DIGITS}g}" for value in values]
                own = [*([drive.name] * several), *([str(start)] * many)]
                writer.writerow([*own, f"{t:.{_DIGITS}g}", *cells])
    return text.getvalue()
