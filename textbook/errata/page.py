"""errata.md: every record with what its check finds, in Markdown that GitHub renders."""

from __future__ import annotations

from textbook.errata.forms import Form
from textbook.errata.records import Class, Finding, Record, judge
from textbook.errata.texts import BIBLIOGRAPHY, ENTRIES, HOLDS
from textbook.index.places import places_of
from wmrgen.report.sections.markdown import code, items, math, table

WIDEST = 700  # characters of LaTeX in a cell
_PARTS = (
    ("Errors of the text", (Class.ERROR,),
     "Two copies, of two editions, have these lines, so the printed pages probably have them too. Each line is well "
     "formed and contradicts mechanics or the text itself. The usual losses of an extraction (dots, arrows, signs "
     "next to a matrix, exponents above an index, letters that look alike) do not explain it."),
    ("Open: read once", (Class.OPEN,),
     "As noted, these lines are well formed and fail, and the usual losses do not explain them. But each line was "
     "read only once, in one copy, so our note may be wrong. These entries are no criticism of the texts until they "
     "are compared with the printed page."),
    ("Damage of the copy", (Class.DAMAGE, Class.LIKELY),
     "The extraction damaged these lines, or probably did. The entries are no criticism of the texts. They are listed "
     "so that you do not compute with the damaged lines."),
    ("Read with care", (Class.CARE,),
     "These lines are right as their authors mean them. They need a condition or a convention that is easily missed."),
)  # fmt: skip
_MARKS = {
    ord(c): text for c, text in (("|", "\\|"), ("_", "\\_"), ("*", "\\*"), ("<", "&lt;"), (">", "&gt;"))
}


def blocks() -> list[str]:
    """The blocks of errata.md, from running every check. ValueError where a class is not borne out."""
    corrections: list[str] = []
    for number, (title, kinds, text) in enumerate(_PARTS, 2):
        corrections += _part(f"## {number} {title}", kinds, text)
    return [*_opening(), *_what_holds(), *corrections]


def _opening() -> list[str]:
    parts = [
        (title, [r.second is not None for r in ENTRIES if r.kind in kinds]) for title, kinds, _ in _PARTS
    ]
    ours, second = sum(bool(r.words) for r in ENTRIES), sum(r.second is not None for r in ENTRIES)
    return [
        "# Equations of five texts, checked, and corrections to our copies",
        f"{len(HOLDS)} equations and statements of five texts were checked in symbols, and hold. "
        "[Section 1](#1-what-holds) lists them. The other sections correct or explain "
        f"{len(ENTRIES)} lines of our copies that are wrong or need care. The table counts both, and the numbered "
        "equations in what holds. `wmrgen textbook` computes every check whenever it writes this page.",
        *table(
            ("text", "checks that hold", "numbered equations in them", "lines corrected or explained"),
            [*(_counts(text) for text in BIBLIOGRAPHY), _counts("")],
            "lrrr",
        ),
        "Our sources are text extractions of the works below. **We have not seen the printed pages** or the figures. "
        "A line that is wrong in a copy may be right in print. The copies are not part of this project. An entry "
        "shows a line in one of two forms, or in both. `Code` is our note, made when the line was read. “Quotation "
        f"marks” contain the wording of a copy, verbatim: our copy in {ours} of the {len(ENTRIES)} entries, and a "
        f"second copy in {second}, which agrees with ours each time. Lines that were read only once are marked. "
        "Whether the text or the copy is wrong is our judgement: the check computes only that the line fails and that "
        "the corrected line holds. Differences at a point are rounded to six digits.",
        *table(
            ("part", "entries", "read in two copies", "read once"),
            (
                (title, str(len(twice)), str(sum(twice)), str(len(twice) - sum(twice)))
                for title, twice in parts
            ),
            "lrrr",
        ),
        *items(f"**{name}**: {entry}" for name, entry in BIBLIOGRAPHY.items()),
    ]


def _counts(text: str) -> tuple[str, str, str, str]:
    """Return a row of the first table for a text, or for all of them together."""
    hold = [r for r in HOLDS if text in ("", r.text)]
    corrected = [r for r in ENTRIES if text in ("", r.text)]
    equations = {place for r in hold for place in places_of(r.text, r.equation.replace("–", "-"))}
    numbered = sum(place.kind == "equation" for place in equations)
    return text or "all", str(len(hold)), str(numbered), str(len(corrected))


def _what_holds() -> list[str]:
    """Return the table of what holds."""
    return [
        "## 1 What holds",
        "The table shows each line of our copy in a common notation. Each line agrees identically with the formula "
        "that the last column names. Rules for matrices are checked for one example.",
        *table(("text", "equation", "as checked", "compared with"), map(_row, HOLDS), "l"),
    ]


def _part(title: str, kinds: tuple[Class, ...], text: str) -> list[str]:
    blocks, last = [title, text], ""
    for r in ENTRIES:
        if r.kind in kinds:
            blocks += [f"### {r.text}"] if r.text != last else []
            blocks += _entry(r)
            last = r.text
    return blocks


def _entry(r: Record) -> list[str]:
    """The copy's line beside its normalised form, and the corrected form, each with what its check found."""
    j = judge(r)
    if not j.borne_out:
        raise ValueError(f"{r.text} {r.equation}: the checks do not bear out '{r.kind}'")
    instead = {Class.CARE: "In general", Class.OPEN: "What would hold"}.get(r.kind, "Corrected")
    return [
        f"#### {r.text} {_words(r.equation)}",
        *(["Class: likely damage."] if r.kind is Class.LIKELY else []),
        _line(r),
        *(["Normalised:", *_display(r.printed)] if r.printed is not None else []),
        _finding("This", j.printed),
        *([_finding(f"If {_words(r.condition)}, it", j.part)] if j.part is not None else []),
        *([f"{instead}:", *_display(r.corrected)] if r.corrected is not None else []),
        *([_finding("This", j.corrected)] if j.corrected is not None else []),
        *([_words(r.remark)] if r.remark else []),
    ]


def _line(r: Record) -> str:
    """What the copy has, as far as it is at hand."""
    shown = []
    if r.words:
        shown.append(f"The copy, verbatim: “{_words(r.words)}”.")
    if r.line:
        what = "the line itself" if r.second is None else "our copy"
        shown.append(f"As we noted it ({what} is not at hand): {code(r.line)}.")
    if r.second is not None:
        shown.append(f"The second copy, page {r.second.page}, verbatim: “{_words(r.second.text)}”.")
    elif shown:
        shown.append("Not read a second time.")
    return " ".join(shown) or "The copy lacks the line. Not read a second time."


def _finding(what: str, f: Finding) -> str:
    return f"{what} {'passes' if f.holds else 'fails'}: {f.text}."


def _words(text: str) -> str:
    """Prose with marks of its own: only what Markdown would take for markup is escaped."""
    return text.translate(_MARKS)


def _display(form: Form) -> list[str]:
    return math("\\begin{gathered}", " \\\\\n".join(form.latex()), "\\end{gathered}")


def _row(r: Record) -> tuple[str, str, str, str]:
    """A line of the table; in a cell no bar may stand, and components of long vectors have no room."""
    j = judge(r)
    if not j.borne_out:
        raise ValueError(f"{r.text} {r.equation}: {j.printed.text}")
    lines = r.printed.latex() if r.printed is not None else []
    shown = "<br>".join(f"$`{_one_line(line)}`$" for line in lines)
    shown = shown if len(shown) <= WIDEST else "(in components, too wide for a cell)"
    against = j.printed.text.removesuffix(": the difference is 0 identically")
    return r.text, _words(r.equation), shown, _words(". ".join([against, *([r.remark] if r.remark else [])]))


def _one_line(latex: str) -> str:
    return " ".join(latex.replace("|", r"\vert ").split())
