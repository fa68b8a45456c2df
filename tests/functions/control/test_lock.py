"""`lock`: the robot can neither move nor turn. `inverse_about`: the twist of a point is driven."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from tests.functions.control.corners import CORNERS, SWERVE, call, derived, robot_text
from tests.functions.refusals import refused
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason

TUNABLE = "parameters: {a: {value: 0.3, tunable: true}}"
THREE = SWERVE.replace("x: 0.3, y: 0.25,", "x: a, y: 0.1,").rsplit("\n", 1)[0]


def robots() -> list[Derivation]:
    texts = [
        robot_text(SWERVE),
        robot_text(SWERVE, "limits: {steer: [-80 deg, 110 deg]}"),
        robot_text(THREE, TUNABLE),
    ]
    return [derived(text, "lock", "inverse_about") for text in texts]


@pytest.mark.parametrize("which", range(3))
def test_no_motion_is_left_and_no_wheel_swings_further_than_it_must(which: int) -> None:
    d, source = robots()[which], random.Random(which)
    wheels = d.robot.wheels
    for _ in range(20):
        now = {f"{w.name}.steer": source.uniform(-1.3, 1.3) for w in wheels}
        values = {p.name: now.get(p.name, 0.3) for p in d.formula("lock").inputs}
        locked = call(d, "lock", values)
        normals = [1j * np.exp(1j * (w.heading + locked[f"{w.name}.steer"])) for w in wheels]
        rows = [
            (n.real, n.imag, (w.pivot.conjugate() * n).imag) for w, n in zip(wheels, normals, strict=True)
        ]
        assert np.linalg.svd(np.array(rows))[1].min() > 0.05
        for w in wheels:
            steer, limit = locked[f"{w.name}.steer"], d.robot.limit(w, "steer")
            assert locked[f"{w.name}.spin"] == 0.0
            swing = abs(steer - now[f"{w.name}.steer"])
            outside = limit and not all(
                float(limit.low) <= steer + k <= float(limit.high) for k in (math.pi, -math.pi)
            )
            assert swing <= math.pi / 2 + 1e-9 or outside
            assert limit is None or float(limit.low) <= steer <= float(limit.high)


@pytest.mark.parametrize(
    ("wheels", "lines", "reason", "names"),
    [
        ("\n".join(SWERVE.split("\n")[::3]), (), Reason.WHEELS_ON_ONE_LINE, ()),
        (SWERVE, ("limits: {steer: 30 deg}",), Reason.STEERING_STOPS, ("fl",)),
        (SWERVE, ("couplings: [{equal: [fl.steer, br.steer]}]",), Reason.SHARED_MOTOR, ("fl", "br")),
        ("  - {name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}", (), Reason.NOT_STEERED, ()),
    ],
)
def test_what_cannot_be_locked_is_named(
    wheels: str, lines: tuple[str, ...], reason: Reason, names: tuple[str, ...]
) -> None:
    with refused(reason, *names):
        _ = derived(robot_text(wheels, *lines), "lock").program


def test_it_turns_about_the_centre() -> None:
    """The centre moves as it is told: at its place the body that `forward` finds has the wanted velocity."""
    d, source = robots()[0], random.Random(5)
    for _ in range(20):
        vx, vy, omega, x, y = (source.uniform(-1, 1) for _ in range(5))
        values = {"vx": vx, "vy": vy, "omega": omega, "centre_x": x, "centre_y": y}
        commands = call(d, "inverse_about", values | {f"{n}.steer": 0.0 for n in CORNERS})
        found = call(d, "forward", {k: v for k, v in commands.items() if k != "slip"})
        at = (found["vx"] - found["omega"] * y, found["vy"] + found["omega"] * x, found["omega"])
        assert at == pytest.approx((vx, vy, omega), abs=1e-9)
