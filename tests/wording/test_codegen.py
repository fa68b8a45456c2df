"""Messages and comments of code generation: each names its subject and says what to do."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from tests.robots import of_gallery
from wmrgen.codegen.compiler import find_compiler, print_pages, run_node, run_rust
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.emit import artifacts
from wmrgen.errors import Code, EnvironmentFailure

MISSING: dict[str, tuple[Callable[[], object], str]] = {
    "C": (find_compiler, "gcc"),
    "Rust": (lambda: run_rust("crate", "", "", "", ()), "rustc"),
    "JavaScript": (lambda: run_node({}), "node"),
    "PDF": (lambda: print_pages("", {}, ()), "chromium"),
}


@pytest.mark.parametrize("language", MISSING)
def test_a_missing_program_is_named_with_its_package(language: str, monkeypatch: pytest.MonkeyPatch) -> None:
    call, program = MISSING[language]
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(EnvironmentFailure) as caught:
        call()
    assert caught.value.code == Code.ENVIRONMENT
    said, _, cure = caught.value.what.partition("nstall ")
    assert re.search(rf"looked for [^.]*\b{program}\b", said) and "apt-get install" in cure


def test_the_report_has_a_text_for_the_files_of_every_backend_that_computes() -> None:
    for entry in BACKENDS.values():
        texts = [files.what for files in entry.files if files.what]
        assert texts or not entry.word or entry.package, entry.name
        assert all(len(text) <= 80 and text == text.strip(" .") for text in texts), entry.name


@pytest.mark.parametrize("robot", ["pioneer3dx", "wpilib_swervebot"])
def test_every_c_file_says_what_it_is_and_who_may_use_it(robot: str) -> None:
    """The first comment of a file has its name, the version, the digest of the model and the licence."""
    for name, content in artifacts(of_gallery(robot)).items():
        if not name.endswith((".c", ".h")):
            continue
        banner = content.decode().partition("*/")[0]
        assert name.rpartition("/")[2] in banner, name
        assert re.search(r"wmrgen \d+\.\d+\.\d+\. Model hash: [0-9a-f]{32}\n", banner), name
        assert "MIT-0" in banner and "sympy" not in banner and "casadi" not in banner, name
