"""Read tables of numbers from CSV files, mappings and data frames, and report their errors by row."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.tools.calibration.path import Reals

_COMMAS = ": write commas between columns, and points in numbers"
_HEADING = re.compile(r"(?i).*(yaw|heading|theta|bearing|azimuth|orientation|quat).*|psi|(.*[._])?q?w")
_QUATERNION = ", which is atan2(2 (w z + x y), 1 - 2 (y^2 + z^2)) of a quaternion"


@dataclass(frozen=True, slots=True)
class Table:
    """Columns of numbers by name, and where they come from."""

    where: str  # a file, or the number of a log
    columns: dict[str, Reals]
    lined: bool  # whether it is a file, with a header in line 1

    def place(self, row: int) -> str:
        """Return where a row is, counted from 0."""
        return f"{self.where}:{row + 2}" if self.lined else f"{self.where}, row {row}"


def table_of(source: Any, where: str, empty: bool) -> Table:
    """Return the table of a path, a mapping or a data frame.

    Args:
        source: The path of a CSV file, or a mapping or data frame with columns by name.
        where: Its name in messages.
        empty: Whether a cell may be empty (nan).

    Returns:
        The table. UsageError if the source is not a table of numbers.
    """
    if isinstance(source, str | PathLike):
        return _checked(Table(where, _columns(Path(source), empty), True), empty)
    names = [str(name) for name in getattr(source, "columns", source)]
    _check_header(where, names)
    try:
        columns = {name: np.array(source[name], dtype=float) for name in names}
        lengths = {column.shape for column in columns.values()}
    except (TypeError, ValueError) as error:
        raise UsageError(f"{where}: this is not a table of numbers: {error}") from None
    if len(lengths) > 1 or any(len(shape) != 1 for shape in lengths):
        raise UsageError(
            f"{where}: columns differ in length or shape: {', '.join(map(str, sorted(lengths)))}"
        )
    return _checked(Table(where, columns, False), empty)


def _checked(table: Table, empty: bool) -> Table:
    """Return the table; UsageError if a number is missing, or t does not rise."""
    t = table.columns["t"]
    if len(t) < 2:
        raise UsageError(f"{table.where}: at least two rows are needed; it has {len(t)}")
    for name, column in table.columns.items():
        bad = ~np.isfinite(column) if name == "t" or not empty else np.isinf(column)
        if bad.any():
            row = int(np.argmax(bad))
            raise UsageError(f"{table.place(row)}: {name} is {column[row]}: delete or correct that row")
    falls = np.diff(t) <= 0
    if falls.any():
        row = int(np.argmax(falls))
        raise UsageError(
            f"{table.place(row + 1)}: t does not rise: {t[row + 1]:.15g} after {t[row]:.15g}; sort the rows, and "
            "delete repeated ones"
        )
    return table


def _columns(path: Path, empty: bool) -> dict[str, Reals]:
    """Return the columns of a CSV file by name."""
    try:
        with path.open(encoding="utf-8-sig") as stream:
            header = [name.strip() for name in next(csv.reader(stream), [])]
            _check_header(f"{path}:1", header)
            numbers = np.empty((0, 0))
            # A cell that is no number is reported below, with its line.
            with warnings.catch_warnings(action="ignore"), suppress(ValueError):
                numbers = np.loadtxt(stream, delimiter=",", ndmin=2)
            if numbers.shape[1] != len(header):
                numbers = _by_line(path, header, empty)
    except UnicodeDecodeError:
        raise UsageError(f"{path}: this is not text in UTF-8: save it as CSV in UTF-8") from None
    except (OSError, csv.Error) as error:
        raise UsageError(f"{path}: it cannot be read: {error}") from None
    return dict(zip(header, numbers.T.copy(), strict=True))


def _check_header(where: str, header: Sequence[str]) -> None:
    """Refuse columns without t, and repeated column names."""
    reads = ",".join(header)[:200]
    if "t" not in header:
        raise UsageError(
            f"{where}: there is no column t [s]; the columns are {reads or 'none'}{_instead(header)}"
        )
    if not header[-1]:
        raise UsageError(f"{where}: the last column has no name in {reads}: is there an extra comma?")
    if len(set(header)) < len(header):
        raise UsageError(f"{where}: a column name is repeated in {reads}")


def _instead(header: Sequence[str]) -> str:
    """Return what to do about a header without a column t."""
    first = header[0] if header else ""
    if re.match(r"#?\s*t\s*[;|\s]\s*\w", first):
        return _COMMAS
    if re.match(r"[-+.\d]", first):
        return ": the first row has to name the columns"
    if re.match(r"(?i)\W*t(ime|imestamp)?\b", first):
        return f": is {first} meant?"
    return ": the header has to be the first line, without a comment above it" if first[:1] == "#" else ""


def _by_line(path: Path, header: Sequence[str], empty: bool) -> Reals:
    """Return rows read one by one: the file has empty cells, or an error whose line is needed."""
    rows = []
    with path.open(encoding="utf-8-sig", newline="") as stream:
        reader = csv.reader(stream)
        next(reader)
        for cells in reader:
            if not cells:
                continue
            if len(cells) != len(header):
                hint = _COMMAS * (len(cells) == 1 or len(cells) > len(header) + 1)
                raise UsageError(
                    f"{path}:{reader.line_num}: the row has {len(cells)} cells, the header {len(header)}{hint}"
                )
            row = zip(header, cells, strict=True)
            rows.append([_number(path, reader.line_num, name, cell, empty) for name, cell in row])
    return np.array(rows).reshape(-1, len(header))


def _number(path: Path, line: int, name: str, cell: str, empty: bool) -> float:
    """Return a cell as a number.

    Args:
        path: The file, for messages.
        line: The row's line.
        name: The column's name.
        cell: The text.
        empty: Whether it may be empty (nan).
    """
    if empty and not cell.strip():
        return float("nan")
    try:
        return float(cell)
    except ValueError:
        point = re.fullmatch(r"\s*[-+]?\d*,\d*\s*", cell)
        hint = "write points in numbers" if point else "delete or correct that row"
        raise UsageError(f"{path}:{line}: {name} is {cell!r}, not a number: {hint}") from None


def without_other_headings(table: Table) -> None:
    """Refuse reference poses with headings in columns that are not read."""
    others = [name for name in table.columns if _HEADING.fullmatch(name)]
    if "theta" in table.columns or not others:
        return
    quaternion = _QUATERNION * any(
        name.lower().endswith("w") and "yaw" not in name.lower() for name in others
    )
    raise UsageError(
        f"{table.where}: {', '.join(others)} would not be read: write the heading as theta [rad]{quaternion}, or "
        "delete columns that are not headings"
    )
