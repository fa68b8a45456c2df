"""Checked functions: status and safe outputs outside the accepted ranges, the function itself inside.

The expected values are written by hand from the robot files.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS, EACH, STRICT
from tests.conftest import put
from tests.ir.selftest.every import files_of
from tests.rules.probe import HEAD, TAIL
from wmrgen.codegen.compiler import compile_program, run_program

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")

DIFFERENTIAL = """
    textbook_differential_twist in = {0.1f, 0.0f, 1.0f}, g;
    textbook_differential_wheels out, same, f;
    textbook_differential_pose pose = {1.0f, 2.0f, 3.0f};
    EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_OK);
    textbook_differential_inverse(&in, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    for (k = 0; k < 3; ++k) {
        in.vx = bad[k];
        EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_NOT_A_NUMBER);
        EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f);
        f.left.spin = 1.0f;
        f.right.spin = bad[k];
        EXPECT(textbook_differential_forward_checked(&f, &g) == TEXTBOOK_DIFFERENTIAL_NOT_A_NUMBER);
        EXPECT(g.vx == 0.0f && g.vy == 0.0f && g.omega == 0.0f);
    }
    in.vx = 1e9f; /* no limit in the robot file */
    EXPECT(textbook_differential_odometry_checked(&pose, &in, 0.01f) == TEXTBOOK_DIFFERENTIAL_OK);
    EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_OK);
    in.vx = 1.1e9f;
    EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_OUT_OF_RANGE);
    EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f);
    f.right.spin = 3e38f;
    EXPECT(textbook_differential_forward_checked(&f, &g) == TEXTBOOK_DIFFERENTIAL_OUT_OF_RANGE);
"""
ODOMETRY = """
    const pioneer3dx_pose start = {1.0f, 2.0f, 3.0f};
    pioneer3dx_pose pose = start, same = start;
    pioneer3dx_twist twist = {0.1f, 0.0f, 0.5f};
    EXPECT(pioneer3dx_odometry_checked(&pose, &twist, 0.01f) == PIONEER3DX_OK);
    pioneer3dx_odometry(&same, &twist, 0.01f);
    EXPECT(memcmp(&pose, &same, sizeof pose) == 0);
    twist.vx = 1.6f; /* measured: the limit of 1.2 is for commands, and wheels that overshoot go as fast */
    EXPECT(pioneer3dx_odometry_checked(&pose, &twist, 0.01f) == PIONEER3DX_OK);
    for (k = 0; k < 2; ++k) {
        twist.vx = k ? 1.7f : 1.1e9f;
        pose = start;
        EXPECT(pioneer3dx_odometry_checked(&pose, &twist, 0.01f) == PIONEER3DX_OUT_OF_RANGE);
        EXPECT(memcmp(&pose, &start, sizeof pose) == 0);
    }
    twist.vx = 0.1f;
    for (k = 0; k < 3; ++k) {
        pose = start;
        pose.y = bad[k];
        EXPECT(pioneer3dx_odometry_checked(&pose, &twist, 0.01f) == PIONEER3DX_NOT_A_NUMBER);
        EXPECT(pose.x == 1.0f && pose.y == 0.0f && pose.theta == 3.0f);
        pose = start;
        EXPECT(pioneer3dx_odometry_checked(&pose, &twist, bad[k]) == PIONEER3DX_NOT_A_NUMBER);
        EXPECT(memcmp(&pose, &start, sizeof pose) == 0);
    }
    pose = start;
    pose.theta = 2e4f;
    EXPECT(pioneer3dx_odometry_checked(&pose, &twist, 0.01f) == PIONEER3DX_OUT_OF_RANGE);
"""
ACKERMANN = """
    /* limits: vx 30, omega 2, steer -40 deg to 40 deg */
    ackermann_car_twist in = {10.0f, 0.0f, 1.0f};
    ackermann_car_wheels now, out, same;
    const float limit = 0.6981317f;
    int j;
    memset(&now, 0, sizeof now);
    now.front_left.steer = 0.1f;
    now.front_right.steer = 0.2f;
    out = now;
    same = now;
    EXPECT(ackermann_car_inverse_checked(&in, &now, &out) == ACKERMANN_CAR_OK);
    ackermann_car_inverse(&in, &now, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    same = now; /* commands may take the place of the present state */
    ackermann_car_inverse(&in, &same, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    in.omega = 2.0f;
    for (k = -40; k <= 40; ++k) {
        for (j = -20; j <= 20; ++j) { /* also from angles a little beyond the limit */
            in.vx = 0.25f * (float)k;
            now.front_left.steer = 0.04f * (float)j;
            now.front_right.steer = -now.front_left.steer;
            EXPECT(ackermann_car_inverse_checked(&in, &now, &out) == ACKERMANN_CAR_OK);
            EXPECT(out.front_left.steer <= limit && out.front_left.steer >= -limit);
            EXPECT(out.front_right.steer <= limit && out.front_right.steer >= -limit);
        }
    }
    now.front_left.steer = 0.5f;
    now.front_right.steer = NAN;
    EXPECT(ackermann_car_inverse_checked(&in, &now, &out) == ACKERMANN_CAR_NOT_A_NUMBER);
    EXPECT(out.rear_left.spin == 0.0f && out.rear_right.spin == 0.0f);
    EXPECT(out.front_left.steer == 0.5f && out.front_right.steer == 0.0f);
    now.front_right.steer = 3.0f; /* refused; what is held stays inside the limits */
    EXPECT(ackermann_car_inverse_checked(&in, &now, &out) == ACKERMANN_CAR_OUT_OF_RANGE);
    EXPECT(out.front_left.steer == 0.5f && out.front_right.steer == limit);
    now.front_right.steer = -0.1f;
    in.vx = 30.1f;
    EXPECT(ackermann_car_inverse_checked(&in, &now, &out) == ACKERMANN_CAR_OUT_OF_RANGE);
    EXPECT(out.front_right.steer == -0.1f && out.rear_right.spin == 0.0f);
    EXPECT(ackermann_car_inverse_checked(&in, &now, &now) == ACKERMANN_CAR_OUT_OF_RANGE);
    EXPECT(now.front_right.steer == -0.1f && now.rear_right.spin == 0.0f);
"""
# For every twist, the limited twist drives the robot.
LIMITING = """
    pioneer3dx_params params;
    pioneer3dx_prepared prepared;
    pioneer3dx_twist wanted = {0.0f, 0.0f, 0.0f}, driven = {0.0f, 0.0f, 0.0f};
    float before;
    pioneer3dx_wheels out;
    unsigned state = 1u;
    int reached = 0;
    pioneer3dx_params_default(&params);
    pioneer3dx_prepare(&params, &prepared);
    for (k = 0; k < 3000; ++k) {
        float *const member[3] = {&wanted.vx, &wanted.vy, &wanted.omega};
        const float most[3] = {k % 3 ? 2.0f : 1e9f, 1e9f, k % 5 ? 8.0f : 200.0f};
        int j;
        for (j = 0; j < 3; ++j) {
            state = state * 1664525u + 1013904223u;
            *member[j] = most[j] * ((float)(state >> 8) / 8388608.0f - 1.0f);
        }
        EXPECT(pioneer3dx_limit_twist_checked(&wanted) == PIONEER3DX_OK);
        EXPECT(pioneer3dx_inverse_checked(&prepared, &wanted, &out) == PIONEER3DX_OK);
        reached += fabsf(wanted.vx) == 1.2f || fabsf(wanted.omega) == 5.2359877f;
        before = fabsf(wanted.vx - driven.vx);
        EXPECT(pioneer3dx_limit_acceleration_checked(&driven, &wanted, 0.5f) == PIONEER3DX_OK);
        EXPECT(fabsf(wanted.vx - driven.vx) <= before);
        EXPECT(pioneer3dx_inverse_checked(&prepared, &driven, &out) == PIONEER3DX_OK);
    }
    EXPECT(reached > 500);
    for (k = 0; k < 3; ++k) {
        wanted.vx = 0.5f;
        wanted.omega = bad[k];
        EXPECT(pioneer3dx_limit_twist_checked(&wanted) == PIONEER3DX_NOT_A_NUMBER);
        EXPECT(wanted.vx == 0.0f && wanted.vy == 0.0f && wanted.omega == 0.0f);
    }
"""
CASTORS = """
    nomad_xr4000_twist in = {0.5f, 0.1f, 0.2f};
    nomad_xr4000_wheels now, out;
    memset(&now, 0, sizeof now);
    EXPECT(nomad_xr4000_inverse_checked(&in, &now, &out) == NOMAD_XR4000_OK);
    EXPECT(out.castor1.steer_rate != 0.0f);
    now.castor4.steer = NAN;
    EXPECT(nomad_xr4000_inverse_checked(&in, &now, &out) == NOMAD_XR4000_NOT_A_NUMBER);
    EXPECT(out.castor1.steer_rate == 0.0f && out.castor1.spin == 0.0f && out.castor4.spin == 0.0f);
    for (k = 0; k < 3; ++k) {
        now.castor4.steer = bad[k];
        EXPECT(nomad_xr4000_inverse_checked(&in, &now, &out) == NOMAD_XR4000_NOT_A_NUMBER);
    }
"""
TUNABLE = """
    pioneer3dx_params params;
    pioneer3dx_prepared prepared;
    pioneer3dx_twist in = {0.1f, 0.0f, 1.0f};
    pioneer3dx_wheels out, same;
    pioneer3dx_params_default(&params);
    pioneer3dx_prepare(&params, &prepared);
    EXPECT(pioneer3dx_inverse_checked(&prepared, &in, &out) == PIONEER3DX_OK);
    pioneer3dx_inverse(&prepared, &in, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    in.vx = 1.2f; /* the limit of the robot file */
    EXPECT(pioneer3dx_inverse_checked(&prepared, &in, &out) == PIONEER3DX_OK);
    in.vx = nextafterf(1.2f, 2.0f);
    EXPECT(pioneer3dx_inverse_checked(&prepared, &in, &out) == PIONEER3DX_OUT_OF_RANGE);
    EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f);
    for (k = 0; k < 3; ++k) {
        in.omega = bad[k];
        EXPECT(pioneer3dx_inverse_checked(&prepared, &in, &out) == PIONEER3DX_NOT_A_NUMBER);
        EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f);
    }
"""


@pytest.mark.parametrize("compiler", EACH)
@pytest.mark.parametrize(
    ("robot", "body"),
    [
        ("textbook_differential", DIFFERENTIAL),
        ("pioneer3dx", ODOMETRY),
        ("ackermann_car", ACKERMANN),
        ("nomad_xr4000", CASTORS),
        ("pioneer3dx", TUNABLE),
        ("pioneer3dx", LIMITING),
    ],
    ids=["differential", "odometry", "ackermann", "castors", "tunable", "limiting"],
)
def test_status_and_safe_outputs(robot: str, body: str, compiler: str, tmp_path: Path) -> None:
    put(tmp_path, files_of(robot))
    (tmp_path / "edges.c").write_text(HEAD.format(robot) + body + TAIL)
    sources = ["edges.c", f"{robot}_checked.c", f"{robot}.c"]
    assert run_program(compile_program(tmp_path, sources, compiler, (*STRICT[:2], "-O2")), "") == ""


def test_options_that_remove_checks_are_rejected(tmp_path: Path) -> None:
    """-ffast-math lets a compiler assume that there is no NaN."""
    put(tmp_path, files_of("lekiwi"))
    with pytest.raises(Exception, match="ffast-math"):
        compile_program(tmp_path, ["lekiwi_checked.c"], None, ("-c", "-std=c99", "-ffast-math"))
