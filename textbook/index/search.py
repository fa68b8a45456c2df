"""Find places in the texts: ``2.75``, ``(3.12)-(3.13)``, ``Siegwart 3.19``, ``Table 2.1``, ``Piaggio``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

from textbook.index.places import KINDS, TEXTS, Place, covered, not_covered, order, places_of
from textbook.index.records import Row
from textbook.index.table import ROWS

NEAR = 4  # places that a query without a match names
_SHORT = 4  # letters: shorter words must be whole words of a row, because they occur in many longer words
Number = tuple[int, ...]  # of a place: 3.12 is (3, 12)
# Beginning of a word of a query -> the kind of place.
_KIND_WORDS = {
    "eq": "equation", "formula": "equation", "tab": "table", "fig": "figure", "exerc": "exercise",
    "probl": "exercise", "examp": "exercise", "ex": "exercise", "sec": "section", "chap": "section",
}  # fmt: skip
_HYPHEN = re.compile(
    r"(?<=[\da-z)])\s*[-–]\s*(?=\(?\d)|(?<=\d\))\s+to\s+(?=\()|(?<=\d)\s+to\s+(?=\d)"
)  # of a range
_NUMBER = re.compile(r"(\d+(?:\.\d+)*)\)?\(?[a-z]?")  # with the letter of a line or part: 2.8a, 3.7.3(b


@dataclass(frozen=True, slots=True)
class Query:
    """What a user looks for: texts, a kind of place, numbers, and other words; empty if not given."""

    texts: tuple[str, ...]
    kind: str
    ranges: tuple[tuple[Number, Number], ...]  # first and last number; equal for a single number
    words: tuple[str, ...]

    def meets(self, place: Place) -> bool:
        """Return whether a place is one that is looked for; words are not compared."""
        return (
            (not self.texts or place.text in self.texts)
            and self.kind in ("", place.kind)
            and (not self.ranges or any(_inside(place.number, *ends) for ends in self.ranges))
        )

    @property
    def too_short(self) -> bool:
        """Return whether the query has nothing but single letters."""
        return not (self.texts or self.kind or self.ranges) and all(len(word) < 2 for word in self.words)


def _inside(number: Number, first: Number, last: Number) -> bool:
    """Return whether a number is in a range of its chapter or section."""
    return number == first or (number[:-1] == first[:-1] and first <= number <= last)


@dataclass(frozen=True, slots=True)
class Found:
    """Rows, and places that no row covers. ``near``: places or words close to a query that has neither."""

    rows: tuple[Row, ...]
    missing: dict[Place, str]
    near: tuple[str, ...]


def parsed(text: str) -> Query:
    """Return the query that a user typed."""
    texts: list[str] = []
    words: list[str] = []
    kind = ""
    ranges: list[tuple[Number, Number]] = []
    for word in _HYPHEN.sub("-", text).split():
        plain = word.strip(".,:;()-").lower()
        named = [name for name in TEXTS if name.lower().startswith(plain)] if len(plain) > 3 else []
        kinds = [kind for start, kind in _KIND_WORDS.items() if plain.startswith(start)]
        ends = _range(plain)
        if named:
            texts += named
        elif ends and (
            not ranges or len(ends[0]) == len(ranges[0][0]) > 1
        ):  # not the 3 of "Table 2.1, 3 wheels"
            ranges.append(ends)
            kind = kind or (KINDS[0] if word.startswith("(") else "")  # (3.12) is an equation
        elif plain == "and" and ranges:
            continue
        elif kinds and _is_kind(plain):
            kind = kinds[0]
        elif plain:
            words.append(plain)
    return Query(tuple(texts), kind, tuple(ranges), tuple(words))


def _range(word: str) -> tuple[Number, Number] | None:
    """Return first and last number of a word such as ``(3.12)-(3.13)`` or ``3.12-13``; None for other words."""
    parts = [_NUMBER.fullmatch(part.strip("()")) for part in word.split("-")]
    if len(parts) > 2 or not parts[0] or not parts[-1]:
        return None
    first, last = (tuple(int(n) for n in part[1].split(".")) for part in (parts[0], parts[-1]))
    last = (*first[: len(first) - len(last)], *last)
    if first[:-1] != last[:-1]:
        return None
    return min(first, last), max(first, last)


def find(text: str) -> Found:
    """Return the rows of the table for a query, or what is near to it."""
    query = parsed(text)
    if query.too_short:
        return Found((), {}, ())
    exact = {place for place in covered() if text.lower() in (place.label.lower(), str(place).lower())}
    if exact:
        return Found(tuple(row for row in ROWS if exact & set(places_of(row.text, row.places))), {}, ())
    rows = tuple(row for row in ROWS if _row_meets(query, row))
    missing = {
        place: why for place, why in not_covered().items() if query.meets(place) and _says(query, place.label)
    }
    return Found(rows, missing, () if rows or missing else _near(query))


def _is_kind(word: str) -> bool:
    """Return whether a word is the name of a kind of place, abbreviated or in full."""
    word = word.removesuffix("s")
    full = (
        "equations",
        "formulas",
        "tables",
        "figures",
        "exercises",
        "problems",
        "examples",
        "sections",
        "chapters",
    )
    return any(name.startswith(word) for name in full) or word == "eqn"


def _row_meets(query: Query, row: Row) -> bool:
    meets = any(query.meets(place) for place in places_of(row.text, row.places))
    return meets and _says(query, f"{row.places} {row.says} {row.robot} {row.command}")


def _says(query: Query, text: str) -> bool:
    return all(_occurs(word, text.lower()) for word in query.words)


def _occurs(word: str, text: str) -> bool:
    """Return whether a text has a word; a short one must be a whole word."""
    if len(word) >= _SHORT:
        return word in text
    return re.search(rf"(?<![a-z0-9]){re.escape(word)}(?![a-z0-9])", text) is not None


def _near(query: Query) -> tuple[str, ...]:
    """Return the places whose numbers are next to that of a query; without a number, words like its words."""
    every = [place for place in (*covered(), *not_covered()) if not query.texts or place.text in query.texts]
    if query.ranges:
        wanted = query.ranges[0][0]
        of_kind = [place for place in every if place.kind == (query.kind or KINDS[0])]
        alike = [place for place in of_kind if len(place.number) == len(wanted)]
        numbered = sorted((place for place in alike or every if place.number), key=order)
        nearest = sorted(numbered, key=lambda place: _distance(wanted, place.number))
        labels = dict.fromkeys(
            str(place).partition(" (")[0] if place.kind == "table" else str(place) for place in nearest
        )
        return tuple(labels)[:NEAR]
    known = _vocabulary(every)
    close: list[str] = []
    for word in query.words:
        close += [match for match in get_close_matches(word, known, NEAR) if match not in close]
    return tuple(close[:NEAR])


def _distance(wanted: tuple[int, ...], number: tuple[int, ...]) -> tuple[int, ...]:
    """Return how far a number is from that of a query: chapters first, then sections and lines."""
    width = max(len(wanted), len(number))
    left, right = ((*n, *[0] * (width - len(n))) for n in (wanted, number))
    return tuple(abs(a - b) for a, b in zip(left, right, strict=True))


def _vocabulary(places: Iterable[Place]) -> list[str]:
    """Return the words of the rows of some places, and the names of the texts."""
    texts = {place.text for place in places}
    words = {word for row in ROWS if row.text in texts for word in re.findall(r"[a-z]{4,}", row.says.lower())}
    return sorted(words | {text.lower() for text in texts})
