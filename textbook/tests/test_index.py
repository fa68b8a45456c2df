"""The table of places in the texts: every command runs, and prints the numbers of its row."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy

from tests.conftest import ROOT, Outcome
from textbook.index.records import Row
from textbook.index.table import ROWS

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
