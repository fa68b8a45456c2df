"""Mappings with known keys: find unknown, missing and conflicting keys, and read the values of the others."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass, field
from itertools import chain

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
from wmrgen.robotfile.fields import Amount, Choice, Field, ListOf, OneOf, Section, Word
from wmrgen.robotfile.keys import ROBOT, WHEEL
from wmrgen.robotfile.numbers import Kind, plain_number
from wmrgen.robotfile.quantities import Scope, read_quantity
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

_NO_ITEMS = ("none", "no", "false", "off")  # words that people write for an empty list
_EVERY_ITEM = ("true", "yes", "on", "all", "both")  # in place of a list: every item, whatever they are
_YES_AND_NO = {
    **dict.fromkeys(("yes", "y", "on", "1"), "Write true."),
    **dict.fromkeys(("no", "n", "off", "0"), "Write false."),
}


@dataclass(frozen=True, slots=True)
class Table:
    """The entries of a mapping by key, with Greek letters spelled out."""

    node: MappingNode
    section: Section  # describes the keys
    keys: dict[str, Scalar] = field(default_factory=dict)
    values: dict[str, Node] = field(default_factory=dict)
    # Keys that an unknown key probably means: as that key has been reported, they are not reported as missing.
    excused: set[str] = field(default_factory=set)

    @property
    def mark(self) -> Mark:
        """The place where the mapping begins."""
        return self.node.mark

    def get(self, key: str) -> Node | None:
        """Return the value of a key, or None if it is absent."""
        return self.values.get(key)

    def require(self, key: str, what: str) -> Node:
        """Return the value of a key; raise RobotFileError if it is missing. ``what`` names the mapping in messages."""
        if key not in self.values:
            reason = self.section.field(key).missing or ("", f"Write {key}: and its value.")
            raise self.missing(key, what, *reason)
        return self.values[key]

    def missing(self, key: str, what: str, why: str, instead: str) -> RobotFileError:
        """Return the error for a missing key.

        Args:
            key: The key.
            what: Names the mapping in messages.
            why: Why the key is needed.
            instead: What to write.
        """
        code = Code.CONSEQUENCE if key in self.excused else Code.MISSING
        return self.node.error(f"{what} has no {key}", why, instead, code=code)

    def require_all(self, what: str, collector: ErrorCollector) -> None:
        """Report each missing key that the section requires."""
        for key in self.section.required:
            with collector:
                self.require(key, what)

    def word(self, key: str) -> bool:
        """Return the meaning of the word of a key, or of its default if the key is absent."""
        value = self.section.field(key).value
        assert isinstance(value, Word)
        if key not in self.values:
            return value.words[value.default]
        scalar = scalar_of(self.values[key], key)
        if scalar.text not in value.words:
            hint = suggestion(scalar.text, value.words, {**_YES_AND_NO, **value.aliases})
            why = f"The value is {' or '.join(value.words)}."
            raise scalar.error(
                f"{key}: {quoted(scalar.text)} is not known", why, "" if hint.startswith("Valid") else hint
            )
        return value.words[scalar.text]

    def items(self, key: str) -> tuple[Node, ...]:
        """Return the items of a list, or none if the key is absent; raise RobotFileError for too few or too many."""
        value, node = self.section.field(key).value, self.values.get(key)
        assert isinstance(value, ListOf)
        if node is None:
            return ()
        if not isinstance(node, SequenceNode):
            instead = f"Write {key}: {_list_for(node, value)}."
            raise node.error(f"{key} must be a list, not {kind_of(node)}", "", instead)
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
        """Return the items of a list of distinct words."""
        scalars: dict[str, Scalar] = {}
        for item in self.items(key):
            scalar = scalar_of(item, f"an item of {key}")
            if scalar.text in scalars:
                what = f"{quoted(scalar.text)} is in {key} twice"
                raise scalar.error(what, "", "Delete one of them.", code=Code.TWICE)
            scalars[scalar.text] = scalar
        return tuple(scalars.values())

    def amount(self, key: str, of: str, scope: Scope) -> Quantity | None:
        """Read the quantity of a key.

        Args:
            key: The key.
            of: Names the mapping in messages.
            scope: The parameters that expressions may use.

        Returns:
            The quantity, or None if the key is absent.
        """
        value, node = self.section.field(key).value, self.values.get(key)
        assert isinstance(value, Amount)
        if node is None:
            return None
        what = f"{key} of {of}"
        if value.unit == "1":
            return read_number(node, what, scope)
        return read_quantity(node, value.kind, what, scope)

    def choose(self, choice: Choice, what: str, required: bool = False) -> tuple[str, ...]:
        """Find which alternative of a choice the mapping has, and check that it is complete.

        Args:
            choice: The alternatives.
            what: Names the mapping in messages.
            required: Whether one is needed even if the choice is optional.

        Returns:
            The keys of the alternative; empty if the mapping has none and needs none.
        """
        chosen = []  # the keys that are there of each alternative, and all its keys
        for every in choice.sets:
            present = [key for key in every if key in self.keys]
            if present:
                chosen.append((present, every))
        excused = not self.excused.isdisjoint(chain.from_iterable(choice.sets))
        if len(chosen) > 1:
            later = max((keys[0] for keys, _ in chosen), key=list(self.keys).index)
            *others, last = chain.from_iterable(keys for keys, _ in chosen)
            code = Code.CONSEQUENCE if excused else Code.TWICE
            raise self.keys[later].error(
                f"{what} has {', '.join(others)} and {last}", *choice.several, code=code
            )
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


def _list_for(node: Node, value: ListOf) -> str:
    """Return the list to write in place of a node that is not a list: of its words, if it has words."""
    if isinstance(value.item, Section):
        return f"and one line for each, such as - {value.item.example}"
    text = node.text if isinstance(node, Scalar) and isinstance(value.item, OneOf) else ""
    if text.lower() in _NO_ITEMS:
        return "[]"
    if text.lower() not in _EVERY_ITEM and re.fullmatch(r"[A-Za-z][\w.]*( *, *[A-Za-z][\w.]*)*", text):
        return f"[{text}]"
    return value.example


def read_number(node: Node, what: str, scope: Scope) -> Quantity:
    """Read a quantity that has no unit.

    Args:
        node: The value.
        what: Names the value in messages.
        scope: The parameters that expressions may use.
    """
    scalar = scalar_of(node, what)
    plain = plain_number(scalar)
    if plain and plain[1] is not None:
        raise scalar.error(
            f"{what} is a number, and {quoted(scalar.text.strip())} has a unit",
            "",
            "Write the number without a unit.",
        )
    return read_quantity(node, Kind.ANY, what, scope)


def spelled(key: str, section: Section) -> str:
    """Return ``key``, or the key for which a Greek letter stands, in any of its Unicode forms."""
    letters = {f.greek: f.key for f in section.fields if f.greek}
    return letters.get(key) or letters.get(unicodedata.normalize("NFKC", key), key)


def mapping_of(node: Node, what: str, example: str) -> MappingNode:
    """Return the node if it is a mapping; raise RobotFileError otherwise.

    Args:
        node: The node.
        what: Names it in messages.
        example: What to write.
    """
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
    """Return the table of a mapping. A misspelt key is reported, and read as the key that it probably means.

    Args:
        node: The mapping.
        section: Describes the keys.
        collector: Receives errors about keys.
        what: Names the mapping in messages; by default the title of the section.
        valid: The keys that this mapping may have; by default all of the section.

    Raises:
        RobotFileError: The node is not a mapping.
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
            if cut_by_comma(key, value) and last in table.values:  # the value before it is incomplete
                del table.keys[last], table.values[last]
                table.excused.add(last)
        elif name in table.keys:
            both = f"{quoted(key.text)} and {quoted(table.keys[name].text)} are the same key"
            collector.add(key.error(both, "", "Delete one of them.", code=Code.TWICE))
        else:
            table.keys[name], table.values[name] = key, value
            last = name
    for key, value in unknown:
        collector.add(unknown_key(key, value, fields, what))
        meant, certain = _meant(key.text, fields)
        if meant and meant not in table.keys:
            table.excused.add(meant)
            empty = isinstance(value, Scalar) and not value.text
            if certain and not empty:
                table.keys[meant], table.values[meant] = key, value
    return table


def _meant(word: str, fields: Collection[Field]) -> tuple[str, bool]:
    """Return the key that an unknown word probably means, and whether its value is likely to be valid for that key."""
    for f in fields:
        if word.lower() in f.aliases:
            return f.key, not f.aliases[word.lower()]
    keys = [f.key for f in fields]
    word = re.split("[ :=\uff1a]", word, maxsplit=1)[0]
    return nearest(word, keys), bool(nearest(word, keys, 0.75))


def cut_by_comma(key: Scalar, value: Node) -> tuple[str, str] | None:
    """Return why and what to write if a "key" is the rest of a value that a comma has cut; else None."""
    if not isinstance(value, Scalar) or value.text or not key.plain:
        return None
    if re.fullmatch(r"[0-9]+( [a-z/]+)?", key.text):
        return "A comma separates entries.", "Write a decimal point."
    if key.text.count(")") > key.text.count("("):
        why = "Inside { } a comma ends the value, even in parentheses."
        return why, "Put an expression with a comma in quotes, such as 'atan2(1, 2)'."
    return None


def unknown_key(key: Scalar, value: Node, fields: Collection[Field], what: str) -> RobotFileError:
    """Return the error for an unknown key.

    Args:
        key: The key.
        value: Its value.
        fields: The valid keys.
        what: Names the mapping in messages.
    """
    cut = cut_by_comma(key, value)
    if cut:
        return key.error(f"{quoted(key.text)} is not a key", *cut)
    if key.plain and isinstance(value, Scalar) and not value.text:
        no_colon = _missing_colon(key, {f.key for f in fields})
        if no_colon:
            return no_colon
    if key.text == "<<":
        return key.error("'<<' is a YAML merge key", "Robot files have no merge keys.", "Write the keys out.")
    unknown, why = f"unknown key {quoted(key.text)} in {what}", lookalike(key.text)
    aliases: dict[str, str] = {}
    for f in fields:
        aliases |= f.hints
    instead = suggestion(key.text, [f.key for f in fields], aliases)
    inside = () if key.text.lower() in aliases else _inside(fields, key.text)
    if inside:
        instead = f"Write {inside[0]}."
    elif instead.startswith("Valid"):
        owners = [section.title for section in (ROBOT, WHEEL) if key.text in section.keys]
        why = f"It is a key of {owners[0]}." if owners else why
    return key.error(unknown, why, instead, code=Code.UNKNOWN_KEY)


def _missing_colon(key: Scalar, valid: Collection[str]) -> RobotFileError | None:
    """Return the error for a key without a value that should be ``key: value``, such as x:0 or x = 0; else None."""
    colon = re.search("[:\uff1a]", key.text)
    if colon:
        word, rest = key.text[: colon.start()], key.text[colon.end() :]
        missing = "space after ':'" if colon[0] == ":" else "':'"
        what = f"missing {missing} in {quoted(key.text)}"
        return key.error(what, lookalike(key.text), f"Write {word}: {rest.strip()}")
    word = re.split("[ =]", key.text, maxsplit=1)[0]
    if word in valid:
        rest = key.text[len(word) :].lstrip(" =")
        return key.error(f"missing ':' in {quoted(key.text)}", "", f"Write {word}: {rest}")
    return None


def _inside(fields: Collection[Field], word: str) -> list[str]:
    """Return the places below ``fields`` where a word is a key, as ``key: {word: …}``, the outermost first."""
    own, deeper = [], []
    for field_ in fields:
        if isinstance(field_.value, Section):
            inner = field_.value.fields
            own += [f"{field_.key}: {{{f.key}: …}}" for f in inner if word in (f.key, *f.aliases)]
            deeper += [f"{field_.key}: {{{place}}}" for place in _inside(inner, word)]
    return own + deeper
