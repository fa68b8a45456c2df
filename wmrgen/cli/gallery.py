"""``wmrgen list``: the robots that come with wmrgen, which a robot file may begin as."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import wmrgen
from wmrgen.cli import console
from wmrgen.shipped import shipped


def gallery() -> dict[str, Path]:
    """Name -> robot file, in the order of names."""
    return {path.stem: path for path in sorted(shipped("robots").glob("*.yaml"))}


def list_robots(as_json: bool) -> int:
    """Print name, degrees and description of every robot of the gallery."""
    rows = [_row(path) for path in gallery().values()]
    if as_json:
        console.data({"robots": rows})
        return 0
    width = max(len(row["name"]) for row in rows)
    for row in rows:
        degrees = f"({row['degree_of_mobility']}, {row['degree_of_steerability']})"
        degenerate = ", degenerate" if row["degenerate"] else ""
        console.result(f"{row['name']:<{width}}  {degrees}  {row['description']}{degenerate}")
    console.note(
        "Degrees are (mobility, steerability). `wmrgen new MY_ROBOT --from NAME` begins as one of them."
    )
    return 0


def _row(path: Path) -> dict[str, Any]:
    robot = wmrgen.load(path)
    m = wmrgen.derive(robot).mobility
    return {
        "name": robot.name,
        "degree_of_mobility": m.degree_of_mobility,
        "degree_of_steerability": m.degree_of_steerability,
        "degree_of_maneuverability": m.degree_of_maneuverability,
        "degenerate": m.robot_type is None,
        "description": robot.description,
    }
