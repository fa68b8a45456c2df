"""Untrusted XML to elements and numbers: by defusedxml, under caps.

No entity and no document type is followed; numbers are read by a pattern, never evaluated.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple
from xml.etree.ElementTree import Element, ParseError

from wmrgen.errors import Code, EnvironmentFailure, Mark, RobotFileError
from wmrgen.importing.frames import unit
from wmrgen.importing.records import Vector
from wmrgen.spec.text import Source, printable, quoted

MAX_BYTES = 4 * 1024 * 1024
MAX_ELEMENTS = 100_000
MAX_DEPTH = 64
_NUMBER = re.compile(r"([+-]?)(\d{1,40}(?:\.\d{0,40})?|\.\d{1,40})(?:[eE]([+-]?\d{1,4}))?")
_ENDLESS = re.compile(r"([+-]?)(?:inf(?:inity)?|[\d.]{1,40}e\+?(?:[3-9]\d|\d{3,4}))", re.IGNORECASE)
_TAG = re.compile(r"<([\w:-]++)([^<>]*+)>\s*+")
_NAME = re.compile(r"""\sname\s*+=\s*+["']([^"'<>]*+)""")
_LARGEST, _SMALLEST = 30, -30  # exponents; below is zero
ONES: Vector = (Fraction(1), Fraction(1), Fraction(1))
ZERO: Vector = (Fraction(0), Fraction(0), Fraction(0))


def refuse(what: str, why: str = "", instead: str = "", mark: Mark | None = None) -> RobotFileError:
    return RobotFileError(what, mark, why, instead, Code.DESCRIPTION)


def parse(text: bytes, file: str, most: int = MAX_BYTES) -> Element:
    """The root element. RobotFileError for what is no XML, has a document type or is too large."""
    try:
        from defusedxml.common import DefusedXmlException
        from defusedxml.ElementTree import fromstring
    except ImportError:
        raise EnvironmentFailure("import reads XML by defusedxml: pip install 'wmrgen[import]'") from None
    if len(text) > most:
        raise refuse(f"{file}: larger than {most // 1024 // 1024} MiB")
    try:
        try:
            root: Element = fromstring(text, forbid_dtd=True)
        except ParseError as error:
            plain = re.sub(rb"<!--.*?-->", _blank, text, flags=re.DOTALL)  # simulators allow -- in comments
            if plain == text and "unbound prefix" not in str(error):
                raise
            root = fromstring(_bound(plain), forbid_dtd=True)
    except DefusedXmlException:
        raise refuse(
            f"{file}: has a document type or entities", "They are refused.", "Delete them."
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        words = re.sub(r": line \d+, column \d+$", "", str(error))
        raise refuse(f"{file}: not XML: {quoted(words, 100)}", mark=_place(error, text, file)) from None
    _cap(root, file)
    return root


def _place(error: Exception, text: bytes, file: str) -> Mark | None:
    """Where the parser stopped, in a text of UTF-8; None where it does not say."""
    if not isinstance(error, ParseError):
        return None
    line, column = error.position
    lines = text.decode("utf-8", "replace").splitlines()
    shown = lines[line - 1] if line <= len(lines) else ""
    return Mark(file, line, column + 1, printable(shown))


class Tag(NamedTuple):
    """A start tag in a text of XML: its kind and attributes, where it begins and where what follows it does; its name
    and where that stands, "" and the beginning where it has none."""

    kind: str
    attributes: str
    start: int
    end: int
    name: str
    name_start: int


def tags(text: str) -> Iterator[Tag]:
    """The start tags of a text of XML, in their order, outside comments."""
    for tag in _TAG.finditer(_without_comments(text)):
        name = _NAME.search(tag[2])
        own = (name[1], tag.start(2) + name.start(1)) if name else ("", tag.start())
        yield Tag(tag[1], tag[2], tag.start(), tag.end(), *own)


def place_of(message: str, data: bytes, file: str) -> Mark | None:
    """Where a file has what a message quotes: first the element of that name, in it what is quoted then. None where it
    does not stand there as it is quoted."""
    text = data.decode("utf-8", "replace")
    plain, at = _without_comments(text), None
    for kind, words in re.findall(r"(?:(joint|link) )?'([^']+)'", message):
        if at is None:
            at = next((t.start for t in tags(text) if t.name == words and kind in ("", t.kind)), None)
            if at is not None:
                continue
            if kind:
                return None  # of an included file
        token = re.compile(rf"(?<![\w.:-]){re.escape(words)}(?![\w.:-])").search(plain, at or 0)
        at = token.start() if token else at
    return None if at is None else Source.of(text, file).mark_at(text, at)


def _without_comments(text: str) -> str:
    """The text with blanks in the place of comments, so that places stay."""
    return re.sub("<!--.*?-->", lambda comment: re.sub(r"[^\n]", " ", comment[0]), text, flags=re.DOTALL)


def _blank(comment: re.Match[bytes]) -> bytes:
    """Line ends alone, so that places stay."""
    return b"\n" * comment[0].count(b"\n")


def _bound(text: bytes) -> bytes:
    """The text with every prefix declared at its root, by its own name: simulators do not ask for declarations."""
    prefixes = sorted(set(re.findall(rb"[<\s]([A-Za-z_][\w.-]{0,30}):[A-Za-z_]", text)) - {b"xml", b"xmlns"})
    declared = b"".join(b' xmlns:%s="%s"' % (p, p) for p in prefixes if b"xmlns:" + p + b"=" not in text)
    return re.sub(rb"<([A-Za-z_][\w.-]*)", lambda match: match[0] + declared, text, count=1)


def _cap(root: Element, file: str) -> None:
    count, level = 0, [root]
    for _ in range(MAX_DEPTH):
        count += len(level)
        level = [child for element in level for child in element]
    if level or count > MAX_ELEMENTS:
        raise refuse(f"{file}: deeper than {MAX_DEPTH} levels or more than {MAX_ELEMENTS} elements")


def local(element: Element) -> str:
    """The name of an element without its namespace; empty for comments."""
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def children(element: Element, name: str) -> list[Element]:
    return [child for child in element if local(child) == name]


def child(element: Element, name: str) -> Element | None:
    return next(iter(children(element, name)), None)


def text_in(element: Element, name: str) -> str:
    """The text of the first child of a name; empty where there is none."""
    part = child(element, name)
    return "" if part is None else (part.text or "").strip()


def below(element: Element, name: str) -> Iterator[Element]:
    return (each for each in element.iter() if local(each) == name)


def number(text: str, what: str) -> Fraction:
    match = _NUMBER.fullmatch(text.strip())
    if not match:
        hint = f"xacro reads ${quoted(text)[1:-1]}." if text.strip().startswith("{") else ""
        raise refuse(f"{what}: {quoted(text)} is not a number", "", hint)
    sign, digits, exponent = match.groups()
    power = int(exponent or 0)
    if power > _LARGEST:
        raise refuse(f"{what}: {quoted(text)} is too large")
    return Fraction(f"{sign}{digits}e{power}") if power >= _SMALLEST else Fraction(0)


def vector(text: str | None, what: str, default: Vector = ZERO) -> Vector:
    """Three numbers; ``default`` where nothing is written."""
    parts = (text or "").split()
    if not parts:
        return default
    if len(parts) != 3:
        raise refuse(f"{what}: three numbers are needed, not {quoted(str(text))}")
    x, y, z = (number(part, what) for part in parts)
    return x, y, z


def bound(text: str, what: str) -> Fraction:
    """A limit. One that is infinite, or as large as a float, is 10^30 of its sign."""
    if match := _ENDLESS.fullmatch(text.strip()):
        return Fraction(f"{match[1]}1e{_LARGEST}")
    return number(text, what)


def direction(text: str | None, what: str) -> Vector | None:
    """The unit vector that three numbers say; None where nothing is written, or 0 0 0, which says as little."""
    try:
        return unit(vector(text, what))
    except ValueError:
        return None


def name_of(element: Element, what: str) -> str:
    name = element.get("name", "")
    if "${" in name or "$(" in name:
        raise refuse(f"the {what} {quoted(name)} is an unresolved xacro expression")
    return name
