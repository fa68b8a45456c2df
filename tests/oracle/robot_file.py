"""A second, small reader of robot files for the oracle: PyYAML and floats, no code of wmrgen.

Reads only what the gallery uses; a file that wmrgen accepts may be beyond it.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import yaml

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "deg": math.pi / 180, "rad": 1.0}
GREEK = {"α": "alpha", "β": "beta", "γ": "gamma"}
NAMES = {
    "pi": math.pi,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "atan2": math.atan2,
}


def value(text: str, names: dict[str, float], scale: float = 1.0) -> float:
    """A number, a number with a unit, or an expression over ``names``. ``scale`` applies to bare numbers."""
    found = re.fullmatch(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([a-z]*)", text.strip())
    if found:
        return float(found[1]) * (UNITS[found[2]] if found[2] else scale)
    return float(eval(text, {"__builtins__": {}}, NAMES | names))  # only this project's own gallery files


def snapped(angle: float) -> float:
    """The multiple of pi/12 within 1e-3 rad, else the angle."""
    near = round(angle / (math.pi / 12)) * math.pi / 12
    return near if abs(near - angle) < 1e-3 else angle


def read(path: Path) -> dict[str, Any]:
    """The layout of a robot file, as `oracle.py` wants it."""
    data = yaml.load(path.read_text(encoding="utf-8"), Loader=yaml.BaseLoader)
    names: dict[str, float] = {}
    for name, entry in data.get("parameters", {}).items():
        names[name] = value(entry["value"] if isinstance(entry, dict) else entry, names)
    scale = math.pi / 180 if data.get("angles") == "deg" else 1.0
    couplings = [
        (entry["equal"][0].split(".")[1], [item.split(".")[0] for item in entry["equal"]])
        for entry in data.get("couplings", [])
    ]
    wheels = [w for entry in data["wheels"] for w in drives(entry, names, scale)]
    return {"name": data["name"], "wheels": wheels, "couplings": couplings}


def drives(entry: dict[str, Any], names: dict[str, float], scale: float) -> list[dict[str, Any]]:
    """The wheel, or a record for each direction in which a ball is driven."""
    directions = entry.get("driven", [])
    records = [wheel(entry | {"heading": d}, names, scale) | {"driven": True} for d in directions]
    if len(records) > 1:
        records = [w | {"name": f"{w['name']}_{k + 1}"} for k, w in enumerate(records)]
    return records or [wheel(entry, names, scale)]


def wheel(entry: dict[str, Any], names: dict[str, float], scale: float) -> dict[str, Any]:
    """One wheel: Cartesian pivot and heading at steering zero."""
    raw = {GREEK.get(key, key): text for key, text in entry.items()}
    length = {k: value(raw[k], names) for k in ("x", "y", "l", "r", "d", "offset_y") if k in raw}
    angle = {
        k: snapped(value(raw[k], names, scale)) for k in ("alpha", "beta", "heading", "gamma") if k in raw
    }
    if "l" in length:
        x, y = length["l"] * math.cos(angle["alpha"]), length["l"] * math.sin(angle["alpha"])
    else:
        x, y = length["x"], length["y"]
    alpha = angle.get("alpha", math.atan2(y, x))
    heading = (
        angle["heading"]
        if "heading" in angle
        else angle.get("beta", math.pi / 2 - alpha) + alpha - math.pi / 2
    )
    return {
        "name": raw["name"], "type": raw["type"], "x": x, "y": y, "heading": snapped(heading), "r": length["r"],
        "gamma": angle.get("gamma", 0.0), "d": length.get("d", 0.0), "o": length.get("offset_y", 0.0),
    }  # fmt: skip
