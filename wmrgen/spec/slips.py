"""Slips of YAML: what PyYAML says of them in people's words, and the line as it was likely meant, to read on.

A line that is mended keeps its place and, as far as something is put in or moved, says where columns have gone.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from wmrgen.errors import Code, Mark, RobotFileError
from wmrgen.spec.text import Source, quoted

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
_SECOND = "a second ':' in one line", "Write a line for each key; put text that contains ': ' in quotes."
_KEY = re.compile(r"^( *)(- *)?([^ :=]*)( *)([:=]?)( *)(.*?) *$")


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


def slip_of(problem: str, at: Place, context: Place | None, lines: tuple[Line, ...], source: Source) -> Slip:
    """What ``problem``, in PyYAML's words, is to people; ``source``: the lines of the file."""
    line, column = min(at.line, len(lines) - 1), at.column
    text = lines[line].text
    why, before, meant = "", text[:column], None
    above = max((k for k in range(line) if lines[k].text.partition("#")[0].strip()), default=line)
    plain = [(what, instead) for part, what, instead in _PLAIN_WORDS if part in problem]
    if context and "expected ':'" in problem:
        line, column = context.line, context.column
        what, instead, meant = _no_colon(lines[line])
    elif "mapping values are not allowed" in problem:
        what, instead = _SECOND
        if re.fullmatch(r" *(- +)*[^:]*", before) and above < line and not re.search(r":( |$)", before):
            column, (what, instead) = len(before) - len(before.lstrip()), _UNALIGNED
            other = lines[above].text
            if re.match(r" *-[^ -]", other) or not re.search(r":( |$)", other):
                line, column = above, len(other) - len(other.lstrip())
                what, instead, meant = _no_colon(lines[line])
            else:
                meant = _aligned(lines, line, above)
        elif "#" not in text and (key := re.match(r"(?:description|source): +(?=\w)", text)):
            meant = (
                Line(text.replace("'", "’"), lines[line].moved).put_in(len(text), "'").put_in(key.end(), "'")
            )
    elif "expected <block end>" in problem:
        rest, (what, instead) = text[column:], _UNALIGNED
        if rest[:1] in ("]", "}", ","):
            what = f"'{rest[0]}' {'stands behind a value that is complete' if rest[0] == ',' else 'closes nothing'}"
            instead, meant = "Delete it.", lines[line]._replace(text=f"{before} {rest[1:]}")
        elif re.match(r"-[^ -]", rest) and not before.strip():
            what, instead, meant = _no_colon(lines[line])
        elif before.endswith(" ") and rest.startswith("//"):
            what, instead = "'//' begins no comment", "Write # in the place of //."
            meant = lines[line]._replace(text=f"{before}# {rest[2:]}")
        elif before.strip(" -"):
            what, instead = "text after the end of a value", "Put the whole value in double quotes."
    elif plain:
        what, instead = plain[0]
        if "a tab" in what:
            meant = lines[line]._replace(text=f"{before} {text[column + 1 :]}")
        elif context and "never closed" in what:
            line, column = context.line, context.column
        elif context and "missing here" in what and "," in what:
            why = f"What is not closed begins on line {context.line + 1}."
            if not before.strip(" -"):  # it is missing where the text before ends
                line, column = above, len(lines[above].text.rstrip())
                if context.line == above and "#" not in lines[above].text:
                    meant = lines[above].put_in(column, what[what.index("or '") + 4])
        elif text[column : column + 2] == "- ":
            what, instead = (
                "a '-' with a space behind it begins an item of a list",
                "Write -0.1 without the space.",
            )
            meant = lines[line]._replace(text=f"{before} -{text[column + 2 :]}")
    elif "cannot start any token" in problem and (word := re.match(r"[^ ,\[\]{}:#]+", text[column:])):
        what, instead = (
            f"{quoted(text[column])} cannot begin a value",
            "Delete it, or put the value in quotes.",
        )
        if "'" not in word[0]:
            meant = lines[line].put_in(column + word.end(), "'").put_in(column, "'")
    else:
        what, instead = f"not YAML: {quoted(problem, 120)}", "Compare with a file under robots/."
    mark = source.mark(line, lines[line].column(column))
    follows = what == _UNALIGNED[0] or (not meant and what in {said for _, said, _ in _PLAIN_WORDS[4:6]})
    return Slip(RobotFileError(what, mark, why, instead, Code.NOT_YAML), line, meant, follows)


def without(lines: tuple[Line, ...], mark: Mark) -> Line | None:
    """The line of ``mark``, where an anchor or a tag stands, with blanks in its place; None where there is none."""
    line = lines[mark.line - 1]
    word = re.compile(r"[&!][^ ,\[\]{}]*").match(line.text, mark.column - 1) if not line.moved else None
    blank = line.text[: word.start()] + " " * len(word[0]) + line.text[word.end() :] if word else ""
    return line._replace(text=blank) if word else None


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
