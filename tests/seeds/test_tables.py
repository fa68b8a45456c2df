"""Siegwart Table 2.1, figure 3.14 and the degenerate layouts: degrees, ranks, DOF and holonomy of every row.

The texts describe the rows in words; layouts.json gives each a concrete layout (angles in degrees).
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.conftest import ROOT
from tests.robots import of_text

FILE = ROOT / "textbook" / "layouts.json"
ROWS: list[dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))


def robot_file(row: dict[str, Any]) -> str:
    lines = ["wmrgen: 1", "name: row", "angles: deg", "wheels:"]
    for k, w in enumerate(row["wheels"]):
        radius = "" if w["type"] == "spherical" else ", r: 0.1"
        keys = ", ".join(f"{key}: {value}" for key, value in w.items())
        lines.append(f"  - {{name: w{k}, {keys}{radius}}}")
    if row["synchro"]:
        lines.append("couplings:")
        for joint in ("steer", "spin"):
            lines.append(f"  - {{equal: [{', '.join(f'w{k}.{joint}' for k in range(len(row['wheels'])))}]}}")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("row", ROWS, ids=lambda r: r["id"])
def test_row(row: dict[str, Any]) -> None:
    m = of_text(robot_file(row)).mobility
    found = [m.degree_of_mobility, m.degree_of_steerability, m.degree_of_maneuverability]
    assert found == row["degrees"]
    assert (m.ddof, m.dof, m.holonomic) == (row["ddof"], row["dof"], row["holonomic"])
    assert (m.rank_C1f.value, m.rank_C1.value) == (row["rank_C1f"], row["rank_C1"])
    assert m.omnidirectional == (row["ddof"] == 3)
    assert m.degenerate == (row["rank_C1f"] > 1)
    assert m.reasons


def test_every_row_is_there() -> None:
    assert len(ROWS) == 33
    assert sum(r["id"].startswith("S-T2.1") for r in ROWS) == 17
