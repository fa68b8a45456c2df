"""The library as an installed extra: its own wheel beside that of wmrgen."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.conftest import ROOT, process
from tests.packaging.test_wheel import installed, wheel

__all__ = ["installed", "wheel"]  # fixtures
pytestmark = pytest.mark.slow


@pytest.fixture
def with_library(installed: Path, tmp_path: Path) -> Path:
    """The fresh environment of wmrgen's wheel, with the wheel of the library in it too."""
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(tmp_path / "dist")]
    subprocess.run([*command, str(ROOT / "textbook")], check=True, capture_output=True)
    (built,) = (tmp_path / "dist").glob("*.whl")
    site = next(installed.parents[1].rglob("site-packages"))
    with zipfile.ZipFile(built) as archive:
        names = archive.namelist()
        metadata = next(archive.read(n).decode() for n in names if n.endswith("/METADATA"))
        archive.extractall(site)
    assert {n.split("/")[0] for n in names if ".dist-info" not in n} == {"textbook"}
    assert not [n for n in names if "tests" in n]
    version = next(line for line in metadata.splitlines() if line.startswith("Version: "))[9:]
    assert f"Requires-Dist: wmrgen=={version}" in metadata.splitlines()
    return installed


def test_it_computes_beside_an_installed_wmrgen(with_library: Path, tmp_path: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    words = ("eval", "textbook", "turning_radius", "wheelbase=1", "psi=pi/4")
    done = process(*words, cwd=work, python=(str(with_library), "-E", "-m", "wmrgen"))
    assert done.code == 0, done.err
    assert done.out.splitlines()[0].split() == ["radius", "=", "1.0", "m"]
    done = process("textbook", cwd=work, python=(str(with_library), "-E", "-m", "wmrgen"))
    assert done.code == 0, done.err
    there = {p.name: p.read_bytes() for p in (work / "generated" / "textbook").rglob("*") if p.is_file()}
    here = {p.name: p.read_bytes() for p in (ROOT / "generated" / "textbook").rglob("*") if p.is_file()}
    assert there == here
