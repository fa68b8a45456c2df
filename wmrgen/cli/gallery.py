"""``wmrgen list``: the robots that come with wmrgen, which a robot file may begin as.

``wmrgen gallery``: pages of those that are derived.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import wmrgen
from wmrgen.cli import console
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import Difference, file_difference, write_tree
from wmrgen.derivation.manifest import PAGES, sha256
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
    """Write the pages of all robots in ``out``, and print what changed."""
    comparable = freshness.can_compare()
    from wmrgen.report.pages.overview import overview

    pages = overview(out)
    if not pages:
        raise UsageError(
            f"there is no robot in {out.as_posix()}/. Derive some into it: wmrgen derive ROBOT.yaml -o DIR"
        )
    changed = write_tree(out, pages, None, _inputs(out) if comparable else None).changed
    if as_json:
        unchanged = [name for name in pages if name not in changed]
        console.data({"changed": [name for name in pages if name in changed], "unchanged": unchanged})
        return 0
    for name in pages:
        console.result(f"{(out / name).as_posix()} ({'new or changed' if name in changed else 'up to date'})")
    return 0


def differing_gallery(out: Path, comparable: bool) -> list[Difference]:
    """Return which pages are out of date; none if ``out`` has no pages.

    Args:
        out: The output directory.
        comparable: Whether pages are taken as fresh by their manifest, see `freshness.can_compare`.

    Returns:
        The pages.
    """
    if not any((out / name).exists() for name in PAGES):
        return []
    manifest = freshness.fresh(out, _inputs(out)) if comparable else None
    if manifest and set(manifest.files) == set(PAGES):
        return []
    from wmrgen.report.pages.overview import overview

    found = []
    for name, content in overview(out).items():
        found += file_difference(out / name, content)
    return found


def _inputs(out: Path) -> dict[str, str]:
    """Return what the pages are made from: the model of each robot, and which pictures it has."""
    inputs = freshness.inputs()
    if not inputs:
        return {}
    robots = []
    for path in sorted(out.glob("*/model.json")):
        pictures = sorted(p.name for p in path.parent.iterdir() if p.suffix in (".svg", ".html"))
        robots.append(f"{path.parent.name} {sha256(path.read_bytes())} {' '.join(pictures)}")
    return {**inputs, "robots": sha256("\n".join(robots).encode())}
