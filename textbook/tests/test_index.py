"""The table of places in the texts: every command runs, and prints the numbers of its row."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy

from tests.conftest import ROOT, Outcome
from textbook.errata.texts import ENTRIES, HOLDS
from textbook.index.places import TEXTS, count, covered, not_covered, places_of
from textbook.index.records import Row
from textbook.index.search import find
from textbook.index.table import ROWS
from textbook.library import FUNCTIONS

pytestmark = pytest.mark.slow

Cli = Callable[..., Outcome]


def found_at(data: Any, path: str) -> Any:
    """What the JSON output of a command has under a name, or under keys divided by slashes."""
    if isinstance(data, dict) and path in data:
        return numbers(data[path])
    for key in path.split("/"):
        data = data[int(key)] if isinstance(data, list) else data[key]
    return numbers(data)


def numbers(value: Any) -> Any:
    """Numbers of nested lists; model.json has entries of matrices as text."""
    if isinstance(value, list):
        return [numbers(v) for v in value]
    return float(sympy.sympify(value)) if isinstance(value, str) else float(value)


def printed(cli: Cli, row: Row) -> Any:
    """What the command of a row prints as JSON."""
    words = [str(ROOT / w) if w == row.robot_file else w for w in row.words if w != "--json"]
    done = cli(*words, "--json")
    assert done.code == 0, done.err
    return json.loads(done.out)


def compare(row: Row, data: Any) -> None:
    """The numbers that are expected are those of the output."""
    assert row.expected
    for name, value in row.expected.items():
        np.testing.assert_allclose(
            np.asarray(found_at(data, name), float),
            np.asarray(value, float),
            rtol=row.tolerance,
            atol=row.tolerance,
            err_msg=f"{row.text} {row.places}: {name}",
        )


@pytest.mark.parametrize("row", ROWS, ids=lambda r: f"{r.text} {r.places} {r.robot} {r.command}")
def test_the_command_prints_the_numbers(wmrgen_cli: Cli, row: Row, tmp_path: Any, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    compare(row, printed(wmrgen_cli, row))


# Query -> places of which some must be among the rows that are found.
QUERIES = {
    "2.75": "Tzafestas (2.75)",
    "(2.75c)": "Tzafestas (2.75)",
    "eq. 2.75": "Tzafestas (2.75)",
    "Siegwart 3.19": "Siegwart (3.19)",
    "siegwart (3.19)": "Siegwart (3.19)",
    "Table 2.1": "Siegwart Table 2.1 (6 wheels, 2)",
    "Table 2.1 (3 wheels, 3)": "Siegwart Table 2.1 (3 wheels, 3)",
    "Figure 3.15": "Siegwart Figure 3.15",
    "fig. 3.15": "Siegwart Figure 3.15",
    "3.15": "Siegwart (3.15)",
    "Exercise 3.7.1": "Siegwart Problem 3.7.1",
    "Exercise 3.7.3": "Siegwart Problem 3.7.3(b)",
    "Example 2.4": "Tzafestas Example 2.4",
    "Box 4.2": "Kelly Box 4.2",
    "Kelly 4.1.2.3": "Kelly 4.1.2.3",
    "Konstantinov 5": "Konstantinov (5)",
    "piaggio": "Siegwart Table 2.1 (3 wheels, 3)",
    "AA274 tricycle": "AA274 tricycle",
    "eqs. 3.12 to 3.13": "Siegwart (3.13)",
    "3.12 and 3.13": "Siegwart (3.13)",
    "(3.12), (3.13)": "Siegwart (3.13)",
    "Table 2.1, 3 wheels": "Siegwart Table 2.1 (3 wheels, 2)",
    "car": "AA274 simplified car",
}


@pytest.mark.parametrize(
    "query",
    ["(3.12)-(3.13)", "3.12-3.13", "3.12 – 3.13", "3.12-13", "(3.13)-(3.12)", "Siegwart (3.12)-(3.13)"],
)
def test_a_range_finds_its_members(query: str) -> None:
    found = {row.places for row in find(query).rows}
    assert {"(3.12)", "(3.13)"} <= found
    if "(" in query:  # without parentheses it may be a figure
        assert len(found) == 2
    wide = find("(3.12)-(3.16)")
    assert {"(3.15), (3.16)", "(3.12)"} <= {row.places for row in wide.rows}
    assert [str(place) for place in wide.missing] == []


def test_short_words_are_whole_words() -> None:
    rows = find("car").rows
    assert rows and all(
        re.search(r"\bcar\b", f"{row.places} {row.says} {row.robot}".replace("_", " ")) for row in rows
    )


@pytest.mark.parametrize("query", QUERIES)
def test_find(query: str) -> None:
    found = {str(place) for row in find(query).rows for place in places_of(row.text, row.places)}
    assert QUERIES[query] in found
    assert find(query).near == ()


def test_find_takes_the_kind_and_the_text_literally() -> None:
    assert all("(3.15)" not in row.places for row in find("Figure 3.15").rows)
    assert {row.text for row in find("Siegwart 3.14").rows} == {"Siegwart"}
    assert len(find("Table 2.1").rows) == 17 and len(find("Table 2.1 (3 wheels, 3)").rows) == 1


def test_find_names_what_is_not_covered() -> None:
    found = find("Siegwart 3.46")
    assert not found.rows and [str(place) for place in found.missing] == ["Siegwart (3.46)"]
    assert all(found.missing.values())


@pytest.mark.parametrize(
    ("query", "near"),
    [
        ("3.70", "Siegwart (3.65)"),
        ("Siegwart 3.70", "Siegwart (3.65)"),
        ("Konstantinov 9", "Konstantinov (6)"),
        ("Table 2.2", "Siegwart Table 2.1"),
        ("Figure 3.17", "Siegwart Figure 3.16"),
        ("pigagio", "piaggio"),
    ],
)
def test_a_query_without_a_match_names_what_is_near(wmrgen_cli: Cli, query: str, near: str) -> None:
    assert near in find(query).near
    done = wmrgen_cli("textbook", "--find", query)
    assert done.code == 2 and done.out == "" and near in done.err


@pytest.mark.parametrize(
    "query", ["", " ", "(", "a", "x", "a x", "%s", "\u00e9\u00df", "[[", "table of contents", "x" * 5000]
)
def test_odd_queries_are_refused(wmrgen_cli: Cli, query: str) -> None:
    done = wmrgen_cli("textbook", "--find", query)
    assert (done.code, done.out) == (2, "") and "error[WMR112]" in done.err


def test_find_as_json(wmrgen_cli: Cli, tmp_path: Any, monkeypatch: Any) -> None:
    """Nothing is written, and the command of each row is one that its robot file has."""
    monkeypatch.chdir(tmp_path)
    done = wmrgen_cli("textbook", "--find", "2.75", "--json")
    data = json.loads(done.out)
    assert done.code == 0 and not list(tmp_path.iterdir())
    (row,) = data["found"]
    assert row["text"] == "Tzafestas" and "(2.75)" in row["places"]
    assert row["robot"] == "robots/texts/tzafestas_four_omni.yaml" and row["robot"] in row["command"]
    assert row["expected"]["w1.spin"] == pytest.approx(-10.8765, abs=1e-4)
    assert (data["covered"], data["places"]) == count()
    missing = json.loads(wmrgen_cli("textbook", "--find", "3.46", "--json").out)
    assert missing["found"] == [] and missing["not_covered"][0]["reason"]


def test_places_are_counted_once() -> None:
    """Every numbered line of a copy is covered or has a reason, and no place is both."""
    assert not covered() & set(not_covered())
    everywhere = {*covered(), *not_covered()}
    lines = {"Siegwart": 65, "Tzafestas": 91, "Konstantinov": 6}
    for text, number in lines.items():
        assert sum(place.text == text and place.kind == "equation" for place in everywhere) == number
    assert count() == (len(covered()), len(everywhere))
    assert [sum(part) for part in zip(*(count(text) for text in TEXTS), strict=True)] == list(count())
    assert sum(place.kind == "table" for place in covered()) == 17


def test_places_of_the_errata_are_places() -> None:
    """Each equation that was checked in symbols is covered by a command, or has a reason."""
    everywhere = {str(place) for place in (*covered(), *not_covered())}
    for record in (*ENTRIES, *HOLDS):
        for number in re.findall(r"\((\d\.\d+)[a-z, ]*\)", record.equation):
            assert f"{record.text} ({number})" in everywhere, record.equation


def test_functions_of_the_library_are_listed(wmrgen_cli: Cli) -> None:
    data = json.loads(wmrgen_cli("functions", "textbook", "--json").out)
    assert [f["name"] for f in data["functions"]] == list(FUNCTIONS)
    assert all(f["inputs"] and f["outputs"] for f in data["functions"])
    done = wmrgen_cli("functions", "textbook")
    assert done.code == 0 and len(done.out.splitlines()) == len(FUNCTIONS)
