"""YAML text to a raw tree, under caps. The only module that knows yaml.

PyYAML's pure-Python scanner is run event by event; nothing is resolved or constructed, so a scalar is the
text that was written. Tags and directives, in robot files anchors and aliases too, stop the scanner where they stand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, NoReturn

import yaml
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.scanner import Scanner

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
from wmrgen.robotfile.slips import Line, Place, Slip, slip_of
from wmrgen.robotfile.text import (
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    Source,
    normalise,
    quoted,
    refused_character,
)

MAX_DEPTH = 16
MAX_NODES = 20_000
_KEY_LIMIT = 100

_DEPTH = (
    f"nested deeper than {MAX_DEPTH} levels",
    "A robot file needs five levels; more is refused.",
    "Look for brackets or dashes that do not end.",
)
_GOES_ON = re.compile(r"[{},]\s*\w+: |- \w+: ")  # keys that a quote has taken in
_MENDED, _LONG = 10, 20_000  # lines that are mended to read on, in files of so many characters


class _Composer(Reader, Scanner, Parser):
    """PyYAML's events to nodes, which are counted; without anchors, aliases, tags, directives and deep nesting."""

    last_counts = False  # of a key that stands twice; else the first

    def __init__(self, lines: tuple[Line, ...], source: Source, collector: ErrorCollector) -> None:
        Reader.__init__(self, "\n".join(line.text for line in lines))
        Scanner.__init__(self)
        Parser.__init__(self)
        self._lines, self._source, self._collector = lines, source, collector
        self._nodes = 0

    def _refuse(self, what: str, why: str, instead: str) -> NoReturn:
        raise RobotFileError(what, self.mark_here(), why, instead, Code.NOT_YAML)

    def mark_here(self) -> Mark:
        """How far the scanner has come."""
        return self._mark(self.line, self.column)

    def _mark(self, line: int, column: int) -> Mark:
        """The place in the file of a place in the lines as they are read."""
        return self._source.mark(line, self._lines[line].column(column))

    def fetch_anchor(self) -> None:
        self._refuse(
            "'&' marks an anchor", "Anchors and aliases are refused.", "Write the value out, or quote it."
        )

    def fetch_alias(self) -> None:
        self._refuse(
            "'*' marks an alias",
            "Anchors and aliases are refused.",
            "Write out what it stands for; a parameter says a shared value once.",
        )

    def fetch_tag(self) -> None:
        self._refuse(
            "'!' marks a tag", "A robot file holds plain data; tags are refused.", "Delete it, or quote it."
        )

    def fetch_directive(self) -> None:
        self._refuse("'%' begins a directive", "Directives are refused.", "Delete the line.")

    def fetch_flow_collection_start(self, TokenClass: Any) -> None:
        # The scanner runs ahead of the parser: without this cap it would look 1024 brackets forward.
        if self.flow_level >= MAX_DEPTH:
            self._refuse(*_DEPTH)
        super().fetch_flow_collection_start(TokenClass)

    def document(self) -> Node | None:
        """The one document of the stream; None when there is none."""
        self.get_event()
        if self.check_event(yaml.StreamEndEvent):
            return None
        self.get_event()
        node = self._node(0)
        self.get_event()
        if not self.check_event(yaml.StreamEndEvent):
            raise RobotFileError(
                "a second document begins here",
                self._source.mark(self.peek_event().start_mark.line, 0),
                "One file describes one robot.",
                "Use a file per robot.",
                Code.NOT_YAML,
            )
        return node

    def _node(self, depth: int) -> Node:
        event = self.get_event()
        mark = self._mark(event.start_mark.line, event.start_mark.column)
        self._nodes += 1
        if depth > MAX_DEPTH:
            raise RobotFileError(_DEPTH[0], mark, *_DEPTH[1:], Code.NOT_YAML)
        if self._nodes > MAX_NODES:
            raise RobotFileError(
                f"more than {MAX_NODES} values in one file",
                mark,
                "Larger input is refused.",
                "",
                Code.NOT_YAML,
            )
        if isinstance(event, yaml.ScalarEvent):
            end = event.end_mark.line + 1 if event.end_mark else mark.line
            if event.style in ("'", '"') and end > mark.line and _GOES_ON.search(event.value):
                what = f"the quote that opens here is closed on line {end}"
                raise RobotFileError(what, mark, "", "Close it behind the value.", Code.NOT_YAML)
            return self._scalar(Scalar(mark, event.value, event.style is None))
        if isinstance(event, yaml.SequenceStartEvent):
            items = []
            while not self.check_event(yaml.SequenceEndEvent):
                items.append(self._node(depth + 1))
            self.get_event()
            return SequenceNode(mark, tuple(items))
        entries: dict[str, tuple[Scalar, Node]] = {}
        repeated = False
        while not self.check_event(yaml.MappingEndEvent):
            key = self._key(depth + 1)
            value = self._node(depth + 1)
            if key.text in entries:
                self._collector.add(_duplicate(key, entries[key.text][0]))
                repeated = True
            if key.text not in entries or self.last_counts:
                entries[key.text] = (key, value)
        self.get_event()
        return MappingNode(mark, tuple(entries.values()), repeated)

    def _scalar(self, scalar: Scalar) -> Scalar:
        refused = refused_character(scalar.text)  # escapes in double quotes can make any character
        if refused:
            raise scalar.error(f"{refused[1]} in a text", refused[2], "Delete it.", code=Code.NOT_YAML)
        return scalar

    def _key(self, depth: int) -> Scalar:
        key = self._node(depth)
        if not isinstance(key, Scalar) or "\n" in key.text or len(key.text) > _KEY_LIMIT:
            raise key.error("a key must be a short word", "", "Write key: value.", code=Code.NOT_YAML)
        return key


def _duplicate(key: Scalar, first: Scalar) -> RobotFileError:
    return key.error(
        f"duplicate key {quoted(key.text)}",
        f"It stands on line {first.mark.line} already, and only one of the two could count.",
        "Delete one of them.",
        code=Code.TWICE,
    )


class _Aliased(_Composer):
    """Files of others, with anchors; of a key that stands twice the last counts, as in ROS. What an alias stands
    for counts again: a few lines cannot mean very many nodes."""

    last_counts = True
    fetch_anchor = Scanner.fetch_anchor
    fetch_alias = Scanner.fetch_alias

    def fetch_tag(self) -> None:
        """Of an angle in ROS, whose number is taken as it is; others are refused."""
        ours = any(self.prefix(len(tag)) == tag for tag in ("!degrees", "!radians"))
        (Scanner if ours else _Composer).fetch_tag(self)

    def __init__(self, lines: tuple[Line, ...], source: Source, collector: ErrorCollector) -> None:
        super().__init__(lines, source, collector)
        self._anchored: dict[str, tuple[Node, int]] = {}  # with the number of its nodes

    def _node(self, depth: int) -> Node:
        event, before = self.peek_event(), self._nodes
        if not isinstance(event, yaml.AliasEvent):
            node = super()._node(depth)
            if event.anchor:
                self._anchored[event.anchor] = node, self._nodes - before
            return node
        self.get_event()
        name = str(event.anchor)
        if name not in self._anchored:
            raise RobotFileError(f"nothing above is called {quoted('&' + name)}", self.mark_here())
        node, count = self._anchored[name]
        self._nodes += count
        return node


def read_tree(
    text: str, file: str, collector: ErrorCollector | None = None, aliases: bool = False
) -> Node | None:
    """The raw tree of ``text``, None for an empty file; ``several``, where given, takes keys that stand twice, and
    slips of YAML, which are mended to read on; None where that fails. ``aliases``: of files of others, which are not
    mended."""
    text = normalise(text, file)
    source, wrong = Source.of(text, file), collector or ErrorCollector()
    lines, slips = tuple(Line(line) for line in text.split("\n")), list[Slip]()
    while True:
        twice = ErrorCollector()
        try:
            tree = _composed(lines, source, twice, aliases)
            break
        except _Slipped as slipped:
            slip = slipped.slip
            if collector is None or aliases:
                raise slip.error from None
            slips += [] if _of_a_mend(slip, slips) else [slip]
            tree = None
            if slip.meant is None or len(slips) > _MENDED or len(text) > _LONG:
                break
            lines = (*lines[: slip.number], slip.meant, *lines[slip.number + 1 :])
    wrong.add(*(slip.error for slip in slips), *twice.errors)
    if collector is None:
        wrong.end()
    return tree


def _place(mark: Any) -> Place | None:
    """A mark of PyYAML."""
    return Place(mark.line, mark.column) if mark else None


def _of_a_mend(slip: Slip, slips: Sequence[Slip]) -> bool:
    """Whether a slip is likely one of how the lines above were mended."""
    return slip.follows and any("tab" in s.error.what or s.number >= slip.number - 1 for s in slips)


class _Slipped(Exception):
    def __init__(self, slip: Slip) -> None:
        super().__init__()
        self.slip = slip


def _without(lines: tuple[Line, ...], mark: Mark) -> Line | None:
    """The line of ``mark``, where an anchor or a tag stands, with blanks in its place, or an alias, as a word; None
    where there is none."""
    line, at = lines[mark.line - 1], mark.column - 1
    word = re.compile(r"[&!][^ ,\[\]{}]*|\*").match(line.text, at) if not line.moved else None
    blank = "_" if word and word[0] == "*" else " " * len(word[0]) if word else ""
    return line._replace(text=line.text[:at] + blank + line.text[at + len(blank) :]) if word else None


def _composed(
    lines: tuple[Line, ...], source: Source, collector: ErrorCollector, aliases: bool
) -> Node | None:
    """The tree of lines that stand in ``source`` as they were before they were mended."""
    composer = (_Aliased if aliases else _Composer)(lines, source, collector)
    try:
        return composer.document()
    except RobotFileError as error:
        meant = _without(lines, error.mark) if error.mark and error.code is Code.NOT_YAML else None
        raise _Slipped(Slip(error, error.mark.line - 1 if error.mark else 0, meant)) from None
    except yaml.MarkedYAMLError as error:
        problem, context = str(error.problem or error.context or ""), _place(error.context_mark)
        at = _place(error.problem_mark) or context or Place(composer.line, composer.column)
        raise _Slipped(slip_of(problem, at, context, lines, source)) from None
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        # PyYAML's own slips, such as the escape "\\UFFFFFFFF"
        what, instead = f"not YAML: {quoted(str(error))}", "Compare with a file under robots/."
        raise _Slipped(Slip(RobotFileError(what, composer.mark_here(), "", instead, Code.NOT_YAML))) from None


class Token(NamedTuple):
    """A word of YAML as it stands, or the start or end of a block, which has no text. ``column`` counts from 0."""

    kind: str
    text: str
    start: int
    column: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


def tokens(text: str, file: str) -> Iterator[Token]:
    """The words of a robot file that `read_tree` reads, in order; what stands between them is blank or comment."""
    lines = tuple(Line(line) for line in text.split("\n"))
    composer = _Composer(lines, Source.of(text, file), ErrorCollector())
    while composer.check_token():
        token = composer.get_token()
        start, end = token.start_mark, token.end_mark
        yield Token(token.id, text[start.index : end.index].rstrip(" \n"), start.index, start.column)
