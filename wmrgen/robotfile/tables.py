"""Mappings with known keys: their spelling, what stands behind them, what is missing."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass, field

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
from wmrgen.robotfile.fields import Amount, Choice, Field, ListOf, OneOf, Section, Word
from wmrgen.robotfile.keys import ROBOT, WHEEL
from wmrgen.robotfile.numbers import Kind, Scope, plain_number
from wmrgen.robotfile.quantities import read_quantity
from wmrgen.robotfile.records import Quantity
from wmrgen.robotfile.text import (
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    kind_of,
    lookalike,
    nearest,
    quoted,
    scalar_of,
    suggestion,
)

_NONE = ("none", "no", "false", "off")
_YES_AND_NO = {
    **dict.fromkeys(("yes", "y", "on", "1"), "Write true."),
    **dict.fromkeys(("no", "n", "off", "0"), "Write false."),
}


@dataclass(frozen=True, slots=True)
class Table:
    """The entries of a mapping by key, Greek letters spelled out, and the section that says what they are.

    ``excused``: keys that something else may stand for, which has been told: nothing is said of them again.
    """

    node: MappingNode
    section: Section
    keys: dict[str, Scalar] = field(default_factory=dict)
    values: dict[str, Node] = field(default_factory=dict)
    excused: set[str] = field(default_factory=set)

    @property
    def mark(self) -> Mark:
        return self.node.mark

    def get(self, key: str) -> Node | None:
        return self.values.get(key)

    def require(self, key: str, what: str) -> Node:
        """The value of a key that must be there."""
        if key not in self.values:
            raise self.missing(
                key, what, *self.section.field(key).missing or ("", f"Write {key}: and its value.")
            )
        return self.values[key]

    def missing(self, key: str, what: str, why: str, instead: str) -> RobotFileError:
        """The error for a key that is not there."""
        code = Code.CONSEQUENCE if key in self.excused else Code.MISSING
        return self.node.error(f"{what} has no {key}", why, instead, code=code)

    def require_all(self, what: str, collector: ErrorCollector) -> None:
        """Every key that the section requires must be there."""
        for key in self.section.required:
            with collector:
                self.require(key, what)

    def word(self, key: str) -> bool:
        """What the word of a key means; its default where the key is not given."""
        value = self.section.field(key).value
        assert isinstance(value, Word)
        if key not in self.values:
            return value.words[value.default]
        scalar = scalar_of(self.values[key], key)
        if scalar.text not in value.words:
            hint = suggestion(scalar.text, value.words, {**_YES_AND_NO, **value.aliases})
            why = f"It is {' or '.join(value.words)}."
            raise scalar.error(
                f"{key}: {quoted(scalar.text)} is not known", why, "" if hint.startswith("Valid") else hint
            )
        return value.words[scalar.text]

    def items(self, key: str) -> tuple[Node, ...]:
        """The items of a list, as many as there may be; none where the key is not given."""
        value, node = self.section.field(key).value, self.values.get(key)
        assert isinstance(value, ListOf)
        if node is None:
            return ()
        if not isinstance(node, SequenceNode):
            item = value.item.example if isinstance(value.item, Section) else ""
            example = f"and a line for each, as - {item}" if item else value.example
            said = node.text if isinstance(node, Scalar) and isinstance(value.item, OneOf) else ""
            if said.lower() in _NONE:
                example = "[]"
            elif said.lower() != "true" and re.fullmatch(r"[A-Za-z][\w.]*( *, *[A-Za-z][\w.]*)*", said):
                example = f"[{said}]"
            raise node.error(f"{key} must be a list, not {kind_of(node)}", "", f"Write {key}: {example}.")
        n = len(node.items)
        words = {"key": key, "n": n, "s": "s" * (n != 1), "most": value.most}
        if n < value.least:
            what, why, instead = (text.format(**words) for text in value.few)
            raise node.error(what, why, instead)
        if value.most is not None and n > value.most:
            what, why, instead = (text.format(**words) for text in value.many)
            raise node.items[value.most].error(what, why, instead)
        return node.items

    def scalars(self, key: str) -> tuple[Scalar, ...]:
        """The items of a list of words, which differ."""
        scalars: dict[str, Scalar] = {}
        for item in self.items(key):
            scalar = scalar_of(item, f"an item of {key}")
            if scalar.text in scalars:
                what = f"{quoted(scalar.text)} stands twice in {key}"
                raise scalar.error(what, "", "Delete one of them.", code=Code.TWICE)
            scalars[scalar.text] = scalar
        return tuple(scalars.values())

    def amount(self, key: str, of: str, scope: Scope) -> Quantity | None:
        """The quantity of a key of ``of``; None where it is not given."""
        value, node = self.section.field(key).value, self.values.get(key)
        assert isinstance(value, Amount)
        if node is None:
            return None
        what = f"{key} of {of}"
        return (
            read_number(node, what, scope)
            if value.unit == "1"
            else read_quantity(node, value.kind, what, scope)
        )

    def choose(self, choice: Choice, what: str, required: bool = False) -> tuple[str, ...]:
        """The keys of the one alternative that stands, complete; none where there may be none."""
        standing = [tuple(k for k in keys if k in self.keys) for keys in choice.sets]
        chosen = [(keys, every) for keys, every in zip(standing, choice.sets, strict=True) if keys]
        excused = not self.excused.isdisjoint(key for keys in choice.sets for key in keys)
        if len(chosen) > 1:
            problem, why, instead = choice.several
            later = max((keys[0] for keys, _ in chosen), key=list(self.keys).index)
            both = f"{' and by ' if 'by {keys}' in problem else ' and '}".join(
                " and ".join(keys) for keys, _ in chosen
            )
            code = Code.CONSEQUENCE if excused else Code.TWICE
            raise self.keys[later].error(f"{what} {problem.format(keys=both)}", why, instead, code=code)
        if not chosen:
            if choice.optional and not required:
                return ()
            problem, why, instead = choice.none
            code = Code.CONSEQUENCE if excused else Code.MISSING
            raise self.node.error(f"{what} {problem}", why, instead, code=code)
        for key in chosen[0][1]:
            if not excused:
                self.require(key, what)
        return chosen[0][1]


def read_number(node: Node, what: str, scope: Scope) -> Quantity:
    """A quantity without a unit."""
    scalar = scalar_of(node, what)
    plain = plain_number(scalar)
    if plain and plain[1] is not None:
        raise scalar.error(
            f"{what} is a number, and {quoted(scalar.text.strip())} has a unit", "", "Write the number alone."
        )
    return read_quantity(node, Kind.ANY, what, scope)


def spelled(key: str, section: Section) -> str:
    """``key`` with a Greek letter, in any of its Unicode forms, as the key that it stands for."""
    letters = {f.greek: f.key for f in section.fields if f.greek}
    return letters.get(key) or letters.get(unicodedata.normalize("NFKC", key), key)


def mapping_of(node: Node, what: str, example: str) -> MappingNode:
    if not isinstance(node, MappingNode):
        raise node.error(f"{what} must be a mapping, not {kind_of(node)}", "", f"Write {example}.")
    return node


def table_of(
    node: Node,
    section: Section,
    collector: ErrorCollector,
    what: str = "",
    valid: Collection[str] | None = None,
) -> Table:
    """The node as a table whose keys are those of ``section``, or of them the ``valid`` ones.

    ``collector`` takes what is wrong with keys. A misspelt key stands for the one that is meant.
    """
    what = what or section.title
    table = Table(mapping_of(node, what, section.example), section)
    if table.node.repeated or any(key.text == "<<" for key, _ in table.node.entries):
        table.excused.update(section.keys)
    fields = [f for f in section.fields if valid is None or f.key in valid]
    unknown, last = [], ""
    for key, value in table.node.entries:
        name = spelled(key.text, section)
        if all(name != f.key for f in fields):
            unknown.append((key, value))
            if severed(key, value) and last in table.values:  # so that half of a value is not judged
                del table.keys[last], table.values[last]
                table.excused.add(last)
        elif name in table.keys:
            both = f"{quoted(key.text)} and {quoted(table.keys[name].text)} are the same key"
            why = "Only one of the two could count."
            collector.add(key.error(both, why, "Delete one of them.", code=Code.TWICE))
        else:
            table.keys[name], table.values[name] = key, value
            last = name
    for key, value in unknown:
        collector.add(unknown_key(key, value, fields, what))
        if _one_level_too_deep(value, fields):
            table.excused.update(section.keys)
            continue
        meant, certain = _meant(key.text, fields)
        if meant and meant not in table.keys:
            table.excused.add(meant)
            if certain and not (isinstance(value, Scalar) and not value.text):
                table.keys[meant], table.values[meant] = key, value
    return table


def _meant(word: str, fields: Collection[Field]) -> tuple[str, bool]:
    """The key that an unknown word is likely to stand for, and whether its value can be that key's."""
    for f in fields:
        if word.lower() in f.aliases:
            return f.key, not f.aliases[word.lower()]
    keys = [f.key for f in fields]
    word = re.split("[ :=\uff1a]", word, maxsplit=1)[0]
    return nearest(word, keys), bool(nearest(word, keys, 0.75))


def severed(key: Scalar, value: Node) -> tuple[str, str] | None:
    """Why, and what to write, where a key is what stood behind the comma of a value."""
    if not isinstance(value, Scalar) or value.text or not key.plain:
        return None
    if re.fullmatch(r"[0-9]+( [a-z/]+)?", key.text):
        return "Commas separate entries.", "Write a decimal point."
    if key.text.count(")") > key.text.count("("):
        why = "Inside { } a comma ends the value, also within parentheses."
        return why, "Put an expression that contains a comma in quotes: 'atan2(1, 2)'."
    return None


def _one_level_too_deep(value: Node, fields: Collection[Field]) -> bool:
    """What stands behind a key has several keys of the table in which that key stands."""
    valid = {f.key for f in fields}
    return isinstance(value, MappingNode) and len(valid & {key.text for key, _ in value.entries}) > 1


def unknown_key(key: Scalar, value: Node, fields: Collection[Field], what: str) -> RobotFileError:
    """The error for a key that does not exist, with the nearest one that does."""
    empty = isinstance(value, Scalar) and not value.text
    valid = {f.key for f in fields}
    if behind := severed(key, value):
        return key.error(f"{quoted(key.text)} stands where a key is expected", *behind)
    colon = re.search("[:\uff1a]", key.text)
    if key.plain and colon and empty:
        word, rest = key.text[: colon.start()], key.text[colon.end() :]
        return key.error(
            f"no {'space after the ' if colon[0] == ':' else ''}colon in {quoted(key.text)}",
            lookalike(key.text) or "YAML needs one.",
            f"Write {word}: {rest.strip()}",
        )
    word = re.split("[ =]", key.text, maxsplit=1)[0]
    rest = key.text[len(word) :]
    if key.plain and empty and word in valid:
        return key.error(f"no colon in {quoted(key.text)}", "", f"Write {word}: {rest.lstrip(' =')}")
    if key.text == "<<":
        return key.error("'<<' merges mappings in YAML", "Merge keys are refused.", "Write the keys out.")
    unknown, why = f"unknown key {quoted(key.text)} in {what}", lookalike(key.text)
    if _one_level_too_deep(value, fields):
        return key.error(unknown, why, "Delete the line, and write what stands below it without indentation.")
    aliases = {alias: text for f in fields for alias, text in f.hints.items()}
    instead = suggestion(key.text, [f.key for f in fields], aliases)
    inside = () if key.text.lower() in aliases else _inside(fields, key.text)
    if inside:
        instead = f"Write {inside[0]}."
    elif instead.startswith("Valid"):
        whose = [f"It is a key of {section.title}." for section in (ROBOT, WHEEL) if key.text in section.keys]
        why = whose[0] if whose else why
    return key.error(unknown, why, instead, code=Code.UNKNOWN_KEY)


def _inside(fields: Collection[Field], word: str) -> list[str]:
    """Where in what stands under some of the fields a word is a key, the outermost places first."""
    under = [(f.key, f.value.fields) for f in fields if isinstance(f.value, Section)]
    own = [f"{key}: {{{s.key}: …}}" for key, inner in under for s in inner if word in (s.key, *s.aliases)]
    return own + [f"{key}: {{{deeper}}}" for key, inner in under for deeper in _inside(inner, word)]
