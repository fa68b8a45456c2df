"""A robot given as a mapping, `wmrgen.load({"name": …})`, as the tree that a file with the same content makes.

The tree takes the same way as that of a file, so it gets the same checks. A place is the path of keys, wheels[0].r.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import count
from numbers import Integral, Rational, Real

from wmrgen.errors import Code, Mark, RobotFileError
from wmrgen.robotfile.reader import MAX_DEPTH, MAX_NODES
from wmrgen.robotfile.text import (
    MAX_BYTES,
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    printable,
    quoted,
    refused_character,
)

_FILE = "the mapping"


def tree_of(values: Mapping[str, object]) -> MappingNode:
    """Return the tree of a mapping with the keys of a robot file.

    Args:
        values: Keys as in a robot file. Values are texts as in a file (``150 mm``, ``pi/2``), numbers, truth values,
            lists and mappings.

    Raises:
        RobotFileError: A key is no text, or a value is none of these.
    """
    if not isinstance(values, Mapping):
        raise TypeError(f"a robot is a mapping, not {type(values).__name__}")
    return _Tree().mapping(values, "", 0)


class _Tree:
    """The nodes of one mapping, which are counted, as those of a file are."""

    def __init__(self) -> None:
        self._numbers = count(1)
        self._size = 0

    def _mark(self, path: str) -> Mark:
        number = next(self._numbers)
        if number > MAX_NODES:
            raise _refused(
                f"more than {MAX_NODES} values in one mapping", Mark(_FILE, number, 1, "", path or _FILE)
            )
        return Mark(_FILE, number, 1, "", path or _FILE)

    def node(self, value: object, path: str, depth: int) -> Node:
        if depth > MAX_DEPTH:
            raise _refused(f"nested deeper than {MAX_DEPTH} levels", self._mark(path))
        if isinstance(value, Mapping):
            return self.mapping(value, path, depth)
        if isinstance(value, Sequence) and not isinstance(value, str | bytes | bytearray):
            mark = self._mark(path)
            items = (self.node(item, f"{path}[{k}]", depth + 1) for k, item in enumerate(value))
            return SequenceNode(mark, tuple(items))
        return self.scalar(value, path)

    def mapping(self, values: Mapping[str, object], path: str, depth: int) -> MappingNode:
        mark, entries = self._mark(path), list[tuple[Scalar, Node]]()
        for key, value in values.items():
            if not isinstance(key, str):
                what = f"the key {quoted(repr(key))} is not a text"
                raise _refused(what, mark, "Write keys as a robot file has them.")
            own = f"{path}.{printable(key)}" if path else printable(key)
            entries.append((self.scalar(key, own), self.node(value, own, depth + 1)))
        return MappingNode(mark, tuple(entries))

    def scalar(self, value: object, path: str) -> Scalar:
        mark = self._mark(path)
        text = _text(value, mark)
        self._size += len(text)
        if self._size > MAX_BYTES:
            raise _refused(f"the texts have more than {MAX_BYTES // 1024} KiB", mark)
        bad = refused_character(text)
        if bad:
            raise _refused(f"a text holds a {bad[1]}", mark, "Delete it.", bad[2])
        return Scalar(mark, text, plain=True)


def _text(value: object, mark: Mark) -> str:
    """What a robot file would say. A float is the decimal that Python shows of it: 0.165, not the nearest binary."""
    if isinstance(value, str):
        return value
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Rational):
        exact = Fraction(int(value.numerator), int(value.denominator))
        return f"{exact.numerator}/{exact.denominator}"
    if isinstance(value, Real):
        return repr(float(value))
    what = f"a value of the type {type(value).__name__}"
    raise _refused(
        what, mark, "Write a number, or a text as in a robot file: '150 mm', 'pi/2', 'half_track'."
    )


def _refused(what: str, mark: Mark, instead: str = "", why: str = "") -> RobotFileError:
    return RobotFileError(what, mark, why, instead, Code.FORM)
