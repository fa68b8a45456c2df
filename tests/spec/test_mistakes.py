"""The examples of `wmrgen explain`: the wrong one has that mistake and no other, the right one is a robot."""

from __future__ import annotations

from pathlib import Path

import pytest

import wmrgen
from tests.spec.files import HEAD
from wmrgen.errors import Code, RobotFileError
from wmrgen.spec.mistakes import MISTAKES, Mistake


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_examples(mistake: Mistake, tmp_path: Path) -> None:
    wrong, right = tmp_path / "wrong.yaml", tmp_path / "right.yaml"
    wrong.write_text(HEAD + mistake.wrong, encoding="utf-8")
    right.write_text(HEAD + mistake.right, encoding="utf-8")
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(wrong)
    assert [error.code for error in caught.value.parts] == [mistake.code]
    assert str(caught.value).startswith(f"error[{mistake.code}]: ")
    assert wmrgen.load(right).wheels


def test_every_code_is_explained() -> None:
    assert list(MISTAKES) == [code for code in Code if code]
