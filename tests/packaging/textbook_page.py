"""docs/textbook.md: which function reproduces which equation of the five texts, with a command to evaluate it.

``python -m tests.packaging.textbook_page`` writes it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

import wmrgen
from tests.conftest import ROOT
from textbook.errata.texts import BIBLIOGRAPHY, ENTRIES, HOLDS
from textbook.library import FUNCTIONS as LIBRARY
from textbook.library import formula
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import FUNCTIONS, names

PAGE = ROOT / "docs" / "textbook.md"
# Robots of the gallery to try for each function, in this order: first those with textbook dimensions.
ROBOTS = (
    "textbook_differential", "textbook_tricycle", "textbook_omnidirectional", "ackermann_car", "kuka_youbot",
    "locked_bicycle", "car_with_trailers", "pioneer3dx",
)  # fmt: skip
THREE_OMNI_WHEELS = "textbook_omnidirectional"  # the robot of Konstantinov's paper
_TEXTS = "|".join(BIBLIOGRAPHY)
_SOURCE = re.compile(rf"({_TEXTS})((?:(?!{_TEXTS}|;).)*)")
HEAD = f"""\
# Textbook equations: functions and commands

These tables lead from an equation of five texts to the function that reproduces it. Equations have the numbers of
the texts. "Corrected" marks an equation that is wrong in our copy.

{len(HOLDS)} equations and statements of the texts were checked in symbols and hold.
[Errata](../generated/errata.md) lists them, and {len(ENTRIES)} lines of our copies that are wrong or need care. The
[tests](../tests/README.md) derive every system of the texts.

A command without inputs evaluates the function at 0. Add inputs as NAME=VALUE, such as `vx=0.5 omega=1`. Replace the
robot file by your own. To find an equation, search this page for its number, such as (2.75).
"""


class Row(NamedTuple):
    """A function with its place in a text."""

    place: str
    function: str
    command: str

    @property
    def order(self) -> tuple[list[int], str]:
        """The numbers of the first equation, for sorting."""
        first = re.search(r"\d+(?:\.\d+)*", self.place)
        return [int(n) for n in first[0].split(".")] if first else [], self.place


def page() -> str:
    """Return the whole page."""
    rows = _rows()
    return HEAD + "".join(text for name in BIBLIOGRAPHY for text in _table(name, rows[name]))


def _table(name: str, rows: list[Row]) -> Iterator[str]:
    """Yield the section of a text."""
    title = BIBLIOGRAPHY[name].partition(". The second copy ")[0].rstrip(".")
    yield f"\n## {name}\n\n{title}.\n\n| in the text | function | command |\n|---|---|---|\n"
    for row in sorted(rows, key=lambda r: r.order):
        yield f"| {row.place} | `{row.function}` | {row.command} |\n"


def _rows() -> dict[str, list[Row]]:
    """Return the rows of each text."""
    rows: dict[str, list[Row]] = {name: [] for name in BIBLIOGRAPHY}
    derivations = {robot: wmrgen.derive(wmrgen.load(ROOT / "robots" / f"{robot}.yaml")) for robot in ROBOTS}
    for name in names():
        for text, place in _SOURCE.findall(FUNCTIONS[name].source):
            first = {THREE_OMNI_WHEELS: derivations[THREE_OMNI_WHEELS]} if text == "Konstantinov" else {}
            rows[text].append(Row(place.strip(" ,") or "–", name, _command(name, first | derivations)))
    for name in LIBRARY:
        for text, place in _SOURCE.findall(formula(name).text):
            rows[text].append(Row(place.strip(" ,") or "–", name, f"`wmrgen eval textbook {name}`"))
    return rows


def _command(name: str, derivations: dict[str, Derivation]) -> str:
    """Return a command that evaluates a function of a robot, with the first robot that has it."""
    for robot, derivation in derivations.items():
        try:
            derivation.formula(name)
        except NotDerivableError:
            continue
        return f"`wmrgen eval robots/{robot}.yaml {name}`"
    return "see `wmrgen functions ROBOT` for the key that the robot file needs"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
