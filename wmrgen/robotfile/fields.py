"""What a key of a robot file is: one record says its meaning, its value and the words of every message about it.

`wmrgen.robotfile.keys` holds the records. Reading, messages, the JSON Schema and the reference documentation all go by
them, so that a key is declared once.
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


class Text(NamedTuple):
    """Free text for people."""

    longest: int


@dataclass(frozen=True, slots=True)
class Word:
    """One of a few words; ``words`` says what each means, ``default`` which stands for none.

    ``interval``: instead of the word that means yes a list [low, high] of such quantities may stand.
    """

    words: Mapping[str, bool]
    default: str
    aliases: Mapping[str, str] = field(default_factory=dict)
    interval: Kind | None = None


YES = {"true": True, "false": False}


class Amount(NamedTuple):
    """A quantity: a number, a number with a unit, an expression. ``unit``: what else than the units of the kind."""

    kind: Kind
    unit: str = ""


class Interval(NamedTuple):
    """A quantity v for [-v, v], or a list [low, high]."""

    kind: Kind


class OneOf(NamedTuple):
    """A name that something else declares: a ``joint`` of the wheel, a ``wheel``, a wheel's joint as
    ``wheel.joint``, a wheel ``type``, a ``function``."""

    what: str


class ListOf(NamedTuple):
    """A list of at least ``least`` and at most ``most`` items; ``once``: all different.

    ``few`` and ``many`` are the error (what, why, what to write) where there are fewer or more: {n} items of {key}.
    """

    item: Value
    example: str = ""
    least: int = 0
    most: int | None = None
    once: bool = False
    few: Error = ("", "", "")
    many: Error = ("{n} {key}", "At most {most} are derived.", "")


class Mapped(NamedTuple):
    """New names, at most ``most``, each with a value of its own or with the keys of ``section``."""

    section: Section
    most: int


class Section(NamedTuple):
    """A mapping with known keys. ``title`` names it in messages, ``example`` is what to write.

    ``choices``: sets of keys of which exactly one stands, all its keys together.
    """

    title: str
    example: str
    fields: tuple[Field, ...]
    choices: tuple[Choice, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(f.key for f in self.fields)

    @property
    def required(self) -> tuple[str, ...]:
        return tuple(f.key for f in self.fields if f.required)

    def keys_of(self, joints: Iterable[str]) -> tuple[str, ...]:
        """The keys that are about these joints."""
        return tuple(f.key for joint in joints for f in self.fields if f.joint == joint)

    def field(self, key: str) -> Field:
        """The record of a key; KeyError where there is none."""
        return {f.key: f for f in self.fields}[key]


Value = Version | Name | Text | Word | Amount | Interval | OneOf | ListOf | Mapped | Section
Reason = tuple[str, str]  # why it matters, what to write instead
Error = tuple[str, str, str]  # what is wrong, why it matters, what to write instead


@dataclass(frozen=True, slots=True)
class Field:
    """A key.

    ``meaning``: in a phrase. ``greek``: the letter that may stand for it. ``default``: what counts where the key is
    not given, in words. ``aliases``: what people write instead, each with a hint ("" asks whether they meant the
    key). ``missing``: of a required key. ``misfit``: of a wheel's key that its type does not take; such a key is
    taken by the wheel types that name it (`wmrgen.robotfile.wheel_types`), one without by all. ``joint``: of a
    limit, the joint that has it; "" is the robot. ``example``: a value, where that of its kind makes no sense.
    """

    key: str
    value: Value
    meaning: str
    required: bool = False
    default: str = ""
    greek: str = ""
    aliases: Mapping[str, str] = field(default_factory=dict)
    missing: Reason | None = None
    misfit: Reason | None = None
    joint: str = ""
    example: str = ""

    @property
    def spellings(self) -> tuple[str, ...]:
        return (self.key, self.greek) if self.greek else (self.key,)

    @property
    def hints(self) -> dict[str, str]:
        """Alias -> what to write."""
        return {alias: text or f"Did you mean {self.key}?" for alias, text in self.aliases.items()}


class Choice(NamedTuple):
    """Of several sets of keys exactly one stands, all its keys together; ``optional``: or none.

    ``several`` and ``none``: what is wrong, why, and what to write. {keys} are those that stand.
    """

    sets: tuple[tuple[str, ...], ...]
    several: Error = ("", "", "")
    none: Error = ("", "", "")
    optional: bool = False
