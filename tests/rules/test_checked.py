"""Checked functions: a status and safe outputs at the edges, the function itself everywhere else.

What is expected stands here, written by hand from the robot files.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c.harness import COMPILERS, STRICT
from tests.conftest import put
from tests.rules.probe import HEAD, TAIL
from tests.selftest.every import files_of
from wmrgen.compiler import compile_program, run_program

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")

DIFFERENTIAL = """
    textbook_differential_inverse_in in = {0.1f, 0.0f, 1.0f};
    textbook_differential_inverse_out out, same;
    textbook_differential_forward_in f;
    textbook_differential_forward_out g;
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
    EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_OK);
    in.vx = 1.1e9f;
    EXPECT(textbook_differential_inverse_checked(&in, &out) == TEXTBOOK_DIFFERENTIAL_OUT_OF_RANGE);
    EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f);
    f.right.spin = 3e38f;
    EXPECT(textbook_differential_forward_checked(&f, &g) == TEXTBOOK_DIFFERENTIAL_OUT_OF_RANGE);
"""
ODOMETRY = """
    pioneer3dx_odometry_in in = {1.0f, 2.0f, 3.0f, 0.1f, 0.0f, 0.5f, 0.01f};
    pioneer3dx_odometry_out out, same;
    EXPECT(pioneer3dx_odometry_checked(&in, &out) == PIONEER3DX_OK);
    pioneer3dx_odometry(&in, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    in.vx = 5.0f; /* measured: the limit of 1.2 is for commands, and the wheels have none */
    EXPECT(pioneer3dx_odometry_checked(&in, &out) == PIONEER3DX_OK);
    in.vx = 1.1e9f;
    EXPECT(pioneer3dx_odometry_checked(&in, &out) == PIONEER3DX_OUT_OF_RANGE);
    EXPECT(out.x == 1.0f && out.y == 2.0f && out.theta == 3.0f);
    in.vx = 0.1f;
    for (k = 0; k < 3; ++k) {
        in.y = bad[k];
        EXPECT(pioneer3dx_odometry_checked(&in, &out) == PIONEER3DX_NOT_A_NUMBER);
        EXPECT(out.x == 1.0f && out.y == 0.0f && out.theta == 3.0f);
    }
    in.y = 2.0f;
    in.theta = 2e4f;
    EXPECT(pioneer3dx_odometry_checked(&in, &out) == PIONEER3DX_OUT_OF_RANGE);
"""
ACKERMANN = """
    /* limits: vx 30, omega 2, steer -40 deg to 40 deg */
    ackermann_car_inverse_in in = {10.0f, 0.0f, 1.0f, {0.1f}, {0.2f}};
    ackermann_car_inverse_out out, same;
    const float limit = 0.6981317f;
    int j;
    EXPECT(ackermann_car_inverse_checked(&in, &out) == ACKERMANN_CAR_OK);
    ackermann_car_inverse(&in, &same);
    EXPECT(memcmp(&out, &same, sizeof out) == 0);
    in.omega = 2.0f;
    for (k = -40; k <= 40; ++k) {
        for (j = -20; j <= 20; ++j) { /* also from angles a little beyond the limit */
            in.vx = 0.25f * (float)k;
            in.front_left.steer = 0.04f * (float)j;
            in.front_right.steer = -in.front_left.steer;
            EXPECT(ackermann_car_inverse_checked(&in, &out) == ACKERMANN_CAR_OK);
            EXPECT(out.front_left.steer <= limit && out.front_left.steer >= -limit);
            EXPECT(out.front_right.steer <= limit && out.front_right.steer >= -limit);
        }
    }
    in.front_left.steer = 0.5f;
    in.front_right.steer = NAN;
    EXPECT(ackermann_car_inverse_checked(&in, &out) == ACKERMANN_CAR_NOT_A_NUMBER);
    EXPECT(out.rear_left.spin == 0.0f && out.front_left.spin == 0.0f);
    EXPECT(out.front_left.steer == 0.5f && out.front_right.steer == 0.0f);
    in.front_right.steer = 3.0f; /* refused; what is held stays inside the limits */
    EXPECT(ackermann_car_inverse_checked(&in, &out) == ACKERMANN_CAR_OUT_OF_RANGE);
    EXPECT(out.front_left.steer == 0.5f && out.front_right.steer == limit);
    in.front_right.steer = -0.1f;
    in.vx = 30.1f;
    EXPECT(ackermann_car_inverse_checked(&in, &out) == ACKERMANN_CAR_OUT_OF_RANGE);
    EXPECT(out.front_right.steer == -0.1f && out.rear_right.spin == 0.0f);
"""
CASTORS = """
    nomad_xr4000_inverse_in in = {0.5f, 0.1f, 0.2f, {0.1f}, {0.2f}, {0.3f}, {0.4f}};
    nomad_xr4000_inverse_out out;
    EXPECT(nomad_xr4000_inverse_checked(&in, &out) == NOMAD_XR4000_OK);
    EXPECT(out.castor1.steer_rate != 0.0f);
    in.castor4.steer = NAN;
    EXPECT(nomad_xr4000_inverse_checked(&in, &out) == NOMAD_XR4000_NOT_A_NUMBER);
    EXPECT(out.castor1.steer_rate == 0.0f && out.castor1.spin == 0.0f && out.castor4.spin == 0.0f);
    for (k = 0; k < 3; ++k) {
        in.castor4.steer = bad[k];
        EXPECT(nomad_xr4000_inverse_checked(&in, &out) == NOMAD_XR4000_NOT_A_NUMBER);
    }
"""
TUNABLE = """
    pioneer3dx_params params;
    pioneer3dx_prepared prepared;
    pioneer3dx_inverse_in in = {0.1f, 0.0f, 1.0f, {0.0f}};
    pioneer3dx_inverse_out out, same;
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
        EXPECT(out.left.spin == 0.0f && out.right.spin == 0.0f && out.tail.steer_rate == 0.0f);
    }
"""


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize(
    ("robot", "body"),
    [
        ("textbook_differential", DIFFERENTIAL),
        ("pioneer3dx", ODOMETRY),
        ("ackermann_car", ACKERMANN),
        ("nomad_xr4000", CASTORS),
        ("pioneer3dx", TUNABLE),
    ],
    ids=["differential", "odometry", "ackermann", "castors", "tunable"],
)
def test_status_and_safe_outputs(robot: str, body: str, compiler: str, tmp_path: Path) -> None:
    put(tmp_path, files_of(robot))
    (tmp_path / "edges.c").write_text(HEAD.format(robot) + body + TAIL)
    sources = ["edges.c", f"{robot}_checked.c", f"{robot}.c"]
    assert run_program(compile_program(tmp_path, sources, compiler, (*STRICT[:2], "-O2")), "") == ""


def test_refuses_to_lose_its_checks(tmp_path: Path) -> None:
    """-ffast-math lets a compiler assume that there is no NaN."""
    put(tmp_path, files_of("lekiwi"))
    with pytest.raises(Exception, match="ffast-math"):
        compile_program(tmp_path, ["lekiwi_checked.c"], None, ("-c", "-std=c99", "-ffast-math"))
