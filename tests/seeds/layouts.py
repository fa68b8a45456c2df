"""From a layout of cases.json to the oracle's layout and to robot file text."""

from __future__ import annotations

from typing import Any

Case = dict[str, Any]
STYLES = ("cartesian", "polar")


def of(case: Case, style: str) -> tuple[dict[str, Any], dict[str, float]]:
    """Layout and the steering angles (by wheel name) that put it where the case is evaluated.

    In the cartesian style steered and castor wheels have their zero along x and the case's heading is their
    steering angle; in the polar style the zero is the case's heading.
    """
    wheels, steer = [], {}
    for w in case["layout"]["wheels"]:
        wheel = {
            "name": w["name"],
            "type": w["type"],
            "x": w["x"],
            "y": w["y"],
            "heading": w["heading"],
            "r": w["r"],
        }
        wheel |= {"gamma": w.get("gamma", 0.0), "d": w.get("d", 0.0), "o": w.get("offset_y", 0.0)}
        wheel["r_sw"] = w.get("r_sw") or w.get("r_roller")
        if w["type"] == "castor" and w.get("powered", True):
            wheel["actuated"] = ["spin", "steer"]
        if w["type"] in ("steered", "castor") and style == "cartesian":
            wheel["heading"], steer[w["name"]] = 0.0, w["heading"]
        wheels.append(wheel)
    return {"wheels": wheels, "couplings": _couplings(case)}, steer


def _couplings(case: Case) -> list[tuple[str, list[str]]]:
    names = [w["name"] for w in case["layout"]["wheels"]]
    found = []
    for entry in case["layout"].get("coupling") or []:
        members = [names[i] for i in entry["wheels"]]
        found += [("steer", members), ("spin", members)]
    return found
