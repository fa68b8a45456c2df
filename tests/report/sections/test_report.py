"""The derivation report: complete, renderable on GitHub, and safe whatever the robot file says."""

from __future__ import annotations

import re

import pytest

from tests.conftest import ROOT
from tests.report.sections.common import keyed_page_of, keys_of, page_of, page_written, pages_of, sentence
from tests.robots import ROBOTS, of_gallery
from wmrgen.report.sections.markdown import letter_in_text
from wmrgen.report.sections.texts import citations

FENCE = re.compile(r"^```math\n(.*?)\n```$", re.MULTILINE | re.DOTALL)

# What KaTeX and GitHub's MathJax both know, and the report uses. GitHub refuses \operatorname, \def and others.
MACROS = set(
    "alpha beta gamma psi varphi omega theta xi eta delta Delta pi dot hat bar frac sqrt sum det dim qquad ldots cdots "
    "vdots cdot times pm ge le left right Bigl Bigr begin end mathrm mathit cos sin tan arctan min max rho quad chi "
    "sigma circ approx cot ne overline perp varepsilon".split()
)
NUMBERS = {
    "fixed": ("(3.12)", "(3.13)"),
    "steered": ("(3.15)", "(3.16)"),
    "castor": ("(3.17)", "(3.18)"),
    "swedish": ("(3.19)", "(3.20)"),
    "spherical": ("(3.21)", "(3.22)"),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_math_is_what_github_renders(name: str) -> None:
    page = page_of(name)
    blocks = FENCE.findall(page)
    assert page.count("```") == 2 * len(blocks) > 10
    assert "\n\n\n" not in page, "an empty block"
    assert all("\0" not in text for text in pages_of(name).values()), "a key of a sentence is left"
    assert not re.search(r"(?m)^\s*$\n^```$", page), "a blank line inside a math block ends it on GitHub"
    for block in blocks:
        assert set(re.findall(r"\\([A-Za-z]+)", block)) <= MACROS
        assert block.count("{") == block.count("}")
        assert block.count(r"\left") == block.count(r"\right")
        assert block.count(r"\Bigl") == block.count(r"\Bigr")
        assert sorted(re.findall(r"\\begin\{(\w+)\}", block)) == sorted(re.findall(r"\\end\{(\w+)\}", block))
        assert "\n\n" not in block
    assert "$" not in FENCE.sub("", page), "no inline math"


@pytest.mark.parametrize("name", ROBOTS)
def test_every_section_wheel_and_equation_number(name: str) -> None:
    page, robot = page_of(name), of_gallery(name).robot
    last = 10 if citations(robot) else 9
    assert [int(n) for n in re.findall(r"(?m)^## (\d+) ", page)] == list(range(1, last + 1))
    assert page.startswith(f"# `{name}`\n")
    assert "![Top view of" in page
    assert all(f"]({file})" in "".join(pages_of(name).values()) for file in of_gallery(name).figures)
    for wheel in robot.wheels:
        assert f"| `{wheel.name}` |" in page
        for number in NUMBERS[wheel.type][: 1 if wheel.ball else 2]:
            assert number in page
    for number in ("(3.24)", "(3.26)", "(3.40)", "(3.41)", "(3.42)"):
        assert number in page
    for parameter in robot.parameters:
        symbol = f" ({letter_in_text(parameter.symbol)})" if parameter.symbol else ""
        assert f"`{parameter.name}`{symbol} = " in page


@pytest.mark.parametrize("name", ROBOTS)
def test_the_verdict_is_the_analysis(name: str) -> None:
    page, m = keyed_page_of(name), of_gallery(name).mobility
    pair = f"({m.degree_of_mobility}, {m.degree_of_steerability})"
    assert (f"a degenerate layout, {pair}" if m.degenerate else f"Campion's type {pair}") in page
    assert rf"\delta_M &= \delta_m + \delta_s = {m.degree_of_mobility} + {m.degree_of_steerability}" in page
    vector = ", ".join(map(str, of_gallery(name).growth.vector))
    key = {
        (True, True): "mobility.both",
        (True, False): "mobility.holonomic_only",
        (False, False): "mobility.neither",
    }
    assert f" ({vector})" in sentence(page, "growth.vector")
    assert [k for k in keys_of(name) if k in key.values()] == [key[m.holonomic, m.omnidirectional]]
    assert f"(DDOF = {m.ddof})" in page and f"(DOF = {m.dof})" in page


@pytest.mark.parametrize("name", ROBOTS)
def test_no_number_is_a_heap_of_digits(name: str) -> None:
    derived = page_of(name).split("## 2 ")[1].split("\n---\n")[0]  # notes and the source quote the file
    assert not re.search(r"\d{10,}", derived)


def test_the_foot_says_what_made_it() -> None:
    assert page_of("pioneer3dx").rstrip().endswith("wmrgen 9.9 · model 0123456789abcdef")


def test_the_report_says_how_to_cite_it() -> None:
    """With the title of CITATION.cff, the version and the first digits of the hash of the model."""
    line = page_of("pioneer3dx").rstrip().split("\n\n")[-2]
    (title,) = re.findall(r'(?m)^title: "(.*)"$', (ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert f"*{title}*, version 9.9" in line and "`pioneer3dx`" in line and "0123456789ab" in line
    assert title in (ROOT / "docs" / "faq.md").read_text(encoding="utf-8")


def test_the_page_is_that_of_the_files() -> None:
    """Made in another process."""
    made = (ROOT / "generated" / "kuka_youbot" / "report.md").read_text(encoding="utf-8")
    assert page_of("kuka_youbot").split("\n---\n")[0] == made.split("\n---\n")[0]


@pytest.mark.parametrize(
    ("name", "formula"),
    [
        (
            "pioneer3dx",
            r"\dot{\varphi}_{\mathrm{left}} &= \frac{v_x-\mathit{half\_track}\;\omega}{\mathit{radius}}",
        ),
        ("pioneer3dx", r"\omega &= \frac{\mathit{radius}}{2\,\mathit{half\_track}}\left("),
        (
            "lekiwi",
            r"v_x &= \frac{\sqrt{3}\,\mathit{wheel\_radius}}{3}\left(\dot{\varphi}_{\mathrm{right\_wheel}}-",
        ),
        ("textbook_tricycle", r"y_{ICR} = L\,\cot\psi"),
        ("kuka_youbot", r"v_x-v_y-\left(l_{x}+l_{y}\right)\omega"),
    ],
)
def test_known_formulas(name: str, formula: str) -> None:
    assert formula in page_of(name)


@pytest.mark.parametrize(("name", "offset"), [("kelly_4ws", True), ("wpilib_swervebot", False)])
def test_the_words_on_steered_wheels_agree_with_their_equations(name: str, offset: bool) -> None:
    page = page_of(name)
    assert ("so steering rolls the wheel" in page) == (r"o\,\dot{\psi}" in page) == offset
    assert ("so ψ̇ does not occur" in page) == (not offset)


def test_the_roller_pattern_is_named() -> None:
    assert "layout.x_from_above" in keys_of("kuka_youbot")


HOSTILE = r"<script>alert(1)</script> | `x` $a$ *b* _c_ #1 [l](javascript:u) & \ ! ~s~"


def test_free_text_is_escaped() -> None:
    body = f"wmrgen: 1\nname: nasty\ndescription: '{HOSTILE}'\nsource: '{HOSTILE}'\n"
    page = page_written(body + "wheels:\n  - {name: a_, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\n")
    assert page.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 2
    assert "<script" not in page and "$" not in FENCE.sub("", page)
    for hostile in re.findall(r"alert.*", page):
        assert not re.search(r"(?<!\\)[`*_\[|~]", hostile)


@pytest.mark.parametrize("start", ["- item", "# title", "1. one", "+ x", "> q", "=== x"])
def test_a_description_is_never_markup(start: str) -> None:
    body = f"wmrgen: 1\nname: plain\ndescription: '{start}'\n"
    page = page_written(body + "wheels:\n  - {name: w, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\n")
    assert page.splitlines()[2][0] in "&\\"


def test_equal_lengths_that_lower_a_rank_are_named() -> None:
    """The mirrored mecanum pattern with half track = half wheelbase cannot turn; other lengths could."""
    rows = [
        ("fl", "lx", "ly", ""),
        ("fr", "lx", "-ly", "-"),
        ("bl", "-lx", "ly", "-"),
        ("br", "-lx", "-ly", ""),
    ]
    wheels = "".join(
        f"  - {{name: {n}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {s}pi/4, r: 0.05}}\n"
        for n, x, y, s in rows
    )
    page = page_written(f"wmrgen: 1\nname: mirrored\nparameters: {{lx: 0.2, ly: 0.2}}\nwheels:\n{wheels}")
    told = "The rank of J₁ is 2 at the given values (lx = 0.2, ly = 0.2) and 3 for general ones."
    assert told in page and page.count("for general ones") == page.count("The rank of J₁") == 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["fixed", "steered", "castor", "swedish", "spherical"])
def test_sixty_four_wheels_stay_readable(kind: str) -> None:
    extra = {"castor": ", d: 0.03, actuated: [spin, steer]", "swedish": ", gamma: pi/4"}.get(kind, "")
    beta = "" if kind == "spherical" else ", beta: 0"
    wheels = "".join(
        f"  - {{name: w{k}, type: {kind}, l: 2, alpha: 2*pi*{k}/64{beta}, r: 0.05{extra}}}\n"
        for k in range(64)
    )
    page = page_written(f"wmrgen: 1\nname: many\nwheels:\n{wheels}")
    assert all(f"| `w{k}` |" in page for k in range(64))
    assert len(page) < 90_000 and len(page.splitlines()) < 1200
