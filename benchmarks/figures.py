"""The tables of docs/benchmarks_laboratory.md: ``python -m benchmarks processor``; ``--update`` writes them there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from benchmarks import footprint, processor, small
from benchmarks.others import wpilib
from wmrgen.derivation.artifacts import write_file

PAGE = Path(__file__).resolve().parent.parent / "docs" / "benchmarks_laboratory.md"
BEGIN = "<!-- begin: python -m benchmarks processor --update -->"
END = "<!-- end -->"


def run(renew: bool, path: Path = PAGE) -> Iterator[str]:
    """Yield the tables. With ``renew`` they replace those in the file, if all tools are installed."""
    lines = []
    for table in (processor.tables, wpilib.table, footprint.table, small.table):
        for line in ("", *table()):
            lines.append(line)
            yield line
    if renew:
        if any(": needs " in line for line in lines):
            raise SystemExit(f"{path.name} stays as it is")
        yield f"{path.name} {'changed' if update(lines, path) else 'has these figures'}"


def between(text: str) -> str:
    """Return the text between the markers."""
    head, begin, rest = text.partition(BEGIN)
    body, end, _ = rest.partition(END)
    if not begin or not end or BEGIN in rest or END in head:
        raise ValueError(f"the page needs one {BEGIN!r} and one {END!r} after it")
    return body


def update(lines: Iterable[str], path: Path = PAGE) -> bool:
    """Write ``lines`` between the markers of the file, and return whether it changed."""
    text = path.read_text(encoding="utf-8")
    old = f"{BEGIN}{between(text)}{END}"
    return write_file(path, text.replace(old, "\n".join([BEGIN, *lines, "", END])).encode())


def rows(text: str) -> list[list[str]]:
    """Return the cells of each row of the Markdown tables in ``text``, without headings and rules."""
    table, lines = [], text.splitlines()
    for line, following in zip(lines, [*lines[1:], ""], strict=True):
        if line.startswith("|") and not any(words.startswith("|---") for words in (line, following)):
            table.append([cell.strip() for cell in line.strip("|").split("|")])
    return table
