"""A robot's model for a solver: x' = f(x, u, p), with the names and bounds of all entries."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import inf
from pathlib import Path

import casadi as ca

ROOT = Path(__file__).resolve().parents[1]
Bounds = dict[str, tuple[float, float]]  # low and high by name, in the order of the vector


@dataclass(frozen=True)
class Model:
    """``ode``: (x, u, p) -> xdot, with the nominal ``p``; ``rolling``: (x, u, p) -> what must be 0 [m/s], if any."""

    ode: ca.Function
    state: Bounds
    inputs: Bounds
    p: tuple[float, ...] = ()
    rolling: ca.Function | None = None


def generated(robot: str) -> Model:
    """The model of a robot as it is checked in. It is read without wmrgen."""
    folder = ROOT / "generated" / robot
    space = json.loads((folder / "model.json").read_text(encoding="utf-8"))["state_space"]
    rolling = folder / f"{robot}_rolling.casadi"
    return Model(
        ca.Function.load(str(folder / f"{robot}_ode.casadi")),
        _bounds(space["x"]),
        _bounds(space["u"]),
        tuple(entry["nominal"] for entry in space["p"]),
        ca.Function.load(str(rolling)) if space["constraints"] else None,
    )


def _bounds(entries: list[dict[str, float | None]]) -> Bounds:
    """null is no bound."""
    return {
        str(e["name"]): (
            -inf if e["lower"] is None else e["lower"],
            inf if e["upper"] is None else e["upper"],
        )
        for e in entries
    }
