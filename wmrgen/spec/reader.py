"""YAML text to a raw tree, under caps. The only module that knows yaml.

PyYAML's pure-Python scanner is run event by event; nothing is resolved or constructed, so a scalar is the
text that was written. Tags and directives, in robot files anchors and aliases too, stop the scanner where they stand.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, NamedTuple, NoReturn

import yaml
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.scanner import Scanner

from wmrgen.errors import Code, Mark, RobotFileError, Several
from wmrgen.spec.text import (
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
# What PyYAML says, and the same for people: (part of its text, what, instead).
_PLAIN_WORDS = (
    ("'\\t'", "a tab where spaces are needed", "YAML indents with spaces: replace the tab."),
    ("unexpected end of stream", "a quote that is never closed", "Close the quote."),
    ("expected ',' or ']'", "a ',' or ']' is missing here", "Separate items by ',' and end the list with ']'."),
    ("expected ',' or '}'", "a ',' or '}' is missing here", "Separate keys by ',' and end with '}'."),
    ("did not find expected <document start>", "text after the end of the document", "Delete it."),
    ("expected the node content", "a value is missing here", "Write it, indented deeper than what asks for it."),
    ("escape", "an unknown escape in double quotes", "Use single quotes, or none."),
)  # fmt: skip
_UNALIGNED = "this line does not fit the indentation above", "Align it with its neighbours."


class _Composer(Reader, Scanner, Parser):
    """PyYAML's events to nodes, which are counted; without anchors, aliases, tags, directives and deep nesting."""

    def __init__(self, text: str, source: Source, several: Several) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        self._source, self._several = source, several
        self._nodes = 0
        self._last_counts = False

    def _refuse(self, what: str, why: str, instead: str) -> NoReturn:
        raise RobotFileError(what, self.mark_here(), why, instead, Code.NOT_YAML)

    def mark_here(self) -> Mark:
        """How far the scanner has come."""
        return self._source.mark(self.line, self.column)

    def fetch_anchor(self) -> None:
        self._refuse(
            "'&' marks an anchor", "Anchors and aliases are refused.", "Write the value out, or quote it."
        )

    def fetch_alias(self) -> None:
        self._refuse(
            "'*' marks an alias",
            "Anchors and aliases are refused.",
            "Use a parameter for a shared value; an expression cannot begin with '*'.",
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
        mark = self._source.mark(event.start_mark.line, event.start_mark.column)
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
                self._several.add(_duplicate(key, entries[key.text][0]))
                repeated = True
            if key.text not in entries or self._last_counts:
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

    fetch_anchor = Scanner.fetch_anchor
    fetch_alias = Scanner.fetch_alias

    def __init__(self, text: str, source: Source, several: Several) -> None:
        super().__init__(text, source, several)
        self._last_counts = True
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


def _from_yaml(error: yaml.MarkedYAMLError, source: Source) -> RobotFileError:
    problem, context = str(error.problem or error.context or ""), error.context_mark
    mark = error.problem_mark or context
    if mark is None:
        return RobotFileError(f"not YAML: {quoted(problem, 120)}", code=Code.NOT_YAML)
    line, column = min(mark.line, len(source.lines) - 1), mark.column
    why, before = "", source.lines[line][:column]
    above = max((k for k in range(line) if source.lines[k].partition("#")[0].strip()), default=line)
    plain = [(what, instead) for part, what, instead in _PLAIN_WORDS if part in problem]
    if context and "expected ':'" in problem:
        line, column = context.line, context.column
        what, instead = _no_colon(source.lines[line])
    elif "mapping values are not allowed" in problem:
        what, instead = (
            "a second ':' in one line",
            "Write a line for each key; put text that contains ': ' in quotes.",
        )
        if re.fullmatch(r" *(- +)*[^:]*", before) and above < line and not re.search(r":( |$)", before):
            column, (what, instead) = len(before) - len(before.lstrip()), _UNALIGNED
            if re.match(r" *-[^ -]", source.lines[above]) or not re.search(r":( |$)", source.lines[above]):
                line, (what, instead) = above, _no_colon(source.lines[above])
                column = len(source.lines[line]) - len(source.lines[line].lstrip())
    elif "expected <block end>" in problem:
        rest, (what, instead) = source.lines[line][column:], _UNALIGNED
        if rest[:1] in ("]", "}"):
            what, instead = f"'{rest[0]}' closes nothing", "Delete it."
        elif before.strip(" -"):
            what, instead = "text after the end of a value", "Put the whole value in double quotes."
    elif plain:
        what, instead = plain[0]
        if context and "never closed" in what:
            line, column = context.line, context.column
        elif context and "missing here" in what and "," in what:
            why = f"What is not closed begins on line {context.line + 1}."
            if not before.strip(" -"):  # it is missing where the text before ends
                line, column = above, len(source.lines[above].rstrip())
    else:
        what, instead = f"not YAML: {quoted(problem, 120)}", "Compare with a file under robots/."
    return RobotFileError(what, source.mark(line, column), why, instead, Code.NOT_YAML)


def _no_colon(text: str) -> tuple[str, str]:
    """What is wrong with a line that should have been ``key: value``, and what to write."""
    dash, key, sign, value = re.findall(r"^ *(- *)?([^ :=]*) *([:=]?) *(.*?) *$", text)[0]
    instead = f"Write {'- ' if dash else ''}{key}: {value}".rstrip() + "."
    if dash and not dash.endswith(" "):
        return "no space after the dash", instead
    return "no space after the colon" if sign == ":" else "a line without ':'", instead


def read_tree(text: str, file: str, several: Several | None = None, aliases: bool = False) -> Node | None:
    """The raw tree of ``text``, None for an empty file; ``several``, where given, takes keys that stand twice.
    ``aliases``: of files of others, of whose keys that stand twice the last counts."""
    text = normalise(text, file)
    source = Source.of(text, file)
    wrong = several or Several()
    composer = (_Aliased if aliases else _Composer)(text, source, wrong)
    try:
        tree = composer.document()
    except yaml.MarkedYAMLError as error:
        raise _from_yaml(error, source) from None
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        # PyYAML's own slips, such as the escape "\\UFFFFFFFF"
        raise RobotFileError(
            f"not YAML: {quoted(str(error))}",
            composer.mark_here(),
            "",
            "Compare with a file under robots/.",
            Code.NOT_YAML,
        ) from None
    if several is None:
        wrong.end()
    return tree


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
    composer = _Composer(text, Source.of(text, file), Several())
    while composer.check_token():
        token = composer.get_token()
        start, end = token.start_mark, token.end_mark
        yield Token(token.id, text[start.index : end.index].rstrip(" \n"), start.index, start.column)
