"""Pages of all robots that stand in an output directory, each with its top view, type and costs: ``README.md`` for
GitHub and ``index.html`` for a browser. They are made of the model.json of each, and derive nothing."""

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
    """Name -> content of both pages. Without robots there is none."""
    models = [model for path in sorted(directory.glob("*/model.json")) if (model := _model(path))]
    if not models:
        return {}
    texts = (
        render(f"html/{name}.j2", robots=[_row(model, how, directory) for model in models])
        for name, how in zip(PAGES, (escape, html_escape), strict=True)
    )
    return dict(zip(PAGES, (text.encode() for text in texts), strict=True))


def _model(path: Path) -> dict[str, Any]:
    """The model of a robot, nothing of what is none."""
    try:
        model = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    whole = isinstance(model, dict) and model.get("name") == path.parent.name
    return model if whole and (path.parent / _PICTURE).is_file() else {}


def _row(model: Mapping[str, Any], quoted: Any, directory: Path) -> dict[str, Any]:
    """What the pages show of a robot, texts ``quoted`` for their language."""
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
