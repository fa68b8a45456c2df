"""What section 7 says of the measurements: how many, what they leave unseen, in robots of every size."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import pytest

from tests.report.sections.common import page_of, sentence
from tests.report.sections.reading import lengths_in_formulas, read
from tests.robots import of_gallery, of_text
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.report.sections.forward import forward, solution_by_rank
from wmrgen.report.sections.markdown import keys

UNSEEN, ENOUGH, MORE = "forward.unseen", "forward.square", "forward.overdetermined"
PSEUDO = "(H^T H)^{+}"


def section(wheels: list[str]) -> str:
    text = "wmrgen: 1\nname: sample\nwheels:\n" + "".join(f"  - {{{w}}}\n" for w in wheels)
    return "\n".join(forward(of_text(text)))


def omni(count: int, sensed: int, reach: str = "0.2") -> list[str]:
    """``count`` omni wheels on a circle, of which ``sensed`` are."""
    return [
        f"name: w{k}, type: swedish, l: {reach}, alpha: {k}*2*pi/{count}, beta: 0, gamma: 0, r: 0.05"
        + (", sensed: []" if k >= sensed else "")
        for k in range(count)
    ]


@pytest.mark.parametrize(
    ("count", "sensed", "words"),
    [
        (3, 3, ENOUGH),
        (3, 2, UNSEEN),
        (3, 1, UNSEEN),
        (4, 4, MORE),
        (4, 3, ENOUGH),
        (4, 2, UNSEEN),
        (5, 4, MORE),
    ],
)
def test_how_many_rows_there_are(count: int, sensed: int, words: str) -> None:
    text = section(omni(count, sensed))
    said = keys(text)
    assert [key for key in (UNSEEN, ENOUGH, MORE) if key in said] == [words]
    assert (PSEUDO in text) == (words is UNSEEN)
    assert ("(H^T H)^{-1}" in text) == (
        words is MORE
    )  # no inverse of what has none, no least squares of three rows
    assert ("forward.full_rank" in said) == (words is MORE)
    assert "forward.rolling_only" in said and "forward.both_rows" not in said


@pytest.mark.parametrize(
    ("rank", "may_fall", "key"),
    [
        (1, True, "forward.rank_one"),
        (2, True, "forward.rank_two"),
        (3, False, "forward.always_regular"),
        (3, True, "forward.may_be_singular"),
    ],
)
def test_what_is_inverted_goes_by_the_rank(rank: int, may_fall: bool, key: str) -> None:
    assert keys("\n".join(solution_by_rank(rank, may_fall))) == [key]


@pytest.mark.parametrize("reach", ["1e-6", "1e-3", "0.2", "1e3", "2e4"])
def test_a_direction_is_seen_whatever_the_size(reach: str) -> None:
    assert ENOUGH in keys(section(omni(3, 3, reach)))
    assert UNSEEN in keys(section(omni(3, 2, reach)))


def test_three_parallel_rows_leave_a_direction_unseen() -> None:
    wheels = [
        f"name: w{k}, type: swedish, x: {0.2 * k}, y: {0.1 * k * k}, heading: 0, gamma: 0, r: 0.05"
        for k in range(3)
    ]
    assert UNSEEN in keys(section(wheels))


def test_nothing_sensed_is_said() -> None:
    assert keys(section(omni(3, 0))) == ["forward.nothing_sensed"]


@pytest.mark.parametrize(("sensed", "words"), [("spin, steer", "both"), ("steer", "one")])
def test_which_rows_are_known(sensed: str, words: str) -> None:
    wheels = [
        f"name: w{k}, type: steered, x: {0.3 - 0.6 * k}, y: 0, heading: 0, r: 0.05, sensed: [{sensed}]"
        for k in range(2)
    ]
    text = section(wheels)
    assert ("`w0` and `w1` " in sentence(text, "forward.both_rows")) == (words == "both")
    assert ("`w0` and `w1` " in sentence(text, "forward.sliding_only")) == (words == "one")
    assert r"v + ω ẑ × B = r φ̇ e, with" in text or words == "one"


@pytest.mark.parametrize(
    "name", ["kuka_youbot", "locked_bicycle", "nexus_4wd", "ssl_parsian", "textbook_two_steer"]
)
def test_the_residual_is_that_of_forward(name: str) -> None:
    """In the robot file's names where it has some, of measurements that do not fit each other."""
    d = of_gallery(name)
    told = re.search(r"(?<=\\mathrm{slip} = ).*", page_of(name).partition("## 7 ")[2].partition("## 8 ")[0])
    assert told
    formula = d.driven.program.formula("forward")
    values = {
        p.name: Fraction(3 * k * k - 5 * k + 7, 10) for k, p in enumerate(formula.inputs) if not p.default
    }
    twist = d.driven.evaluate("forward", {n: Exact(v) for n, v in values.items()})
    known = lengths_in_formulas(d.robot)
    known |= {notation.port(n): float(v) for n, v in (values | twist).items()}
    root = re.fullmatch(r"\\sqrt{(.*)}", told[0])
    value = read(root[1] if root else told[0], known)
    assert (math.sqrt(value) if root else value) == pytest.approx(float(twist["slip"]), rel=1e-6)
    named = all(w.symbolic.r.constant is None for w in d.robot.wheels if w.has_spin)
    assert float(twist["slip"]) > 0.001 and not (named and re.search(r"\d\.\d", told[0]))


def test_wheels_in_one_place() -> None:
    """Four rows of rank 2 leave two relations, so the residual is the root of a sum of squares."""
    wheels = [
        f"name: w{k}, type: fixed, x: 0, y: -0.6, heading: {k} * pi, r: {r}" for k, r in enumerate("12")
    ]
    text = section(wheels)
    assert "forward.unseen" in keys(text)
    assert r"\mathrm{slip} = \sqrt{" in text
