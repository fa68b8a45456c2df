"""docs/textbook.md: each place in the texts with robot file, command and the numbers to expect."""

from __future__ import annotations

from collections.abc import Iterator

from textbook.errata.texts import BIBLIOGRAPHY, ENTRIES, HOLDS
from textbook.index.command import command_line, numbers
from textbook.index.places import TEXTS, count, in_ranges, not_covered, order, places_of
from textbook.index.records import Row
from textbook.index.table import ROWS
from wmrgen.report.sections.markdown import code, escape, page, table

LONGEST = 160  # characters of numbers in a cell; longer lists are matrices, which the command prints


def content() -> str:
    """Return the whole page."""
    return page([*_opening(), *(block for text in TEXTS for block in _section(text))])


def _opening() -> Iterator[str]:
    here, every = count()
    yield "# Textbook equations: from the book to the command"
    yield (
        "These tables lead from an equation, figure, table or exercise of five texts to a robot file, a command and "
        'the numbers that it prints. Equations have the numbers of the texts. "Corrected" marks an equation that is '
        "wrong in our copy."
    )
    yield (
        f"Commands cover {here} of {every} places. A test runs each command and compares its numbers. Each equation of "
        "a group such as (3.9)-(3.11) is counted, even if the command shows a part of the group. "
        '`wmrgen textbook --find "2.75"` '
        'prints the rows of a place; "(3.12)-(3.13)", "Siegwart 3.19", "Table 2.1", "Figure 3.15", "Exercise 3.7.1" '
        'and "Piaggio" '
        "work too."
    )
    yield (
        f"{len(HOLDS)} equations and statements of the texts were checked in symbols and hold. "
        f"[Errata](../generated/errata.md) lists them, and {len(ENTRIES)} lines of our copies that are wrong or need "
        "care. [Robots of the texts](textbook_robots.md) shows the layouts. `wmrgen functions textbook` lists the "
        "functions that need no robot."
    )
    yield (
        "Numbers are rounded to six digits. Robot files are under `robots/`. Most texts have symbols only, so most "
        "numbers in the robot files are chosen; each file says which."
    )


def _section(text: str) -> Iterator[str]:
    """Yield the blocks of a text."""
    here, every = count(text)
    yield f"## {text}"
    yield BIBLIOGRAPHY[text].partition(" The second copy ")[0]
    yield f"Commands cover {here} of {every} places."
    rows = sorted((row for row in ROWS if row.text == text), key=_order)
    yield from table(("in the text", "what", "command, and the numbers to expect"), map(_cells, rows), "l")
    missing = {place: reason for place, reason in not_covered().items() if place.text == text}
    for reason in dict.fromkeys(missing.values()):
        labels = in_ranges(place for place, why in missing.items() if why == reason)
        yield f"Not covered: {escape(', '.join(labels))}: {escape(reason)}."


def _order(row: Row) -> tuple[int, int, tuple[int, ...], str]:
    return order(next(places_of(row.text, row.places)))


def _cells(row: Row) -> tuple[str, str, str]:
    expected = numbers(row)
    if len(expected) > LONGEST:
        expected = expected[:LONGEST].rpartition(", ")[0] + ", …"
    return escape(row.places), escape(row.says), f"{code(command_line(row))}<br>{code(expected)}"
