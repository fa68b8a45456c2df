"""Untrusted XML to elements and numbers: by defusedxml, under caps.

No entity and no document type is followed; numbers are read by a pattern, never evaluated.
"""

from __future__ import annotations

import codecs
import contextlib
import re
from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, cast
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

from wmrgen.errors import Code, EnvironmentFailure, Mark, RobotFileError
from wmrgen.geometry.exact.poly import triple
from wmrgen.robotfile.text import Source, bytes_of, printable, quoted
from wmrgen.tools.importing.frames import unit
from wmrgen.tools.importing.records import Vector

MAX_BYTES = 4 * 1024 * 1024  # of a description; the largest known has 0.3 MiB
MAX_ELEMENTS = 100_000  # of XML
MAX_DEPTH = 64  # of elements in elements
_NUMBER = re.compile(r"([+-]?)(\d{1,40}(?:\.\d{0,40})?|\.\d{1,40})(?:[eE]([+-]?\d{1,4}))?")
_ENDLESS = re.compile(r"([+-]?)(?:inf(?:inity)?|[\d.]{1,40}e\+?(?:[3-9]\d|\d{3,4}))", re.IGNORECASE)
_LARGEST, _SMALLEST = 30, -30  # exponents; below is zero
_UNBOUND = "unbound prefix"
_XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
ONES: Vector = (Fraction(1), Fraction(1), Fraction(1))
ZERO: Vector = (Fraction(0), Fraction(0), Fraction(0))


def refuse(what: str, why: str = "", instead: str = "", mark: Mark | None = None) -> RobotFileError:
    """Return the error for a description that cannot be read.

    Args:
        what: What is wrong.
        why: The reason.
        instead: What to write.
        mark: The place in the file.

    Returns:
        The error, which the caller raises.
    """
    return RobotFileError(what, mark, why, instead, Code.DESCRIPTION)


class Text:
    """The bytes of a file, and its name in messages."""

    def __init__(self, data: bytes, file: str) -> None:
        self.data, self.file = data, file

    @cached_property
    def source(self) -> Source:
        wide = self.data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        text = self.data.decode("utf-16" if wide else "utf-8", "replace")
        return Source.of(re.sub("\r\n?", "\n", text), self.file)


class Place(NamedTuple):
    """Where a tag begins: line and column as expat counts them, from 1 and 0."""

    text: Text
    line: int
    column: int

    @property
    def mark(self) -> Mark:
        return self.text.source.mark(self.line - 1, self.column)


class Placed(Element):
    """An element that keeps its place; None where nobody wrote it."""

    place: Place | None = None


def placed(root: Element) -> Iterator[Placed]:
    """The elements below what `parse` gave, and that itself, in the order of the file."""
    return (each for each in root.iter() if isinstance(each, Placed))


def mark_of(element: Element) -> Mark | None:
    """Where an element stands."""
    place = element.place if isinstance(element, Placed) else None
    return place.mark if place else None


@contextlib.contextmanager
def at(element: Element) -> Iterator[None]:
    """What is wrong in the block stands at ``element``, where it does not stand at one inside."""
    try:
        yield
    except RobotFileError as error:
        error.mark = error.mark or mark_of(element)
        raise


class _Builder(TreeBuilder):
    """Placed elements; ``parser``: expat, which reads ``text``."""

    def __init__(self, text: Text) -> None:
        super().__init__(Placed)
        self.text, self.parser = text, cast(Any, None)

    def start(self, tag: Any, attributes: Any, /) -> Any:
        element: Any = super().start(tag, attributes)
        element.place = Place(self.text, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber)
        return element


def parse(text: bytes, file: str, most: int = MAX_BYTES, strict: bool = False) -> Element:
    """Return the root of `Placed` elements of a text.

    Args:
        text: The content of the file.
        file: The path of the file.
        most: The largest size [bytes].
        strict: Whether to reject what simulators read all the same: -- in comments, prefixes that are not declared, and
            text before the declaration of XML.

    Returns:
        The root.

    Raises:
        RobotFileError: The text is no XML, has a document type, or is too large.
    """
    try:
        from defusedxml.common import DefusedXmlException
    except ImportError:
        raise EnvironmentFailure("import reads XML by defusedxml: pip install 'wmrgen[import]'") from None
    name = file.rpartition("/")[2]
    if len(text) > most:
        raise refuse(f"{name}: larger than {most // 1024 // 1024} MiB")
    source = Text(text, file)
    try:
        try:
            root = _elements(text, source)
        except ParseError as error:
            plain = re.sub(rb"<!--.*?-->", _blank, text, flags=re.DOTALL)
            plain = re.sub(rb"\A\s+<\?xml[^>]*>", _blank, plain)
            if strict or (plain == text and _UNBOUND not in str(error)):
                raise
            root = _elements(_bound(plain), source)
    except DefusedXmlException:
        raise refuse(
            f"{name}: has a document type or entities", "They are refused.", "Delete them."
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        words = re.sub(r": line \d+, column \d+$", "", str(error))
        line, column = error.position if isinstance(error, ParseError) else (0, 0)
        mark = source.source.mark(line - 1, column) if line else None
        hint = f"Write <robot {_XACRO}>." if _UNBOUND in words else ""
        raise refuse(f"{name}: not XML: {quoted(words, 100)}", "", hint, mark) from None
    _cap(root, name)
    return root


def parse_file(path: Path) -> Element:
    """The root of a file, see `parse`."""
    return parse(bytes_of(path, MAX_BYTES + 1), printable(str(path)))


def _elements(data: bytes, text: Text) -> Element:
    """The root of ``data``, its elements placed in ``text``."""
    from defusedxml.ElementTree import DefusedXMLParser

    builder = _Builder(text)
    parser = DefusedXMLParser(target=builder, forbid_dtd=True)
    builder.parser = parser.parser
    parser.feed(data)
    root: Element = parser.close()
    return root


def _blank(part: re.Match[bytes]) -> bytes:
    """Blanks in the place of a comment or declaration, so that places stay."""
    return re.sub(rb"[^\n]", b" ", part[0])


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
        comma = "Numbers are separated by spaces, and have a decimal point." if "," in text else ""
        hint = f"xacro reads ${quoted(text)[1:-1]}." if text.strip().startswith("{") else comma
        raise refuse(f"{what}: {quoted(text)} is not a number", "", hint)
    sign, digits, exponent = match.groups()
    power = int(exponent or 0)
    if power > _LARGEST:
        raise refuse(f"{what}: {quoted(text)} is too large")
    return Fraction(f"{sign}{digits}e{power}") if power >= _SMALLEST else Fraction(0)


def vector(text: str | None, what: str, default: Vector = ZERO) -> Vector:
    """Return three numbers.

    Args:
        text: The words of the file.
        what: The name of the value in messages.
        default: The value if nothing is written.

    Returns:
        The numbers.
    """
    parts = (text or "").split()
    if not parts:
        return default
    if len(parts) != 3:
        raise refuse(f"{what}: three numbers are needed, not {quoted(str(text))}")
    return triple(number(part, what) for part in parts)


def bound(text: str, what: str) -> Fraction:
    """A limit. One that is infinite, or as large as a float, is 10^30 of its sign."""
    if match := _ENDLESS.fullmatch(text.strip()):
        return Fraction(f"{match[1]}1e{_LARGEST}")
    return number(text, what)


def radius_in(text: str, what: str, notes: list[str]) -> Fraction | None:
    """Return a radius [m].

    Args:
        text: The word of the file.
        what: The name of the value in messages.
        notes: A list to which a note on a negative radius is appended.

    Returns:
        None if nothing is written, or the radius is negative.
    """
    value = number(text, f"{what} radius") if text else None
    if value is not None and value < 0:
        notes.append(f"{what}: a radius of {text.strip()} is not read")
        return None
    return value


def direction(text: str | None, what: str) -> Vector | None:
    """The unit vector that three numbers say; None where nothing is written, or 0 0 0, which says as little."""
    try:
        return unit(vector(text, what))
    except ValueError:
        return None


def name_of(element: Element, what: str) -> str:
    name = element.get("name", "")
    if "${" in name or "$(" in name:
        problem = f"the {what} {quoted(name)} is an unresolved xacro expression"
        raise refuse(problem, mark=mark_of(element))
    return name
