"""`symbol:` of a parameter: its letter in formulas, in reports, exercises and notebooks."""

from __future__ import annotations

import re

import pytest

from tests.report.sections.common import keyed_page_written, keys_written, page_written, sentence
from tests.robots import of_text
from wmrgen.errors import Code, RobotFileError
from wmrgen.report.sections.exercise import exercise

PAIR = """wmrgen: 1
name: pair
parameters: {half_track: {value: 0.2, symbol: %s}, radius: {value: 0.05, symbol: %s}}
wheels:
  - {name: left,  type: fixed, x: 0, y: half_track,  heading: 0, r: radius}
  - {name: right, type: fixed, x: 0, y: -half_track, heading: 0, r: radius}
"""


@pytest.mark.parametrize(
    ("symbol", "shown", "in_text"),
    [
        ("h", "h", "h"),
        ("L", "L", "L"),
        ("l_x", "l_{x}", "l<sub>x</sub>"),
        ("s_front", r"s_{\mathrm{front}}", "s<sub>front</sub>"),
        ("lambda", r"\lambda", "λ"),
        ("λ", r"\lambda", "λ"),
        ("μ_1", r"\mu_{1}", "μ<sub>1</sub>"),
    ],
)
def test_formulas_show_the_symbol(symbol: str, shown: str, in_text: str) -> None:
    text = PAIR % (symbol, "r")
    page = page_written(text)
    formulas = "".join(re.findall(r"```math\n(.*?)```", page, re.DOTALL))
    assert rf"\frac{{v_x-{shown}\;\omega}}{{r}}" in formulas and r"\mathit" not in formulas
    assert f"`half_track` ({in_text}) = 0.2" in page
    d = of_text(text)
    assert shown in d._repr_latex_() and r"\mathit" not in d._repr_latex_()
    assert r"\mathit" not in "".join(exercise(d, 1, True))


def test_code_and_data_keep_the_name() -> None:
    plain, lettered = of_text(PAIR.replace("symbol: %s", "tunable: false")), of_text(PAIR % ("h", "r"))
    assert plain.J1 == lettered.J1
    assert [str(s) for s in lettered.J1.free_symbols] == ["half_track"]


def test_the_next_report_has_its_own_symbols() -> None:
    """Symbols of one robot do not reach the report of another."""
    assert "h\\;\\omega" in page_written(PAIR % ("h", "r"))
    other = PAIR.replace("{value: 0.2, symbol: %s}", "0.2").replace("{value: 0.05, symbol: %s}", "0.05")
    assert r"\mathit{half\_track}" in page_written(other)


@pytest.mark.parametrize(
    "symbol", ["hh", "v", "omega", "x", "v_x", "e", "h_", "h_x_y", "2", r"\alpha", "$h$", "Theta"]
)
def test_what_reports_use_or_cannot_show_is_refused(symbol: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        of_text(PAIR % (f"'{symbol}'", "r"))
    (part,) = refused.value.parts
    assert part.code is Code.NAME and part.mark.line == 3


@pytest.mark.parametrize(
    "parameters",
    [
        "{half_track: {value: 0.2, symbol: h}, radius: {value: 0.05, symbol: h}}",
        "{half_track: {value: 0.2, symbol: r}, r: 0.05, radius: r}",
        "{half_track: {value: 0.2, symbol: l_x}, lx: 0.05, radius: lx}",
        "{half_track: {value: 0.2, symbol: lambda}, radius: {value: 0.05, symbol: λ}}",
    ],
)
def test_two_parameters_have_two_letters(parameters: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        of_text(re.sub(r"parameters: .*", f"parameters: {parameters}", PAIR))
    assert [part.code for part in refused.value.parts] == [Code.TWICE]


def test_upper_and_lower_case_are_two_letters() -> None:
    assert r"-L\;\omega" in page_written(PAIR % ("L", "l"))


@pytest.mark.parametrize(
    ("symbols", "told"), [(("l", "r"), False), (("r", "l"), True), (("alpha", "beta"), True)]
)
def test_letters_that_a_wheel_has_too_are_told_apart(symbols: tuple[str, str], told: bool) -> None:
    """l is the distance from P, r the radius, alpha and beta angles of a wheel in the book's equations."""
    key, text = "layout.letters_of_parameters", PAIR % symbols
    assert (key in keys_written(text)) == told
    if told:
        shown = [{"alpha": "α", "beta": "β"}.get(s, s) for s in symbols]
        assert all(f"`{letter}`" in sentence(keyed_page_written(text), key) for letter in shown)


CAR = """wmrgen: 1
name: sample
parameters: {base: {value: 2.5, symbol: %s}, half: {value: 0.7, symbol: %s}}
wheels:
  - {name: rl, type: fixed, x: 0, y: half, heading: 0, r: 0.3}
  - {name: rr, type: fixed, x: 0, y: -half, heading: 0, r: 0.3}
  - {name: fl, type: steered, x: base, y: half, heading: 0, r: 0.3, actuated: [steer]}
  - {name: fr, type: steered, x: base, y: -half, heading: 0, r: 0.3, actuated: [steer]}
"""


@pytest.mark.parametrize(
    ("symbols", "shown"),
    [
        (("L", "h"), r"\frac{\omega\,L}{v_x} = \frac{L}{R}, \qquad L = 2.5 "),
        (("a", "b"), r"\frac{\omega\,L}{v_x} = \frac{L}{R}, \qquad L = a = 2.5 "),
        (("a", "L"), r"\frac{\omega\,x_A}{v_x} = \frac{x_A}{R}, \qquad x_A = a = 2.5 "),
    ],
)
def test_the_wheelbase_is_called_l_unless_a_parameter_is(symbols: tuple[str, str], shown: str) -> None:
    assert shown in page_written(CAR % symbols)


TURNED = """wmrgen: 1
name: turned
parameters: {half: 0.3, radius: {value: 0.05, symbol: r}, off: {value: 0.02, symbol: %s}}
wheels:
  - {name: a, type: steered, x: half, y: half, heading: %s, r: radius, offset_y: -off, limits: {steer: [-0.7, 0.7]}}
  - {name: b, type: steered, x: -half, y: -half, heading: 0, r: radius, offset_y: -off}
"""


@pytest.mark.parametrize(("heading", "turned"), [("30 deg", True), ("0", False)])
def test_section_six_has_one_letter_for_each_quantity(heading: str, turned: bool) -> None:
    """The offset h and the heading psi_0, which occurs if a wheel is not ahead at angle 0 and is explained there."""
    section = page_written(TURNED % ("h", heading)).partition("## 6 ")[2].partition("## 7 ")[0]
    formulas = "".join(re.findall(r"```math\n(.*?)```", section, re.DOTALL))
    words = re.sub(r"```math\n.*?```", "", section, flags=re.DOTALL)
    assert (r"\psi_0" in formulas) == turned == ("ψ<sub>0</sub>" in words)
    assert not re.search(r"(?<![\w\\{.`])h(?![\w_`])", words) and r"\mathit" not in formulas.replace(
        r"\mathit{half}", ""
    )
    rates = re.findall(r"\\dot\{\\varphi\}.*?= (.*)", formulas)
    assert sum(r"h\,\omega" in rate for rate in rates) >= 2 and "o\\,\\omega" not in formulas
