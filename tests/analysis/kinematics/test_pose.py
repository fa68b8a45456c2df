"""The posture model of robots whose castors are coupled: their angles are states, turned by the motion itself."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest

from tests.analysis.mobility.test_couplings import AXLE, CASTORS, wheel
from tests.laws.common import derived

COUPLED: dict[str, tuple[list[dict[str, Any]], tuple[str, list[str]]]] = {
    "spins of castors": (CASTORS, ("spin", ["a", "b"])),
    "angles of castors": ([CASTORS[0] | {"d": -0.05}, *CASTORS[1:]], ("steer", ["a", "b"])),
    "a castor and a wheel": (
        [*AXLE[:1], wheel("k", "castor", -0.3, 0.1, d=-0.04, actuated=["spin"])],
        ("spin", ["a", "k"]),
    ),
}


@pytest.mark.parametrize("name", COUPLED)
def test_castors_turn_as_inverse_says_and_couplings_hold(name: str) -> None:
    wheels, (joint, pair) = COUPLED[name]
    model = derived({"wheels": wheels, "couplings": [(joint, pair)]})
    inputs, outputs = model.ports("dynamics")
    turned = [port for port in outputs if port.endswith(".steer_rate")]
    assert turned and all(port.removesuffix("_rate") in inputs for port in turned)
    chance = random.Random(9)
    for _ in range(4):
        state = {port: chance.uniform(-0.8, 0.8) for port in inputs}
        rates = model.call("dynamics", state)
        c, s = math.cos(state["theta"]), math.sin(state["theta"])
        vx, vy, omega = (rates[f"{k}_rate"] for k in ("x", "y", "theta"))
        twist = {"vx": c * vx + s * vy, "vy": c * vy - s * vx, "omega": omega}
        angles = {port: state.get(port, 0.0) for port in model.ports("inverse")[0] if port.endswith(".steer")}
        if joint == "steer":  # the second is no state of its own
            angles[f"{pair[1]}.steer"] = state[f"{pair[0]}.steer"]
        joints = model.call("inverse", twist | angles)
        for port in turned:
            assert rates[port] == pytest.approx(joints[port], abs=1e-9)
        suffix = "steer_rate" if joint == "steer" else "spin"
        first, second = (joints[f"{n}.{suffix}"] for n in pair)
        assert first == pytest.approx(second, abs=1e-9) and joints["slip"] == pytest.approx(0, abs=1e-9)
