"""Format the text of a robot file: change spaces and line ends, but no word. Comments keep their lines.

Blocks are indented by two spaces. Mappings in braces on consecutive lines have their entries aligned. Brackets have no
spaces inside. A comment is three spaces after the text that it follows.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby

from wmrgen.robotfile.reader import Token, read_tree, tokens
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, normalise

_STEP = 2  # spaces of indentation
_GAP = "   "  # before a comment
_OPENS, _CLOSES = ("{", "["), ("}", "]")
_MAPPING, _LIST = "<block mapping start>", "<block sequence start>"


def formatted(text: str, file: str) -> str:
    """Return the formatted text of a robot file.

    If formatting would change the content, as it may with quoted texts over several lines, the text is returned
    unchanged. Names and values may be wrong; a text that is not the YAML of robot files raises RobotFileError.
    """
    text = normalise(text, file)
    before = read_tree(text, file)
    layout = _Layout(text)
    for token in tokens(text, file):
        layout.take(token)
    result = layout.finished()
    return result if _content(read_tree(result, file)) == _content(before) else text


def _content(node: Node | None) -> object:
    """Return the content of a tree without its marks."""
    if isinstance(node, Scalar):
        return node.text, node.plain
    if isinstance(node, SequenceNode):
        return [_content(item) for item in node.items]
    return [(k.text, _content(v)) for k, v in node.entries] if isinstance(node, MappingNode) else None


@dataclass(slots=True)
class _Line:
    """A line of the result."""

    was: int = 0  # the column where it begins in the given text
    column: int = 0  # the column where it begins in the result
    words: list[tuple[str, str]] = field(default_factory=list)  # the spaces before each word, and the word
    comment: str = ""

    def __str__(self) -> str:
        start = _GAP if self.words else " " * self.column
        return f"{self.shown(len(self.words))}{start if self.comment else ''}{self.comment}".rstrip(" ")

    def shown(self, count: int, start: int = 0) -> str:
        """Return the text of the words from ``start`` up to ``count``."""
        return "".join(space + word for space, word in self.words[start:count])

    @property
    def cells(self) -> list[int]:
        """The indices of the words that begin an entry of the first mapping in braces, and of its closing brace.

        Empty if there is no mapping in braces, or if it ends on another line.
        """
        starts, depth = [], 0
        for i, (_, word) in enumerate(self.words):
            if word in _OPENS and (depth or word == "{"):
                depth += 1
                starts += [i + 1] if depth == 1 else []
            elif word in _CLOSES and depth:
                depth -= 1
                if not depth:
                    # A comma may stand before the brace.
                    return [*(start for start in starts if start < i), i]
            elif word == "," and depth == 1:
                starts.append(i + 1)
        return []


class _Layout:
    """Builds the result from the tokens, which `take` gets in order."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._lines: list[_Line] = []
        self._blocks: list[
            tuple[str, int]
        ] = []  # kind and column of each open block; -1 before its first word
        self._flows: list[tuple[int, int]] = []  # columns of the content and the end of each open bracket
        self._dash = 0  # the column of the last dash
        self._last = Token("", "", 0, 0)
        self._line = _Line()  # the last line that has words

    def take(self, token: Token) -> None:
        """Write one token and the comments before it."""
        if token.kind in (_MAPPING, _LIST):
            self._blocks.append((token.kind, -1))
        elif token.kind == "<block end>":
            self._blocks.pop()
        elif token.text:
            gap = self._text[self._last.end : token.start]
            if "\n" in gap or not self._line.words:
                line = _Line(token.column, self._column(token))
                self._between(gap, line)
                self._line = line
                self._lines.append(line)
                self._add(token, " " * line.column)
            else:
                close = self._last.kind in _OPENS or token.kind in (*_CLOSES, ",", ":")
                self._add(token, "" if close else " ")
            self._last = token

    def finished(self) -> str:
        """Return the whole text with aligned entries."""
        self._between(self._text[self._last.end :] + "\n", _Line())
        for _, table in groupby(
            self._lines, lambda line: bool(line.cells) and len(line.shown(line.cells[0]))
        ):
            _align(list(table), 0)
        text = re.sub(r"\n{3,}", "\n\n", "\n".join(map(str, self._lines))).strip("\n")
        return f"{text}\n" if text else ""

    def _column(self, token: Token) -> int:
        """Return the column of a line that begins with ``token``."""
        if self._flows:
            return self._flows[-1][token.kind in _CLOSES]
        if self._last.kind == "-":
            return self._dash + _STEP
        outer = next((column for _, column in reversed(self._blocks) if column >= 0), -_STEP)
        inside_a_key = token.kind == "-" and self._blocks[-1:] == [(_MAPPING, outer)]
        begins = bool(self._blocks) and self._blocks[-1][1] < 0
        return outer + _STEP if self._last.kind == ":" or inside_a_key or begins else max(outer, 0)

    def _between(self, gap: str, following: _Line) -> None:
        """Write the comments and empty lines between the last word and the line ``following``."""
        first, *others = gap.split("\n")
        if self._line.words:
            self._lines[-1].comment = _comment(first)
        elif others:
            others.insert(0, first)
        for text in others[:-1]:
            was = len(text) - len(text.lstrip(" "))
            near = self._line if abs(was - self._line.was) < abs(was - following.was) else following
            self._lines.append(_Line(column=near.column, comment=_comment(text)))

    def _add(self, token: Token, space: str) -> None:
        """Write ``token`` at the end of the last line."""
        line = self._lines[-1]
        first, *more = token.text.split("\n")
        line.words.append((space, first))
        begins = len(line.shown(len(line.words))) - len(first)
        if self._blocks and self._blocks[-1][1] < 0:
            self._blocks[-1] = (self._blocks[-1][0], begins)
        if token.kind == "-":
            self._dash = begins
        elif token.kind in _OPENS:
            rest = self._text[token.end :].partition("\n")[0].strip()
            hangs = not rest or rest[0] == "#"
            inside = (
                (self._line.column + 2 * _STEP, self._line.column + _STEP) if hangs else (begins + 1, begins)
            )
            self._flows.append(inside)
        elif token.kind in _CLOSES:
            self._flows.pop()
        shift = self._line.column - self._line.was
        for part in more:  # a text over several lines moves with the line on which it begins
            moved = " " * shift + part if shift > 0 else re.sub(rf"^ {{0,{-shift}}}", "", part)
            self._lines.append(_Line(words=[("", moved)]))


def _comment(text: str) -> str:
    """Return a comment with a space after its sign; "" for a blank line."""
    return re.sub(r"^#(?=[^\s#!:])", "# ", text.strip())


def _align(table: Sequence[_Line], k: int) -> None:
    """Align entry ``k`` + 1 of lines whose mappings begin in one column and have the same keys up to it."""

    def keys(line: _Line) -> tuple[str, ...]:
        """The first words of the entries up to ``k`` + 1; empty if the line has too few entries."""
        cells = line.cells
        return tuple(line.words[i][1] for i in cells[:-1]) if len(cells) > k + 2 else ()

    for same, group in groupby(table, lambda line: keys(line)[: k + 2]):
        lines = list(group)
        if not same:
            continue
        widths = [len(line.shown(line.cells[k + 1], line.cells[k]).lstrip()) for line in lines]
        for line, width in zip(lines, widths, strict=True):
            i = line.cells[k + 1]
            line.words[i] = (" " * (1 + max(widths) - width), line.words[i][1])
        _align(lines, k + 1)
