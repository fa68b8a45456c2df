"""What is read: no verb waits for a file without an end, and few modules open files at all."""

from __future__ import annotations

import ast
import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

Cli = Callable[..., Outcome]
PIONEER = str(ROOT / "robots" / "pioneer3dx.yaml")

# The modules that open files, and which. Files that a user names are read by `robotfile/text.py`, which accepts only
# regular files and reads a limited size. The other modules read files that wmrgen has written or comes with.
OPEN = {
    "robotfile/text.py": "the reader of files that a user names",
    "tools/calibration/tables.py": "logs, after `wmrgen calibrate` has checked that they are regular files",
    "tools/calibration/bags.py": "ROS bags, by the library rosbags",
    "tools/calibration/written.py": "a robot file that the reader has accepted",
    "derivation/artifacts.py": "generated files, and the log of a bug",
    "report/pages/overview.py": "generated models",
    "report/pages/document.py": "scripts and fonts that come with wmrgen",
    "functions/registry.py": "sources of wmrgen, whose digest is recorded",
    "codegen/compiler.py": "a PDF that a browser or TeX has printed",
    "derivation/freshness.py": "sources of wmrgen, for their digests",
    "derivation/manifest.py": "manifests, and generated files for their digests",
    "cli/console.py": "standard streams",
    "cli/generate.py": "generated models and a generated PDF",
    "cli/gallery.py": "generated models",
    "cli/textbook.py": "the generated errata",
}
OPENING = {"open", "fdopen", "read_bytes", "read_text", "fromfile", "memmap", "genfromtxt"}
OTHERS = {("read_text", "Name"), ("open", "webbrowser")}  # our function that parses a text; a browser


def opened(source: str) -> list[str]:
    """The names of the functions that ``source`` calls and that open files, sorted."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        match node.func:
            case ast.Name(id=name):
                owner = "Name"
            case ast.Attribute(attr=name, value=ast.Name(id=owner)):
                pass
            case ast.Attribute(attr=name):
                owner = ""
            case _:
                continue
        if name in OPENING and (name, owner) not in OTHERS:
            found.append(name)
    return sorted(found)


def test_where_files_are_opened() -> None:
    package = ROOT / "wmrgen"
    found = {p for p in package.rglob("*.py") if opened(p.read_text(encoding="utf-8"))}
    assert {p.relative_to(package).as_posix() for p in found} == OPEN.keys()


@pytest.mark.parametrize(
    "line", ["open(p)", "p.open()", "io.open(p)", "Path(p).read_bytes()", "p.read_text()", "np.fromfile(p)"]
)
def test_a_call_that_opens_a_file_is_seen(line: str) -> None:
    assert Counter(opened(f"def f(p):\n    return {line}\n")).total() == 1


VERBS = [
    "derive X", "check X", "view X --no-open", "export X --to urdf", "lint X", f"compare {PIONEER} X", "import X",
    f"import {PIONEER} --controller X", "fmt X", "model X", "gains X", f"eval {PIONEER} inverse --cases X",
    f"motion {PIONEER} --segments X", "calibrate X --plan", f"calibrate {PIONEER} X --truth X",
    f"calibrate {PIONEER} {PIONEER} --truth X",
]  # fmt: skip


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices")
@pytest.mark.parametrize("words", VERBS)
def test_a_file_without_an_end_is_refused(wmrgen_cli: Cli, tmp_path: Path, words: str) -> None:
    """A device, a pipe that nobody writes to, and a folder: exit code 2 and a message that names it."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in ("/dev/zero", str(pipe), str(tmp_path)):
        done = wmrgen_cli(*(path if word == "X" else word for word in words.split()))
        assert (done.code, done.out) == (2, "")
        assert done.err.startswith("error[WMR110]") and path in done.err
