"""Slips of YAML: what PyYAML says of them in people's words, and the line as it was likely meant, to read on.

A line that is mended keeps its place and, as far as something is put in or moved, says where columns have gone.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.text import Source, quoted

_UNALIGNED = "this line does not fit the indentation above", "Align it with its neighbours."
_SECOND = "a second ':' in one line", "Write a line for each key; put text that contains ': ' in quotes."
_AFTER_THE_END = "text after the end of the document", "Delete it."
_NO_VALUE = "a value is missing here", "Write it, indented deeper than what asks for it."
_OPEN_AT_THE_END = "the file ends, and a bracket is not closed", "Write the ] or } that closes it."
_COLON = re.compile(r":( |$)")
_KEY = re.compile(r"^( *)(- *)?([^ :=\uff1a]*)( *)([:=\uff1a]?)( *)(.*?) *$")


class Line(NamedTuple):
    """A line as it is read. ``moved``: from which of its columns on it stands how much further right than in the
    file."""

    text: str
    moved: tuple[tuple[int, int], ...] = ()

    def put_in(self, column: int, text: str) -> Line:
        """With ``text`` before its ``column``; a negative column counts from the end."""
        at = column % (len(self.text) + 1)
        return Line(self.text[:at] + text + self.text[at:], (*self.moved, (at, len(text))))

    def column(self, column: int) -> int:
        """Where in the file a column of this line stands."""
        for start, width in reversed(self.moved):
            column -= min(width, column - start) if column > start and width > 0 else min(width, 0)
        return column


class Place(NamedTuple):
    """A line and a column, counted from 0."""

    line: int
    column: int


class Slip(NamedTuple):
    """What is wrong, and the line, counted from 0, as it was likely meant; None where that is not clear.
    ``follows``: may come of a line that is mended above."""

    error: RobotFileError
    number: int = 0
    meant: Line | None = None
    follows: bool = False


class _Trouble(NamedTuple):
    """``problem``, in PyYAML's words, ``at`` a place of ``lines``; ``context``: where that began which it is about."""

    problem: str
    at: Place
    context: Place | None
    lines: tuple[Line, ...]

    @property
    def line(self) -> Line:
        return self.lines[self.at.line]

    @property
    def before(self) -> str:
        return self.line.text[: self.at.column]

    @property
    def rest(self) -> str:
        return self.line.text[self.at.column :]

    @property
    def above(self) -> int:
        """The number of the line above that says something; of this one where there is none."""
        said = (k for k in range(self.at.line) if self.lines[k].text.partition("#")[0].strip())
        return max(said, default=self.at.line)

    def here(self, what: str, instead: str, meant: str | Line | None = None, why: str = "") -> _Mistake:
        """A mistake where PyYAML says it is; ``meant``: the line or its text."""
        line = self.line._replace(text=meant) if isinstance(meant, str) else meant
        return _Mistake(what, instead, self.at, line, why)

    def no_colon(self, at: Place) -> _Mistake:
        """The line of ``at`` should have been ``key: value``."""
        what, instead, meant = _no_colon(self.lines[at.line])
        return _Mistake(what, instead, at, meant)


class _Mistake(NamedTuple):
    what: str
    instead: str
    at: Place
    meant: Line | None = None
    why: str = ""


def slip_of(problem: str, at: Place, context: Place | None, lines: tuple[Line, ...], source: Source) -> Slip:
    """What ``problem``, in PyYAML's words, is to people; ``source``: the lines of the file."""
    trouble = _Trouble(problem, at._replace(line=min(at.line, len(lines) - 1)), context, lines)
    mistakes = (rule(trouble) for part, rule in _RULES if part in problem)
    what, instead, (line, column), meant, why = next((m for m in mistakes if m), None) or _not_yaml(trouble)
    mark = source.mark(line, lines[line].column(column))
    follows = what == _UNALIGNED[0] or (
        not meant and what in (_AFTER_THE_END[0], _NO_VALUE[0], _OPEN_AT_THE_END[0])
    )
    return Slip(RobotFileError(what, mark, why, instead, Code.NOT_YAML), line, meant, follows)


# ---- the mistakes, each None where it is another

_Rule = Callable[[_Trouble], _Mistake | None]


def _said(what: str, instead: str) -> _Rule:
    """A mistake that is where PyYAML says it is, and is not mended."""
    return lambda t: t.here(what, instead)


def _key_alone(t: _Trouble) -> _Mistake | None:
    return t.no_colon(t.context) if t.context else None


def _misindented(t: _Trouble) -> _Mistake | None:
    """The line, or the one above is no key with a value."""
    key = re.fullmatch(r" *(- +)*[^:]*", t.before) and not _COLON.search(t.before)
    if not key or t.above == t.at.line:
        return None
    other = t.lines[t.above].text
    if re.match(r" *-[^ -]", other) or not _COLON.search(other):
        return t.no_colon(Place(t.above, len(other) - len(other.lstrip())))
    place = t.at._replace(column=len(t.before) - len(t.before.lstrip()))
    return _Mistake(*_UNALIGNED, place, _aligned(t.lines, t.at.line, t.above))


def _colon_in_a_text(t: _Trouble) -> _Mistake | None:
    text, key = t.line.text, re.match(r"(?:description|source): +(?=\w)", t.line.text)
    if not key or "#" in text:
        return None
    line = t.line._replace(text=text.replace("'", "’"))
    return t.here(*_SECOND, line.put_in(len(text), "'").put_in(key.end(), "'"))


def _surplus(t: _Trouble) -> _Mistake | None:
    """A bracket or a comma."""
    if t.rest[:1] not in ("]", "}", ","):
        return None
    why = "stands behind a value that is complete" if t.rest[0] == "," else "closes nothing"
    return t.here(f"'{t.rest[0]}' {why}", "Delete it.", f"{t.before} {t.rest[1:]}")


def _dash_without_space(t: _Trouble) -> _Mistake | None:
    dash = re.match(r" *(?=-[^ -])", t.line.text)
    return t.no_colon(t.at._replace(column=dash.end())) if dash else None


def _slashes(t: _Trouble) -> _Mistake | None:
    if not t.before.endswith(" ") or not t.rest.startswith("//"):
        return None
    return t.here("'//' begins no comment", "Write # in the place of //.", f"{t.before}# {t.rest[2:]}")


def _text_after_a_value(t: _Trouble) -> _Mistake | None:
    if not t.before.strip(" -"):
        return None
    return t.here("text after the end of a value", "Put the whole value in double quotes.")


def _tab(t: _Trouble) -> _Mistake:
    """Before a dash it stands for as many spaces as another dash has."""
    what, instead = "a tab where spaces are needed", "YAML indents with spaces: replace the tab."
    dashes = (re.match(" +(?=- )", line.text) for line in t.lines) if t.rest.lstrip().startswith("- ") else ()
    spaces = next((dash[0] for dash in dashes if dash and not t.before.strip()), " ")
    return t.here(what, instead, f"{t.before}{spaces}{t.rest[1:]}")


def _beside_its_item(t: _Trouble) -> _Mistake | None:
    """The first line that should stand in the item of a list above it, and is indented as its dash."""
    for k, line in enumerate(t.lines[: t.at.line] if t.rest.startswith("- ") else ()):
        if line.text.startswith(f"{t.before}- ") and re.match(
            rf"{re.escape(t.before)}\w", t.lines[k + 1].text
        ):
            what = "this line is no part of the item above it"
            return _Mistake(what, "Indent it by two spaces.", Place(k + 1, t.at.column))
    return None


def _open_quote(t: _Trouble) -> _Mistake:
    return _Mistake("a quote that is never closed", "Close the quote.", t.context or t.at)


def _open(end: str, instead: str) -> _Rule:
    """A list or a mapping that does not end."""
    what = f"a ',' or '{end}' is missing here"

    def rule(t: _Trouble) -> _Mistake:
        why = f"What is not closed begins on line {t.context.line + 1}." if t.context else ""
        if not t.context or t.before.strip(" -"):
            return t.here(what, instead, why=why)
        other = t.lines[t.above]  # it is missing where the text before ends
        said = other.text if re.search("['\"]", other.text) else other.text.partition(" #")[0]
        column = len(said.rstrip())
        meant = other.put_in(column, end) if t.context.line == t.above and "#" not in said else None
        return _Mistake(what, instead, Place(t.above, column), meant, why)

    return rule


def _open_at_the_end(t: _Trouble) -> _Mistake:
    """A comma or a colon with nothing behind it but the end of the file: where the text ends."""
    last = t.at.line if t.before.strip() else t.above
    return _Mistake(*_OPEN_AT_THE_END, Place(last, len(t.lines[last].text.rstrip())))


def _minus_with_space(t: _Trouble) -> _Mistake | None:
    if not t.rest.startswith("- "):
        return None
    what = "a '-' with a space behind it begins an item of a list"
    return t.here(what, "Write -0.1 without the space.", f"{t.before} -{t.rest[2:]}")


def _no_beginning(t: _Trouble) -> _Mistake | None:
    """A character with which no value begins."""
    if not (word := re.match(r"[^ ,\[\]{}:#]+", t.rest)):
        return None
    end = t.at.column + word.end()
    meant = t.line.put_in(end, "'").put_in(t.at.column, "'") if "'" not in word[0] else None
    what = f"{quoted(t.rest[0])} cannot begin a value"
    return t.here(what, "Delete it, or put the value in quotes.", meant)


def _not_yaml(t: _Trouble) -> _Mistake:
    return t.here(f"not YAML: {quoted(t.problem, 120)}", "Compare with a file under robots/.")


# A part of what PyYAML says, and the mistakes that it may be, in order.
_RULES: tuple[tuple[str, _Rule], ...] = (
    ("expected ':'", _key_alone),
    ("mapping values are not allowed", _dash_without_space),
    ("mapping values are not allowed", _misindented),
    ("mapping values are not allowed", _colon_in_a_text),
    ("mapping values are not allowed", _said(*_SECOND)),
    ("expected <block end>", _surplus),
    ("expected <block end>", _dash_without_space),
    ("expected <block end>", _beside_its_item),
    ("expected <block end>", _slashes),
    ("expected <block end>", _text_after_a_value),
    ("expected <block end>", _said(*_UNALIGNED)),
    ("'\\t'", _tab),
    ("unexpected end of stream", _open_quote),
    ("expected ',' or ']'", _open("]", "Separate items by ',' and end the list with ']'.")),
    ("expected ',' or '}'", _open("}", "Separate keys by ',' and end with '}'.")),
    ("did not find expected <document start>", _minus_with_space),
    ("did not find expected <document start>", _said(*_AFTER_THE_END)),
    ("expected the node content", _minus_with_space),
    ("but found '<stream end>'", _open_at_the_end),
    ("expected the node content", _said(*_NO_VALUE)),
    ("escape", _said("an unknown escape in double quotes", "Use single quotes, or none.")),
    ("cannot start any token", _no_beginning),
)


def _aligned(lines: tuple[Line, ...], number: int, above: int) -> Line | None:
    """A line that is indented deeper than its neighbours above and below, level with them."""
    line, below = lines[number], lines[number + 1].text if number + 1 < len(lines) else ""
    before, own, under = (len(text) - len(text.lstrip(" ")) for text in (lines[above].text, line.text, below))
    dash = re.match(r" *- +", lines[above].text)
    level = len(dash[0]) if dash else before
    return (
        Line(line.text[own - level :], ((0, level - own),))
        if own > level == under and not line.moved
        else None
    )


def _no_colon(line: Line) -> tuple[str, str, Line]:
    """What is wrong with a line that should have been ``key: value``, what to write, and the line so."""
    match = _KEY.match(line.text)
    assert match
    indent, dash, key, _, sign, space, value = (part or "" for part in match.groups())
    instead = f"Write {'- ' if dash else ''}{key}: {value}".rstrip() + "."
    if sign:
        meant = line._replace(text=f"{line.text[: match.start(5)]}:{line.text[match.end(5) :]}")
        if not space:
            meant = meant.put_in(match.end(5), " ")
    else:
        meant = line.put_in(match.end(3), ":")
    if key.startswith("//"):
        what, instead = "'//' begins no comment", "Write # in the place of //."
        return what, instead, line._replace(text=line.text.replace("//", "# ", 1))
    if dash and not dash.endswith(" "):
        return "no space after the dash", instead, line.put_in(len(indent) + 1, " ") if sign else meant
    return "no space after the colon" if sign == ":" else "a line without ':'", instead, meant
