"""Weighted least squares over sensed rows, in plain numpy; layouts that try every way in which `forward` solves them.

Wheels have a ``weight`` beside the keys of `tests.oracle.oracle`; the largest of a measuring wheel counts as 1. A
layout may have a ``gyro`` of this weight, the row [0 0 1]: 1 is a wheel at the mean square distance of those that
measure from their middle.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle import oracle

Array = NDArray[np.float64]
Layout = dict[str, Any]
WEIGHTS = (0.25, 3.0, 1.0, 0.0625, 40.0)


def layout(*wheels: dict[str, Any]) -> Layout:
    """Wheels w0, w1, … with heading 0, radius 0.05 m and the weights of `WEIGHTS`, unless they say otherwise."""
    named = [
        {"name": f"w{i}", "heading": 0.0, "r": 0.05, "weight": WEIGHTS[i]} | w for i, w in enumerate(wheels)
    ]
    return {"wheels": named, "couplings": []}


def _castor(x: float, y: float, d: float = 0.03, o: float = 0.01) -> dict[str, Any]:
    return {"type": "castor", "x": x, "y": y, "d": d, "o": o, "actuated": ["spin", "steer"]}


_DRIVEN = [{"type": "fixed", "x": 0.0, "y": y, "heading": 0.0} for y in (0.2, -0.15)]
_CORNERS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
LAYOUTS = {
    "differential": layout(*_DRIVEN),
    "load wheel": layout(*_DRIVEN, {"type": "fixed", "x": 0.1, "y": 0.4, "sensed": ["spin"], "actuated": []}),
    "swerve": layout(*({"type": "steered", "x": x, "y": y + 0.2 * x} for x, y in _CORNERS)),
    "mecanum": layout(*({"type": "swedish", "x": x, "y": y, "gamma": 0.8 * x * y} for x, y in _CORNERS)),
    "wide castors": layout(_castor(0.4, 0.3), _castor(0.4, -0.3), _castor(-0.5, 0)),
    "narrow castors": layout(_castor(0.05, 0, 0.1), _castor(-0.05, 0.02, 0.1)),
    "one castor": layout(_castor(0.05, 0, 0.1)),
    "mixed": layout(*_DRIVEN, _castor(0.5, 0), {"type": "swedish", "x": 0.3, "y": -0.3, "gamma": 0.7}),
    "bicycle": layout(_DRIVEN[0], {"type": "steered", "x": 1.0, "y": 0.0, "sensed": ["steer"]}),
    "offset": layout(
        {"type": "steered", "x": 0.4, "y": 0.1, "o": 0.05},
        {"type": "castor", "x": -0.3, "y": 0.1, "d": 0.05, "sensed": ["steer"], "actuated": []},
        _DRIVEN[0],
    ),
}


def rows(robot: Layout, sensed: dict[str, float]) -> tuple[Array, Array, Array]:
    """H [n, 3], z [n] and weights [n] of every sensed row, wheel by wheel."""
    parts = [(oracle.measured_rows({"wheels": [w]}, sensed), w.get("weight", 1.0)) for w in robot["wheels"]]
    weights = np.concatenate([np.full(len(h), weight) for (h, _), weight in parts])
    h, z = np.vstack([h for (h, _), _ in parts]), np.concatenate([z for (_, z), _ in parts])
    weights = weights / weights.max() if len(weights) else weights
    if "gyro" not in robot:
        return h, z, weights
    measuring = [w for w, (part, _) in zip(robot["wheels"], parts, strict=True) if len(part[0])]
    places, offsets = ([[w.get(k, 0.0) for k in keys] for w in measuring] for keys in ("xy", "do"))
    spread = float(np.var(places, axis=0).sum() + np.mean(np.square(offsets), axis=0).sum())
    weight = robot["gyro"] * (spread or 1.0)
    return np.vstack([h, [0.0, 0.0, 1.0]]), np.append(z, sensed["gyro"]), np.append(weights, weight)


def forward(robot: Layout, sensed: dict[str, float]) -> tuple[Array, float]:
    """Twist and weighted residual."""
    h, z, weights = rows(robot, sensed)
    if not len(h):
        return np.zeros(3), 0.0
    sizes = np.sqrt(weights)
    twist = np.linalg.lstsq(sizes[:, None] * h, sizes * z, rcond=1e-9)[0]
    return twist, math.sqrt(float(weights @ (h @ twist - z) ** 2))
