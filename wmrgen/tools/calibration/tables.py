"""CSV files of numbers with a header: columns by name, and what is no such file, by line."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from wmrgen.errors import UsageError
from wmrgen.tools.calibration.path import Reals

_COMMAS = ": write commas between columns, and points in numbers"
_HEADING = re.compile(r"(?i).*(yaw|heading|theta|bearing|azimuth|orientation|quat).*|psi|(.*[._])?q?w")
_QUATERNION = ", which is atan2(2 (w z + x y), 1 - 2 (y^2 + z^2)) of a quaternion"


def table_of(path: Path, empty: bool) -> dict[str, Reals]:
    """Columns by name. ``empty``: a cell may be empty, which is nan."""
    try:
        with path.open(encoding="utf-8-sig") as stream:
            header = [name.strip() for name in next(csv.reader(stream), [])]
            _check_header(path, header)
            numbers = np.empty((0, 0))
            with warnings.catch_warnings(action="ignore"), suppress(ValueError):  # which are told by line
                numbers = np.loadtxt(stream, delimiter=",", ndmin=2)
            if numbers.shape[1] != len(header):
                numbers = _by_line(path, header, empty)
    except UnicodeDecodeError:
        raise UsageError(f"{path}: it is no text in UTF-8: save it as CSV in UTF-8") from None
    except (OSError, csv.Error) as error:
        raise UsageError(f"{path}: it cannot be read: {error}") from None
    if len(numbers) < 2:
        raise UsageError(f"{path}: at least two rows are needed below the header; it has {len(numbers)}")
    bad = np.isinf(numbers) | (np.isnan(numbers) & [not empty or name == "t" for name in header])
    if bad.any():
        row, column = (int(i[0]) for i in np.nonzero(bad))
        raise UsageError(
            f"{path}:{row + 2}: {header[column]} is {numbers[row, column]}: delete or mend that row"
        )
    return dict(zip(header, numbers.T.copy(), strict=True))


def _check_header(path: Path, header: Sequence[str]) -> None:
    """Refuse a header without a column t, and one in which a name stands twice."""
    reads = ",".join(header)[:200]
    if "t" not in header:
        raise UsageError(
            f"{path}:1: the header has no column t [s]; it reads {reads or 'nothing'}{_instead(header)}"
        )
    if not header[-1]:
        raise UsageError(f"{path}:1: the last column has no name in {reads}: is there a comma too many?")
    if len(set(header)) < len(header):
        raise UsageError(f"{path}:1: a column stands twice in {reads}")


def _instead(header: Sequence[str]) -> str:
    """What to do about a ``header`` without a column t."""
    first = header[0] if header else ""
    if re.match(r"#?\s*t\s*[;|\s]\s*\w", first):
        return _COMMAS
    if re.match(r"[-+.\d]", first):
        return ": the first row has to name the columns"
    if re.match(r"(?i)\W*t(ime|imestamp)?\b", first):
        return f": is {first} meant?"
    return ": the header has to be the first line, without a comment above it" if first[:1] == "#" else ""


def _by_line(path: Path, header: Sequence[str], empty: bool) -> Reals:
    """Rows one by one, for a file with empty cells, or to find the line that is wrong."""
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
    """A cell of the column ``name``."""
    if empty and not cell.strip():
        return float("nan")
    try:
        return float(cell)
    except ValueError:
        point = re.fullmatch(r"\s*[-+]?\d*,\d*\s*", cell)
        hint = "write points in numbers" if point else "delete or mend that row"
        raise UsageError(f"{path}:{line}: {name} is {cell!r}, which is no number: {hint}") from None


def times_of(path: Path, table: Mapping[str, Reals]) -> Reals:
    """The column t, which has to rise, and be in seconds."""
    t = table["t"]
    step = np.diff(t)
    if not np.all(step > 0):
        row = int(np.argmin(step > 0))
        raise UsageError(
            f"{path}:{row + 3}: t does not rise: {t[row + 1]:.15g} after {t[row]:.15g}; sort the rows, and leave "
            "doubles out"
        )
    return t


def without_other_headings(path: Path, table: Mapping[str, Reals]) -> None:
    """Refuse a truth whose headings stand in columns that nothing reads."""
    others = [name for name in table if _HEADING.fullmatch(name)]
    if "theta" in table or not others:
        return
    quaternion = _QUATERNION * any(
        name.lower().endswith("w") and "yaw" not in name.lower() for name in others
    )
    raise UsageError(
        f"{path}:1: {', '.join(others)} would be left unread: write the heading as theta [rad]{quaternion}, or delete "
        "what is no heading"
    )
