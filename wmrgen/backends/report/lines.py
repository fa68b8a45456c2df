"""How wide LaTeX is, and long sums on several lines."""

from __future__ import annotations

from collections.abc import Sequence

WIDE = 80  # characters of a line before a sum is broken


def width(text: str) -> int:
    """Roughly how many characters a reader sees."""
    count, skip = 0, False
    for i, ch in enumerate(text):
        if ch == "\\":
            skip = True
            count += text[i + 1 : i + 2].isalpha()
        elif skip and not ch.isalpha():
            skip = False
        if not skip and ch not in "{}^_ \\,":
            count += 1
    return count


def wrapped(parts: Sequence[str], limit: int = WIDE) -> str:
    """Signed summands on one line, or on several inside ``aligned``: each further line begins with a sign."""
    texts, used = [""], 0
    for part in parts:
        size = width(part)
        if used and used + size > limit:
            texts.append("")
            used = 0
        texts[-1] += part
        used += size
    texts[0] = texts[0].removeprefix("+")
    return "\\\\\n&\\qquad ".join(texts) or "0"
