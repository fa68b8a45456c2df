"""The text of a robot file: reading its bytes, refusing characters, marks, suggestions, and the nodes of its tree."""

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

MAX_BYTES = 256 * 1024  # a robot file is a page; larger files are something else, and are not read

# Characters that a robot file must not contain: controls other than tab and newline, surrogates, line and paragraph
# separators, bidirectional controls, invisible operators, byte order marks inside the text, tags and non-characters.
_REFUSED = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff"
    "\ufdd0-\ufdef\ufeff\ufff0-\ufffb\ufffe\uffff\U000e0000-\U000e0fff\U0001fffe-\U0001ffff"
    "\U0010fffe-\U0010ffff]"
)
# Cyrillic letters that look like a e o p c y x i j s.
_CYRILLIC = "\u0430\u0435\u043e\u0440\u0441\u0443\u0445\u0456\u0458\u0455"
_LATIN = str.maketrans(_CYRILLIC + _CYRILLIC.upper(), "aeopcyxijsAEOPCYXIJS")
_BIDI = re.compile("[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def printable(text: str) -> str:
    """Return ``text`` with refused characters replaced by U+FFFD and tabs by one space."""
    return _REFUSED.sub("\ufffd", text.replace("\t", " "))


def quoted(text: str, limit: int = 60) -> str:
    """Return ``text`` in quotes for a message: one printable line of at most ``limit`` characters."""
    line = printable(text.replace("\n", " "))
    return f"'{line if len(line) <= limit else line[: limit - 1] + '…'}'"


def refused_character(text: str) -> tuple[int, str, str] | None:
    """Return index, description and reason of the first character that a robot file must not contain, or None."""
    match = _REFUSED.search(text)
    if not match:
        return None
    code = ord(match.group())
    if 0xD800 <= code <= 0xDFFF:
        kind, why = "lone surrogate", "It is half of a character and cannot be written to a file."
    elif _BIDI.match(match.group()):
        kind, why = "bidirectional control", "It changes the order in which text is displayed."
    elif code < 0x20 or 0x7F <= code < 0xA0:
        kind, why = "control character", "It is invisible, and would get into generated code."
    else:
        kind, why = "invisible character", "It would get into generated code unseen."
    return match.start(), f"{kind} U+{code:04X}", why


@dataclass(frozen=True, slots=True)
class Source:
    """A file name and the lines of the file, from which marks are made."""

    file: str
    lines: tuple[str, ...]

    @classmethod
    def of(cls, text: str, file: str) -> Source:
        """Return the source of a text; ``file`` is shown in messages."""
        return cls(printable(file), tuple(printable(line) for line in text.split("\n")))

    def mark(self, line: int, column: int) -> Mark:
        """Return the mark of a line and a column, both counted from 0."""
        line = max(0, min(line, len(self.lines) - 1))
        return Mark(self.file, line + 1, column + 1, self.lines[line])

    def mark_at(self, text: str, index: int) -> Mark:
        """Return the mark of the character at ``index`` of the whole text."""
        start = text.rfind("\n", 0, index) + 1
        return self.mark(text.count("\n", 0, index), index - start)


def _too_large(file: str) -> RobotFileError:
    """Return the error for a file that is larger than MAX_BYTES."""
    return RobotFileError(
        f"{printable(file)}: the file is larger than {MAX_BYTES // 1024} KiB",
        None,
        "A robot file is a page of text. Larger files are not read.",
        "Give the robot file itself, not a log, an image or a generated file.",
        Code.FILE,
    )


def decode(data: bytes, file: str) -> str:
    """Return the text of UTF-8 bytes without the byte order mark. Raise RobotFileError for other encodings."""
    if len(data) > MAX_BYTES:
        raise _too_large(file)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise RobotFileError(
            f"{printable(file)}: the file is UTF-16",
            None,
            "Robot files are UTF-8.",
            "Save the file as UTF-8.",
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
            "Robot files are UTF-8. This file has another encoding, or is not text.",
            "Save the file as UTF-8.",
            Code.NOT_YAML,
        ) from None


def normalise(text: str, file: str) -> str:
    """Return ``text`` with ``\\n`` as line ends. Raise RobotFileError if it is too long or has a refused character."""
    if len(text) > MAX_BYTES:
        raise _too_large(file)
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
    """Return ``word`` without accents, and with Latin letters in place of Cyrillic letters that look the same."""
    letters = unicodedata.normalize("NFKD", word.translate(_LATIN))
    return "".join(c for c in letters if not unicodedata.combining(c))


def nearest(wrong: str, valid: Iterable[str], likeness: float = 0.6) -> str:
    """Return the valid word that is most similar to a wrong one.

    Args:
        wrong: The word to replace. A single letter must match exactly, except for its case.
        valid: The words to choose from.
        likeness: The least similarity, from 0 to 1, as `difflib` computes it.

    Returns:
        The most similar word; else a word that is a part of ``wrong``, as vx is of max_vx; else "".
    """
    words = {word.lower(): word for word in valid}
    wrong = latin(wrong).lower()[:40]
    near = get_close_matches(wrong, words, n=1, cutoff=likeness if len(wrong) > 1 else 1)
    parts = [part for part in wrong.split("_") if len(part) > 1 and part in words]
    found = [*near, *parts]
    return words[found[0]] if found else ""


def suggestion(wrong: str, valid: Iterable[str], aliases: Mapping[str, str] | None = None) -> str:
    """Return what to write in place of ``wrong``.

    Args:
        wrong: The word to replace.
        valid: The words that are valid in its place.
        aliases: Words in lower case that people also write, each with its hint.

    Returns:
        The hint of the alias, else the nearest valid word, else all valid words, as a sentence.
    """
    words = list(valid)
    hint = (aliases or {}).get(wrong.lower())
    if hint:
        return hint
    near = nearest(wrong, words)
    alias = nearest(wrong, aliases or (), 0.8)  # an alias that is misspelt slightly
    if near:
        return f"Did you mean {near}?"
    if alias and aliases:
        return aliases[alias]
    return f"Valid here: {' '.join(words)}." if words else ""


def lookalike(word: str) -> str:
    """Return a sentence that names the first character of a word that is not ASCII, or "" if there is none."""
    strange = next((c for c in word if not c.isascii()), "")
    if not strange:
        return ""
    return f"Its {strange!r} is U+{ord(strange):04X} {unicodedata.name(strange, '')}".rstrip() + "."


@dataclass(frozen=True, slots=True)
class Node:
    """A part of a robot file with its place: a text, a list or a mapping."""

    mark: Mark

    def mark_at(self, offset: int) -> Mark:
        """Return the place of character ``offset``."""
        return self.mark

    def error(
        self, what: str, why: str = "", instead: str = "", offset: int = 0, code: Code = Code.FORM
    ) -> RobotFileError:
        """Return an error at this node.

        Args:
            what: What is wrong.
            why: Why it matters.
            instead: What to write.
            offset: The character of the text that is wrong.
            code: The code of the error.
        """
        return RobotFileError(what, self.mark_at(offset), why, instead, code)


@dataclass(frozen=True, slots=True)
class Scalar(Node):
    """A text as written."""

    text: str
    plain: bool  # whether it is written without quotes

    def mark_at(self, offset: int) -> Mark:
        """Return the place of character ``offset``, or of the start of a text with escapes or several lines."""
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
    """A mapping. Keys are distinct and in the order of the file."""

    entries: tuple[tuple[Scalar, Node], ...]
    repeated: bool = False  # whether the file repeats a key, which the reader has reported


def kind_of(node: Node) -> str:
    """Return what a node is, in words for messages."""
    if isinstance(node, Scalar):
        return "one value" if node.text or not node.plain else "nothing"
    return "a list" if isinstance(node, SequenceNode) else "a mapping"


def scalar_of(node: Node, what: str) -> Scalar:
    """Return the node if it is a text that is not empty; raise RobotFileError otherwise. ``what`` names it."""
    if isinstance(node, MappingNode) and any(key.text in ("value", "tunable") for key, _ in node.entries):
        raise node.error(
            f"{what} must be one value, not {kind_of(node)}",
            "Only parameters can be tunable.",
            "Write parameters: {size: {value: 0.1, tunable: true}}, with a name of your own, and use that name here.",
        )
    if not isinstance(node, Scalar):
        in_brackets = isinstance(node, SequenceNode)
        instead = "Write the value without [ ]." if in_brackets else "Write one value in its place."
        raise node.error(f"{what} must be one value, not {kind_of(node)}", "", instead)
    if not node.text.strip():
        raise node.error(f"{what} has no value", "", "Write a value after the colon, or delete the key.")
    return node


_OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")  # files that the caller has opened: pipes are welcome
_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def bytes_of(path: str | Path, limit: int) -> bytes:
    """Return the first ``limit`` bytes of a file. Raise RobotFileError if the file cannot be read."""
    try:
        return read_at_most(path, limit)
    except FileNotFoundError:
        what, instead = "no such file", "Give the path of a file."
        name = Path(path).stem
        copy = Path(path) if Path(path).suffix else Path(f"{path}.yaml")  # a name is a file of this name
        robots = shipped("robots")
        if any((folder / copy.name).is_file() for folder in (robots, robots / "texts")):
            instead = f"`wmrgen new {name} --from {name} -o {printable(str(copy))}` copies the robot of the gallery."
    except IsADirectoryError:
        what, instead = "is a directory", "Give the path of a file in it."
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what, instead = f"cannot be read: {printable(reason)}", "Give the path of a file that you may read."
    raise RobotFileError(f"{printable(str(path))}: {what}", None, "", instead, Code.FILE)


def read_at_most(path: str | Path, limit: int) -> bytes:
    """Return the first ``limit`` bytes of a file.

    Raises:
        OSError: The file cannot be read.
        ValueError: It is not a regular file, and the caller has not opened it.
    """
    kind = _KINDS.get(stat.S_IFMT(Path(path).stat().st_mode))
    if kind and not str(path).startswith(_OPENED):
        raise ValueError(f"it is {kind}, not a regular file")
    with Path(path).open("rb") as file:
        return read_stream(file, limit)


def read_stream(stream: BinaryIO, limit: int) -> bytes:
    """Return the bytes of ``stream`` up to its end, at most ``limit``. A pipe may deliver them in parts."""
    parts: list[bytes] = []
    rest = limit
    while rest and (part := stream.read(rest)):
        parts.append(part)
        rest -= len(part)
    return b"".join(parts)
