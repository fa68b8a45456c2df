"""Places in the texts: which are covered by a row of the table, and which are not, with the reason."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from textbook.index.table import ROWS

# The numbered lines of our copies: chapter (0 if numbers have no chapter), first and last number.
_NUMBERED = {
    "Tzafestas": ((2, 1, 91),),
    "Konstantinov": ((0, 1, 6),),
    "Kelly": ((4, 18, 18), (4, 23, 31), (4, 39, 40), (4, 62, 62)),
    "Siegwart": ((3, 1, 65),),
    "AA274": (),
}
TEXTS = tuple(_NUMBERED)
_UNKNOWN = "our notes do not have this line"
# Text -> places, and why no command reproduces them.
_REASONS = {
    "Tzafestas": {
        "(2.19)-(2.22)": "a definition, without numbers",
        "(2.23)": "an example of an integrable constraint, without a robot",
        "2.3.4": "sets of speeds, {-1, 0, 1} and {0, 1}; no command of its own",
    },
    "Konstantinov": {
        "v_i^2": "checked in symbols, see the errata; no command prints squares of velocities",
    },
    "Kelly": {
        "(4.18)": "a definition, without numbers",
        "4.1.3.2": "the slides do not have the formula of the margin",
        "Fresnel argument": "an argument in words, without numbers",
    },
    "Siegwart": {
        "(3.1)": "a definition, without numbers",
        "Problem 3.7.3(a)": "our notes have part (b) only",
    },
    "AA274": {},
}
_RANGE = re.compile(r"\((\d+\.)?(\d+)[a-z]?\)(?:-\((?:\d+\.)?(\d+)[a-z]?\))?")
_PART = re.compile(r",\s+(?![^(]*\))")  # a comma outside of parentheses
KINDS = ("equation", "table", "figure", "exercise", "section")
_FIRST_WORDS = {"table": "table", "figure": "figure", "problem": "exercise", "example": "exercise"}


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A place in a text: an equation ``(2.75)``, ``Figure 3.15``, ``Table 2.1 (2 wheels, 1)``, or a section."""

    text: str
    label: str

    @property
    def kind(self) -> str:
        """One of `KINDS`; problems and examples are exercises."""
        if self.label.startswith("("):
            return "equation"
        return _FIRST_WORDS.get(self.label.partition(" ")[0].lower(), "section")

    @property
    def number(self) -> tuple[int, ...]:
        """The number of the place, of a table without its row; empty if it has none."""
        found = re.search(r"\d+(?:\.\d+)*", self.label)
        return tuple(int(n) for n in found[0].split(".")) if found else ()

    def __str__(self) -> str:
        return f"{self.text} {self.label}"


def places_of(text: str, places: str) -> Iterator[Place]:
    """Yield the places that a row names, each equation of a range by itself.

    Args:
        text: the text.
        places: such as ``(3.9)-(3.11), Figure 3.14 (omni-steer)``; letters of equations are left out.

    Yields:
        The places.
    """
    for part in _PART.split(places):
        found = _RANGE.fullmatch(part)
        if found:
            first, last = int(found[2]), int(found[3] or found[2])
            for number in range(first, last + 1):
                yield Place(text, f"({found[1] or ''}{number})")
        elif part.startswith("Figure"):
            yield Place(text, part.partition(" (")[0])
        else:
            yield Place(text, part)


@cache
def covered() -> frozenset[Place]:
    """Return the places that a row of the table reproduces."""
    return frozenset(place for row in ROWS for place in places_of(row.text, row.places))


@cache
def not_covered() -> MappingProxyType[Place, str]:
    """Return the places that no row reproduces, in order, with the reason."""
    reasons = {place: reason for place, reason in _listed() if place not in covered()}
    for place in _numbered():
        if place not in covered():
            reasons.setdefault(place, _UNKNOWN)
    return MappingProxyType(dict(sorted(reasons.items(), key=lambda item: order(item[0]))))


def order(place: Place) -> tuple[int, int, tuple[int, ...], str]:
    """Return a key that sorts places by text, kind and number."""
    return TEXTS.index(place.text), KINDS.index(place.kind), place.number, place.label


def count(text: str = "") -> tuple[int, int]:
    """Return how many places are covered, and how many there are, in one text or in all."""
    here = [place for place in covered() if text in ("", place.text)]
    missing = [place for place in not_covered() if text in ("", place.text)]
    return len(here), len(here) + len(missing)


def in_ranges(places: Iterable[Place]) -> list[str]:
    """Return labels of places in order, with equations that follow one another as a range."""
    labels: list[str] = []
    runs: list[list[Place]] = []
    for place in places:
        last = runs[-1][-1] if runs else None
        if (
            last
            and place.kind == last.kind == "equation"
            and place.number == (*last.number[:-1], last.number[-1] + 1)
        ):
            runs[-1].append(place)
        else:
            runs.append([place])
    for run in runs:
        labels.append(run[0].label if len(run) == 1 else f"{run[0].label}-{run[-1].label}")
    return labels


def _numbered() -> Iterator[Place]:
    for text, ranges in _NUMBERED.items():
        for chapter, first, last in ranges:
            for number in range(first, last + 1):
                yield Place(text, f"({chapter}.{number})" if chapter else f"({number})")


def _listed() -> Iterator[tuple[Place, str]]:
    for text, reasons in _REASONS.items():
        for places, reason in reasons.items():
            for place in places_of(text, places):
                yield place, reason
