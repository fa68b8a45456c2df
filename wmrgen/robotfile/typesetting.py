"""How the text of a robot file is laid out: spaces and line ends, never a word. Comments keep their lines.

Blocks are indented by two spaces, entries of mappings in braces that stand one below the other are aligned, brackets
have no spaces inside, and a comment stands three spaces behind what it is about.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby

from wmrgen.robotfile.reader import Token, read_tree, tokens
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, normalise

_STEP = 2
_GAP = "   "  # before a comment
_OPENS, _CLOSES = ("{", "["), ("}", "]")
_MAPPING, _LIST = "<block mapping start>", "<block sequence start>"


def formatted(text: str, file: str) -> str:
    """``text`` laid out; as it is where that would change what it says, which only texts over several lines can do.

    RobotFileError where it is not what a robot file is made of; names and values may be wrong.
    """
    text = normalise(text, file)
    before = read_tree(text, file)
    layout = _Layout(text)
    for token in tokens(text, file):
        layout.take(token)
    result = layout.finished()
    return result if _content(read_tree(result, file)) == _content(before) else text


def _content(node: Node | None) -> object:
    """What a tree says, without its places."""
    if isinstance(node, Scalar):
        return node.text, node.plain
    if isinstance(node, SequenceNode):
        return [_content(item) for item in node.items]
    return [(k.text, _content(v)) for k, v in node.entries] if isinstance(node, MappingNode) else None


@dataclass(slots=True)
class _Line:
    """A line of the result: words, each behind its spaces. ``column``: where it begins; ``was``: where it began."""

    was: int = 0
    column: int = 0
    words: list[tuple[str, str]] = field(default_factory=list)
    comment: str = ""

    def __str__(self) -> str:
        start = _GAP if self.words else " " * self.column
        return f"{self.shown(len(self.words))}{start if self.comment else ''}{self.comment}".rstrip(" ")

    def shown(self, count: int, start: int = 0) -> str:
        """The words from ``start`` to before ``count``."""
        return "".join(space + word for space, word in self.words[start:count])

    @property
    def cells(self) -> list[int]:
        """Where the entries begin of the first mapping in braces, and its end; [] where it ends on another line."""
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
    """Takes tokens in order. ``_blocks``: kind and column of each block collection that is open, -1 before it is known;
    ``_flows``: of each in brackets, the columns of what is inside and of its end."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._lines: list[_Line] = []
        self._blocks: list[tuple[str, int]] = []
        self._flows: list[tuple[int, int]] = []
        self._dash = 0  # the column of the last dash
        self._last = Token("", "", 0, 0)
        self._line = _Line()  # the last that has words

    def take(self, token: Token) -> None:
        """Lay out one token, and the comments before it."""
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
        """The whole text, entries aligned."""
        self._between(self._text[self._last.end :] + "\n", _Line())
        for _, table in groupby(
            self._lines, lambda line: bool(line.cells) and len(line.shown(line.cells[0]))
        ):
            _align(list(table), 0)
        text = re.sub(r"\n{3,}", "\n\n", "\n".join(map(str, self._lines))).strip("\n")
        return f"{text}\n" if text else ""

    def _column(self, token: Token) -> int:
        """Where a line goes that ``token`` begins."""
        if self._flows:
            return self._flows[-1][token.kind in _CLOSES]
        if self._last.kind == "-":
            return self._dash + _STEP
        outer = next((column for _, column in reversed(self._blocks) if column >= 0), -_STEP)
        inside_a_key = token.kind == "-" and self._blocks[-1:] == [(_MAPPING, outer)]
        begins = bool(self._blocks) and self._blocks[-1][1] < 0
        return outer + _STEP if self._last.kind == ":" or inside_a_key or begins else max(outer, 0)

    def _between(self, gap: str, following: _Line) -> None:
        """Comments and empty lines between the last word and the line ``following``."""
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
    """A comment with a space behind its sign; "" for a line that has none."""
    return re.sub(r"^#(?=[^\s#!:])", "# ", text.strip())


def _align(table: Sequence[_Line], k: int) -> None:
    """Pad entry ``k`` of lines whose mappings begin in one column, where those up to the next have the same keys."""

    def keys(line: _Line) -> tuple[str, ...]:
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
