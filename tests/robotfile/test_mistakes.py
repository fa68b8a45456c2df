"""The examples of `wmrgen explain`: the wrong one has this mistake and no other, the right one is a robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from tests.robotfile.files import HEAD
from wmrgen.errors import Code, NotDerivableError, RobotFileError
from wmrgen.robotfile.mistakes import CALLS, MISTAKES, Mistake
from wmrgen.tools.lint import Subject, findings


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES)
def test_examples(mistake: Mistake, tmp_path: Path) -> None:
    wrong, right = tmp_path / "wrong.yaml", tmp_path / "right.yaml"
    wrong.write_text(HEAD + mistake.wrong, encoding="utf-8")
    right.write_text(HEAD + mistake.right, encoding="utf-8")
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(wrong)
    assert [error.code for error in caught.value.parts] == [mistake.code]
    assert str(caught.value).startswith(f"error[{mistake.code}]: ")
    spec, robot = wmrgen.read(right)
    assert findings(Subject(spec, robot, wmrgen.derive(robot).mobility)) == []


@pytest.mark.parametrize(("code", "exit_code"), [(Code.FILE, 2), (Code.USAGE, 2), (Code.ENVIRONMENT, 4)])
def test_examples_of_calls(
    code: Code,
    exit_code: int,
    wmrgen_cli: Callable[..., Outcome],
    robot_file: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    folder = robot_file.parent
    monkeypatch.chdir(folder)
    (folder / "robots").mkdir()
    for name in ("robots/my_robot.yaml", "my_robot.yaml"):
        (folder / name).write_text(robot_file.read_text())
    wrong, right = (wmrgen_cli(*text.split()[1:]) for text in (CALLS[code].wrong, CALLS[code].right))
    assert wrong.code == exit_code and wrong.err.startswith(f"error[{code}]: ")
    assert right.code == 0


def test_examples_of_descriptions(wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> None:
    """The wrong example has a place; the right one is XML, but a robot without a wheel."""
    for name in ("wrong", "right"):
        (tmp_path / name).write_text(getattr(CALLS[Code.DESCRIPTION], name))
    wrong, right = (wmrgen_cli("import", tmp_path / name) for name in ("wrong", "right"))
    code, place, line = wrong.err.splitlines()[:3]
    assert code.startswith("error[WMR111]: ")
    assert [place, line] == [f" --> {tmp_path / 'wrong'}:3:3", "3 | </robot>"]
    assert right.err.startswith("error[WMR111]: right: ") and " --> " not in right.err


def test_examples_of_robots_that_are_not_derived(tmp_path: Path) -> None:
    mistake = CALLS[Code.UNDERIVABLE]
    for name in ("wrong", "right"):
        (tmp_path / name).write_text(HEAD + getattr(mistake, name), encoding="utf-8")
    with pytest.raises(NotDerivableError) as caught:
        wmrgen.load(tmp_path / "wrong")
    assert str(caught.value).startswith("error[WMR113]: ") and caught.value.exit_code == 3
    assert wmrgen.derive(wmrgen.load(tmp_path / "right")).inverse


def test_every_code_is_explained() -> None:
    assert [*MISTAKES, *CALLS] == [code for code in Code if code]
