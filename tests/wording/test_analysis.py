"""Sentences of the analysis room: every reason, balance and singularity renders, and has its names and numbers."""

from __future__ import annotations

import re

import pytest

from tests.analysis.mobility.test_couplings import STEERED, wheel
from tests.analysis.mobility.test_reasons import CASES, mobility
from wmrgen.analysis.mobility.records import Balance


@pytest.mark.parametrize("case", CASES)
def test_reasons_are_sentences(case: str) -> None:
    m = mobility(*CASES[case][:2])
    for reason in m.explanation:
        assert reason.text.endswith(".") and "  " not in reason.text and reason.text.count("`") % 2 == 0
    assert m.deciding in m.reasons
    if m.degenerate:
        assert f"({m.degree_of_mobility}, {m.degree_of_steerability})" in m.verdict


@pytest.mark.parametrize("joint", ["spin", "steer"])
@pytest.mark.parametrize(
    ("motors", "independent", "need", "numbers"),
    [(2, 2, 2, "2 2"), (1, 1, 1, "1 1"), (1, 1, 2, "1 2 1"), (3, 2, 2, "3 2 1 1"), (4, 1, 1, "4 1 3 3")],
)
def test_a_balance_has_its_numbers(
    joint: str, motors: int, independent: int, need: int, numbers: str
) -> None:
    text = str(Balance(joint, motors, independent, need))
    assert " ".join(re.findall(r"\d+", text)) == numbers
    assert text.startswith("steering" if joint == "steer" else "driving")
    assert re.search(rf"\b{motors} actuated joints?\b", text)
    assert ("joints" in text) == (motors != 1) and ("degrees" in text) == (need != 1)


def test_one_motor_of_no_use_is_not_a_relation_between_rates() -> None:
    texts = [str(Balance(joint, 1, 0, 0)) for joint in ("spin", "steer")]
    assert "rate alone" in texts[0] and "angle alone" in texts[1]


def test_singularities_name_their_wheels() -> None:
    rear = wheel("r", "fixed", 0.0, 0.0)
    front = wheel("f", "steered", 0.5, 0.0, actuated=["steer"])
    omni = [wheel(f"w{k}", "swedish", 0.3 * k, 0.0, heading=0.0, gamma=0.0) for k in range(3)]
    found = [s for wheels in ([rear, front], STEERED, omni) for s in mobility(wheels).singularities]
    assert {s.kind for s in found} == {"icr_on_pivot", "shared_axle", "drive", "rolling_rank"}
    for s in found:
        assert all(f"`{name}`" in s.meaning for name in s.wheels) and not s.meaning.endswith(".")
