"""A tool that is on the PATH and does not run is missing: tests that need it are skipped, and fail in CI."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests import external_tools

RUSTUP = """#!/bin/sh
echo "error: rustup could not choose a version of rustc to run, because one wasn't specified explicitly" >&2
exit 1
"""


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is first on the PATH, with a rustc that has no toolchain, and no folder of Python's scripts."""
    (tmp_path / "rustc").write_text(RUSTUP)
    (tmp_path / "rustc").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setattr(external_tools, "BIN", str(tmp_path))
    monkeypatch.delenv("CI_DEEP", raising=False)
    return tmp_path


@pytest.mark.skipif(os.name != "posix", reason="plants a shell script")
def test_a_tool_that_does_not_run_is_missing(planted: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for call in (lambda: external_tools.need("true", "rustc"), lambda: external_tools.tool("rustc")):
        with pytest.raises(pytest.skip.Exception) as skipped:
            call()
        assert "rustc" in str(skipped.value) and "true," not in str(skipped.value)
    monkeypatch.setenv("CI_DEEP", "1")
    with pytest.raises(pytest.fail.Exception):
        external_tools.need("rustc")


@pytest.mark.skipif(os.name != "posix", reason="plants shell scripts")
@pytest.mark.parametrize("text", ["#!/nowhere/sh\n", "", "#!/bin/sh\nkill $$\n"])
def test_other_tools_that_do_not_run(planted: Path, text: str) -> None:
    (planted / "broken").write_text(text)
    (planted / "broken").chmod(0o755)
    with pytest.raises(pytest.skip.Exception):
        external_tools.need("broken")


@pytest.mark.skipif(os.name != "posix", reason="plants a shell script")
def test_a_tool_that_runs_is_tried_once(planted: Path) -> None:
    log = planted / "log"
    (planted / "works").write_text(f'#!/bin/sh\necho "$@" >> {log}\n')
    (planted / "works").chmod(0o755)
    for _ in range(3):
        assert external_tools.tool("works") == str(planted / "works")
    assert log.read_text() == "--version\n"
