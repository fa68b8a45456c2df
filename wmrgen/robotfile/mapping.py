"""Convert a robot that is given as a mapping, `wmrgen.load({"name": …})`, to the tree of a file with the same content.

The tree is read like that of a file, with the same checks. The place of a value is the path of its keys, wheels[0].r.
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
        RobotFileError: A key is not a text, or a value has another type.
    """
    if not isinstance(values, Mapping):
        raise TypeError(f"a robot is a mapping, not {type(values).__name__}")
    return _Tree().mapping(values, "", 0)


class _Tree:
    """Makes the nodes of one mapping, with the same limits on number, depth and size as for a file."""

    def __init__(self) -> None:
        self._numbers = count(1)
        self._size = 0

    def _mark(self, path: str) -> Mark:
        """Return the mark of the next value; raise RobotFileError if there are too many."""
        number = next(self._numbers)
        if number > MAX_NODES:
            raise _refused(
                f"more than {MAX_NODES} values in one mapping",
                Mark(_FILE, number, 1, "", path or _FILE),
                "Give the robot alone.",
            )
        return Mark(_FILE, number, 1, "", path or _FILE)

    def node(self, value: object, path: str, depth: int) -> Node:
        """Return the node of a value.

        Args:
            value: A text, number, truth value, list or mapping.
            path: The keys that lead to it.
            depth: The number of lists and mappings around it.
        """
        if depth > MAX_DEPTH:
            instead = "Look for a mapping that contains itself."
            raise _refused(f"nested deeper than {MAX_DEPTH} levels", self._mark(path), instead)
        if isinstance(value, Mapping):
            return self.mapping(value, path, depth)
        if isinstance(value, Sequence) and not isinstance(value, str | bytes | bytearray):
            mark = self._mark(path)
            items = (self.node(item, f"{path}[{k}]", depth + 1) for k, item in enumerate(value))
            return SequenceNode(mark, tuple(items))
        return self.scalar(value, path)

    def mapping(self, values: Mapping[str, object], path: str, depth: int) -> MappingNode:
        """Return the node of a mapping; see `node` for the arguments."""
        mark, entries = self._mark(path), list[tuple[Scalar, Node]]()
        for key, value in values.items():
            if not isinstance(key, str):
                what = f"the key {quoted(repr(key))} is not a text"
                raise _refused(what, mark, "Give the keys of a robot file, as texts.")
            own = f"{path}.{printable(key)}" if path else printable(key)
            entries.append((self.scalar(key, own), self.node(value, own, depth + 1)))
        return MappingNode(mark, tuple(entries))

    def scalar(self, value: object, path: str) -> Scalar:
        """Return the node of a text, number or truth value."""
        mark = self._mark(path)
        text = _text(value, mark)
        self._size += len(text)
        if self._size > MAX_BYTES:
            raise _refused(f"the texts have more than {MAX_BYTES // 1024} KiB", mark, "Shorten them.")
        bad = refused_character(text)
        if bad:
            raise _refused(f"{bad[1]} in a text", mark, "Delete it.", bad[2])
        return Scalar(mark, text, plain=True)


def _text(value: object, mark: Mark) -> str:
    """Return a value as a robot file would write it. A float is the decimal that Python prints, such as 0.165."""
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
    instead = "Give a number, or a text as in a robot file: '150 mm', 'pi/2', 'half_track'."
    raise _refused(what, mark, instead)


def _refused(what: str, mark: Mark, instead: str = "", why: str = "") -> RobotFileError:
    """Return the error for a value that no robot file could have."""
    return RobotFileError(what, mark, why, instead, Code.FORM)
