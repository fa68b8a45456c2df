"""Mappings with known keys: spelling, Greek letters, missing ones."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from wmrgen.errors import Mark, RobotFileError
from wmrgen.spec.fields import KEY_ALIASES, MISSING
from wmrgen.spec.nodes import Mapping, Node, Scalar, kind_of
from wmrgen.spec.text import quoted, suggestion

_GREEK = {"α": "alpha", "β": "beta", "γ": "gamma"}


@dataclass(frozen=True, slots=True)
class Table:
    """The entries of a mapping by key, Greek letters spelled out."""

    node: Mapping
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
            raise self.node.error(
                f"{what} has no {key}", *MISSING.get(key, ("", f"Write {key}: and its value."))
            )
        return self.values[key]


def spelled(key: str) -> str:
    """``key`` with α β γ in any of their Unicode forms as alpha beta gamma."""
    return _GREEK.get(key) or _GREEK.get(unicodedata.normalize("NFKC", key), key)


def mapping_of(node: Node, what: str, example: str) -> Mapping:
    if not isinstance(node, Mapping):
        raise node.error(f"{what} must be a mapping, not {kind_of(node)}", "", f"Write {example}.")
    return node


def table_of(node: Node, valid: Collection[str], what: str, example: str) -> Table:
    """The node as a table whose keys are all in ``valid``."""
    mapping = mapping_of(node, what, example)
    table = Table(mapping, {}, {})
    for key, value in mapping.entries:
        name = spelled(key.text)
        if name not in valid:
            raise unknown_key(key, value, valid, what)
        if name in table.keys:
            raise key.error(
                f"{quoted(key.text)} and {quoted(table.keys[name].text)} are the same key",
                "Only one of the two could count.",
                "Delete one of them.",
            )
        table.keys[name], table.values[name] = key, value
    return table


def unknown_key(key: Scalar, value: Node, valid: Iterable[str], what: str) -> RobotFileError:
    """The error for a key that does not exist, with the nearest one that does."""
    names = list(valid)
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
    aliases = {alias: text for alias, text in KEY_ALIASES.items() if any(f" {n}" in text for n in names)}
    return key.error(f"unknown key {quoted(key.text)} in {what}", "", suggestion(key.text, names, aliases))
