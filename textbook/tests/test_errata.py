"""Every entry's class is borne out by its check, and follows from the forms: swap them and it no longer is."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import sympy

from tests.conftest import ROOT
from textbook.emit import errata
from textbook.errata.forms import Form, symbol
from textbook.errata.records import Class, Record, judge
from textbook.errata.texts import BIBLIOGRAPHY, ENTRIES, HOLDS
from textbook.errata.zero import is_zero
from wmrgen.cli.textbook import installed

CLASSES = {
    "Tzafestas": {
        "(2.15b)": "open", "Example 2.2, slip with ζ ≠ 0": "open", "(2.81)": "open",
        "(2.75c, d)": "likely", "Example 2.1, (2.44)": "damage", "(2.63)": "damage", "(2.71a)": "damage",
        "(2.23)": "likely", "(2.60)": "likely", "2.3.6, constraint of trailer i": "likely",
        "(2.43a)": "care", "Example 2.2, G": "care", "(2.47a)": "care", "(2.70)": "care",
    },
    "Konstantinov": {
        "(2)": "open", "R": "open", "|u_i|": "damage", "u_i, w_i before (3)": "likely",
        "(4) in detail, ω₁": "likely", "v²": "likely",
    },
    "Kelly": {
        "4.1.2.4": "damage", "4.2.1.4": "damage", "4.1.4.1, acceleration": "likely", "(4.25)": "likely",
        "differential steer, positions": "likely", "Ackermann, wheel equation": "likely",
        "generalized bicycle": "likely", "Fresnel argument": "care", "4.2.2.1.1, steering": "care",
    },
    "Siegwart": {
        "3.2.2, “diameter r”": "open", "(3.20)": "error", "(3.55)": "error", "(3.65)": "error",
        "(3.21), (3.22)": "damage", "(3.29), (3.30)": "likely", "(3.14)": "likely",
        "(3.17), (3.18)": "care", "(3.41)": "care", "3.4.2, locked bicycle": "care",
    },
    "AA274": {
        "tricycle": "care", "bounds": "care", "degree of mobility, three fixed wheels": "care",
    },
}  # fmt: skip
# Once called wrong, and right: the copy was misread, or nothing of the kind is printed.
WITHDRAWN = {
    "Tzafestas": ("(2.47b)",), "Konstantinov": ("case Ω ≠ 0, θ",), "Siegwart": ("(3.3)",),
    "Kelly": ("(4.39)", "4.2.2.1.2, wheel speed"),
}  # fmt: skip


def name(r: Record) -> str:
    return f"{r.text} {r.equation}"


def test_every_entry_has_its_class_and_no_other_is_there() -> None:
    rows = {(text, e): kind for text, entries in CLASSES.items() for e, kind in entries.items()}
    assert {(r.text, r.equation): r.kind.name.lower() for r in ENTRIES} == rows
    assert len(ENTRIES) == len(rows)
    assert len({(r.text, r.equation) for r in HOLDS}) == len(HOLDS) >= 95
    assert all(
        (text, e) in {(r.text, r.equation) for r in HOLDS} for text, es in WITHDRAWN.items() for e in es
    )
    assert {r.text for r in (*ENTRIES, *HOLDS)} == set(BIBLIOGRAPHY)


@pytest.mark.slow
@pytest.mark.parametrize("r", (*ENTRIES, *HOLDS), ids=name)
def test_the_checks_bear_out_the_class(r: Record) -> None:
    found = judge(r)
    assert found.borne_out, (found.printed.text, found.corrected)


@pytest.mark.slow
@pytest.mark.parametrize("r", ENTRIES, ids=name)
def test_swapped_forms_bear_out_nothing(r: Record) -> None:
    """What was corrected would hold as printed; what was printed would not do as a correction."""
    assert r.corrected is not None
    assert judge(replace(r, printed=r.corrected, corrected=None, kind=Class.HOLDS)).borne_out
    assert not judge(replace(r, printed=r.corrected)).borne_out
    if r.printed is not None:
        assert not judge(replace(r, corrected=r.printed)).borne_out


@pytest.mark.slow
@pytest.mark.parametrize("r", HOLDS, ids=name)
def test_a_changed_equation_no_longer_holds(r: Record) -> None:
    """A term added to the last right-hand side is noticed."""
    assert r.printed is not None
    last = r.printed.lines[-1]
    extra = symbol(r"\delta")
    changed = last[-1] + extra if last[-1].is_Matrix is False else last[-1].applyfunc(lambda e: e + extra)
    made = Form((*r.printed.lines[:-1], (*last[:-1], changed)))
    assert not judge(replace(r, printed=made)).borne_out


def test_what_is_called_an_error_was_read_in_two_copies() -> None:
    """What was read once may fail by a slip of ours: it accuses no author."""
    for r in ENTRIES:
        assert r.second is not None or r.kind is not Class.ERROR, name(r)
        assert r.second is None or r.kind is not Class.OPEN, name(r)


def test_what_is_read_with_care_holds_under_a_condition() -> None:
    for r in ENTRIES:
        assert (r.part is not None and r.condition != "") or r.kind is not Class.CARE, name(r)
        assert r.line or r.words or r.printed is None, name(r)


@pytest.mark.slow
def test_the_page() -> None:
    page = errata().decode()
    first = page.split("\n\n")[3]
    assert page.startswith("# Equations of five texts, checked, and corrections to our copies\n")
    assert "text extractions" in first and "have not seen the printed pages" in first
    assert "our copy in 4 of the 42 entries, and a second copy in 7, which" in first
    titles = re.findall(r"^## \d (.*)$", page, re.MULTILINE)
    assert titles == [
        "What holds",
        "Errors of the text",
        "Open: read once",
        "Damage of the copy",
        "Read with care",
    ]
    sizes = ("Errors of the text | 3 | 3 | 0", "Open: read once | 6 | 0 | 6", "Damage of the copy | 21 | 1 | 20",
             "Read with care | 12 | 3 | 9")  # fmt: skip
    assert all(f"| {row} |" in page for row in sizes)
    # Checks that hold, numbered equations in them, and lines that are corrected or explained.
    texts = ("Tzafestas | 37 | 64 | 14", "Konstantinov | 12 | 5 | 6", "Kelly | 17 | 9 | 9", "Siegwart | 31 | 46 | 10",
             "AA274 | 3 | 0 | 3", "all | 100 | 124 | 42")  # fmt: skip
    assert all(f"| {row} |" in page for row in texts)
    for edition in ("1st edition, Elsevier, 2014", "1st edition, Cambridge University Press, 2013",
                    "2nd edition, MIT Press, 2011"):  # fmt: skip
        assert edition in page
    entries = re.split(r"^#### ", page.partition("## 2 ")[2], flags=re.MULTILINE)[1:]
    assert len(entries) == len(ENTRIES)
    twice = {f"{r.text} {r.equation}" for r in ENTRIES if r.second is not None}
    for entry in entries:  # the copy's line, before its normalised form
        title = entry.partition("\n")[0].replace("\\", "")
        assert (title in twice) != ("Not read a second time." in entry), title
        assert re.search(
            r"The copy, verbatim: “|not at hand\): `|The copy lacks the line",
            entry.partition("Corrected:")[0],
        )
    second = {r.equation: r.second for r in ENTRIES if r.second is not None}
    assert {e: q.page for e, q in second.items()} == {
        "(3.17), (3.18)": 57, "(3.20)": 59, "(3.29), (3.30)": 64, "(3.41)": 72, "3.4.2, locked bicycle": 76,
        "(3.55)": 85, "(3.65)": 88,
    }  # fmt: skip
    for quote in second.values():  # short, as a quotation for criticism is
        assert f"The second copy, page {quote.page}, verbatim: “" in page and len(quote.text) < 130
    holds = page.partition("## 1 ")[2].partition("## 2 ")[0]
    assert holds.count("\n| ") == len(HOLDS) + 2
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in holds.splitlines() if row.startswith("| ")} == {5}
    for found in (
        "α rises to 1.75382 > π/2",  # Siegwart (3.65), k = (0.5, 10.5, −6), from (1.55, 3.1)
        "a sum of 4×2 and 4×1 does not exist",  # Tzafestas (2.75)
        "their rank at d₁ = d₂ is 2",  # Tzafestas (2.81)
        "automobile: 2, steerability 1",  # Siegwart (3.41)
        "units do not agree: m/s² against m/s",  # Kelly 4.1.2.4
    ):
        assert found in page
    assert r"\operatorname" not in page


def test_zero_is_decided() -> None:
    a, b = symbol("a"), symbol("b")
    assert is_zero(sympy.sin(a + b) - sympy.sin(a) * sympy.cos(b) - sympy.cos(a) * sympy.sin(b))
    assert is_zero((a**2 - b**2) / (a - b) - a - b)
    assert not is_zero(sympy.sin(a + b) - sympy.sin(a) * sympy.cos(b))
    assert not is_zero(sympy.Rational(1, 10**15) * a)


@pytest.mark.slow  # `wmrgen check` says the same, in make check
def test_what_is_generated_is_fresh() -> None:
    """The page and the library's folder, as `wmrgen check` finds them."""
    assert installed().differing(ROOT / "generated") == []
    assert (ROOT / "generated" / "errata.md").is_file() and (ROOT / "generated" / "textbook").is_dir()
