"""Every robot of the gallery: its configuration model and its inverse kinematics say the same."""

from __future__ import annotations

import numpy as np
import pytest

from tests.functions.models.robots import call
from tests.robots import ROBOTS, of_gallery

# No drive for every freedom: the models use eta and say what is missing.
UNDERACTUATED = {"office_chair", "textbook_omni_steer", "unicycle"}


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_that_moves_has_a_posture_model(name: str) -> None:
    """Siegwart 3.4: xi' = R(theta)^T Sigma(beta) u, in driven speeds where every freedom is driven, else in eta."""
    d = of_gallery(name)
    system = d.system("posture")
    assert len(system.inputs) == len(system.fields) >= d.mobility.degree_of_mobility
    in_eta = {f"eta{k + 1}" for k in range(d.mobility.degree_of_mobility)} <= {u.name for u in system.inputs}
    assert in_eta == (name in UNDERACTUATED)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_twist_of_the_model_asks_for_its_own_wheel_speeds(name: str) -> None:
    """At rest steering, theta = 0: the rates of the pose are the twist, and no wheel has to slide."""
    d = of_gallery(name)
    system = d.system("configuration")
    random = np.random.default_rng(3)
    values = {q.name: float(random.uniform(0.1, 0.5)) for q in (*system.state, *system.inputs)}
    coordinates = {f"{n}.steer" for n in d.mobility.basis_wheels} | {
        f"{v.name}.steer" for v in d.robot.virtual
    }
    values |= {u.name: 0.0 for u in system.inputs if u.name.removesuffix("_rate") in coordinates}
    values |= {q.name: 0.0 for q in system.state[:3]}
    rates = call(d, "configuration", values)
    twist = dict(zip(("vx", "vy", "omega"), (rates[f"{k}_rate"] for k in ("x", "y", "theta")), strict=True))
    turning = {f"{w.name}.steer": values.get(f"{w.name}.steer", 0.0) for w in d.robot.wheels if w.turns}
    wanted = call(d, "inverse", twist | turning)
    assert wanted["slip"] == pytest.approx(0.0, abs=1e-9) or d.mobility.degenerate
    for w in d.robot.wheels:
        if f"{w.name}.spin" in rates and not d.mobility.degenerate:
            assert abs(rates[f"{w.name}.spin"]) == pytest.approx(abs(wanted[f"{w.name}.spin"]), abs=1e-9)
        if w.type == "castor":
            assert rates[f"{w.name}.steer_rate"] == pytest.approx(wanted[f"{w.name}.steer_rate"], abs=1e-9)
