"""The wording of errors in robot files: each names its code and place, shows the line, and says what to write."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import wmrgen
from tests.robotfile.files import refused, robot, wheel
from tests.robotfile.test_bad_files import CASES
from wmrgen.errors import RobotFileError
from wmrgen.robotfile.mistakes import CALLS, MISTAKES, Mistake

KINDS = MISTAKES | CALLS


def test_layout_of_a_message() -> None:
    text = str(refused(robot(wheel("a", type="fixd"))))
    first, place, line, caret, *remarks = text.split("\n")
    assert first.startswith("error[WMR104]: ") and "'fixd'" in first
    assert place == " --> bot.yaml:4:21"
    assert line == "4 |   - {name: a, type: fixd, x: 0, y: 0.1, heading: 0, r: 0.05}"
    assert caret.index("^") == line.index("fixd")
    assert remarks and all(remark.startswith("  = ") for remark in remarks)


@pytest.mark.parametrize("name", CASES)
def test_messages_of_bad_files(name: str, tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(CASES[name].file.encode())
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(path)
    for part in caught.value.parts:
        first, place, *shown = str(part).splitlines()
        assert first == f"error[{part.code}]: {part.what}" and place.strip() == f"--> {part.mark}"
        if part.mark and part.mark.text:
            line, caret = shown[:2]
            assert line.startswith(str(part.mark.line))
            assert caret.index("^") - caret.index("|") == part.mark.column + 1
        assert not part.what.endswith(".") and (not part.why or part.why.endswith("."))
        assert re.match("[A-Z]", part.instead or part.why)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_titles_name_the_mistake(kind: Mistake) -> None:
    assert re.fullmatch(r"(?!an? |the )\w+( \w+){1,3}", kind.title)
    assert kind.text.endswith(".") and kind.title not in [k.title for k in KINDS.values() if k is not kind]
