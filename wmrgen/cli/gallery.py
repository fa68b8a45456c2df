"""``wmrgen list`` prints the robots that come with wmrgen; ``wmrgen gallery`` writes pages of derived robots."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Out, verb
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import Difference, file_difference, write_tree
from wmrgen.derivation.manifest import PAGES, sha256
from wmrgen.errors import UsageError
from wmrgen.robotfile.shipped import shipped

TEXTS = "texts"  # the folder of the second gallery, beside the robot files
TABLE = "gallery.json"  # beside the robot files; `make generate` writes it


def gallery() -> dict[str, Path]:
    """Return the robot files that come with wmrgen, by name of the robot."""
    return {path.stem: path for path in sorted(shipped("robots").glob("*.yaml"))}


def robots_of_texts() -> dict[str, Path]:
    """Return the layouts of the textbooks, by name of the robot: the second gallery."""
    return {path.stem: path for path in sorted((shipped("robots") / TEXTS).glob("*.yaml"))}


def shipped_robots() -> dict[str, Path]:
    """Return the robot files of both galleries, by name of the robot."""
    return gallery() | robots_of_texts()


@verb("list")
def list_robots(as_json: Json = False) -> int:
    """Example:  wmrgen list

    List the robots that come with wmrgen: name, type (mobility, steerability) and description.
    """
    table = json.loads((shipped("robots") / TABLE).read_bytes())
    rows = table["robots"]
    if as_json:
        console.data(table)
        return 0
    width = max(len(row["name"]) for row in rows)
    for row in rows:
        degrees = f"({row['degree_of_mobility']}, {row['degree_of_steerability']})"
        degenerate = ", degenerate" if row["degenerate"] else ""
        console.result(f"{row['name']:<{width}}  {degrees}  {row['description']}{degenerate}")
    console.note(
        "Degrees are (mobility, steerability). `wmrgen new MY_ROBOT --from NAME` starts from a robot. "
        '`wmrgen textbook --find "Table 2.1"` leads to layouts of textbooks.'
    )
    return 0


def table_of_robots() -> dict[str, Any]:
    """Derive every robot that comes with wmrgen, and return the content of the table that `list_robots` prints."""
    import wmrgen

    rows = []
    for path in gallery().values():
        robot = wmrgen.load(path)
        mobility = wmrgen.derive(robot).mobility
        rows.append(
            {
                "name": robot.name,
                "degree_of_mobility": mobility.degree_of_mobility,
                "degree_of_steerability": mobility.degree_of_steerability,
                "degree_of_maneuverability": mobility.degree_of_maneuverability,
                "degenerate": mobility.robot_type is None,
                "description": robot.description,
            }
        )
    return {"robots": rows}


@verb("gallery")
def write_gallery(out: Out = Path("generated"), as_json: Json = False) -> int:
    """Example:  wmrgen gallery -o generated

    Write DIR/README.md and DIR/index.html: the robots in DIR with top view, type, degrees and operations.
    `wmrgen check` reports pages that are out of date.
    """
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
