"""Odometry over many steps in float: increments to be added in double."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest

from wmrgen import derive, load
from wmrgen.exact.number import Exact
from wmrgen.ir.interpret import FLOAT32, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Module
from wmrgen.ir.rounding import nearest_float32

UNICYCLE = Path(__file__).resolve().parents[3] / "robots" / "unicycle.yaml"
POSE, TWIST = ("x", "y", "theta"), ("vx", "vy", "omega")


def printed(*names: str) -> Module:
    """The operations of the C."""
    return expand(derive(load(UNICYCLE), names).c_module, DEFAULT.scalar, DEFAULT.math, DEFAULT.target)


def test_increments_are_what_odometry_adds() -> None:
    d = derive(load(UNICYCLE), ["odometry", "odometry_increment"])
    source = random.Random(1)
    for _ in range(20):
        case = {n: Exact(source.randint(-999, 999)) / 1000 for n in (*POSE, *TWIST, "dt")}
        after = d.evaluate("odometry", case)
        step = d.evaluate("odometry_increment", {n: case[n] for n in ("theta", *TWIST, "dt")})
        assert {n: after[n] - case[n] for n in POSE} == {n: step[f"{n}_step"] for n in POSE}


@pytest.mark.parametrize(("speed", "rate"), [(0.003, 0.0), (0.003, 0.001), (0.2, 1.0)])
def test_increments_added_in_double(speed: float, rate: float) -> None:
    """A thousand steps 100 m out: the pose is that of one long arc, where `odometry` in float stands or drifts."""
    module = printed("odometry", "odometry_increment")
    twist = {
        "vx": nearest_float32(speed),
        "vy": 0.0,
        "omega": nearest_float32(rate),
        "dt": nearest_float32(0.001),
    }
    start = {"x": 100.0, "y": -100.0, "theta": 0.5}
    plain, pose = dict(start), dict(start)
    for _ in range(1000):
        plain = evaluate_module(module, "odometry", plain | twist, FLOAT32)
        theta = nearest_float32(math.remainder(pose["theta"], math.tau))
        step = evaluate_module(module, "odometry_increment", {"theta": theta} | twist, FLOAT32)
        pose = {n: v + step[f"{n}_step"] for n, v in pose.items()}
    d = derive(load(UNICYCLE), ["odometry"])
    arc = twist | {"dt": 1000 * twist["dt"]}
    true = d.evaluate("odometry", {n: _exact(v) for n, v in (start | arc).items()})
    for n in POSE:
        assert pose[n] == pytest.approx(float(true[n]), abs=1e-6 * max(speed, rate))
    lost = max(abs(plain[n] - float(true[n])) for n in POSE)
    assert lost > 100 * max(abs(pose[n] - float(true[n])) for n in POSE)


def _exact(value: float) -> Exact:
    numerator, denominator = value.as_integer_ratio()
    return Exact(numerator) / denominator
