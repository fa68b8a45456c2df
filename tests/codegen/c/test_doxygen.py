"""Doxygen finds a description of everything that the headers declare."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.conftest import put
from tests.depth import everyday
from tests.external_tools import need
from tests.ir.selftest.every import NAMES, files_of

SETTINGS = """
INPUT = .
QUIET = YES
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
WARN_IF_UNDOCUMENTED = YES
WARN_NO_PARAMDOC = NO
"""


def warnings(folder: Path) -> list[str]:
    need("doxygen")
    (folder / "Doxyfile").write_text(SETTINGS)
    words = ["doxygen", "Doxyfile"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=120, check=True)
    return done.stderr.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("robot", everyday(NAMES, ("pioneer3dx", "wpilib_swervebot", "pr2")))
def test_everything_has_a_description(robot: str, tmp_path: Path) -> None:
    headers = {name: text for name, text in files_of(robot).items() if name.endswith(".h")}
    put(tmp_path, headers)
    assert warnings(tmp_path) == []
    pages = "".join(page.read_text() for page in (tmp_path / "xml").glob("*_8h.xml"))
    text = b"".join(headers.values()).decode()
    declared = re.findall(rf"^(?:\w+ \*?)({robot}_\w+)\(", text, flags=re.M)
    assert declared and not [name for name in declared if f"<name>{name}</name>" not in pages]


@pytest.mark.slow
def test_a_missing_description_is_found(tmp_path: Path) -> None:
    put(tmp_path, {"lekiwi.h": files_of("lekiwi")["lekiwi.h"].replace(b"/** Sensed", b"/* Sensed")})
    assert any("lekiwi_forward" in line for line in warnings(tmp_path))
