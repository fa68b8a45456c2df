"""`setpoint`: what it cannot keep is refused, and without time nothing changes. Its laws are in tests/laws."""

from __future__ import annotations

import pytest

from tests.functions.control.corners import FLOAT32, SWERVE, call, derived, robot_text
from tests.functions.refusals import refused
from wmrgen.functions.registry import Reason

LIMITS = "limits: {spin_rate: 60, steer_rate: 8}"
CASTOR = "  - {name: a, type: castor, x: X, y: 0, heading: 0, d: 0.05, r: 0.1, actuated: [spin, steer]}"


@pytest.mark.parametrize(
    ("wheels", "lines", "reason", "names"),
    [
        (SWERVE, (), Reason.NO_LIMIT, ("spin_rate: 60",)),
        (SWERVE, ("limits: {spin_rate: [0, 60]}",), Reason.ONE_SIDED_LIMIT, ("fl.spin_rate",)),
        (SWERVE, ("limits: {steer_rate: 8, steer: 92 deg}",), Reason.STEERING_STOPS, ("fl", "190 deg")),
        (SWERVE, ("limits: {steer_rate: 8, steer: 60 deg}",), Reason.STEERING_STOPS, ("fl", "190 deg")),
        (
            SWERVE,
            (LIMITS, "couplings: [{equal: [fl.steer, br.steer]}]"),
            Reason.SHARED_MOTOR,
            ("fl", "br", "steering"),
        ),
        (
            SWERVE,
            (LIMITS, "couplings: [{equal: [fl.spin, br.spin]}]"),
            Reason.SHARED_MOTOR,
            ("fl", "br", "spin"),
        ),
        (
            "\n".join(
                CASTOR.replace("a,", f"{n},").replace("X", x) for n, x in (("a", "0.2"), ("b", "-0.2"))
            ),
            ("limits: {spin_rate: 60}",),
            Reason.CASTOR,
            ("a",),
        ),
    ],
)
def test_what_it_cannot_keep_is_named(
    wheels: str, lines: tuple[str, ...], reason: Reason, names: tuple[str, ...]
) -> None:
    with refused(reason, *names):
        _ = derived(robot_text(wheels, *lines), "setpoint").program


@pytest.mark.parametrize("dt", [0.0, -0.0, -1.0])
def test_without_time_the_twist_is_held(dt: float) -> None:
    d, last = derived(robot_text(SWERVE, LIMITS), "setpoint"), {"vx": 0.5, "vy": -0.0, "omega": 1.0}
    values = last | {"vx_wanted": 1.0, "vy_wanted": 2.0, "omega_wanted": -3.0, "dt": dt}
    values |= {p.name: 0.0 for p in d.formula("setpoint").inputs if p.name.endswith("steer")}
    assert call(d, "setpoint", values, FLOAT32) == last
