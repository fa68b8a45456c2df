"""Markdown that GitHub renders: escaping of free text, tables, math fences, names and numbers in words and cells.

A page is a list of blocks, which `page` parts by blank lines: a heading, a paragraph, a list, a table, a formula.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from math import degrees
from typing import SupportsFloat

from wmrgen.codegen.registry import BACKENDS, Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.sections.latex import alike

CAP = 16  # wheels whose equations are written out
_BELOW, _APART = " \\\\\n", " \\\\[4pt]\n"  # from row to row of a formula, and where fractions would touch
_ENTITY = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "$": "&#36;"}
_LOW = str.maketrans("12", "₁₂")
_NEGATIVE = re.compile(r"(?<![\w.)])-(?=\d)")
_CODE = re.compile(r"(\\`.*?\\`|\b[A-Za-z](?:\\_|\w)*\.(?:spin|speed|steer(?:\\_rate)?)\b)")  # escaped
_ETA = re.compile(r"\beta(\d)\b")
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
    """A finding in words: escaped, with joints and what stands in backticks as code, the rest with symbols."""
    parts = _CODE.split(escape(text))
    return "".join(
        code(part.replace("\\", "").strip("`")) if k % 2 else _with_symbols(part)
        for k, part in enumerate(parts)
    )


def _with_symbols(words: str) -> str:
    """delta_m, C1f, eta1 and omega as formulas have them."""
    shown = minus(_INDEX.sub(_symbol, words)).replace("omega = 0", "ω = 0")
    return _ETA.sub(r"η<sub>\1</sub>", shown)


def minus(text: str) -> str:
    """Words and numbers, these with a minus sign in place of a hyphen."""
    return _NEGATIVE.sub("−", text)


def _symbol(match: re.Match[str]) -> str:
    head, bar, index = match.groups()
    if head == "delta":
        return f"δ<sub>{index}</sub>" if bar and index else match[0]
    if bar or (index and index not in "fs"):
        return match[0]
    return f"{head[:-1]}<sub>{head[-1]}{index}</sub>" if index else head.translate(_LOW)


def capitalised(text: str) -> str:
    """A finding as a sentence of its own; code that it begins with stays as it is."""
    return sentence(text[:1].upper() + text[1:]).removesuffix(".") + "."


def pictures(figures: Mapping[str, tuple[str, str]], *files: str) -> list[str]:
    """Those figures that there are, beside each other where the page is wide enough."""
    lines = [f"![{escape(figures[file][0])}]({file})" for file in files if file in figures]
    return ["\n".join(lines)] if lines else []


def code(name: str) -> str:
    """An identifier."""
    return f"`{name}`"


def listed(names: Sequence[str]) -> str:
    """`a`, `b` and `c`"""
    return notation.in_code(names)


def some(wheels: Sequence[Wheel]) -> str:
    """The names of wheels, of many the first ones."""
    return listed([w.name for w in wheels[:CAP]]) + (" and others" if len(wheels) > CAP else "")


def cut_note(wheels: Sequence[Wheel]) -> list[str]:
    """Says that the equations of some of the wheels were left out, where they were."""
    more = len(wheels) - CAP
    return [f"({more} more wheels follow the same pattern; they stand in `model.json`.)"] if more > 0 else []


def grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Each text once, with the names of all wheels that have it."""
    names: dict[str, list[str]] = {}
    for text, name in pairs:
        names.setdefault(text, []).append(name)
    return names


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


def matrix(rows: Iterable[Iterable[Poly | str]]) -> str:
    """A bracketed matrix of polynomials or finished entries."""
    listed_rows = [list(row) for row in rows]
    shown = iter(alike([e for row in listed_rows for e in row if isinstance(e, Poly)]))
    entries = [[next(shown) if isinstance(e, Poly) else e for e in row] for row in listed_rows]
    end = _APART if any("\\frac" in entry for row in entries for entry in row) else _BELOW
    body = end.join(" & ".join(row) for row in entries)
    return f"\\begin{{bmatrix}}\n{body}\n\\end{{bmatrix}}"


def aligned(lines: Iterable[str]) -> list[str]:
    """Formulas one below the other, aligned at their &; further apart where fractions would touch."""
    rows = list(lines)
    further = [(_APART if "\\frac" in a and "\\frac" in b else _BELOW) + b for a, b in pairwise(rows)]
    return math("\\begin{aligned}", "".join([*rows[:1], *further]), "\\end{aligned}")


def written(d: Derivation) -> list[tuple[list[str], str]]:
    """The files that stand beside a page, and what they are; an example only where it has a joint."""
    every = (files for entry in BACKENDS.values() for files in entry.files if files.what)
    rows = [
        ([name.format(robot=d.robot.name) for name in files.names], files.what)
        for files in every
        if d.c_module.joints or "example/main.c" not in files.names
    ]
    return [*rows, (["model.json"], "what the report says, as data")]


def foot(facts: Facts) -> list[str]:
    """What made a page."""
    return ["---", f"wmrgen {facts.wmrgen_version} · model {facts.model_hash or 'unhashed'}"]


def rounded(value: float) -> str:
    """Six significant digits, dust of 1e-12 gone."""
    return f"{round(value, 12) + 0.0:.6g}".replace("-", "−")


def in_degrees(angle: SupportsFloat) -> str:
    """An angle [rad] in degrees."""
    return f"{round(degrees(float(angle)), 9) + 0.0:.6g}°".replace("-", "−")


def plain(value: Exact) -> str:
    """A number: exact when short, else six significant digits."""
    sign = "−" if value.sign < 0 else ""
    if value.is_rational:
        f = abs(value.parts[0])
        exact = str(f.numerator) if f.denominator == 1 and f.numerator < 10**7 else notation.terminating(f)
        if exact is not None:
            return sign + exact
    return f"{float(value):.6g}".replace("-", "−")
