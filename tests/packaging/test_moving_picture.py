"""The moving picture of README is what ``simulate`` draws today, and the robot keeps its limits in it."""

from __future__ import annotations

from pathlib import Path

from tests.conftest import ROOT
from tests.packaging.moving_picture import PICTURE, write


def test_it_is_fresh_and_shown(tmp_path: Path) -> None:
    write(tmp_path / "drive.svg")
    assert PICTURE.read_bytes() == (tmp_path / "drive.svg").read_bytes(), (
        "python -m tests.packaging.moving_picture"
    )
    assert f"]({PICTURE.relative_to(ROOT).as_posix()})" in (ROOT / "README.md").read_text(encoding="utf-8")
