"""Sensed rates that leave motions unseen: forward is the smallest least-squares twist, in every backend."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests.laws.common import derived
from tests.oracle import oracle
from tests.oracle.harness import twist_of
from wmrgen.cli.evaluate import computed
from wmrgen.geometry.exact.number import Exact

Layout = dict[str, Any]
STEERS = (0.0, 0.1, 0.7, math.pi / 2, -2.3, 11.65)
RATES = (0.4, -0.9)


def wheel(name: str, kind: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    return {"name": name, "type": kind, "x": x, "y": y, "heading": 0.0, "r": 0.1} | more


# (layout, rank of the measured rows at unequal steering)
UNSEEN: dict[str, tuple[list[dict[str, Any]], int]] = {
    "one castor, its swivel alone": ([wheel("a", "castor", 0.3, 0.1, d=-0.05, sensed=["steer"])], 1),
    "two castors abreast, their swivels alone": (
        [
            wheel("a", "castor", 0.3, 0.2, d=-0.05, sensed=["steer"]),
            wheel("b", "castor", 0.3, -0.2, d=-0.05, sensed=["steer"]),
        ],
        2,
    ),
    "two castors anywhere, their swivels alone": (
        [
            wheel("a", "castor", 0.3, 0.2, heading=0.1, d=-0.05, sensed=["steer"]),
            wheel("b", "castor", -0.31, -0.17, heading=0.4, d=-0.05, sensed=["steer"]),
        ],
        2,
    ),
    "a passive fixed wheel and a swivel": (
        [
            wheel("a", "castor", 0.31, 0.22, heading=0.4, d=-0.05, sensed=["steer"]),
            wheel("b", "fixed", -0.3, 0.1, heading=0.7, actuated=[]),
        ],
        2,
    ),
    "a steered wheel at P, its angle alone": (
        [wheel("a", "steered", 0.0, 0.0, heading=0.3, o=-0.023, sensed=["steer"])],
        1,
    ),
}


def cases(layout: Layout) -> list[dict[str, float]]:
    """Steering and swivel rates of both signs; equal and unequal angles."""
    names = [w["name"] for w in layout["wheels"] if w["type"] in ("castor", "steered")]
    found = []
    for steer in STEERS:
        for shift in (0.0, 0.9):
            case: dict[str, float] = {}
            for k, name in enumerate(names):
                case[f"{name}.steer"] = steer + shift * k
                case[f"{name}.steer_rate"] = RATES[k]
            found.append(case)
    return found


@pytest.mark.parametrize("backend, accuracy", [("exact", 1e-9), ("casadi", 1e-9), ("c", 1e-4)])
@pytest.mark.parametrize("name", UNSEEN)
def test_smallest_least_squares_twist(name: str, backend: str, accuracy: float) -> None:
    wheels, rank = UNSEEN[name]
    layout = {"wheels": wheels}
    derivation = derived(layout).derivation
    function = next(f for f in derivation.raw_module.functions if f.name == "forward")
    samples = cases(layout)
    inputs = [{p.name: Exact.of(Fraction(case[p.name])) for p in function.inputs} for case in samples]
    for case, result in zip(samples, computed(derivation, function, inputs, backend), strict=True):
        twist, residual, found = oracle.forward(layout, case)
        assert found <= rank
        rows, values = oracle.measured_rows(layout, case)
        singular = np.linalg.svd(rows, compute_uv=False)
        if singular[0] > 30 * singular[found - 1]:
            continue  # too near a lower rank for a comparison
        np.testing.assert_allclose(twist_of(result), twist, atol=accuracy * 30)
        assert result["slip"] == pytest.approx(residual, abs=accuracy * 30)
        assert np.linalg.norm(rows @ twist_of(result) - values) == pytest.approx(residual, abs=accuracy * 30)
