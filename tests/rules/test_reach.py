"""`odometry` accepts every result of `forward` for accepted joints, so the pose does not freeze."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS
from tests.rules.probe import printed
from wmrgen import derive, load
from wmrgen.derivation.emit import site

QUICK = """
wmrgen: 1
name: probed
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.23,  heading: 0, r: 0.0412}
  - {name: right, type: fixed, x: 0, y: -0.23, heading: 0, r: 0.0412}
limits: {omega: 4, spin: 35}
"""
LEANING = QUICK.replace("spin: 35", "spin: [-5, 35]")
TUNABLE = QUICK.replace("wheels:", "parameters: {rho: {value: 0.0412, tunable: true}}\nwheels:").replace(
    "0.0412}\n", "rho}\n"
)
SWERVE = """
wmrgen: 1
name: probed
wheels:
  - {name: front_left, type: steered, x: 0.4,  y: 0.3,  heading: 0, r: 0.05}
  - {name: front_right, type: steered, x: 0.4,  y: -0.3, heading: 0, r: 0.05}
  - {name: back_left, type: steered, x: -0.4, y: 0.3,  heading: 0, r: 0.05}
limits: {vx: 0.1, vy: 0.1, omega: 0.1, spin: 35}
"""
TRICYCLE = """
wmrgen: 1
name: probed
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.4,  heading: 0, r: 0.11, actuated: [], sensed: [spin], limits: {spin: 35}}
  - {name: right, type: fixed, x: 0, y: -0.4, heading: 0, r: 0.11, actuated: [], sensed: [spin], limits: {spin: 35}}
  - {name: front, type: steered, x: 1.4, y: 0, heading: 0, r: 0.11, limits: {steer: [-75 deg, 60 deg]}}
limits: {vx: 0.1, omega: 0.1, spin: 35}
"""
FREE = TRICYCLE.replace(", limits: {spin: 35}}", "}")  # wheels that are only sensed, at any speed
# At a right angle, the front wheel does not determine the yaw rate.
ACROSS = """
wmrgen: 1
name: probed
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3, sensed: [spin]}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, actuated: [steer], sensed: [steer]}
limits: {vx: 8, omega: 4, spin: 20}
"""
# Joints at their stops, beyond a limit, between the limits, and at an angle of many revolutions.
WALK = """
    enum { COUNT = PROBED_JOINTS };
    static const float ends[8] = {43.75f, -43.75f, -10.0f, 40.0f, -1.5f, 1.3f, 999.0f, -998.0f};
    probed_wheels measured;
    probed_twist twist;
    probed_pose pose = {0.0f, 0.0f, 0.0f};
    unsigned long seed = 1UL;
    long accepted = 0L;
    long round;
    for (round = 0L; round < 200000L; ++round) {
        for (k = 0; k < COUNT; ++k) {
            unsigned draw;
            seed = (seed * 1103515245UL + 12345UL) & 0x7fffffffUL;
            draw = (unsigned)(seed >> 16);
            *probed_joint(&measured, k) = ((draw & 8U) != 0U) ? ends[draw & 7U]
                : 40.0f * ((float)(draw >> 4) / 1024.0f - 1.0f);
        }
        if (probed_forward_checked(PREPARED &measured, &twist) == PROBED_OK) {
            ++accepted;
            pose.x = 0.0f; pose.y = 0.0f; pose.theta = 0.0f;
            if (probed_odometry_checked(&pose, &twist, 0.01f) != PROBED_OK) {
                printf("%g %g %g\\n", (double)twist.vx, (double)twist.vy, (double)twist.omega);
                return 1;
            }
        }
    }
    EXPECT(accepted > 2000L);
"""
PREPARE = """
    probed_params params;
    probed_prepared prepared;
    probed_params_default(&params);
    probed_prepare(&params, &prepared);
"""
TURNING = """
    probed_wheels in = {{-30.0f}, {30.0f}};
    probed_twist twist, step = {0.0f, 0.0f, 0.0f};
    const probed_pose start = {1.0f, 2.0f, 3.0f};
    probed_pose pose = start;
    (void)bad;
    for (k = 0; k < 2; ++k) {
        EXPECT(probed_forward_checked(&in, &twist) == PROBED_OK);
        EXPECT(fabsf(twist.omega) > 5.3f && fabsf(twist.omega) < 5.4f); /* commands: up to 4 */
        step.omega = twist.omega;
        EXPECT(probed_odometry_checked(&pose, &step, 0.01f) == PROBED_OK);
        EXPECT(pose.theta != 3.0f);
        pose = start;
        in.left.spin = 30.0f;
        in.right.spin = -30.0f;
    }
    step.omega = 7.83f; /* 2 * 43.75 * 0.0412 / 0.46 = 7.837 */
    EXPECT(probed_odometry_checked(&pose, &step, 0.01f) == PROBED_OK);
    pose = start;
    step.omega = 7.84f;
    EXPECT(probed_odometry_checked(&pose, &step, 0.01f) == PROBED_OUT_OF_RANGE);
    EXPECT(pose.x == 1.0f && pose.y == 2.0f && pose.theta == 3.0f);
    step.omega = 0.0f;
    step.vx = -1.80f; /* 43.75 * 0.0412 = 1.8025 */
    step.vy = 0.1f; /* from a sensor that sees what these wheels cannot */
    EXPECT(probed_odometry_checked(&pose, &step, 0.01f) == PROBED_OK);
    step.vx = -1.81f;
    EXPECT(probed_odometry_checked(&pose, &step, 0.01f) == PROBED_OUT_OF_RANGE);
"""

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")


def test_what_is_singular_is_not_bounded(tmp_path: Path) -> None:
    (tmp_path / "probed.yaml").write_text(ACROSS)
    assert "omega" not in site(derive(load(tmp_path / "probed.yaml"))).reach
    limited = ACROSS.replace("sensed: [steer]}", "sensed: [steer], limits: {steer: 40 deg}}")
    (tmp_path / "probed.yaml").write_text(limited)
    low, high = site(derive(load(tmp_path / "probed.yaml"))).reach["omega"]
    assert (
        low == -high and 7.5 * 1.19 <= high <= 7.5 * 2.4
    )  # 25 rad/s * 0.3 m * tan 50 deg / 1 m, plus the overestimate of interval arithmetic


def test_turns_faster_than_commands(tmp_path: Path) -> None:
    """A robot whose wheels turn faster than its limits command still has a valid pose."""
    assert printed(tmp_path, QUICK, TURNING) == ""


ROBOTS = {
    "quick": QUICK,
    "leaning": LEANING,
    "tunable": TUNABLE,
    "swerve": SWERVE,
    "tricycle": TRICYCLE,
    "free": FREE,
}


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_odometry_takes_what_forward_gives(robot: str, tmp_path: Path) -> None:
    body = "    (void)bad;\n" + WALK
    if robot is TUNABLE:
        body = PREPARE + body.replace("PREPARED ", "&prepared, ")
    assert printed(tmp_path, robot, body.replace("PREPARED ", "")) == ""
