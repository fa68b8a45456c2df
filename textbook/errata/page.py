"""errata.md: every record with its verdict, in Markdown that GitHub renders."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from textbook.errata.forms import Form
from textbook.errata.records import Finding, Judgement, Record, judge
from textbook.errata.texts import CONVENTIONS, ERRATA, HOLDS, WORKED
from wmrgen.backends.report.markdown import escape, items, math

Judged = tuple[Record, Judgement]

TITLES = {
    "Tzafestas": "Tzafestas, chapter 2",
    "Konstantinov": "Konstantinov",
    "Kelly": "Kelly, chapter 4 (slides)",
    "Siegwart": "Siegwart, Nourbakhsh and Scaramuzza, chapters 2.3 and 3",
    "AA274": "AA274, lecture 1",
}
_MEANING = {
    "wrong": "the printed equation fails, the corrected one passes",
    "garbled": "the printed line is no statement (an undefined name, units that do not agree, a missing part), or "
    "glyphs read for others, one for one, give the corrected line",
    "incomplete": "the printed equation passes on a part of what the text claims and fails on the rest",
    "convention": "the printed equation passes under a condition that the text leaves open and fails without it",
    "holds": "the printed equation passes",
    "undecided": "no form passes: an error of this page",
}


_MARKS = {
    ord(c): text for c, text in (("|", "\\|"), ("_", "\\_"), ("*", "\\*"), ("<", "&lt;"), (">", "&gt;"))
}


def blocks() -> list[str]:
    """The blocks of errata.md, from running every check."""
    judged = [(r, judge(r)) for r in (*ERRATA, *CONVENTIONS, *HOLDS)]
    counts = Counter(j.verdict for _, j in judged)
    not_right = [(r, j) for r, j in judged if j.verdict in ("wrong", "garbled", "incomplete", "undecided")]
    conditional = [(r, j) for r, j in judged if j.verdict == "convention"]
    right = [(r, j) for r, j in judged if j.verdict == "holds"]
    return [
        *_opening(counts, len(judged)),
        "## 1 Misprints",
        *_sections(not_right, _entry),
        "## 2 What holds under a condition",
        *_sections(conditional, _entry),
        "## 3 What holds as printed",
        *_sections(right, _folded),
        "## 4 Worked numbers that are right",
        *(line for r, j in right if r in WORKED for line in _worked(r, j)),
    ]


def _opening(counts: Counter[str], total: int) -> list[str]:
    return [
        "# Errata of the source texts",
        "Written by `wmrgen textbook`. Each verdict follows from running the check that stands beside it, on the "
        "printed and on the corrected form; no verdict is typed in. Figures at a point are rounded to six digits.",
        f"{total} equations and statements:",
        *items(f"**{name}** ({counts[name]}): {_MEANING[name]}" for name in _MEANING if counts[name]),
    ]


def _by_text(judged: Iterable[Judged]) -> list[tuple[str, list[Judged]]]:
    every = list(judged)
    return [
        (title, kept) for text, title in TITLES.items() if (kept := [p for p in every if p[0].text == text])
    ]


def _sections(judged: Iterable[Judged], entry: Callable[[Record, Judgement], list[str]]) -> list[str]:
    parts = []
    for title, pairs in _by_text(judged):
        parts += [f"### {escape(title)}", *(line for r, j in pairs for line in entry(r, j))]
    return parts


def _entry(r: Record, j: Judgement) -> list[str]:
    """Printed and corrected form, each with what its check found."""
    shown = [f"#### {r.text} {_words(r.equation)}: {j.verdict}", "Printed:"]
    shown += _display(r.printed) if r.printed is not None else ["(nothing)"]
    shown += [f"Check: {_finding(j.printed)}"]
    if j.part is not None:
        shown += [f"Where {_words(r.condition)}: {_finding(j.part)}"]
    if r.corrected is not None:
        shown += ["Corrected:", *_display(r.corrected)]
    if j.corrected is not None:
        shown += [f"Check: {_finding(j.corrected)}"]
    return [*shown, *([f"{_words(r.remark)}"] if r.remark else [])]


def _finding(f: Finding) -> str:
    return f"{'passes' if f.holds else 'fails'}: {f.text}."


def _words(text: str) -> str:
    """Prose with marks of its own: only what Markdown would take for markup is escaped."""
    return text.translate(_MARKS)


def _display(form: Form) -> list[str]:
    return math("\\begin{gathered}", " \\\\\n".join(form.latex()), "\\end{gathered}")


def _folded(r: Record, j: Judgement) -> list[str]:
    """The printed form behind a line that says what it is held against."""
    summary = f"{escape(r.text)} {escape(r.equation)}: {escape(j.printed.text.replace('$', ''))}"
    shown = _display(r.printed) if r.printed is not None else []
    remark = [_words(r.remark)] if r.remark else []
    return [f"<details><summary>{summary}</summary>", *shown, *remark, "</details>"]


def _worked(r: Record, j: Judgement) -> list[str]:
    shown = _display(r.printed) if r.printed is not None else []
    return [f"{r.text} {_words(r.equation)}. {_words(j.printed.text)}:", *shown]
