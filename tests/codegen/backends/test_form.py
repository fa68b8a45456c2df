"""Properties of the text of all backends that need no compiler: characters, lines, brackets, comparisons."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import PurePosixPath

import pytest

from tests.codegen.backends.test_contract import CODE, FACTS
from tests.robots import of_gallery
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.emit import site

# Comments and strings by the suffix of a file; they are not searched.
C = r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"'
NOT_CODE = {
    ".c": C,
    ".h": C,
    ".rs": C,
    ".js": C + r"|'[^'\n]*'|`[^`]*`",
    ".py": r'""".*?"""|#[^\n]*|"[^"\n]*"',
}
PAIRS = {")": "(", "]": "[", "}": "{"}
ROBOTS = ("pioneer3dx", "ackermann_car", "wpilib_swervebot")


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("name", CODE)
def test_text_is_well_formed(name: str, robot: str) -> None:
    """Lines are printable without trailing spaces, brackets match, and no value is compared with itself."""
    entry, derivation = BACKENDS[name], of_gallery(robot)
    facts = replace(FACTS, site=site(derivation), options=dict.fromkeys(entry.switches, True))
    for file, content in entry.load().emit(getattr(derivation, entry.source), facts).items():
        kind = PurePosixPath(file).suffix
        if kind not in NOT_CODE:
            continue
        text = content.decode()
        lines = text.split("\n")
        assert not lines[-1], file
        assert not [line for line in lines if not line.isprintable() or line != line.rstrip()], file
        code = re.sub(NOT_CODE[kind], "", text, flags=re.DOTALL)
        opened: list[str] = []
        for sign in re.findall(r"[()\[\]{}]", code):
            if sign in PAIRS:
                assert opened and opened.pop() == PAIRS[sign], file
            else:
                opened.append(sign)
        assert not opened, file
        assert not re.search(r"(?<![\w.>\])])([\w.>\[\]-]+) (?:[=!<>]=|[<>]) \1(?![\w.\[(-])", code), file
