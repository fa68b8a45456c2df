"""A robot's folder as part of a firmware: a build that takes every C file of it has one `main`, the firmware's own."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS, EACH, STRICT
from tests.conftest import Outcome, put, tree
from tests.ir.selftest.every import files_of
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.derivation.manifest import MANIFEST
from wmrgen.errors import EnvironmentFailure

FIRMWARE = """
#include "pair.h"
#include <stdio.h>
int main(void) {{ {body} puts("firmware"); return 0; }}
"""
OLD = "pair_selftest.c"  # where earlier versions wrote it

needs_compiler = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")


@pytest.fixture
def folder(robot_file: Path, wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> Path:
    """What ``derive --fuzz`` writes for a differential drive."""
    assert wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--fuzz").code == 0
    return tmp_path / "out" / "pair"


def test_check_looks_after_the_harness(
    folder: Path, robot_file: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    assert wmrgen_cli("check", robot_file, "-o", folder.parent).code == 0
    (folder / "test" / "pair_fuzz.c").unlink()
    stale = wmrgen_cli("check", robot_file, "-o", folder.parent)
    assert stale.code == 1 and "pair_fuzz.c" in stale.out + stale.err


@needs_compiler
@pytest.mark.parametrize("pattern", ["*.c", "**/*.c"])
@pytest.mark.parametrize("compiler", EACH)
def test_every_c_file_and_the_main_of_a_firmware(folder: Path, compiler: str, pattern: str) -> None:
    """``*.c`` as a CMake glob or an Arduino sketch takes them, ``**/*.c`` as PlatformIO does."""
    body = "" if pattern == "*.c" else "extern int pair_selftest(void); if (pair_selftest()) { return 1; }"
    (folder / "firmware.c").write_text(FIRMWARE.format(body=body))
    sources = [path.relative_to(folder).as_posix() for path in folder.glob(pattern)]
    assert {"firmware.c", "pair.c", "pair_checked.c"} <= set(sources)
    assert (OLD in sources, "test/pair_selftest.c" in sources, "test/pair_fuzz.c" in sources) == (
        (False, False, False) if pattern == "*.c" else (False, True, True)
    )
    flags = ("-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
    assert run_program(compile_program(folder, sources, compiler, flags), "") == "firmware\n"


@needs_compiler
@pytest.mark.parametrize("compiler", EACH)
def test_main_only_on_request(folder: Path, compiler: str) -> None:
    sources = ["pair.c", "test/pair_selftest.c"]
    with pytest.raises(EnvironmentFailure, match="main"):
        compile_program(folder, sources, compiler, STRICT)
    assert (
        run_program(compile_program(folder, sources, compiler, (*STRICT, "-DPAIR_SELFTEST_MAIN")), "") == ""
    )


def test_nothing_beside_the_sources_defines_main() -> None:
    for name, content in files_of("pioneer3dx").items():
        if "/" not in name:
            assert not re.search(rb"\bmain\s*\(", content), name


def test_removes_the_self_test_of_an_earlier_version(
    folder: Path, robot_file: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """It stood beside the sources, with a main; check says so, derive removes it, and a user's own file stays."""
    now = tree(folder)
    content = (folder / "test" / "pair_selftest.c").read_bytes()
    manifest = json.loads(now[MANIFEST])
    manifest["files"] = {name.removeprefix("test/"): digest for name, digest in manifest["files"].items()}
    for name in ("test/pair_selftest.c", "test/pair_fuzz.c"):
        (folder / name).unlink()
    (folder / "test").rmdir()
    put(
        folder,
        {OLD: content, "pair_fuzz.c": b"", MANIFEST: json.dumps(manifest).encode(), "mine.c": b"int mine;"},
    )
    checked = wmrgen_cli("check", robot_file, "-o", folder.parent)
    assert checked.code == 1
    assert f"{OLD}: no robot file produces it" in checked.out
    assert "test/pair_selftest.c: missing" in checked.out
    derived = wmrgen_cli("derive", robot_file, "-o", folder.parent, "--fuzz")
    assert derived.code == 0 and f"removed {OLD}" in derived.err
    assert tree(folder) == {**now, "mine.c": b"int mine;"}
