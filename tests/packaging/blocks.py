"""The fenced blocks of README and docs/, which are run in the order of their page. ``python -m tests.packaging.blocks``
lists those that are not, with the reason.

A comment in the line above a block says how, where its language does not: ``<!-- file: NAME -->`` writes it there,
``<!-- in: FILE -->`` finds its lines in a file, ``<!-- exit: 1 -->`` expects that code, ``<!-- slow -->`` leaves it
to CI, ``<!-- needs: TOOL… -->`` to CI with tools, ``<!-- run by: TEST -->`` to another test,
``<!-- not run: REASON -->`` to nobody.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.conftest import DIFFERENTIAL, ROOT, Outcome

# Generated pages whose blocks other tests check: tests/cli/page.py, tests/tools/lint/page.py.
MADE = ("command_line.md", "lint.md")
PAGES = (ROOT / "README.md", *(p for p in sorted((ROOT / "docs").glob("*.md")) if p.name not in MADE))
NOTES = ("file", "in", "exit", "slow", "needs", "run by", "not run")
_BLOCK = re.compile(r"^(?:<!-- ([^\n]*) -->\n)?```([\w+]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_SHELL = re.compile(r"[|<>&;]")
Cli = Callable[..., Outcome]


@dataclass(frozen=True, slots=True)
class Block:
    """``language`` and ``text`` of a fenced block, and the ``notes`` above it."""

    place: str
    language: str
    notes: dict[str, str]
    text: str

    @property
    def everyday(self) -> bool:
        return not {"slow", "needs"} & set(self.notes)


def blocks(page: Path) -> Iterator[Block]:
    """All fenced blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    for match in _BLOCK.finditer(text):
        words = [note.partition(": ") for note in (match[1] or "").split("; ") if note]
        line = text.count("\n", 0, match.start(2)) + 1
        yield Block(f"{page.name}:{line}", match[2], {name: value for name, _, value in words}, match[3])


@dataclass
class Session:
    """A page worked through in ``folder``, with robots/ and tests/ of the checkout. ``said``: the last output."""

    folder: Path
    cli: Cli
    said: str = ""
    names: dict[str, Any] = field(default_factory=lambda: {"__name__": "page"})

    def run(self, block: Block) -> None:
        """Do what a block says; AssertionError where something else comes of it than the page shows."""
        if {"run by", "not run"} & set(block.notes):
            return
        if "file" in block.notes:
            (self.folder / block.notes["file"]).write_text(block.text, encoding="utf-8")
        elif "in" in block.notes:
            self.is_in(block)
        else:
            getattr(self, f"run_{block.language or 'nothing'}")(block)

    def is_in(self, block: Block) -> None:
        name = block.notes["in"]
        place = self.folder / name if (self.folder / name).exists() else ROOT / name
        lines = [re.sub(r"\s*/\*.*\*/$", "", line) for line in block.text.splitlines()]
        missing = set(lines) - {re.sub(r"\s*/\*.*\*/$", "", x) for x in place.read_text("utf-8").splitlines()}
        assert not missing, f"{block.place}: not in {name}: {missing}"

    def run_math(self, block: Block) -> None:
        """Formulas are typeset by Sphinx."""

    def run_python(self, block: Block) -> None:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block.text, block.place, "exec"), self.names)
        self.said = printed.getvalue()

    def run_console(self, block: Block) -> None:
        for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
            command, shown = part.split("\n", 1)
            done = self.command(command)
            assert done.code == int(block.notes.get("exit", 0)), f"{block.place}: {command}\n{done.err}"
            self.said = done.out
            if shown:
                seen = (done.out, done.err + done.out, done.out + done.err)
                assert any(matches(shown, text) for text in seen), f"{block.place}: {command}\n{seen[1]}"

    def command(self, line: str) -> Outcome:
        if line.startswith("wmrgen ") and not _SHELL.search(line.split("#")[0]):
            return self.cli(*shlex.split(line, comments=True)[1:])
        return self.shell(line)

    def run_sh(self, block: Block) -> None:
        done = self.shell(block.text)
        assert done.code == 0, f"{block.place}: {done.err}"
        self.said = done.out

    def shell(self, text: str) -> Outcome:
        tools = f'wmrgen() {{ PYTHONPATH={ROOT} {sys.executable} -m wmrgen "$@"; }}\n'
        done = subprocess.run(
            ["bash", "-c", f"set -e\n{tools}{text}"],
            cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=300,
        )  # fmt: skip
        return Outcome(done.returncode, re.sub(r"\x1b\[[\d;]*m", "", done.stdout), done.stderr)

    def run_text(self, block: Block) -> None:
        assert matches(block.text, self.said), f"{block.place}: the block above printed\n{self.said}"

    def run_yaml(self, block: Block) -> None:
        """A robot file is derived; a part of one joins two wheels, left and right."""
        import wmrgen

        whole = "wmrgen: 1\n" in block.text
        path = self.folder / "block.yaml"
        path.write_text(block.text if whole else DIFFERENTIAL + block.text, encoding="utf-8")
        derivation = wmrgen.derive(wmrgen.load(path))
        assert derivation.mobility and derivation.program

    def run_c(self, block: Block) -> None:
        """A program, compiled with the robot that it includes: one derived on the page, else the gallery's."""
        (name,) = re.findall(r'#include "(\w+)\.h"', block.text)
        source = next(self.folder.rglob(f"{name}.c"), ROOT / "generated" / name / f"{name}.c")
        (self.folder / "program.c").write_text(block.text, encoding="utf-8")
        flags = "-std=c99 -Wall -Wextra -Werror"
        done = self.shell(f"cc {flags} -I{source.parent} program.c {source} -lm -o program && ./program")
        assert done.code == 0, f"{block.place}: {done.err}"
        self.said = done.out


def matches(shown: str, printed: str) -> bool:
    """``...`` in what a page shows stands for anything; so does space at the ends of lines."""
    pattern = re.escape(_trimmed(shown)).replace(r"\.\.\.", ".*")
    return re.fullmatch(pattern, _trimmed(printed), re.DOTALL) is not None


def _trimmed(text: str) -> str:
    return "\n".join(line.rstrip() for line in text.splitlines())


if __name__ == "__main__":
    for one in (b for p in PAGES for b in blocks(p) if "not run" in b.notes):
        print(f"{one.place} {one.language}: {one.notes['not run']}")
