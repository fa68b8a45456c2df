"""A record of the errata and its verdict, which follows from running its checks.

holds       the printed formula passes the check
garbled     the printed line is no statement (a name that nothing defines, units that do not agree, a missing part),
            or reading some of its glyphs for others, one for one, turns it into the corrected line
incomplete  it passes on a part of what the text claims, and fails on the rest
convention  it passes under a condition that the text leaves open, and fails without
wrong       it fails otherwise
In the last four cases the corrected formula passes the check.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from textbook.errata.forms import Form
from wmrgen.symbolic import Expr


@dataclass(frozen=True, slots=True)
class Finding:
    """Whether a form passed a check, and what was computed, in words and numbers (Markdown)."""

    holds: bool
    text: str


Check = Callable[[Form], Finding]
Slip = Callable[[Form], str]


@dataclass(frozen=True, slots=True)
class Record:
    """One equation of one text.

    ``printed`` is None where the line is missing from the text; ``corrected`` is None where the printed line is
    what wmrgen uses. ``part`` is the check on the part where a condition (``condition``, in words) holds;
    ``claimed``: the text claims more than that part. ``slip`` says why a form is no statement, "" if it is one.
    ``reading``: glyphs that may have been taken for others.
    """

    text: str
    equation: str
    check: Check
    printed: Form | None
    corrected: Form | None = None
    part: Check | None = None
    condition: str = ""
    claimed: bool = False
    slip: Slip | None = None
    reading: tuple[tuple[Expr, Expr], ...] = ()
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Judgement:
    """The verdict and the findings on the printed and the corrected form."""

    verdict: str
    printed: Finding
    corrected: Finding | None
    part: Finding | None = None


def judge(r: Record) -> Judgement:
    """Run the checks of a record."""
    slip = _slip(r, r.printed)
    printed = Finding(False, slip) if slip or r.printed is None else r.check(r.printed)
    if printed.holds:
        return Judgement("holds", printed, None)
    if r.corrected is None:
        return Judgement("undecided", printed, None)
    other = _slip(r, r.corrected)
    corrected = Finding(False, other) if other else r.check(r.corrected)
    if not corrected.holds:
        return Judgement("undecided", printed, corrected)
    if slip or r.printed is None:
        return Judgement("garbled", printed, corrected)
    part = r.part(r.printed) if r.part is not None else None
    if part is not None and part.holds:
        return Judgement("incomplete" if r.claimed else "convention", printed, corrected, part)
    if r.reading and r.printed.read(dict(r.reading)).same(r.corrected):
        return Judgement("garbled", printed, corrected)
    return Judgement("wrong", printed, corrected)


def _slip(r: Record, form: Form | None) -> str:
    if form is None:
        return "the line is missing from the text"
    return r.slip(form) if r.slip is not None else ""
