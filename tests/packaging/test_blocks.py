"""The fenced blocks of README and docs/ do what the pages say, and a block that is not run says why."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT, Outcome
from tests.external_tools import need
from tests.packaging.blocks import NOTES, PAGES, Block, Session, blocks, matches
from tests.report.pages.katex import mistakes

Cli = Callable[..., Outcome]
SLOW = [p for p in PAGES if not all(b.everyday for b in blocks(p))]
CC = ("c", "sh")
FIRST = ("README.md", "tutorial.md", "first_robot.md", "commands.md")  # pages that newcomers follow


def pages() -> list[Any]:
    """All pages; others than the first ones are slow."""
    marked = []
    for page in PAGES:
        marked.append(pytest.param(page, id=page.name, marks=[] if page.name in FIRST else pytest.mark.slow))
    return marked


def session(folder: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> Session:
    for name in ("robots", "tests"):
        (folder / name).symlink_to(ROOT / name)
    monkeypatch.chdir(folder)
    return Session(folder, cli)


@pytest.mark.parametrize("page", pages())
def test_a_page(page: Path, wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that needs Python and a C compiler."""
    here = session(tmp_path, wmrgen_cli, monkeypatch)
    for block in blocks(page):
        if block.everyday:
            here.run(block)


@pytest.mark.slow
@pytest.mark.parametrize("page", SLOW, ids=lambda p: p.name)
def test_a_whole_page(page: Path, wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole page, with compilers and emulators of boards."""
    need(*{tool for block in blocks(page) for tool in block.notes.get("needs", "").split()})
    here = session(tmp_path, wmrgen_cli, monkeypatch)
    for block in blocks(page):
        here.run(block)


def test_a_block_that_is_not_run_says_why() -> None:
    every = [b for p in PAGES for b in blocks(p)]
    assert len(every) > 30
    assert all(set(b.notes) <= set(NOTES) for b in every), "a misspelled note"
    assert not [b.place for b in every if len(b.notes.get("not run", "a good reason").split()) < 3]
    assert not [b.place for b in every if not (ROOT / b.notes.get("run by", "tests")).exists()]


@pytest.mark.parametrize(
    "block",
    [
        Block("p:1", "python", {}, "assert 1 == 2\n"),
        Block("p:1", "console", {}, "$ wmrgen eval robots/unicycle.yaml inverse vx=1\nwheel.spin = 2\n"),
        Block("p:1", "console", {}, "$ wmrgen derive nothing.yaml\n"),
        Block("p:1", "console", {"exit": "1"}, "$ true && true\n"),
        Block("p:1", "sh", {}, "false\ntrue\n"),
        Block("p:1", "text", {}, "what nobody said\n"),
        Block("p:1", "yaml", {}, "limits: {vx: 1, nothing: 2}\n"),
        Block("p:1", "c", {"in": "generated/unicycle/unicycle.c"}, "    nothing = 1;\n"),
        Block("p:1", "c", {}, '#include "unicycle.h"\nint main(void) { return 1; }\n'),
    ],
    ids=lambda b: b.language,
)
def test_a_wrong_block_is_seen(
    block: Block, wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if block.language in CC and shutil.which("cc") is None:
        pytest.skip("no C compiler")
    with pytest.raises(Exception):  # noqa: B017 - of many kinds
        session(tmp_path, wmrgen_cli, monkeypatch).run(block)


FENCED = re.compile(r"^```([^\n]*)\n.*?^```$", re.M | re.S)


def only_math(block: re.Match[str]) -> str:
    """Return a fenced block of mathematics, and nothing for another block."""
    return block[0] if block[1] == "math" else ""


@pytest.mark.slow
def test_every_formula_is_one_to_katex() -> None:
    """Between dollars, too, which those of generated/ are not."""
    need("node")
    texts = [FENCED.sub(only_math, page.read_text("utf-8")) for page in PAGES]
    texts.append((ROOT / "generated" / "errata.md").read_text(encoding="utf-8"))
    displayed = [f for text in texts for f in re.findall(r"^```math\n(.*?)^```$", text, re.M | re.S)]
    inline = [f for text in texts for f in re.findall(r"(?<![`\w])\$`?([^$\n]+?)`?\$(?![`\w])", text)]
    assert len(displayed) > 80 and len(inline) > 200
    assert mistakes(displayed + inline) == [] and mistakes([r"\foo"]) != []


def test_dots_stand_for_anything() -> None:
    assert matches("a\n...\nb 1...\n", "a \nx\nb 1.25\n") and not matches("a.c\n", "abc\n")
