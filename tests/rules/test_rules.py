"""Static checkers find nothing in generated C but the documented deviations, and they find planted faults."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.ir.selftest.every import FEW, NAMES
from tests.rules.checkers import CALLER, Finding, clang_tidy, cppcheck, gcc_analyzer, write
from tests.rules.deviations import DEVIATIONS, MISRA, TIDY, Deviation, kept, table

ONE = "ackermann_car"
PLANTED = """
int planted(int x);
int planted(int x)
{
    float y = 0.1f * x;
    int *p = 0;
    if (x == 7) goto end;
    if (y == 0.3f) { return *p; }
    if (x = 3) return 1;
end:
    return planted(x - 1);
}
"""


def beyond(tool: str, findings: list[Finding]) -> list[Finding]:
    return [finding for finding in findings if kept(tool, finding[1], finding[0]) is None]


def needed(robot: str) -> set[Deviation | None]:
    return {deviation for deviation in DEVIATIONS if deviation.robot == robot}


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, Finding]]:
    """Return all findings of the two checkers for one robot's C and its self-test."""
    folder = tmp_path_factory.mktemp(ONE)
    sources = write(folder, ONE)
    both = {MISRA: cppcheck(folder, sources), TIDY: tidy(folder, sources)}
    return [(tool, finding) for tool, findings in both.items() for finding in findings]


def tidy(folder: Path, sources: list[str]) -> list[Finding]:
    return clang_tidy(folder, [source for source in sources if source != CALLER])


@pytest.mark.slow
def test_nothing_beyond_the_deviations(found: list[tuple[str, Finding]]) -> None:
    assert [(tool, f) for tool, f in found if kept(tool, f[1], f[0]) is None] == []


@pytest.mark.slow
def test_every_deviation_is_needed_and_written_down(found: list[tuple[str, Finding]]) -> None:
    assert {kept(tool, check, file) for tool, (file, check, _) in found} == needed(ONE)
    text = (ROOT / "docs" / "misra.md").read_text()
    assert table() in text
    assert not re.search(r"MISRA[- ]compliant", text)


@pytest.mark.slow
@pytest.mark.parametrize("robot", [name for name in NAMES if name != ONE])
def test_misra_of_the_gallery(robot: str, tmp_path: Path) -> None:
    """Self-tests differ only in their numbers, so those of one robot per family are checked."""
    sources = write(tmp_path, robot)
    found = cppcheck(tmp_path, sources if robot in FEW else sources[:-1])
    assert beyond(MISRA, found) == []
    assert needed(robot) <= {kept(MISRA, check, file) for file, check, _ in found}


@pytest.mark.slow
@pytest.mark.parametrize("robot", [name for name in NAMES if name != ONE])
def test_clang_tidy_of_the_gallery(robot: str, tmp_path: Path) -> None:
    assert beyond(TIDY, tidy(tmp_path, write(tmp_path, robot))) == []


@pytest.mark.slow
@pytest.mark.parametrize("robot", [ONE, "lekiwi"])
def test_nothing_beyond_the_deviations_with_called_kernels(robot: str, tmp_path: Path) -> None:
    sources = write(tmp_path, robot)
    text = (tmp_path / f"{robot}.c").read_text()
    (tmp_path / f"{robot}.c").write_text("#define WMRGEN_SMALL\n" + text)
    assert beyond(MISRA, cppcheck(tmp_path, sources)) == []
    assert beyond(TIDY, tidy(tmp_path, sources)) == []
    assert gcc_analyzer(tmp_path, sources) == ""


def test_gcc_analyzer(tmp_path: Path) -> None:
    assert gcc_analyzer(tmp_path, write(tmp_path, ONE)) == ""


@pytest.mark.slow
@pytest.mark.parametrize("robot", NAMES)
def test_gcc_analyzer_of_the_gallery(robot: str, tmp_path: Path) -> None:
    assert gcc_analyzer(tmp_path, write(tmp_path, robot)[:2]) == ""


def test_planted_faults_are_found(tmp_path: Path) -> None:
    """The checkers find planted faults: goto, recursion, an assignment as condition, an unset variable, a null
    pointer."""
    (tmp_path / "planted.c").write_text(PLANTED)
    rules = {check for _, check, _ in beyond(MISRA, cppcheck(tmp_path, ["planted.c"]))}
    assert {"misra-c2012-13.4", "misra-c2012-15.1", "misra-c2012-17.2", "misra-c2012-15.6"} <= rules
    checks = {check for _, check, _ in clang_tidy(tmp_path, ["planted.c"])}
    assert "misc-no-recursion" in checks and any(check.startswith("clang-analyzer-") for check in checks)
    assert "-Wanalyzer-null-dereference" in gcc_analyzer(tmp_path, ["planted.c"])
