"""docs/textbook.md has every row of the table of places and every function of the library; its commands are run in
``textbook/tests/test_index.py``."""

from __future__ import annotations

import re

from tests.packaging import textbook_robots
from tests.packaging.textbook_page import PAGE
from textbook.errata.texts import BIBLIOGRAPHY
from textbook.index.command import command_line
from textbook.index.page import content
from textbook.index.places import TEXTS
from textbook.index.table import ROWS
from textbook.library import FUNCTIONS as LIBRARY
from wmrgen.cli.gallery import robots_of_texts
from wmrgen.functions.registry import FUNCTIONS, names

# Functions of robots that cite an equation and have no row: what they add to the equation is ours.
WITHOUT_ROW = {"compensate_steering", "forward_covariance"}


def test_the_pages_are_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == content(), "run: python -m tests.packaging.textbook_page"
    page = textbook_robots.PAGE.read_text(encoding="utf-8")
    assert page == textbook_robots.content(), "run: python -m tests.packaging.textbook_robots"
    pictures = {path.stem for path in textbook_robots.PICTURES.glob("*.svg")}
    assert pictures == set(robots_of_texts()) == set(re.findall(r"figures/texts/(\w+)\.svg", page))


def test_the_texts_are_those_of_the_errata() -> None:
    assert tuple(BIBLIOGRAPHY) == TEXTS


def test_every_row_is_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert all(f"`{command_line(row)}`" in page for row in ROWS)


def test_every_formula_of_the_library_has_a_row() -> None:
    commands = {row.command for row in ROWS}
    assert {f"eval {name}" for name in LIBRARY} <= commands


def test_functions_that_cite_an_equation_have_a_row() -> None:
    commands = {row.command for row in ROWS}
    cited = {name for name in names() if re.search(r"\(\d\.\d+", FUNCTIONS[name].source)}
    missing = {name for name in cited if f"eval {name}" not in commands}
    assert missing == WITHOUT_ROW
