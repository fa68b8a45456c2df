"""The text of a robot file: its bytes, characters and lines, and the tree of texts, lists and mappings it makes."""

from __future__ import annotations

import re
import stat
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import BinaryIO

from wmrgen.errors import Code, Mark, RobotFileError
from wmrgen.robotfile.shipped import shipped

MAX_BYTES = 256 * 1024

# Controls other than tab and newline, surrogates, line and paragraph separators, bidirectional controls,
# invisible operators, byte order marks inside the text, tag characters and non-characters.
_REFUSED = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff"
    "\ufdd0-\ufdef\ufeff\ufff0-\ufffb\ufffe\uffff\U000e0000-\U000e0fff\U0001fffe-\U0001ffff"
    "\U0010fffe-\U0010ffff]"
)
# Letters of Cyrillic that look like a e o p c y x i j s.
_CYRILLIC = "\u0430\u0435\u043e\u0440\u0441\u0443\u0445\u0456\u0458\u0455"
_LATIN = str.maketrans(_CYRILLIC + _CYRILLIC.upper(), "aeopcyxijsAEOPCYXIJS")
_BIDI = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def printable(text: str) -> str:
    """``text`` with every refused character shown as U+FFFD and tabs as one space."""
    return _REFUSED.sub("\ufffd", text.replace("\t", " "))


def quoted(text: str, limit: int = 60) -> str:
    """``text`` in quotes for an error message: one line, printable, at most ``limit`` characters."""
    line = printable(text.replace("\n", " "))
    return f"'{line if len(line) <= limit else line[: limit - 1] + '…'}'"


def refused_character(text: str) -> tuple[int, str, str] | None:
    """Index, description and reason of the first character that no robot file may hold, or None."""
    match = _REFUSED.search(text)
    if not match:
        return None
    code = ord(match.group())
    if 0xD800 <= code <= 0xDFFF:
        kind, why = "lone surrogate", "It is half a character and cannot be written out."
    elif _BIDI.match(match.group()):
        kind, why = "bidirectional control", "It makes text read differently from what it says."
    elif code < 0x20 or 0x7F <= code < 0xA0:
        kind, why = "control character", "It cannot be seen and may end up in generated code."
    else:
        kind, why = "invisible character", "It cannot be seen and may end up in generated code."
    return match.start(), f"{kind} U+{code:04X}", why


@dataclass(frozen=True, slots=True)
class Source:
    """A file name and the lines of its text, to give marks."""

    file: str
    lines: tuple[str, ...]

    @classmethod
    def of(cls, text: str, file: str) -> Source:
        return cls(printable(file), tuple(printable(line) for line in text.split("\n")))

    def mark(self, line: int, column: int) -> Mark:
        """The mark of a zero-based line and column."""
        line = max(0, min(line, len(self.lines) - 1))
        return Mark(self.file, line + 1, column + 1, self.lines[line])

    def mark_at(self, text: str, index: int) -> Mark:
        """The mark of a character index into the whole text."""
        start = text.rfind("\n", 0, index) + 1
        return self.mark(text.count("\n", 0, index), index - start)


def too_large(file: str) -> RobotFileError:
    return RobotFileError(
        f"{printable(file)}: the file is larger than {MAX_BYTES // 1024} KiB",
        None,
        "A robot file is a page of text; larger input is refused unread.",
        "Give the robot file itself, not a log, an image or a generated file.",
        Code.FILE,
    )


def decode(data: bytes, file: str) -> str:
    """UTF-8 bytes as text, the byte order mark dropped, line ends made ``\\n``."""
    if len(data) > MAX_BYTES:
        raise too_large(file)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise RobotFileError(
            f"{printable(file)}: the file is UTF-16",
            None,
            "Robot files are UTF-8.",
            "Save it as UTF-8.",
            Code.FILE,
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", "replace")
        line = data[error.start :].split(b"\n", 1)[0].decode("utf-8", "replace")
        source = Source.of(before + line, file)
        raise RobotFileError(
            f"byte 0x{data[error.start]:02x} is not UTF-8",
            source.mark_at(before + line, len(before)),
            "Robot files are UTF-8; this one was saved in another encoding or is not text.",
            "Save the file as UTF-8.",
            Code.NOT_YAML,
        ) from None


def normalise(text: str, file: str) -> str:
    """``text`` with ``\\n`` line ends. Refuses over-long text and characters that must not appear."""
    if len(text) > MAX_BYTES:
        raise too_large(file)
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    refused = refused_character(text)
    if refused:
        index, name, why = refused
        raise RobotFileError(
            f"{name} in the file",
            Source.of(text, file).mark_at(text, index),
            why,
            "Delete it.",
            Code.NOT_YAML,
        )
    return text


def latin(word: str) -> str:
    """``word`` with letters of Latin in the place of those that look like them, and without accents."""
    letters = unicodedata.normalize("NFKD", word.translate(_LATIN))
    return "".join(c for c in letters if not unicodedata.combining(c))


def nearest(wrong: str, valid: Iterable[str], likeness: float = 0.6) -> str:
    """The word that is most like ``wrong``, case aside, or a part of it as vx of max_vx; nothing where none is, and for
    a letter that is no word."""
    words = {word.lower(): word for word in valid}
    wrong = latin(wrong).lower()[:40]
    near = get_close_matches(wrong, words, n=1, cutoff=likeness if len(wrong) > 1 else 1)
    near = near or [part for part in wrong.split("_") if len(part) > 1 and part in words]
    return words[near[0]] if near else ""


def suggestion(wrong: str, valid: Iterable[str], aliases: Mapping[str, str] | None = None) -> str:
    """What to write instead of ``wrong``: the nearest valid word, else all of them."""
    words = list(valid)
    hint = (aliases or {}).get(wrong.lower())
    if hint:
        return hint
    near, alias = nearest(wrong, words), nearest(wrong, aliases or (), 0.8)
    if near:
        return f"Did you mean {near}?"
    if alias and aliases:
        return aliases[alias]
    return f"Valid here: {' '.join(words)}." if words else ""


def lookalike(word: str) -> str:
    """A sentence about a character that no keyword has; nothing where there is none."""
    strange = next((c for c in word if not c.isascii()), "")
    return (
        f"Its {strange!r} is U+{ord(strange):04X} {unicodedata.name(strange, '')}".rstrip() + "."
        if strange
        else ""
    )


@dataclass(frozen=True, slots=True)
class Node:
    """A part of a robot file: a text, a list or a mapping, at its place. No type is guessed."""

    mark: Mark

    def mark_at(self, offset: int) -> Mark:
        """The place of character ``offset``."""
        return self.mark

    def error(
        self, what: str, why: str = "", instead: str = "", offset: int = 0, code: Code = Code.FORM
    ) -> RobotFileError:
        return RobotFileError(what, self.mark_at(offset), why, instead, code)


@dataclass(frozen=True, slots=True)
class Scalar(Node):
    """A text as written. ``plain`` when it stands without quotes."""

    text: str
    plain: bool

    def mark_at(self, offset: int) -> Mark:
        """The place of character ``offset`` of the text, or of its start when escapes or folds hide it."""
        column = self.mark.column - 1
        for start in (column, column + 1) if offset else ():  # plain, quoted
            if self.mark.text.startswith(self.text, start):
                return replace(self.mark, column=start + offset + 1)
        return self.mark


@dataclass(frozen=True, slots=True)
class SequenceNode(Node):
    """A list."""

    items: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class MappingNode(Node):
    """Keys are distinct and keep the order of the file. ``repeated``: one stood twice, which has been told."""

    entries: tuple[tuple[Scalar, Node], ...]
    repeated: bool = False


def kind_of(node: Node) -> str:
    """What a node is, for error messages."""
    if isinstance(node, Scalar):
        return "one value" if node.text or not node.plain else "nothing"
    return "a list" if isinstance(node, SequenceNode) else "a mapping"


def scalar_of(node: Node, what: str) -> Scalar:
    """The node, when it is a text with something in it."""
    if isinstance(node, MappingNode) and any(key.text in ("value", "tunable") for key, _ in node.entries):
        raise node.error(
            f"{what} must be one value, not {kind_of(node)}",
            "Parameters alone are tunable.",
            "Write parameters: {size: {value: 0.1, tunable: true}}, with a name of your own, and that name here.",
        )
    if not isinstance(node, Scalar):
        instead = (
            "Write one value in its place." if isinstance(node, MappingNode) else "Write it without [ ]."
        )
        raise node.error(f"{what} must be one value, not {kind_of(node)}", "", instead)
    if not node.text.strip():
        raise node.error(f"{what} has no value", "", "Write a value after the colon, or delete the key.")
    return node


_OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")  # names of what the caller has opened
_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def bytes_of(path: str | Path, limit: int) -> bytes:
    """`read_at_most`; RobotFileError where the file cannot be read."""
    try:
        return read_at_most(path, limit)
    except FileNotFoundError:
        what, instead = "no such file", "Give the path of a file."
        name = Path(path).stem
        if (shipped("robots") / Path(path).name).is_file():
            instead = f"`wmrgen new {name} --from {name} -o {printable(str(path))}` begins it as that of the gallery."
    except IsADirectoryError:
        what, instead = "is a directory", "Give the file in it."
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what, instead = f"cannot be read: {printable(reason)}", ""
    raise RobotFileError(f"{printable(str(path))}: {what}", None, "", instead, Code.FILE)


def read_at_most(path: str | Path, limit: int) -> bytes:
    """The first ``limit`` bytes of a file. OSError where it cannot be read, ValueError where it is no regular file."""
    kind = _KINDS.get(stat.S_IFMT(Path(path).stat().st_mode))
    if kind and not str(path).startswith(_OPENED):
        raise ValueError(f"it is {kind}, not a regular file")
    with Path(path).open("rb") as file:
        return read_stream(file, limit)


def read_stream(stream: BinaryIO, limit: int) -> bytes:
    """What ``stream`` gives until its end, at most ``limit`` bytes; a pipe may give it in parts."""
    parts: list[bytes] = []
    rest = limit
    while rest and (part := stream.read(rest)):
        parts.append(part)
        rest -= len(part)
    return b"".join(parts)
