"""Every kind of message renders, and says where the mistake is and what to write. Sentences themselves are free.

The other tests ask for codes, places and numbers. `python -m tests.wording.prose FILE...` counts patterns that make
sentences hard to read; it is a guide for writers, and no test.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import wmrgen
from tests.tools.lint.test_rules import linted
from wmrgen.errors import NotDerivableError, RobotFileError, WmrgenError
from wmrgen.robotfile.mistakes import MISTAKES, Mistake
from wmrgen.tools.lint import RULES, Rule

HEAD = "wmrgen: 1\nname: tried\n"
LONGEST_TITLE = 8  # words; a title names the mistake
IN_ROBOT_FILES = [m for m in MISTAKES.values() if m.form == "yaml"]


def check_text(text: str) -> None:
    """A message for people: no braces of a template, no doubled words, spaces or full stops."""
    assert text.strip() == text != ""
    assert not re.search(r"\{\w+\}|\bNone\b|  |\.\.(?!\.)", text), text
    assert not re.search(r"\b(\w+) \1\b", re.sub(r"[`\"'].*?[`\"']", "", text)), text


def check_rendered(text: str, code: str, name: str) -> None:
    """Level and code, an arrow with file, line and column, the line with a caret, and at least one remark."""
    first, place, *rest = text.split("\n")
    assert re.match(rf"(error|warning)\[{code}\]: \S", first)
    assert re.match(rf" *--> .*{name}:\d+:\d+$", place)
    assert any(re.match(r" *\| *\^$", line) for line in rest)
    assert any(re.match(r" *= \S", line) for line in rest), text


@pytest.mark.parametrize("mistake", [*RULES.values(), *MISTAKES.values()], ids=lambda m: m.code)
def test_titles_name_the_mistake(mistake: Rule | Mistake) -> None:
    assert len(mistake.title.split()) <= LONGEST_TITLE
    assert not mistake.title.endswith(".")
    check_text(mistake.text)


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
def test_findings_name_their_place_and_their_cure(rule: Rule, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(HEAD + rule.wrong, encoding="utf-8")
    for finding in linted(path):
        check_rendered(str(finding), rule.code, "robot.yaml")
        check_text(finding.what)
        check_text(finding.instead)


@pytest.mark.parametrize("mistake", IN_ROBOT_FILES, ids=lambda m: m.code)
def test_errors_name_their_place_and_their_cure(mistake: Mistake, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(HEAD + mistake.wrong, encoding="utf-8")
    with pytest.raises((RobotFileError, NotDerivableError)) as caught:
        wmrgen.derive(wmrgen.load(path)).casadi()
    error: WmrgenError
    for error in caught.value.parts:
        check_rendered(str(error), mistake.code, "robot.yaml")
        check_text(error.what.replace("\n", " "))
