"""``python -m tests.packaging.textbook_robots`` writes docs/textbook_robots.md and its pictures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import wmrgen
from tests.conftest import ROOT
from textbook.index.places import TEXTS
from textbook.index.records import Row, facts
from textbook.index.table import ROWS
from wmrgen.cli.gallery import TEXTS as FOLDER
from wmrgen.cli.gallery import robots_of_texts
from wmrgen.report.sections.markdown import escape, page, table

PAGE = ROOT / "docs" / "textbook_robots.md"
PICTURES = ROOT / "docs" / "figures" / FOLDER
TABLE = "Table 2.1"
COLUMNS = 2  # pictures in a row: two fit on the screen of a phone


def content() -> str:
    """Return the page. It reads no robot but its file: degrees are those of the table of places."""
    return page(_blocks())


def picture(name: str) -> bytes:
    """Return the top view of a robot of the texts."""
    derivation = wmrgen.derive(wmrgen.load(robots_of_texts()[name]))
    return derivation.figures["layout.svg"][1].encode()


def _blocks() -> Iterator[str]:
    rows = [row for row in ROWS if row.robot.startswith(f"{FOLDER}/")]
    in_table = [row for row in rows if row.places.startswith(TABLE)]
    shown = {row.robot for row in in_table}
    yield "# Robots of the texts"
    yield (
        f"These {len({row.robot for row in rows})} robot files describe layouts of five texts. Each file names its "
        "source and its assumptions. Most texts have symbols only and no lengths, so most lengths are chosen. "
        "`wmrgen new my_robot --from siegwart_piaggio` starts a robot file from a layout. "
        "[Textbook equations](textbook.md) has a command for each."
    )
    yield f"## Siegwart, table 2.1: all {len(in_table)} rows"
    yield (
        "Our copy has no icons of the table, so the pictures follow the descriptions in our notes. The numbers in "
        "brackets are the degrees of mobility, steerability and maneuverability."
    )
    yield from _pictures(in_table)
    for text in TEXTS:
        others = {row.robot: row for row in reversed(rows) if row.text == text and row.robot not in shown}
        shown |= set(others)
        if others:
            yield f"## {text}"
            yield from _pictures([others[robot] for robot in sorted(others)])


def _pictures(rows: Sequence[Row]) -> list[str]:
    cells = [_cell(row) for row in rows]
    cells += [""] * (-len(cells) % COLUMNS)
    lines: Iterable[Sequence[str]] = (cells[k : k + COLUMNS] for k in range(0, len(cells), COLUMNS))
    return table([" "] * COLUMNS, lines, "l")


def _cell(row: Row) -> str:
    name = row.robot.removeprefix(f"{FOLDER}/")
    robot = wmrgen.load(robots_of_texts()[name])
    degrees = facts(row.case).get("degrees")
    caption = f"<br>({', '.join(map(str, degrees))})" if degrees and row.command.startswith("derive ") else ""
    place = f"{escape(row.places)}<br>" if row.places.startswith(TABLE) else ""
    alt = escape(f"Top view of {robot.name}")
    return f"![{alt}](figures/{FOLDER}/{name}.svg)<br>{place}{escape(robot.description)}{caption}<br>`{name}`"


if __name__ == "__main__":
    PICTURES.mkdir(parents=True, exist_ok=True)
    for robot_name in robots_of_texts():
        (PICTURES / f"{robot_name}.svg").write_bytes(picture(robot_name))
    PAGE.write_text(content(), encoding="utf-8")
