"""The limits of joints count in every checked function that takes joints, not in `inverse` and `forward` alone; and
which joints these are where a coupling or an encoder brings them in."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS
from tests.robots import of_text
from tests.rules.probe import printed
from wmrgen.codegen.signature import members

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")

BICYCLE = """
wmrgen: 1
name: probed
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, limits: {steer: [-60 deg, 20 deg], steer_rate: 2}}
functions: [posture, configuration, desaturate]
limits: {vx: 8, omega: 4, spin: 20}
"""
CAR = """
wmrgen: 1
name: probed
wheels:
  - {name: rear_left,   type: fixed,   x: 0, y: 0.4,  heading: 0, r: 0.1}
  - {name: rear_right,  type: fixed,   x: 0, y: -0.4, heading: 0, r: 0.1}
  - {name: front_left,  type: steered, x: 1.4, y: 0.4,  heading: 0, r: 0.1, actuated: [steer], limits: {steer: 40 deg}}
  - {name: front_right, type: steered, x: 1.4, y: -0.4, heading: 0, r: 0.1, actuated: [steer], limits: {steer: 30 deg}}
virtual:
  - {name: front, steers: [front_left, front_right]}
  - {name: rear,  drives: [rear_left, rear_right]}
functions: [posture]
"""
# From 20 - 1.25 * 40 = -70 to 30 deg for the bicycle, 1.25 * 40 = 50 deg for the wheel between the two of the car.
ANGLE = """
    {wheels} in;
    {declared}
    static const float angles[6] = {{{angles}}};
    static const probed_status expected[6] = {{
        PROBED_OK, PROBED_OUT_OF_RANGE, PROBED_OK, PROBED_OUT_OF_RANGE, PROBED_OUT_OF_RANGE, PROBED_NOT_A_NUMBER}};
    for (k = 0; k < 6; ++k) {{
        memset(&in, 0, sizeof in);
        in.front.steer = (k < 5) ? angles[k] : bad[1];
        EXPECT(probed_{function}_checked({arguments}) == expected[k]);
    }}
"""
BICYCLE_DECLARED = (
    "const probed_pose pose = {0.0f, 0.0f, 0.0f}; probed_wheels out; float x_rate, y_rate, theta_rate;"
)
RATES = """
    probed_wheels in, asked;
    const probed_pose pose = {0.0f, 0.0f, 0.0f};
    probed_wheels out;
    float x_rate, y_rate, theta_rate, scale;
    (void)bad;
    (void)k;
    memset(&in, 0, sizeof in);
    in.rear.spin = 10.0f;
    in.front.steer_rate = 2.4f;
    EXPECT(probed_posture_checked(&pose, &in, &out, &x_rate, &y_rate, &theta_rate) == PROBED_OK);
    EXPECT(fabsf(x_rate - 3.0f) < 1e-5f && out.front.steer_rate == 2.4f);
    in.front.steer_rate = 2.6f; /* the limit of 2, and a quarter of it */
    EXPECT(probed_posture_checked(&pose, &in, &out, &x_rate, &y_rate, &theta_rate) == PROBED_OUT_OF_RANGE);
    EXPECT(x_rate == 0.0f && out.front.steer_rate == 0.0f);
    memset(&asked, 0, sizeof asked);
    asked.rear.spin = 400.0f; /* what is to be scaled may be too fast */
    EXPECT(probed_desaturate_checked(&asked, &scale) == PROBED_OK);
    EXPECT(fabsf(asked.rear.spin - 20.0f) < 1e-4f);
"""
# The first wheel of the pair has the motor of the wheel, the second that of the steering; the castor has an encoder.
COUPLED = """
wmrgen: 1
name: probed
wheels:
  - {name: a, type: steered, x: 0.3,  y: 0.3, heading: 0, r: 0.1, actuated: [spin]}
  - {name: b, type: steered, x: -0.3, y: 0.3, heading: 0, r: 0.1, actuated: [steer]}
  - {name: tail, type: castor, x: 0, y: 0, heading: 0, d: -0.03, r: 0.05, encoder: {steer: {counts: 100, offset: 0}}}
  - {name: fast, type: castor, x: 0, y: 0, heading: 0, d: -0.03, r: 0.05, limits: {spin: 40}}
  - {name: loose, type: steered, x: 0.1, y: 0, heading: 0, r: 0.05, actuated: []}
couplings: [{equal: [a.steer, b.steer]}]
limits: {vx: 1, vy: 1, spin: 14, steer_rate: 4}
functions: [desaturate, compensate_steering, steer_toward, joints_from_counts]
"""
TURN = """
wmrgen: 1
name: probed
wheels:
  - {{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}}
  - {{name: other, type: {wheel}{own}}}
"""
ONE_TYPE = """
    const probed_twist sideways = {0.0f, 0.5f, 0.0f};
    const probed_counters before = {{0}};
    probed_counters counters = {{25}};
    probed_wheels now, out;
    (void)bad;
    (void)k;
    memset(&now, 0, sizeof now);
    memset(&out, 0, sizeof out);
    probed_joints_from_counters(&counters, &before, &now);
    EXPECT(fabsf(now.tail.steer - 1.5707964f) < 1e-6f);
    now.a.steer = now.b.steer = 1.0f;
    now.fast.steer = 1.5707964f;
    probed_inverse(&sideways, &now, &out);
    EXPECT(fabsf(out.b.steer - 1.5707964f) < 1e-6f && out.a.steer == out.b.steer && fabsf(out.a.spin - 5.0f) < 1e-5f);
    EXPECT(fabsf(out.fast.spin - 10.0f) < 1e-5f); /* of no motor, but limited: along its angle as it stands */
    probed_compensate_steering(&out, &now);
    EXPECT(fabsf(out.a.spin - 5.0f * cosf(0.57079633f)) < 1e-5f);
    probed_steer_toward(&now, &out, 0.01f, &out);
    EXPECT(fabsf(out.b.steer - 1.04f) < 1e-6f && out.a.steer == out.b.steer);
"""


def test_every_joint_that_the_loop_reads_is_of_the_shared_type(tmp_path: Path) -> None:
    """No function has its own struct, which the example would leave at 0, including dt."""
    assert printed(tmp_path, COUPLED, ONE_TYPE) == ""


def test_a_limit_of_a_passive_joint_changes_no_type() -> None:
    """This holds in C and in Rust: both use the joints of the module."""
    wheels = (
        "castor, d: 0.03, x: 0.4, y: 0, heading: 0, r: 0.05",
        "steered, x: 0.4, y: 0, heading: 0, r: 0.05, actuated: []",
    )
    for wheel in wheels:
        plain = of_text(TURN.format(wheel=wheel, own="")).c_module
        limited = of_text(TURN.format(wheel=wheel, own=", limits: {steer_rate: 4}")).c_module
        assert plain.joints == limited.joints == ("left.spin",)
        assert members(plain) == members(limited)


@pytest.mark.parametrize("function", ["posture", "configuration"])
def test_steering_keeps_its_limits(function: str, tmp_path: Path) -> None:
    angles = "-1.22f, -1.23f, 0.52f, 0.53f, 3.0f, 0.0f"
    values = {"declared": BICYCLE_DECLARED, "wheels": "probed_wheels"}
    if function == "configuration":
        values["declared"] += " probed_configuration_in rates = {0};"
    rates = ", &rates" if function == "configuration" else ""
    values["arguments"] = f"&pose, &in{rates}, &out, &x_rate, &y_rate, &theta_rate"
    assert printed(tmp_path, BICYCLE, ANGLE.format(function=function, angles=angles, **values)) == ""


def test_a_virtual_wheel_is_within_the_limits_of_its_wheels(tmp_path: Path) -> None:
    angles = "0.87f, 0.88f, -0.87f, -0.88f, 3.0f, 0.0f"
    declared = "const probed_pose pose = {0.0f, 0.0f, 0.0f}; probed_posture_out out;"
    values = {"declared": declared, "wheels": "probed_posture_in", "arguments": "&pose, &in, &out"}
    assert printed(tmp_path, CAR, ANGLE.format(function="posture", angles=angles, **values)) == ""


def test_rates_are_within_their_limits(tmp_path: Path) -> None:
    assert printed(tmp_path, BICYCLE, RATES) == ""
