"""``wmrgen textbook --find``: from a place in a text to the command that reproduces it."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import Path

from textbook.index.places import count, in_ranges, places_of
from textbook.index.records import Row, shown
from textbook.index.search import Found, find, parsed
from wmrgen.cli import console
from wmrgen.errors import UsageError

EXAMPLES = (
    '"2.75", "(3.12)-(3.13)", "Siegwart 3.19", "Table 2.1", "Figure 3.15", "Exercise 3.7.1" or "Piaggio"'
)


def run(query: str, as_json: bool) -> int:
    """Print the rows of the table for a query. Raise UsageError if there are none."""
    if parsed(query).too_short:
        raise UsageError(f"{query!r} is too short to find a place. Write a place such as {EXAMPLES}.")
    found = find(query)
    if not found.rows and not found.missing:
        near = f" Near it: {', '.join(found.near)}." if found.near else f" Write a place such as {EXAMPLES}."
        raise UsageError(f"no place in the five texts matches {query!r}.{near}")
    if as_json:
        console.data(_as_data(query, found))
        return 0
    for row in found.rows:
        console.result(_as_text(row))
    for reason, places in _by_reason(found).items():
        console.result(f"Not covered: {places}: {reason}.\n")
    _note_missing_files(found.rows)
    here, every = count()
    console.result(f"Commands cover {here} of {every} places of the five texts.")
    return 0


def command_line(row: Row) -> str:
    """Return the command of a row as a user types it."""
    return shlex.join(["wmrgen", *row.words])


def numbers(row: Row) -> str:
    """Return the numbers of a row: ``x_rate = 0, y_rate = 3``."""
    return ", ".join(f"{name} = {shown(value)}" for name, value in row.expected.items())


def _note_missing_files(rows: Iterable[Row]) -> None:
    """Print how to copy the robot files that are not in the working directory."""
    missing = [
        file for file in dict.fromkeys(row.robot_file for row in rows) if file and not Path(file).is_file()
    ]
    if missing:
        name = Path(missing[0]).stem
        more = len(missing) - 1
        others = f" Copy the other {more} file{'s' * (more > 1)} in the same way." if more else ""
        console.note(
            f"To copy the robot file to this folder: `wmrgen new {name} --from {name} -o {missing[0]}`.{others}"
        )


def _as_text(row: Row) -> str:
    lines = [f"{row.text} {row.places}: {row.says}"]
    if row.robot_file:
        lines.append(f"  robot    {row.robot_file}")
    lines += [f"  command  {command_line(row)}", f"  expect   {numbers(row)}", ""]
    return "\n".join(lines)


def _by_reason(found: Found) -> dict[str, str]:
    """Return reason -> places of each text, those that follow one another as a range."""
    groups: dict[tuple[str, str], list[str]] = {}
    for text, reason in {(place.text, reason) for place, reason in found.missing.items()}:
        places = [place for place, why in found.missing.items() if (place.text, why) == (text, reason)]
        groups.setdefault((reason, text), []).extend(in_ranges(places))
    lines: dict[str, list[str]] = {}
    for (reason, text), labels in sorted(groups.items()):
        lines.setdefault(reason, []).append(f"{text} {', '.join(labels)}")
    return {reason: "; ".join(parts) for reason, parts in lines.items()}


def _as_data(query: str, found: Found) -> dict[str, object]:
    here, every = count()
    return {
        "query": query,
        "found": [
            {
                "text": row.text,
                "places": [place.label for place in places_of(row.text, row.places)],
                "says": row.says,
                "robot": row.robot_file or None,
                "command": command_line(row),
                "expected": row.expected,
            }
            for row in found.rows
        ],
        "not_covered": [
            {"text": place.text, "place": place.label, "reason": reason}
            for place, reason in found.missing.items()
        ],
        "covered": here,
        "places": every,
    }
