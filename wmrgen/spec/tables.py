"""Mappings with known keys: their spelling, what stands behind them, what is missing; and names that a file gives."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass

from wmrgen.backends.registry import why_reserved
from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.expressions import read_quantity, scalar_of
from wmrgen.spec.fields import Amount, Choice, ListOf, Section, Word
from wmrgen.spec.numbers import Scope, plain_number
from wmrgen.spec.records import Quantity
from wmrgen.spec.text import MappingNode, Node, Scalar, SequenceNode, kind_of, quoted, suggestion


@dataclass(frozen=True, slots=True)
class Table:
    """The entries of a mapping by key, Greek letters spelled out, and the section that says what they are."""

    node: MappingNode
    section: Section
    keys: dict[str, Scalar]
    values: dict[str, Node]

    @property
    def mark(self) -> Mark:
        return self.node.mark

    def get(self, key: str) -> Node | None:
        return self.values.get(key)

    def require(self, key: str, what: str) -> Node:
        """The value of a key that must be there."""
        if key not in self.values:
            reason = self.section.field(key).missing or ("", f"Write {key}: and its value.")
            raise self.node.error(f"{what} has no {key}", *reason)
        return self.values[key]

    def require_all(self, what: str) -> None:
        """Every key that the section requires must be there."""
        for key in self.section.required:
            self.require(key, what)

    def word(self, key: str) -> bool:
        """What the word of a key means; its default where the key is not given."""
        value = self.section.field(key).value
        assert isinstance(value, Word)
        if key not in self.values:
            return value.words[value.default]
        scalar = scalar_of(self.values[key], key)
        if scalar.text not in value.words:
            raise scalar.error(
                f"{key}: {quoted(scalar.text)} is not known",
                f"It is {' or '.join(value.words)}.",
                suggestion(scalar.text, value.words, value.aliases),
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
            example = f"and a list of items - {item}" if item else value.example
            raise node.error(f"{key} must be a list, not {kind_of(node)}", "", f"Write {key}: {example}.")
        n = len(node.items)
        words = {"key": key, "n": n, "s": "s" * (n != 1), "most": value.most}
        if n < value.least:
            what, why, instead = (text.format(**words) for text in value.few)
            raise node.error(what, why, instead)
        if value.most is not None and n > value.most:
            what, why, instead = (text.format(**words) for text in value.many)
            raise RobotFileError(what, node.items[value.most].mark, why, instead)
        return node.items

    def scalars(self, key: str) -> tuple[Scalar, ...]:
        """The items of a list of words, which differ."""
        scalars: list[Scalar] = []
        for item in self.items(key):
            scalar = scalar_of(item, f"an item of {key}")
            if scalar.text in (other.text for other in scalars):
                raise scalar.error(f"{quoted(scalar.text)} stands twice in {key}", "", "Delete one of them.")
            scalars.append(scalar)
        return tuple(scalars)

    def amount(self, key: str, of: str, scope: Scope) -> Quantity | None:
        """The quantity of a key of ``of``; None where it is not given."""
        value, node = self.section.field(key).value, self.values.get(key)
        assert isinstance(value, Amount)
        if node is None:
            return None
        if value.unit == "1":
            _refuse_units(scalar_of(node, f"{key} of {of}"), f"{key} of {of}")
        return read_quantity(node, value.kind, f"{key} of {of}", scope)

    def required_amount(self, key: str, of: str, scope: Scope) -> Quantity:
        """The quantity of a key that `require_all` has seen."""
        quantity = self.amount(key, of, scope)
        assert quantity is not None
        return quantity

    def choose(self, choice: Choice, what: str, required: bool = False) -> tuple[str, ...]:
        """The keys of the one alternative that stands, complete; none where there may be none."""
        standing = [tuple(k for k in keys if k in self.keys) for keys in choice.sets]
        chosen = [(keys, every) for keys, every in zip(standing, choice.sets, strict=True) if keys]
        if len(chosen) > 1:
            problem, why, instead = choice.several
            later = max((keys[0] for keys, _ in chosen), key=list(self.keys).index)
            both = f"{' and by ' if 'by {keys}' in problem else ' and '}".join(
                " and ".join(keys) for keys, _ in chosen
            )
            raise self.keys[later].error(f"{what} {problem.format(keys=both)}", why, instead)
        if not chosen:
            if choice.optional and not required:
                return ()
            problem, why, instead = choice.none
            raise self.node.error(f"{what} {problem}", why, instead)
        for key in chosen[0][1]:
            self.require(key, what)
        return chosen[0][1]


def _refuse_units(scalar: Scalar, what: str) -> None:
    plain = plain_number(scalar)
    if plain and plain[1] is not None:
        raise scalar.error(
            f"{what} is a number, and {quoted(scalar.text.strip())} has a unit", "", "Write the number alone."
        )


def spelled(key: str, section: Section) -> str:
    """``key`` with a Greek letter, in any of its Unicode forms, as the key that it stands for."""
    letters = {f.greek: f.key for f in section.fields if f.greek}
    return letters.get(key) or letters.get(unicodedata.normalize("NFKC", key), key)


def mapping_of(node: Node, what: str, example: str) -> MappingNode:
    if not isinstance(node, MappingNode):
        raise node.error(f"{what} must be a mapping, not {kind_of(node)}", "", f"Write {example}.")
    return node


def table_of(node: Node, section: Section, what: str = "", valid: Collection[str] | None = None) -> Table:
    """The node as a table whose keys are those of ``section``, or of them the ``valid`` ones."""
    what = what or section.title
    mapping = mapping_of(node, what, section.example)
    table = Table(mapping, section, {}, {})
    for key, value in mapping.entries:
        name = spelled(key.text, section)
        if name not in (section.keys if valid is None else valid):
            raise unknown_key(key, value, section, what, valid)
        if name in table.keys:
            raise key.error(
                f"{quoted(key.text)} and {quoted(table.keys[name].text)} are the same key",
                "Only one of the two could count.",
                "Delete one of them.",
            )
        table.keys[name], table.values[name] = key, value
    return table


def unknown_key(
    key: Scalar, value: Node, section: Section, what: str, valid: Collection[str] | None
) -> RobotFileError:
    """The error for a key that does not exist, with the nearest one that does."""
    empty = isinstance(value, Scalar) and not value.text
    if re.fullmatch(r"[0-9]+", key.text) and empty:
        return key.error(
            f"{quoted(key.text)} stands where a key is expected",
            "Commas separate entries.",
            "Write a decimal point.",
        )
    if key.plain and ":" in key.text and empty:
        word, _, rest = key.text.partition(":")
        return key.error(
            f"no space after the colon in {quoted(key.text)}", "YAML needs one.", f"Write {word}: {rest}"
        )
    if key.plain and empty and key.text.count(")") > key.text.count("("):
        return key.error(
            f"{quoted(key.text)} stands where a key is expected",
            "Inside { } a comma ends the value, also within parentheses.",
            "Put an expression that contains a comma in quotes: 'atan2(1, 2)'.",
        )
    if key.text == "<<":
        return key.error("'<<' merges mappings in YAML", "Merge keys are refused.", "Write the keys out.")
    fields = [f for f in section.fields if valid is None or f.key in valid]
    aliases = {alias: text for f in fields for alias, text in f.hints.items()}
    keys = [f.key for f in fields]
    return key.error(f"unknown key {quoted(key.text)} in {what}", "", suggestion(key.text, keys, aliases))


NAME_PATTERN = "^[a-z][a-z0-9_]{0,30}$"
_DEVICES = {
    "con",
    "prn",
    "aux",
    "nul",
    "clock",
    *(f"{port}{i}" for port in ("com", "lpt") for i in range(10)),
}
_FILE_NAMES = {
    *"math stdio stdint stdlib stdbool string stddef stdarg float limits tgmath fenv inttypes".split(),
    *"numpy sympy casadi wmrgen".split(),
}
_EXPRESSION_WORDS = {*"pi sqrt sin cos tan atan2 vx vy omega slip x y theta dt".split()}


def _reserved(name: str) -> str:
    """Why no name may be this word; nothing where it may."""
    if name.endswith("_t"):
        return "POSIX keeps names that end in _t for types."
    if "__" in name:
        return "C++ keeps names with a double underscore for the implementation."
    return why_reserved(name) or ("Windows keeps that name for a device." if name in _DEVICES else "")


def _check(node: Scalar, what: str) -> str:
    """The name, when it is one; ``what`` says whose: robot, wheel, parameter."""
    name = node.text
    if not name:
        raise node.error(f"the {what} name is empty", "", "Write a name such as front_left.")
    if not re.fullmatch(NAME_PATTERN, name):
        raise node.error(
            f"{quoted(name)} is not a valid {what} name",
            "Names become identifiers of generated C: [a-z][a-z0-9_]*, at most 31 characters.",
            f"Write {quoted(_repaired(name))}." if _repaired(name) else "Write a name such as front_left.",
        )
    reason = _reserved(name)
    if reason:
        raise node.error(
            f"the {what} name {quoted(name)} is reserved", reason, f"Write {quoted(_free(name))}."
        )
    return name


def _free(name: str) -> str:
    """A name near a reserved one that is not reserved."""
    return re.sub(r"__+", "_", name.removesuffix("_t"))[:28].rstrip("_") + "_1"


def _repaired(name: str) -> str:
    """A valid name near ``name``, or nothing."""
    near = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:31].rstrip("_")
    return near if re.fullmatch(NAME_PATTERN, near) and not _reserved(near) else ""


def robot_name(node: Scalar) -> str:
    """A robot's name, which also names its files and folder."""
    if node.text == "textbook":
        raise node.error(
            "the robot name 'textbook' is reserved",
            "Beside the robots' folders, `wmrgen textbook` writes a folder of that name: one would replace the other.",
            "Write textbook_robot.",
        )
    if node.text in _FILE_NAMES:
        raise node.error(
            f"the robot name {quoted(node.text)} is reserved",
            "The generated files would be taken for a standard header or module.",
            f"Write {node.text}_robot.",
        )
    return _check(node, "robot")


def wheel_name(node: Scalar) -> str:
    return _check(node, "wheel")


def parameter_name(node: Scalar) -> str:
    """A parameter's name, which must not be a word of expressions or of the contract either."""
    if node.text in _EXPRESSION_WORDS or re.fullmatch(r"eta[0-9]+", node.text):
        raise node.error(
            f"the parameter name {quoted(node.text)} is reserved",
            "Expressions or the inputs and outputs of the model use that word already.",
            f"Write {node.text}_0 or a longer name." if node.text != "pi" else "Use pi as it is.",
        )
    return _check(node, "parameter")
