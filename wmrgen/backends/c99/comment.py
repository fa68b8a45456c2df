"""Free text in C comments: printable ASCII that can neither end a comment nor confuse a compiler."""

from __future__ import annotations

import textwrap
import unicodedata
from collections.abc import Sequence

WIDTH = 100  # columns of generated C


def _plain(char: str) -> str:
    """ASCII for one character: a Greek letter by its name, an accented letter without its accent."""
    if " " <= char <= "~":
        return char
    name = unicodedata.name(char, "")
    if name.startswith("GREEK "):
        word = name.rsplit(" ", 1)[-1].lower()
        return word.capitalize() if "CAPITAL" in name else word
    folded = unicodedata.normalize("NFKD", char)
    if folded == char:
        return {"–": "-", "—": "-", "−": "-", "×": "x", "·": ".", "’": "'", "°": " deg"}.get(char, "?")
    return "".join(_plain(part) for part in folded if not unicodedata.combining(part))


def comment_text(text: str) -> str:
    """``text`` on one line, without comment marks, trigraphs, backslashes or letters beyond ASCII."""
    plain = "".join(_plain(char) for char in " ".join(text.split()))
    plain = plain.replace("\\", "/")
    for pair in ("*/", "/*", "??", "//"):
        while pair in plain:
            plain = plain.replace(pair, f"{pair[0]} {pair[1]}")
    return " ".join(plain.split(" ")).rstrip()


def comment_lines(text: str, width: int = WIDTH - 3) -> list[str]:
    """``text`` escaped and wrapped for a block comment whose lines begin with `` * ``."""
    return textwrap.wrap(comment_text(text), width, break_on_hyphens=False) or [""]


def block_comment(paragraphs: Sequence[str], indent: str = "") -> list[str]:
    """The finished lines of one comment, each paragraph starting on a line of its own."""
    lines = [line for text in paragraphs for line in comment_lines(text, WIDTH - len(indent) - 6)]
    if len(lines) == 1:
        return [f"{indent}/* {lines[0]} */"]
    first, *middle, last = lines
    return [f"{indent}/* {first}", *(f"{indent} * {line}" for line in middle), f"{indent} * {last} */"]
