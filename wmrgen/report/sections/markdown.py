"""Write Markdown that GitHub renders: escaped text, tables, formulas, names and numbers.

A page is a list of blocks: headings, paragraphs, lists, tables and formulas. `page` joins them with blank lines.
Sentences that tests look for have a key (`keyed`), which `page` removes.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from itertools import pairwise
from math import degrees
from typing import Concatenate, ParamSpec, SupportsFloat

from wmrgen.codegen.registry import BACKENDS, Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.sections.latex import latex, width

CAP = 16  # number of wheels whose equations are written out; more would fill pages with the same equation
LINE = 70  # visible characters of matrices side by side, whose columns have space between them: 900 px
_BELOW, _APART = " \\\\\n", " \\\\[4pt]\n"  # between rows of a formula; the second one keeps fractions apart
_KEY = re.compile(r"\0([a-z_.]+)\0")  # NUL marks a key; no sentence contains it
_ENTITY = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "$": "&#36;"}
_LOW = str.maketrans("12", "₁₂")
_NEGATIVE = re.compile(r"(?<![\w.)])-(?=\d)")
_CODE = re.compile(r"(\\`.*?\\`|\b[A-Za-z](?:\\_|\w)*\.(?:spin|speed|steer(?:\\_rate)?)\b)")  # escaped
_ETA = re.compile(r"\beta(\d)\b")
_INDEX = re.compile(r"\b(delta|rank C1|C1|J1|J2)(\\_)?(m|s|M|f)?\b")


_Rest = ParamSpec("_Rest")
_Writer = Callable[Concatenate[Derivation, _Rest], list[str]]


def in_symbols(write: _Writer[_Rest]) -> _Writer[_Rest]:
    """Make a function write the formulas of a derivation with the symbols that the robot file gives to parameters."""

    @wraps(write)
    def written(d: Derivation, /, *rest: _Rest.args, **named: _Rest.kwargs) -> list[str]:
        with notation.with_symbols(d.robot.letters):
            return write(d, *rest, **named)

    return written


def page(blocks: Iterable[str]) -> str:
    """Return the text of a page, without the keys of its sentences."""
    return _KEY.sub("", "\n\n".join(blocks)) + "\n"


def keyed(key: str, text: str) -> str:
    """Return a sentence with its key: lower-case letters, low lines and dots."""
    return f"\0{key}\0{text}"


def keys(text: str) -> list[str]:
    """Return the keys of the sentences in blocks that `page` has not joined yet, in their order."""
    return _KEY.findall(text)


def escape(text: str) -> str:
    """Return free text for Markdown and HTML on one line, escaped so that nothing in it is markup."""
    flat = " ".join(text.split())
    done = "".join(_ENTITY.get(c, f"\\{c}" if c in "\\`*_[]{}#|~!" else c) for c in flat)
    return f"&#{ord(done[0])};{done[1:]}" if done[:1] in tuple("+-=0123456789:") else done


def sentence(text: str) -> str:
    """Return a finding as Markdown: joints and words in backticks as code, names such as delta_m as symbols."""
    parts = _CODE.split(escape(text))
    return "".join(
        code(part.replace("\\", "").strip("`")) if k % 2 else _with_symbols(part)
        for k, part in enumerate(parts)
    )


def _with_symbols(words: str) -> str:
    """Write delta_m, C1f, eta1 and omega as formulas write them."""
    shown = minus(_INDEX.sub(_symbol, words)).replace("omega = 0", "ω = 0")
    return _ETA.sub(r"η<sub>\1</sub>", shown)


def minus(text: str) -> str:
    """Replace the hyphen of negative numbers by a minus sign."""
    return _NEGATIVE.sub("−", text)


def _symbol(match: re.Match[str]) -> str:
    head, bar, index = match.groups()
    if head == "delta":
        return f"δ<sub>{index}</sub>" if bar and index else match[0]
    if bar or (index and index not in "fs"):
        return match[0]
    return f"{head[:-1]}<sub>{head[-1]}{index}</sub>" if index else head.translate(_LOW)


def capitalised(text: str) -> str:
    """Return a finding as a sentence: with a capital letter, unless it begins with code, and a full stop."""
    return sentence(text[:1].upper() + text[1:]).removesuffix(".") + "."


def pictures(figures: Mapping[str, tuple[str, str]], *files: str) -> list[str]:
    """Return the images of those ``files`` that are among the figures, side by side on a wide page."""
    lines = [f"![{escape(figures[file][0])}]({file})" for file in files if file in figures]
    return ["\n".join(lines)] if lines else []


def letter_in_text(symbol: str) -> str:
    """Return the symbol of a parameter for text: ``l_x`` with its index lowered, ``lambda`` as the Greek letter."""
    head, _, index = symbol.partition("_")
    unicode_name = head.upper().replace("LAMBDA", "LAMDA")  # Unicode's spelling
    letter = head if len(head) == 1 else unicodedata.lookup(f"GREEK SMALL LETTER {unicode_name}")
    return f"{letter}<sub>{index}</sub>" if index else letter


def code(name: str) -> str:
    """Return an identifier as code."""
    return f"`{name}`"


def listed(names: Sequence[str]) -> str:
    """Return names as a list in words: `a`, `b` and `c`."""
    return notation.in_backticks(names)


def some(wheels: Sequence[Wheel]) -> str:
    """Return the names of wheels as a list in words, cut after the first `CAP`."""
    return listed([w.name for w in wheels[:CAP]]) + (" and others" if len(wheels) > CAP else "")


def cut_note(wheels: Sequence[Wheel]) -> list[str]:
    """Return a note if the equations of some wheels were left out."""
    more = len(wheels) - CAP
    return [f"({more} more wheels follow the same pattern; `model.json` has them.)"] if more > 0 else []


def grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Return each text once, with the names of all wheels that have it."""
    names: dict[str, list[str]] = {}
    for text, name in pairs:
        names.setdefault(text, []).append(name)
    return names


def table(head: Sequence[str], rows: Iterable[Sequence[str]], align: str) -> list[str]:
    """Return a table.

    Args:
        head: the words above the columns.
        rows: the cells of each row, as many as ``head`` has.
        align: a letter for each column, l for words and r for numbers; the last letter repeats.

    Returns:
        One block of Markdown.
    """
    rule = [":--" if align[min(i, len(align) - 1)] == "l" else "--:" for i in range(len(head))]
    return ["\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *rows))]


def items(texts: Iterable[str], marks: Callable[[int], str] = lambda _: "*") -> list[str]:
    """Return a list. ``marks`` gives the mark of the k-th item, counted from 1."""
    lines = [f"{marks(k)} {text}" for k, text in enumerate(texts, 1)]
    return ["\n".join(lines)] if lines else []


def titled(title: str, blocks: Sequence[str]) -> list[str]:
    """Return blocks of which the first one begins with a title in bold; [] without blocks."""
    return [f"**{title}.** {blocks[0]}", *blocks[1:]] if blocks else []


def math(*blocks: str) -> list[str]:
    """Return a displayed formula."""
    return ["\n".join(("```math", *blocks, "```"))]


def matrix(rows: Iterable[Iterable[Poly | str]]) -> str:
    """Return a matrix in brackets. Its entries are polynomials or LaTeX."""
    entries = [[latex(e) if isinstance(e, Poly) else e for e in row] for row in rows]
    end = _APART if any("\\frac" in entry for row in entries for entry in row) else _BELOW
    body = end.join(" & ".join(row) for row in entries)
    return f"\\begin{{bmatrix}}\n{body}\n\\end{{bmatrix}}"


def packed(matrices: list[str]) -> list[str]:
    """Return matrices, as many side by side as fit on a line."""
    lines: list[list[str]] = []
    used = 0
    for m in matrices:
        size = max(map(width, m.split("\n")))
        if not lines or used + size > LINE:
            lines.append([])
            used = 0
        lines[-1].append(m)
        used += size + 4
    return [block for line in lines for block in math(r", \qquad ".join(line))]


def aligned(lines: Iterable[str]) -> list[str]:
    """Return formulas below each other, aligned at their &; lines with fractions get more space between them."""
    rows = list(lines)
    further = [(_APART if "\\frac" in a and "\\frac" in b else _BELOW) + b for a, b in pairwise(rows)]
    return math("\\begin{aligned}", "".join([*rows[:1], *further]), "\\end{aligned}")


def written(d: Derivation) -> list[tuple[list[str], str]]:
    """Return the generated files next to a page, each with its purpose; the C example only if the robot has a joint."""
    every = (files for entry in BACKENDS.values() for files in entry.files if files.what)
    rows = []
    for files in every:
        if d.c_module.joints or "example/main.c" not in files.names:
            names = [name.format(robot=d.robot.name) for name in files.names]
            rows.append((names, files.what))
    return [*rows, (["model.json"], "the contents of the report, as data")]


def citation(name: str, facts: Facts) -> list[str]:
    """Return the line by which texts cite the report of a robot, in a list."""
    return [
        f"To cite this report: The wmrgen authors, *wmrgen: exact kinematics of wheeled robots, compiled from their "
        f"wheel layout*, version {facts.wmrgen_version}, report of {code(name)}, "
        f"model {(facts.model_hash or 'unhashed')[:12]}."
    ]


def foot(facts: Facts) -> list[str]:
    """Return the last lines of a page: the version of wmrgen and the hash of the model."""
    return ["---", f"wmrgen {facts.wmrgen_version} · model {facts.model_hash or 'unhashed'}"]


def rounded(value: float) -> str:
    """Return a number with six significant digits; rounding errors below 1e-12 are removed."""
    return f"{round(value, 12) + 0.0:.6g}".replace("-", "−")


def in_degrees(angle: SupportsFloat) -> str:
    """Return an angle [rad] as text in degrees."""
    return f"{round(degrees(float(angle)), 9) + 0.0:.6g}°".replace("-", "−")


def plain(value: Exact) -> str:
    """Return a number as text: exact if it is short, else with six significant digits."""
    sign = "−" if value.sign < 0 else ""
    if value.is_rational:
        f = abs(value.parts[0])
        exact = str(f.numerator) if f.denominator == 1 and f.numerator < 10**7 else notation.terminating(f)
        if exact is not None:
            return sign + exact
    return f"{float(value):.6g}".replace("-", "−")
