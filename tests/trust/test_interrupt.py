"""A set of C files that is half old and half new does not compile."""

from __future__ import annotations

import itertools
import shutil
import subprocess
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import DIFFERENTIAL
from wmrgen.derivation.emit import artifacts
from wmrgen.ir.kernels.choice import Choice

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_mixed_pairs_are_refused_by_the_compiler(tmp_path: Path) -> None:
    changes = {"first": "0.0975", "second": "0.0976"}
    sets = {}
    for name, radius in changes.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(DIFFERENTIAL.replace("0.0975", radius))
        sets[name] = artifacts(wmrgen.derive(wmrgen.load(path)))
    sets["double"] = artifacts(wmrgen.derive(wmrgen.load(tmp_path / "first.yaml")), Choice("double", "libm"))
    for header, source in itertools.product(sets, repeat=2):
        folder = tmp_path / f"{header}_{source}"
        folder.mkdir()
        (folder / "pair.h").write_bytes(sets[header]["pair.h"])
        (folder / "pair.c").write_bytes(sets[source]["pair.c"])
        command = [str(COMPILER), "-std=c99", "-fsyntax-only", "pair.c"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert (done.returncode == 0) == (header == source), done.stderr
        assert header == source or "not generated together" in done.stderr
