"""docs/textbook.md has every function with a source in the texts, and its commands run."""

from __future__ import annotations

import re
from collections.abc import Callable

from tests.conftest import ROOT, Outcome
from tests.packaging.textbook_page import PAGE, page
from textbook.library import FUNCTIONS as LIBRARY
from wmrgen.functions.registry import FUNCTIONS, names


def test_the_page_is_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_every_function_of_the_texts_is_on_the_page() -> None:
    functions = set(re.findall(r"^\| .* \| `(\w+)` \| ", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    cited = {name for name in names() if re.search(r"\(\d\.\d+", FUNCTIONS[name].source)}
    assert len(cited) > 30 and cited <= functions and set(LIBRARY) <= functions


def test_commands_of_the_page_run(wmrgen_cli: Callable[..., Outcome]) -> None:
    """A command of each text, whose robot file exists."""
    for section in PAGE.read_text(encoding="utf-8").split("\n## ")[1:]:
        robot, function = re.findall(r"`wmrgen eval (\S+) (\w+)`", section)[-1]
        place = robot if robot == "textbook" else str(ROOT / robot)
        done = wmrgen_cli("eval", place, function)
        assert done.code == 0 and " = " in done.out, section
