"""The rules of the importer are records: each has a code of its own, a reason and the description that needs it."""

from __future__ import annotations

from itertools import chain
from typing import Any

import pytest

from wmrgen.tools.importing import candidates, rejections, robot_questions, type_questions, wheel_questions
from wmrgen.tools.importing.rule import Rule

LISTS: dict[str, list[Any]] = {
    "proposals": candidates.PROPOSALS,
    "doubts": candidates.DOUBTS,
    "rejections": rejections.REJECTIONS,
    "remarks": rejections.REMARKS,
    "wheels": wheel_questions.RULES,
    "robot": robot_questions.RULES,
    "support": robot_questions.LAST,
    "types": type_questions.RULES,
}
RULES: list[Rule[Any]] = list(chain.from_iterable(LISTS.values()))


@pytest.mark.parametrize("name", LISTS)
def test_each_list_has_rules(name: str) -> None:
    assert LISTS[name]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_a_rule_has_a_reason_and_a_witness(rule: Rule[Any]) -> None:
    assert rule.why.endswith(".") and len(rule.why) > 20 and len(rule.witness) > 2
    assert [other.code for other in RULES].count(rule.code) == 1
