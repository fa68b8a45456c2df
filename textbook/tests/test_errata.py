"""The verdicts are those of the catalogue, and follow from the forms: swap them and the verdict changes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from tests.conftest import ROOT
from textbook.emit import errata
from textbook.errata.forms import Form, form, symbol
from textbook.errata.records import Judgement, Record, judge
from textbook.errata.texts import CONVENTIONS, ERRATA, HOLDS, RECORDS
from textbook.errata.zero import is_zero
from wmrgen.cli.generate import installed

# Sections 6.1 and 6.2 of the catalogue, in its order.
CATALOGUE = {
    "Tzafestas": {
        "(2.15b)": "wrong", "(2.23)": "garbled", "Example 2.1, (2.44)": "garbled",
        "Example 2.2, slip with ζ ≠ 0": "incomplete", "(2.60)": "wrong", "(2.63)": "garbled",
        "2.3.6, constraint of trailer i": "wrong", "(2.70)": "wrong", "(2.71a)": "garbled",
        "(2.75c, d)": "wrong", "(2.81)": "wrong",
        "(2.43a)": "convention", "Example 2.2, G": "convention", "(2.47a)": "convention", "(2.47b)": "convention",
    },
    "Konstantinov": {
        "(2)": "wrong", "|u_i|": "garbled", "u_i, w_i before (3)": "wrong", "(4) in detail, ω₁": "garbled",
        "v²": "wrong", "R": "wrong",
        "case Ω ≠ 0, θ": "convention",
    },
    "Kelly": {
        "4.1.2.4": "garbled", "4.1.4.1, acceleration": "garbled", "(4.25)": "wrong", "4.2.1.4": "garbled",
        "differential steer, positions": "garbled", "Ackermann, wheel equation": "garbled",
        "generalized bicycle": "garbled",
        "Fresnel argument": "convention", "(4.39)": "convention", "4.2.2.1.1, steering": "convention",
        "4.2.2.1.2, wheel speed": "convention",
    },
    "Siegwart": {
        "3.2.2, “diameter r”": "wrong", "(3.14)": "wrong", "(3.20)": "wrong", "(3.21), (3.22)": "garbled",
        "(3.29), (3.30)": "garbled", "(3.55)": "wrong", "(3.65)": "incomplete",
        "(3.3)": "convention", "(3.17), (3.18)": "convention", "castor, self-alignment": "convention",
        "(3.41)": "convention", "3.4.2, locked bicycle": "convention", "Problem 3.7.1": "convention",
        "figure 3.16": "convention",
    },
    "AA274": {
        "tricycle": "convention", "bounds": "convention", "degree of mobility, three fixed wheels": "convention",
    },
}  # fmt: skip
NOT_RIGHT = (*ERRATA, *CONVENTIONS)


@cache
def judged(k: int) -> Judgement:
    return judge(RECORDS[k])


def name(r: Record) -> str:
    return f"{r.text} {r.equation}"


def test_every_row_of_the_catalogue_and_no_other() -> None:
    assert [(r.text, r.equation) for r in NOT_RIGHT if r.text == "Siegwart"] == [
        ("Siegwart", e) for e in CATALOGUE["Siegwart"]
    ]
    rows = {(text, equation) for text, verdicts in CATALOGUE.items() for equation in verdicts}
    assert {(r.text, r.equation) for r in NOT_RIGHT} == rows
    assert len(NOT_RIGHT) == len(rows) == 50
    counts = [v for verdicts in CATALOGUE.values() for v in verdicts.values()]
    assert [counts.count(v) for v in ("wrong", "garbled", "incomplete", "convention")] == [15, 14, 2, 19]
    assert len(HOLDS) >= 88 and len({(r.text, r.equation) for r in HOLDS}) == len(HOLDS)


@pytest.mark.parametrize("k", range(len(NOT_RIGHT)), ids=lambda k: name(NOT_RIGHT[k]))
def test_verdict(k: int) -> None:
    r = NOT_RIGHT[k]
    assert judged(k).verdict == CATALOGUE[r.text][r.equation]


@pytest.mark.parametrize("r", HOLDS, ids=name)
def test_holds(r: Record) -> None:
    found = judge(r)
    assert found.verdict == "holds", found.printed.text


@pytest.mark.parametrize("r", NOT_RIGHT, ids=name)
def test_swapped_forms_flip_the_verdict(r: Record) -> None:
    """What was corrected passes as printed; what was printed would not do as a correction."""
    assert r.corrected is not None
    assert judge(replace(r, printed=r.corrected, corrected=r.printed)).verdict == "holds"
    if r.printed is not None:
        assert judge(replace(r, corrected=r.printed)).verdict == "undecided"


@pytest.mark.parametrize("r", HOLDS, ids=name)
def test_a_changed_equation_no_longer_holds(r: Record) -> None:
    """A term added to the last right-hand side is noticed."""
    assert r.printed is not None
    last = r.printed.lines[-1]
    extra = symbol(r"\delta")
    changed = last[-1] + extra if last[-1].is_Matrix is False else last[-1].applyfunc(lambda e: e + extra)
    made = Form((*r.printed.lines[:-1], (*last[:-1], changed)))
    assert judge(replace(r, printed=made)).verdict == "undecided"


@pytest.mark.slow
def test_counterexamples_stand_on_the_page() -> None:
    page = errata().decode()
    assert "α rises to 1.75382 > π/2" in page  # Siegwart (3.65), k = (0.5, 10.5, −6), from (1.55, 3.1)
    assert "a sum of 4×2 and 3×1 does not exist" in page  # Tzafestas (2.75)
    assert "their rank at d₁ = d₂ is 2" in page  # Tzafestas (2.81)
    assert "automobile: 2, steerability 1" in page  # Siegwart (3.41)
    assert "units do not agree: m/s² against m/s" in page  # Kelly 4.1.2.4
    assert r"\operatorname" not in page
    for number in ("\\frac{2 \\, \\sqrt{3}}{3}", "- \\frac{4}{3}", "- \\frac{7}{3}"):
        assert number in page.partition("## 4 Worked numbers")[2]  # Siegwart (3.34)


def test_zero_is_decided() -> None:
    import sympy

    a, b = symbol("a"), symbol("b")
    assert is_zero(sympy.sin(a + b) - sympy.sin(a) * sympy.cos(b) - sympy.cos(a) * sympy.sin(b))
    assert is_zero((a**2 - b**2) / (a - b) - a - b)
    assert not is_zero(sympy.sin(a + b) - sympy.sin(a) * sympy.cos(b))
    assert not is_zero(sympy.Rational(1, 10**15) * a)
    assert form(a).same(form(a)) and not form(a).same(form(b))


def test_what_is_generated_is_fresh() -> None:
    """The page and the library's folder, as `wmrgen check` finds them."""
    assert installed().differing(ROOT / "generated") == []
    assert (ROOT / "generated" / "errata.md").is_file() and (ROOT / "generated" / "textbook").is_dir()
