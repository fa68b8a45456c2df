"""Finding places in the texts: ``2.75``, ``Siegwart 3.19``, ``Table 2.1``, ``Exercise 3.7.1``, ``Piaggio``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

from textbook.index.places import KINDS, TEXTS, Place, covered, not_covered, order, places_of
from textbook.index.records import Row
from textbook.index.table import ROWS

NEAR = 4  # places that a query without a match names
# Beginning of a word of a query -> the kind of place.
_KIND_WORDS = {
    "eq": "equation", "formula": "equation", "tab": "table", "fig": "figure", "exerc": "exercise",
    "probl": "exercise", "examp": "exercise", "ex": "exercise", "sec": "section", "chap": "section",
}  # fmt: skip
_NUMBER = re.compile(r"(\d+(?:\.\d+)*)\)?\(?[a-z]?")  # with the letter of a line or part: 2.8a, 3.7.3(b


@dataclass(frozen=True, slots=True)
class Query:
    """What a user looks for: texts, a kind of place, a number, and other words; empty if not given."""

    texts: tuple[str, ...]
    kind: str
    number: tuple[int, ...]
    words: tuple[str, ...]

    def meets(self, place: Place) -> bool:
        """Return whether a place is one that is looked for; words are not compared."""
        return (
            (not self.texts or place.text in self.texts)
            and self.kind in ("", place.kind)
            and self.number in ((), place.number)
        )


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
    kind, number = "", tuple[int, ...]()
    for word in text.split():
        plain = word.strip(".,:;()").lower()
        named = [name for name in TEXTS if name.lower().startswith(plain)] if len(plain) > 3 else []
        kinds = [kind for start, kind in _KIND_WORDS.items() if plain.startswith(start)]
        numbered = _NUMBER.fullmatch(plain)
        if named:
            texts += named
        elif numbered and not number:  # the first number is that of the place
            number = tuple(int(n) for n in numbered[1].split("."))
        elif kinds and _is_kind(plain):
            kind = kinds[0]
        elif plain:
            words.append(plain)
    return Query(tuple(texts), kind, number, tuple(words))


def find(text: str) -> Found:
    """Return the rows of the table for a query, or what is near to it."""
    query = parsed(text)
    if not any((query.texts, query.kind, query.number, query.words)):
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
    return all(word in text.lower() for word in query.words)


def _near(query: Query) -> tuple[str, ...]:
    """Return the places whose numbers are next to that of a query; without a number, words like its words."""
    every = [place for place in (*covered(), *not_covered()) if not query.texts or place.text in query.texts]
    if query.number:
        of_kind = [place for place in every if place.kind == (query.kind or KINDS[0])]
        alike = [place for place in of_kind if len(place.number) == len(query.number)]
        numbered = sorted((place for place in alike or every if place.number), key=order)
        nearest = sorted(numbered, key=lambda place: _distance(query.number, place.number))
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
