"""Constants and free text as C99 writes them."""

from __future__ import annotations

import textwrap
import unicodedata
from fractions import Fraction
from functools import lru_cache
from math import isinf

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.ir.rounding import to_float32, to_float64

WIDTH = 100  # columns of generated C


@lru_cache(maxsize=4096)
def rounded(value: Exact, scalar: str) -> float:
    """``value`` in the target type. NotDerivableError when it leaves the type's range."""
    result = to_float32(value) if scalar == "float" else to_float64(value)
    if isinf(result) or (result == 0.0 and value):
        raise NotDerivableError(f"the constant {value} does not fit the C type {scalar}; use --scalar double")
    return result


def _shortest_single(value: float) -> str:
    for digits in range(1, 9):
        text = f"{value:.{digits}g}"
        if to_float32(Exact(Fraction(text))) == value:
            return text
    return f"{value:.9g}"


@lru_cache(maxsize=4096)
def literal(value: Exact, scalar: str) -> str:
    """The shortest decimal that reads back as the correctly rounded value; negative ones in parentheses."""
    number = rounded(value, scalar)
    text = _shortest_single(number) if scalar == "float" else repr(number)
    if not set(text) & set(".e"):
        text += ".0"
    text += "f" if scalar == "float" else ""
    return f"({text})" if text.startswith("-") else text


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
    """``text`` on one line of printable ASCII that can neither end nor confuse a C comment."""
    plain = "".join(_plain(char) for char in " ".join(text.split()))
    plain = plain.replace("\\", "/")
    for pair in ("*/", "/*", "??", "//"):
        while pair in plain:
            plain = plain.replace(pair, f"{pair[0]} {pair[1]}")
    return " ".join(plain.split(" ")).rstrip()


def comment_lines(text: str, width: int = WIDTH - 3) -> list[str]:
    """``text`` escaped and wrapped for a block comment whose lines begin with `` * ``."""
    return textwrap.wrap(comment_text(text), width, break_on_hyphens=False) or [""]
