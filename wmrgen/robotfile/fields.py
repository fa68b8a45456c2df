"""The records that describe a key of a robot file: its meaning, its value and the text of its messages.

`wmrgen.robotfile.keys` declares each key once. Reading, messages, the JSON Schema and the reference page all use these
records.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from wmrgen.robotfile.numbers import Kind


class Version(NamedTuple):
    """The number of the format."""

    number: str


@dataclass(frozen=True, slots=True)
class Name:
    """A new name, see `wmrgen.robotfile.names`."""


@dataclass(frozen=True, slots=True)
class Letter:
    """The letter of a parameter in formulas, see `wmrgen.robotfile.names.symbol_name`."""


class Text(NamedTuple):
    """Free text for people."""

    longest: int  # characters


class OuterName(NamedTuple):
    """The name of a joint or frame in other tools, see `wmrgen.robotfile.names.outer_name`."""

    signed: bool  # whether a minus sign before the name means the opposite direction


@dataclass(frozen=True, slots=True)
class Word:
    """One of a few words."""

    words: Mapping[str, bool]  # each word with its meaning
    default: str  # the word that is assumed if the key is absent
    aliases: Mapping[str, str] = field(default_factory=dict)  # other words, with a hint
    interval: Kind | None = None  # a list [low, high] of such quantities may replace the word that means yes


YES = {"true": True, "false": False}


class Amount(NamedTuple):
    """A quantity: a number, a number with a unit, or an expression."""

    kind: Kind
    unit: str = ""  # shown in place of the units of the kind; "1" is a number that has no unit


class Interval(NamedTuple):
    """A quantity v, which means [-v, v], or a list [low, high]."""

    kind: Kind


class OneOf(NamedTuple):
    """A name that is declared elsewhere."""

    what: str  # joint (of the same wheel), wheel, wheel.joint, type (of wheels) or function


class ListOf(NamedTuple):
    """A list of values."""

    item: Value
    example: str = ""
    least: int = 0  # number of items
    most: int | None = None  # number of items
    once: bool = False  # whether all items must differ
    # The errors for too few and too many items: {n} items of {key}.
    few: Error = ("", "", "")
    many: Error = ("{n} {key}", "At most {most} are allowed.", "Delete the others.")


class Mapped(NamedTuple):
    """New names, each with a value or with the keys of a section."""

    section: Section
    most: int  # number of names


class Section(NamedTuple):
    """A mapping with known keys."""

    title: str  # names the section in messages
    example: str  # of what to write
    fields: tuple[Field, ...]
    choices: tuple[Choice, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys."""
        return tuple(f.key for f in self.fields)

    @property
    def required(self) -> tuple[str, ...]:
        """The keys that must be there."""
        return tuple(f.key for f in self.fields if f.required)

    def keys_of(self, joints: Iterable[str]) -> tuple[str, ...]:
        """Return the keys that belong to these joints."""
        keys: list[str] = []
        for joint in joints:
            keys += [f.key for f in self.fields if f.joint == joint]
        return tuple(keys)

    def field(self, key: str) -> Field:
        """Return the record of a key; raise KeyError if the section does not have it."""
        return {f.key: f for f in self.fields}[key]


Value = (
    Version | Name | Letter | OuterName | Text | Word | Amount | Interval | OneOf | ListOf | Mapped | Section
)
Reason = tuple[str, str]  # why it matters, what to write
Error = tuple[str, str, str]  # what is wrong, why it matters, what to write


@dataclass(frozen=True, slots=True)
class Field:
    """A key."""

    key: str
    value: Value
    meaning: str  # a phrase
    required: bool = False
    default: str = ""  # the value that is assumed if the key is absent, in words
    greek: str = ""  # the letter that may be written in place of the key
    # Other words for the key, with a hint; "": "Did you mean".
    aliases: Mapping[str, str] = field(default_factory=dict)
    missing: Reason | None = None  # the error for an absent required key
    misfit: Reason | None = (
        None  # the error for a wheel whose type does not have the key; None if all types have it
    )
    joint: str = ""  # the joint that a limit, noise, encoder or lag belongs to; "" is the robot
    example: str = ""  # a value for the reference page; not needed if `value` has an example

    @property
    def spellings(self) -> tuple[str, ...]:
        """The key, and its Greek letter if it has one."""
        return (self.key, self.greek) if self.greek else (self.key,)

    @property
    def hints(self) -> dict[str, str]:
        """What to write in place of each alias."""
        return {alias: text or f"Did you mean {self.key}?" for alias, text in self.aliases.items()}


class Choice(NamedTuple):
    """Sets of keys. A mapping has all keys of exactly one set and no key of another."""

    sets: tuple[tuple[str, ...], ...]
    several: Reason = ("", "")  # the error if keys of several sets are there
    none: Error = ("", "", "")  # the error if no key is there
    optional: bool = False  # whether a mapping may have none of the keys
