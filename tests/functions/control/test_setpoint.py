"""`setpoint`: what it cannot keep is refused, and without time nothing changes. Its laws are in tests/laws."""

from __future__ import annotations

import pytest

from tests.functions.control.corners import FLOAT32, SWERVE, call, derived, robot_text
from wmrgen.errors import NotDerivableError

LIMITS = "limits: {spin_rate: 60, steer_rate: 8}"
CASTOR = "  - {name: a, type: castor, x: X, y: 0, heading: 0, d: 0.05, r: 0.1, actuated: [spin, steer]}"


@pytest.mark.parametrize(
    ("wheels", "lines", "why"),
    [
        (SWERVE, (), r"no limits of acceleration; write limits: \{spin_rate: 60\}"),
        (SWERVE, ("limits: {spin_rate: [0, 60]}",), "limits of fl.spin_rate leave nothing on one side of 0"),
        (SWERVE, ("limits: {steer_rate: 8, steer: 92 deg}",), "fl cannot reach every direction"),
        (SWERVE, ("limits: {steer_rate: 8, steer: 60 deg}",), "fl cannot reach every direction"),
        (
            SWERVE,
            (LIMITS, "couplings: [{equal: [fl.steer, br.steer]}]"),
            "fl and br are steered by one motor",
        ),
        (SWERVE, (LIMITS, "couplings: [{equal: [fl.spin, br.spin]}]"), "turn as one and do not steer as one"),
        (
            "\n".join(
                CASTOR.replace("a,", f"{n},").replace("X", x) for n, x in (("a", "0.2"), ("b", "-0.2"))
            ),
            ("limits: {spin_rate: 60}",),
            "the castor a swings",
        ),
    ],
)
def test_what_it_cannot_keep_is_named(wheels: str, lines: tuple[str, ...], why: str) -> None:
    with pytest.raises(NotDerivableError, match=why):
        _ = derived(robot_text(wheels, *lines), "setpoint").program


@pytest.mark.parametrize("dt", [0.0, -0.0, -1.0])
def test_without_time_the_twist_is_held(dt: float) -> None:
    d, last = derived(robot_text(SWERVE, LIMITS), "setpoint"), {"vx": 0.5, "vy": -0.0, "omega": 1.0}
    values = last | {"vx_wanted": 1.0, "vy_wanted": 2.0, "omega_wanted": -3.0, "dt": dt}
    values |= {p.name: 0.0 for p in d.formula("setpoint").inputs if p.name.endswith("steer")}
    assert call(d, "setpoint", values, FLOAT32) == last
