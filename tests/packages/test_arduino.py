"""The Arduino library: its sketches built by the recipes of Debian's core for an Uno, run by simavr."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.packages.arduino import build, needed, said, size
from tests.packages.made import in_folder

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("robot", ["pioneer3dx", "ackermann_car"])
def test_the_self_test_says_ok(robot: str, tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, robot, "arduino", "avr")
    program = build(library, f"{robot}_selftest", tmp_path / "build")
    assert said(program, 1) == ["OK"]
    flash, ram = size(program)
    assert flash <= 32256 and ram <= 500


def test_a_broken_library_does_not(tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, "textbook_differential", "arduino", "avr")
    source = library / "src" / "textbook_differential.c"
    source.write_text(source.read_text().replace(" + ", " - "))
    (heard,) = said(build(library, "textbook_differential_selftest", tmp_path / "build"), 1)
    assert heard.startswith("row ")
