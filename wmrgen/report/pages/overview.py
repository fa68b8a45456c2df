"""Write the overview of all robots in an output directory, with top view, type and costs of each.

``README.md`` is for GitHub and ``index.html`` for a browser. Both are made from model.json files; nothing is derived.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape as html_escape
from pathlib import Path
from typing import Any

from wmrgen.codegen.render import render
from wmrgen.derivation.manifest import PAGES
from wmrgen.report.sections.markdown import escape

_PICTURE = "layout.svg"
_FIGURES = ("symbols", "motion", "singular", "reach", "wiring")
_COUNTED = ("inverse", "forward", "odometry")


def overview(directory: Path) -> dict[str, bytes]:
    """Return both pages by file name; {} without robots."""
    models = [model for path in sorted(directory.glob("*/model.json")) if (model := _model(path))]
    if not models:
        return {}
    pages = {}
    for name, quoted in zip(PAGES, (escape, html_escape), strict=True):
        rows = [_row(model, quoted, directory) for model in models]
        pages[name] = render(f"html/{name}.j2", robots=rows).encode()
    return pages


def _model(path: Path) -> dict[str, Any]:
    """Return the model of a robot; {} if the file is not such a model."""
    try:
        model = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    whole = isinstance(model, dict) and model.get("name") == path.parent.name
    return model if whole and (path.parent / _PICTURE).is_file() else {}


def _row(model: Mapping[str, Any], quoted: Any, directory: Path) -> dict[str, Any]:
    """Return the contents of one row.

    Args:
        model: the contents of model.json.
        quoted: function that escapes text for the language of the page.
        directory: the output directory.

    Returns:
        The values that the template uses.
    """
    kind: Sequence[int] | None = model["robot_type"]
    holonomic = "holonomic" if model["holonomic"] else "nonholonomic"
    costs, folder = model["operations"], directory / model["name"]
    report = "report.html" if (folder / "report.html").is_file() else "report.md"
    figures = [f"{figure}.svg" for figure in _FIGURES if (folder / f"{figure}.svg").is_file()]
    return {
        "name": model["name"],
        "title": quoted(model["name"]),
        "about": quoted(model["description"] or "—"),
        "type": f"({kind[0]}, {kind[1]}), {holonomic}" if kind else "degenerate",
        "degrees": [model[f"degree_of_{name}"] for name in ("mobility", "steerability", "maneuverability")],
        "wheels": len(model["wheels"]),
        "costs": [sum(costs[name].values()) if name in costs else "—" for name in _COUNTED],
        "report": report,
        "figures": figures,
        "shown": f"{model['name']}/{report if report.endswith('html') else _PICTURE}",
        "picture": f"{model['name']}/{_PICTURE}",
    }
