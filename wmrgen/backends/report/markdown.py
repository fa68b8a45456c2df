"""Markdown that GitHub renders: escaping of free text, tables, math fences.

A page is a list of blocks, which `page` parts by blank lines: a heading, a paragraph, a list, a table, a formula.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

_ENTITY = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "$": "&#36;"}
_LOW = str.maketrans("12", "₁₂")
_INDEX = re.compile(r"\b(delta|rank C1|C1|J1|J2)(\\_)?(m|s|M|f)?\b")


def page(blocks: Iterable[str]) -> str:
    """The text of a page."""
    return "\n\n".join(blocks) + "\n"


def escape(text: str) -> str:
    """Free text for Markdown and HTML, on one line: nothing in it is markup."""
    flat = " ".join(text.split())
    done = "".join(_ENTITY.get(c, f"\\{c}" if c in "\\`*_[]{}#|~!" else c) for c in flat)
    return f"&#{ord(done[0])};{done[1:]}" if done[:1] in tuple("+-=0123456789:") else done


def sentence(text: str) -> str:
    """A finding in words: escaped, with delta_m and C1f set as symbols."""
    return _INDEX.sub(_symbol, escape(text)).replace("omega = 0", "ω = 0")


def _symbol(match: re.Match[str]) -> str:
    head, bar, index = match.groups()
    if head == "delta":
        return f"δ<sub>{index}</sub>" if bar and index else match[0]
    if bar or (index and index not in "fs"):
        return match[0]
    return f"{head[:-1]}<sub>{head[-1]}{index}</sub>" if index else head.translate(_LOW)


def code(name: str) -> str:
    """An identifier."""
    return f"`{name}`"


def listed(names: Sequence[str]) -> str:
    """`a`, `b` and `c`"""
    return conjoined([code(n) for n in names])


def conjoined(parts: Sequence[str]) -> str:
    """a, b and c"""
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def table(head: Sequence[str], rows: Iterable[Sequence[str]], align: str) -> list[str]:
    """A table; ``align`` has a letter per column, l for words, r for numbers; its last letter repeats."""
    rule = [":--" if align[min(i, len(align) - 1)] == "l" else "--:" for i in range(len(head))]
    return ["\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *rows))]


def items(texts: Iterable[str], marks: Callable[[int], str] = lambda _: "*") -> list[str]:
    """A list; ``marks`` gives what stands before the k-th item, counted from 1."""
    lines = [f"{marks(k)} {text}" for k, text in enumerate(texts, 1)]
    return ["\n".join(lines)] if lines else []


def math(*blocks: str) -> list[str]:
    """A displayed formula."""
    return ["\n".join(("```math", *blocks, "```"))]


def aligned(lines: Iterable[str]) -> list[str]:
    """Formulas one below the other, aligned at their &."""
    body = " \\\\\n".join(lines)
    return math("\\begin{aligned}", body, "\\end{aligned}")
