"""Read YAML text as a tree of texts, lists and mappings. This is the only module that knows PyYAML.

PyYAML's pure-Python scanner and parser give events. Nothing is resolved or constructed, so each value is the text that
was written. Depth and size are limited. Tags and directives, and in robot files anchors and aliases, are refused where
they are. Reading stops at the first mistake in the YAML, which is explained in words of the robot file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, NoReturn

import yaml
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.scanner import Scanner

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
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

MAX_DEPTH = 16  # levels; a robot file needs five
MAX_NODES = 20_000  # values in one file; limits the work for hostile input, far above any robot
_LONGEST_KEY = 100  # characters; the longest key or name has 31

_TOO_DEEP = (
    f"nested deeper than {MAX_DEPTH} levels",
    "A robot file needs five levels.",
    "Look for brackets that are not closed, or for repeated dashes.",
)
_KEYS_IN_A_QUOTE = re.compile(r"[{},]\s*\w+: |- \w+: ")  # a quoted text that runs on over the next keys


class _Composer(Reader, Scanner, Parser):
    """Makes nodes of PyYAML's events and counts them; refuses what a robot file must not contain."""

    last_duplicate_counts = False  # which value a repeated key has: the first, or the last

    def __init__(self, text: str, source: Source, collector: ErrorCollector) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        self._source, self._collector = source, collector
        self._nodes = 0

    def _refuse(self, what: str, why: str, instead: str) -> NoReturn:
        """Raise an error at the place that the scanner has reached."""
        raise RobotFileError(what, self.mark_here(), why, instead, Code.NOT_YAML)

    def mark_here(self) -> Mark:
        """Return the place that the scanner has reached."""
        return self._source.mark(self.line, self.column)

    # The scanner calls these where it meets the sign, before anything is built from it.

    def fetch_anchor(self) -> None:
        self._refuse(
            "'&' starts an anchor", "Robot files have no anchors.", "Write the value out, or quote it."
        )

    def fetch_alias(self) -> None:
        self._refuse(
            "'*' starts an alias",
            "Robot files have no aliases.",
            "Write the value out, or declare it under parameters: and use its name.",
        )

    def fetch_tag(self) -> None:
        self._refuse("'!' starts a tag", "Robot files have no tags.", "Delete the tag, or quote the value.")

    def fetch_directive(self) -> None:
        self._refuse("'%' starts a directive", "Robot files have no directives.", "Delete the line.")

    def fetch_flow_collection_start(self, TokenClass: Any) -> None:
        # The scanner runs ahead of the parser: without this limit it would read 1024 brackets first.
        if self.flow_level >= MAX_DEPTH:
            self._refuse(*_TOO_DEEP)
        super().fetch_flow_collection_start(TokenClass)

    def document(self) -> Node | None:
        """Return the tree of the only document, or None if the file has no document."""
        self.get_event()
        if self.check_event(yaml.StreamEndEvent):
            return None
        self.get_event()
        node = self._node(0)
        self.get_event()
        if not self.check_event(yaml.StreamEndEvent):
            raise RobotFileError(
                "a second document starts here",
                self._source.mark(self.peek_event().start_mark.line, 0),
                "A robot file describes one robot.",
                "Write one file for each robot.",
                Code.NOT_YAML,
            )
        return node

    def _node(self, depth: int) -> Node:
        """Return the next value with everything below it."""
        event = self.get_event()
        mark = self._source.mark(event.start_mark.line, event.start_mark.column)
        self._nodes += 1
        if depth > MAX_DEPTH:
            raise RobotFileError(_TOO_DEEP[0], mark, *_TOO_DEEP[1:], Code.NOT_YAML)
        if self._nodes > MAX_NODES:
            raise RobotFileError(
                f"more than {MAX_NODES} values in one file",
                mark,
                "A robot file is a page of text.",
                "Give the robot file itself, not a log or a generated file.",
                Code.NOT_YAML,
            )
        if isinstance(event, yaml.ScalarEvent):
            return self._scalar(event, mark)
        if isinstance(event, yaml.SequenceStartEvent):
            items = []
            while not self.check_event(yaml.SequenceEndEvent):
                items.append(self._node(depth + 1))
            self.get_event()
            return SequenceNode(mark, tuple(items))
        return self._mapping(mark, depth)

    def _scalar(self, event: Any, mark: Mark) -> Scalar:
        """Return the text of an event, if it may be in a robot file."""
        end = event.end_mark.line + 1 if event.end_mark else mark.line
        if event.style in ("'", '"') and end > mark.line and _KEYS_IN_A_QUOTE.search(event.value):
            what = f"the quote that opens here is closed on line {end}"
            raise RobotFileError(what, mark, "", "Close the quote at the end of the value.", Code.NOT_YAML)
        scalar = Scalar(mark, event.value, event.style is None)
        refused = refused_character(scalar.text)  # an escape in double quotes can make any character
        if refused:
            raise scalar.error(f"{refused[1]} in a text", refused[2], "Delete it.", code=Code.NOT_YAML)
        return scalar

    def _mapping(self, mark: Mark, depth: int) -> MappingNode:
        """Return the entries of a mapping whose start has been read. Repeated keys are reported to the collector."""
        entries: dict[str, tuple[Scalar, Node]] = {}
        repeated = False
        while not self.check_event(yaml.MappingEndEvent):
            key = self._key(depth + 1)
            value = self._node(depth + 1)
            if key.text in entries:
                self._collector.add(_duplicate(key, entries[key.text][0]))
                repeated = True
            if key.text not in entries or self.last_duplicate_counts:
                entries[key.text] = (key, value)
        self.get_event()
        return MappingNode(mark, tuple(entries.values()), repeated)

    def _key(self, depth: int) -> Scalar:
        """Return the next key; raise RobotFileError if it is not a word."""
        key = self._node(depth)
        if not isinstance(key, Scalar) or "\n" in key.text or len(key.text) > _LONGEST_KEY:
            raise key.error(
                f"a key must be a word of at most {_LONGEST_KEY} characters", "", "Write key: value.",
                code=Code.NOT_YAML,
            )  # fmt: skip
        return key


def _duplicate(key: Scalar, first: Scalar) -> RobotFileError:
    """Return the error for a key that is repeated."""
    return key.error(
        f"duplicate key {quoted(key.text)}",
        f"The key is also on line {first.mark.line}.",
        "Delete one of the two.",
        code=Code.TWICE,
    )


class _AliasComposer(_Composer):
    """Reads files of other programs, which may have anchors. If a key is repeated, the last one counts, as in ROS.

    The nodes of an alias are counted again, so that a few lines cannot stand for millions of nodes.
    """

    last_duplicate_counts = True
    fetch_anchor = Scanner.fetch_anchor
    fetch_alias = Scanner.fetch_alias

    def fetch_tag(self) -> None:
        """Accept the tags of angles in ROS files (the number is read as written); refuse other tags."""
        of_ros = any(self.prefix(len(tag)) == tag for tag in ("!degrees", "!radians"))
        (Scanner if of_ros else _Composer).fetch_tag(self)

    def __init__(self, text: str, source: Source, collector: ErrorCollector) -> None:
        super().__init__(text, source, collector)
        self._anchored: dict[str, tuple[Node, int]] = {}  # the node of each anchor, and how many nodes it has

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
            what = f"nothing above is called {quoted('&' + name)}"
            raise RobotFileError(what, self.mark_here(), "", "Write the value out.")
        node, count = self._anchored[name]
        self._nodes += count
        return node


def read_tree(
    text: str, file: str, collector: ErrorCollector | None = None, aliases: bool = False
) -> Node | None:
    """Return the tree of a YAML text.

    Args:
        text: The whole file.
        file: The name of the file, for messages.
        collector: Receives repeated keys. Without it, the first repeated key is raised.
        aliases: Whether anchors and aliases are read, as files of other programs have them.

    Returns:
        The root of the tree, or None if the file is empty.

    Raises:
        RobotFileError: The text is not the YAML of robot files, with the place of the first mistake.
    """
    text = normalise(text, file)
    source, repeated = Source.of(text, file), collector or ErrorCollector()
    composer = (_AliasComposer if aliases else _Composer)(text, source, repeated)
    try:
        tree = composer.document()
    except yaml.MarkedYAMLError as error:
        raise _explained(error, composer.mark_here(), text, source) from None
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        # Errors that PyYAML raises without a place, such as for the escape "\\UFFFFFFFF".
        raise RobotFileError(*_not_yaml(str(error), composer.mark_here())) from None
    if collector is None:
        repeated.end()
    return tree


class Token(NamedTuple):
    """A word of YAML as written, or the start or end of a block, which has no text."""

    kind: str
    text: str
    start: int  # index of the first character in the whole text
    column: int  # of the first character, from 0

    @property
    def end(self) -> int:
        """Index of the character after the last one."""
        return self.start + len(self.text)


def tokens(text: str, file: str) -> Iterator[Token]:
    """Yield the words of a text that `read_tree` accepts, in order. Between them are only blanks and comments."""
    composer = _Composer(text, Source.of(text, file), ErrorCollector())
    while composer.check_token():
        token = composer.get_token()
        start, end = token.start_mark, token.end_mark
        yield Token(token.id, text[start.index : end.index].rstrip(" \n"), start.index, start.column)


# ---- what PyYAML reports, explained in words of the robot file


class _Problem(NamedTuple):
    """What PyYAML reports. Lines and columns count from 0."""

    text: str  # in PyYAML's words
    line: int
    column: int
    # Line and column where the key, quote or bracket begins that the problem is about.
    start: tuple[int, int] | None
    lines: tuple[str, ...]  # of the whole file

    @property
    def before(self) -> str:
        """The line up to the problem."""
        return self.lines[self.line][: self.column]

    @property
    def rest(self) -> str:
        """The line from the problem on."""
        return self.lines[self.line][self.column :]

    @property
    def line_above(self) -> int:
        """The number of the nearest line above that is not blank or a comment; of this line if there is none."""
        for number in range(self.line - 1, -1, -1):
            if self.lines[number].partition("#")[0].strip():
                return number
        return self.line

    def here(self, what: str, instead: str) -> _Explanation:
        """Return an explanation at the place that PyYAML reports."""
        return _Explanation(what, instead, self.line, self.column)


class _Explanation(NamedTuple):
    """What is wrong, what to write, and where. Lines and columns count from 0."""

    what: str
    instead: str
    line: int
    column: int
    why: str = ""


def _explained(error: yaml.MarkedYAMLError, reached: Mark, text: str, source: Source) -> RobotFileError:
    """Return the error for what PyYAML reports.

    Args:
        error: The error of PyYAML.
        reached: The place that the scanner has reached, in case PyYAML gives none.
        text: The whole file.
        source: The lines of the file, from which marks are made.
    """
    problem_text = str(error.problem or error.context or "")
    mark, start = error.problem_mark or error.context_mark, error.context_mark
    lines = tuple(text.split("\n"))
    line, column = (mark.line, mark.column) if mark else (reached.line - 1, reached.column - 1)
    started = (start.line, start.column) if start else None
    problem = _Problem(problem_text, min(line, len(lines) - 1), column, started, lines)
    for part, explain in _EXPLANATIONS:
        if part in problem_text:
            what, instead, line, column, why = explain(problem)
            return RobotFileError(what, source.mark(line, column), why, instead, Code.NOT_YAML)
    return RobotFileError(*_not_yaml(problem_text, source.mark(problem.line, problem.column)))


def _not_yaml(problem: str, mark: Mark) -> tuple[str, Mark, str, str, Code]:
    """Return the arguments of the error for a problem that has no explanation below."""
    instead = "Compare the line with a file under robots/."
    return f"not YAML: {quoted(problem, 120)}", mark, "", instead, Code.NOT_YAML


def _missing_colon(line: int, text: str) -> _Explanation:
    """Return the error for a line that should be ``key: value`` or ``- key: value``."""
    parts = re.fullmatch(r"( *)(- *)?([^ :=\uff1a]*) *([:=\uff1a]?) *(.*?) *", text)
    assert parts
    indent, dash, key, sign, value = (part or "" for part in parts.groups())
    what = "missing space after ':'" if sign == ":" else "missing ':' after the key"
    if dash and not dash.endswith(" "):
        what = "missing space after '-'"
    instead = "Write key: value, or # before a comment."
    if key[:1].isalpha() or dash:
        pair = f"{key}: {value}" if sign or not dash else f"{key} {value}"
        instead = f"Write {'- ' if dash else ''}{pair.rstrip()}."
    return _Explanation(what, instead, line, len(indent))


def _dash_without_space(line: str) -> bool:
    """Return whether a line begins with - and no space."""
    return bool(re.match(r" *-[^ -]", line))


def _key_without_colon(p: _Problem) -> _Explanation:
    """Explain a key that has no colon."""
    line = p.start[0] if p.start else p.line
    return _missing_colon(line, p.lines[line])


def _unexpected_colon(p: _Problem) -> _Explanation:
    """Explain an unexpected colon: a second one, none in the line above, or wrong indentation."""
    above = p.lines[p.line_above]
    if ":" not in p.before and p.line_above < p.line:
        if _dash_without_space(above) or not re.search(r":( |$)", above):
            return _missing_colon(p.line_above, above)
        return _Explanation(*_INDENTATION, p.line, len(p.before) - len(p.before.lstrip()))
    if _dash_without_space(p.lines[p.line]):
        return _missing_colon(p.line, p.lines[p.line])
    instead = "Write one line for each key; put a text that contains ': ' in quotes."
    return p.here("a second ':' in one line", instead)


_INDENTATION = "wrong indentation", "Align the line with its neighbours."


def _unexpected_text(p: _Problem) -> _Explanation:
    """Explain unexpected text: an extra bracket or comma, text after a value, or wrong indentation."""
    sign = p.rest[:1]
    if sign in ("]", "}"):
        return p.here(f"'{sign}' without an opening bracket", "Delete it.")
    if sign == ",":
        return p.here("a ',' after a complete value", "Delete it.")
    if _dash_without_space(p.lines[p.line]):
        return _missing_colon(p.line, p.lines[p.line])
    if p.before.strip(" -"):
        instead = "Put the whole value in double quotes, or # before a comment."
        return p.here("text after the end of a value", instead)
    return p.here(*_INDENTATION)


def _unclosed_quote(p: _Problem) -> _Explanation:
    """Explain a quote that is not closed before the end of the file."""
    return _Explanation("a quote that is never closed", "Close the quote.", *(p.start or (p.line, p.column)))


def _unclosed_bracket(p: _Problem) -> _Explanation:
    """Explain a bracket that is not closed. It is missing after the last text before the problem."""
    end = "]" if "']'" in p.text else "}"
    line, column = p.line, p.column
    if p.start and not p.before.strip(" -"):
        line = p.line_above
        text = p.lines[line]
        column = len((text if re.search("['\"]", text) else text.partition(" #")[0]).rstrip())
    why = f"The bracket on line {p.start[0] + 1} is not closed." if p.start else ""
    instead = f"Separate entries by ',' and close the bracket with '{end}'."
    return _Explanation(f"missing ',' or '{end}'", instead, line, column, why)


def _missing_value(p: _Problem) -> _Explanation:
    """Explain a missing value, or a file that ends inside a bracket."""
    if "<stream end>" in p.text:
        line = p.line if p.before.strip() else p.line_above
        return _Explanation(
            "the file ends inside a bracket",
            "Write the ] or } that closes it.",
            line,
            len(p.lines[line].rstrip()),
        )
    return p.here(
        "missing value",
        "Write the value, or close the bracket above. A negative number has no space after '-'.",
    )


def _reserved_character(p: _Problem) -> _Explanation:
    """Explain a value that begins with a character that YAML reserves."""
    return p.here(f"{quoted(p.rest[:1])} cannot begin a value", "Delete it, or put the value in quotes.")


# A part of PyYAML's message, and what explains it. The first part that occurs counts.
_EXPLANATIONS: tuple[tuple[str, Callable[[_Problem], _Explanation]], ...] = (
    ("expected ':'", _key_without_colon),
    ("mapping values are not allowed", _unexpected_colon),
    ("expected <block end>", _unexpected_text),
    ("'\\t'", lambda p: p.here("a tab in the indentation", "Replace the tab with spaces.")),
    ("unexpected end of stream", _unclosed_quote),
    (
        "sequence entries are not allowed",
        lambda p: p.here("a list item in the line of its key", "Begin the list on the next line."),
    ),
    ("expected ',' or ", _unclosed_bracket),
    ("expected <document start>", lambda p: p.here("text after the end of the document", "Delete it.")),
    ("expected the node content", _missing_value),
    ("escape", lambda p: p.here("unknown escape in double quotes", "Use single quotes, or no quotes.")),
    ("cannot start any token", _reserved_character),
)
