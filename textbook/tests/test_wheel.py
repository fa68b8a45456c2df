"""The library inside the wheel of wmrgen: it computes, and writes the files that are checked in."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from tests.conftest import ROOT, process
from tests.packaging.test_wheel import installed, wheel

__all__ = ["installed", "wheel"]  # fixtures
pytestmark = pytest.mark.slow


def test_the_wheel_has_the_library_without_its_tests(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if name.startswith("textbook/")]
    assert "textbook/command.py" in names
    assert not [name for name in names if "tests" in name.split("/")]


def test_an_installed_wmrgen_computes_and_writes_the_library(installed: Path, tmp_path: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    words = ("eval", "textbook", "turning_radius", "wheelbase=1", "psi=pi/4")
    done = process(*words, cwd=work, python=(str(installed), "-E", "-m", "wmrgen"))
    assert done.code == 0, done.err
    assert done.out.splitlines()[0].split() == ["radius", "=", "1.0", "m"]
    done = process("textbook", cwd=work, python=(str(installed), "-E", "-m", "wmrgen"))
    assert done.code == 0, done.err
    there = {p.name: p.read_bytes() for p in (work / "generated" / "textbook").rglob("*") if p.is_file()}
    here = {p.name: p.read_bytes() for p in (ROOT / "generated" / "textbook").rglob("*") if p.is_file()}
    assert there == here
