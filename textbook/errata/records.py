"""An entry of the corrections: what our copy has, how it is classed, and the check that bears the class out.

Error, open, damage: the form in which our copy has the line fails its check (or is no statement: a name that nothing
defines, units that do not agree, a missing part); the corrected form passes. Care: the form passes under a condition,
and fails without; the general form passes. Holds: the form passes.

Only what was read in two copies is called an error of a text. What looks like one in our copy alone is open.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from textbook.errata.forms import Form


class Class(StrEnum):
    """What is the matter with a line; whose mistake it is was judged by people, not computed."""

    ERROR = "error of the text"
    OPEN = "open: read once"
    DAMAGE = "damage of the copy"
    LIKELY = "likely damage of the copy"
    CARE = "read with care"
    HOLDS = "holds"


@dataclass(frozen=True, slots=True)
class Finding:
    """Whether a form passed a check, and what was computed, in words and numbers (Markdown)."""

    holds: bool
    text: str


@dataclass(frozen=True, slots=True)
class Quote:
    """A line of a second copy, verbatim, and the printed page that it stands on."""

    page: int
    text: str


Check = Callable[[Form], Finding]
Slip = Callable[[Form], str]


@dataclass(frozen=True, slots=True)
class Record:
    """One equation of one text.

    ``line``: our transcription of the copy's line; ``words``: words of the copy, verbatim; ``second``: the line in a
    second copy. ``printed`` is the line normalised, None where the copy lacks it; ``corrected`` is None where the
    line holds. ``part`` is the check on the part where a condition (``condition``, in words) holds. ``slip`` says
    why a form is no statement, "" if it is one.
    """

    text: str
    equation: str
    check: Check
    printed: Form | None
    corrected: Form | None = None
    part: Check | None = None
    condition: str = ""
    slip: Slip | None = None
    kind: Class = Class.HOLDS
    line: str = ""
    words: str = ""
    second: Quote | None = None
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Judgement:
    """The findings on the copy's form, on its part, and on the corrected form; ``borne_out``: they agree with the
    class of the record."""

    borne_out: bool
    printed: Finding
    corrected: Finding | None = None
    part: Finding | None = None


def judge(r: Record) -> Judgement:
    """Run the checks of a record."""
    printed = _checked(r, r.printed)
    if r.corrected is None or r.kind is Class.HOLDS:
        return Judgement(printed.holds and r.kind is Class.HOLDS, printed)
    corrected = _checked(r, r.corrected)
    part = r.part(r.printed) if r.part is not None and r.printed is not None else None
    passes_in_part = part.holds if part is not None else r.kind is not Class.CARE
    return Judgement(not printed.holds and corrected.holds and passes_in_part, printed, corrected, part)


def _checked(r: Record, form: Form | None) -> Finding:
    if form is None:
        return Finding(False, "the line is missing from our copy")
    slip = r.slip(form) if r.slip is not None else ""
    return Finding(False, slip) if slip else r.check(form)
