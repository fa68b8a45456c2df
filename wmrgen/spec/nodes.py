"""The raw tree of a robot file: texts, lists and mappings, each with its place. No type is guessed."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.errors import Mark, RobotFileError


@dataclass(frozen=True, slots=True)
class Scalar:
    """A text as written. ``plain`` when it stands without quotes."""

    text: str
    plain: bool
    mark: Mark

    def mark_at(self, offset: int) -> Mark:
        """The place of character ``offset`` of the text, or of its start when escapes or folds hide it."""
        column = self.mark.column - 1
        for start in (column, column + 1):  # plain, quoted
            if self.mark.text.startswith(self.text, start):
                return Mark(self.mark.file, self.mark.line, start + offset + 1, self.mark.text)
        return self.mark

    def error(self, what: str, why: str = "", instead: str = "", offset: int = 0) -> RobotFileError:
        return RobotFileError(what, self.mark_at(offset) if offset else self.mark, why, instead)


@dataclass(frozen=True, slots=True)
class Sequence:
    items: tuple[Node, ...]
    mark: Mark

    def error(self, what: str, why: str = "", instead: str = "") -> RobotFileError:
        return RobotFileError(what, self.mark, why, instead)


@dataclass(frozen=True, slots=True)
class Mapping:
    """Keys are distinct and keep the order of the file."""

    entries: tuple[tuple[Scalar, Node], ...]
    mark: Mark

    def error(self, what: str, why: str = "", instead: str = "") -> RobotFileError:
        return RobotFileError(what, self.mark, why, instead)


Node = Scalar | Sequence | Mapping


def kind_of(node: Node) -> str:
    """What a node is, for error messages."""
    if isinstance(node, Scalar):
        return "a text" if node.text or not node.plain else "nothing"
    return "a list" if isinstance(node, Sequence) else "a mapping"
