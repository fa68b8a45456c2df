"""``wmrgen list``: the robots that come with wmrgen, which a robot file may begin as.

``wmrgen gallery``: pages of those that are derived.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import wmrgen
from wmrgen.cli import console
from wmrgen.derivation.artifacts import Difference, file_difference, write_file
from wmrgen.errors import UsageError
from wmrgen.robotfile.shipped import shipped


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


def write_gallery(out: Path, as_json: bool) -> int:
    """Write the pages of all robots under ``out``, and say so."""
    from wmrgen.report.pages.overview import overview

    pages = overview(out)
    if not pages:
        raise UsageError(
            f"no robot stands in {out.as_posix()}/. Derive some into it: wmrgen derive ROBOT.yaml -o DIR"
        )
    changed = [name for name, content in pages.items() if write_file(out / name, content)]
    if as_json:
        console.data({"changed": changed, "unchanged": [name for name in pages if name not in changed]})
        return 0
    for name in pages:
        console.result(f"{(out / name).as_posix()} ({'new or changed' if name in changed else 'up to date'})")
    return 0


def differing_gallery(out: Path) -> list[Difference]:
    """Which pages are not as `write_gallery` would leave them; nothing is asked of a directory that has none."""
    from wmrgen.report.pages.overview import PAGES, overview

    if not any((out / name).exists() for name in PAGES):
        return []
    return [d for name, content in overview(out).items() for d in file_difference(out / name, content)]
