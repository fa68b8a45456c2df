"""Markdown that GitHub renders: escaping of free text, tables, math fences."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_ENTITY = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "$": "&#36;"}
_INDEX = re.compile(r"\b(delta|rank C1|C1|J1|J2)(\\_)?(m|s|M|f)?\b")


def escape(text: str) -> str:
    """Free text for Markdown and HTML, on one line: nothing in it is markup."""
    flat = " ".join(text.split())
    done = "".join(_ENTITY.get(c, f"\\{c}" if c in "\\`*_[]{}#|~!" else c) for c in flat)
    return f"&#{ord(done[0])};{done[1:]}" if done[:1] in tuple("+-=0123456789:") else done


def sentence(text: str) -> str:
    """A finding in words: escaped, with delta_m and C1f set as symbols."""
    return _INDEX.sub(_symbol, escape(text))


def _symbol(found: re.Match[str]) -> str:
    head, bar, index = found.groups()
    if head == "delta":
        return f"δ<sub>{index}</sub>" if bar and index else found[0]
    name = {"C1": "C₁", "rank C1": "rank C₁", "J1": "J₁", "J2": "J₂"}[head]
    if bar or (index and index not in "fs"):
        return found[0]
    return f"{name}<sub>{index}</sub>" if index else name


def code(name: str) -> str:
    """An identifier."""
    return f"`{name}`"


def listed(names: Sequence[str]) -> str:
    """`a`, `b` and `c`"""
    parts = [code(n) for n in names]
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def table(head: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> list[str]:
    """A table; the first ``left`` columns are words, the others numbers."""
    rule = [":--" if i < left else "--:" for i in range(len(head))]
    return ["", *(f"| {' | '.join(row)} |" for row in (head, rule, *rows)), ""]


def math(*blocks: str) -> list[str]:
    """A displayed formula."""
    return ["", "```math", *blocks, "```", ""]


def aligned(lines: Iterable[str]) -> list[str]:
    """Formulas one below the other, aligned at their &."""
    body = " \\\\\n".join(lines)
    return math("\\begin{aligned}", body, "\\end{aligned}")
