"""What is commanded can be driven, at any moment while steering swings: every wheel rolls and none slides.

The oracle is rigid-body kinematics: the contact of a wheel moves with the body and with its own swing, along the
wheel as fast as its rim and across it not at all.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.laws.common import NAMES, admissible, gallery
from tests.oracle import oracle
from tests.oracle.harness import named, twist_of
from tests.robots import of_gallery
from wmrgen.errors import NotDerivableError
from wmrgen.ir.interpret import FLOAT64, evaluate_module
from wmrgen.robot import Derivation

Case = dict[str, float]
DT, STEPS = 0.02, 40
STEERED = [name for name in NAMES if any(w["type"] == "steered" for w in gallery(name)[1]["wheels"])]
LIMITED = ("spin", "steer", "steer_rate")


def call(d: Derivation, function: str, values: Case) -> Case:
    """The function of these values, of which it takes those that it knows."""
    known = {p.name for p in d.formula(function).inputs}
    return evaluate_module(d.module, function, {k: v for k, v in values.items() if k in known}, FLOAT64)


def commanded(d: Derivation, twist: Case, now: Case) -> Case:
    """`inverse` and, of robots that have it, `steer_toward`."""
    asked = call(d, "inverse", twist | now)
    asked |= {w.name + ".steer_rate": 0.0 for w in d.robot.wheels if w.kind.steers}
    if "steer_toward" not in {f.name for f in d.module.functions}:
        return asked
    wanted = {f"{name}_wanted": value for name, value in asked.items()}
    return asked | call(d, "steer_toward", now | wanted | {"dt": DT})


def check(d: Derivation, layout: dict[str, Any], twist: Any, commands: Case) -> None:
    """No wheel slides at ``twist``, `forward` finds it, and joints keep their limits."""
    for w in layout["wheels"]:
        spin, steer, rate = (commands.get(f"{w['name']}.{joint}", 0.0) for joint in LIMITED)
        for kind, row, per_spin, per_rate in oracle.wheel_rows(w, steer):
            if w["type"] != "castor":
                assert row @ twist + per_spin * spin + per_rate * rate == pytest.approx(0.0, abs=1e-9), kind
    found = call(d, "forward", commands)
    assert found["slip"] == pytest.approx(0.0, abs=1e-9)
    if (
        oracle.forward(layout, {p.name: commands.get(p.name, 0.0) for p in d.formula("forward").inputs})[2]
        == 3
    ):
        np.testing.assert_allclose(twist_of(found), twist, atol=1e-9)
    for wheel in d.robot.wheels:
        for joint in LIMITED:
            if (limit := d.robot.limit(wheel, joint)) and f"{wheel.name}.{joint}" in commands:
                value = commands[f"{wheel.name}.{joint}"]
                assert float(limit.low) - 1e-12 <= value <= float(limit.high) + 1e-12


def derived(name: str) -> Derivation:
    try:
        d = of_gallery(name, "inverse", "forward", "steer_toward")
        _ = d.module
    except NotDerivableError:
        d = of_gallery(name, "inverse", "forward")
    return d


@pytest.mark.parametrize("name", STEERED)
def test_a_twist_that_turns_is_driven_while_it_turns(name: str) -> None:
    """Slowly enough for the limits of steering, which `limit_twist` and the rates of a twist are about."""
    d, layout = derived(name), gallery(name)[1]
    straight = np.linalg.pinv(oracle.null(oracle.sliding_rows(layout, "fixed", {}))) @ (0.4, 0.0, 0.0)
    bend = np.linalg.pinv(oracle.null(oracle.sliding_rows(layout, "fixed", {}))) @ (0.0, 0.1, 0.1)
    now = {f"{w['name']}.steer": 0.0 for w in layout["wheels"] if w["type"] in oracle.STEERABLE}
    commands = now
    for k in range(STEPS):
        twist = admissible(layout, straight + bend * math.sin(1.5 * k * DT))
        commands = commanded(d, named(twist), now)
        if k:  # the first step swings to where the motion begins
            check(d, layout, twist, commands)
        now |= {name: value for name, value in commands.items() if name in now}
