"""The limits of joints count in every checked function that takes joints, not in `inverse` and `forward` alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c.harness import COMPILERS
from tests.rules.probe import printed

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


@pytest.mark.parametrize("function", ["posture", "configuration"])
def test_steering_keeps_its_limits(function: str, tmp_path: Path) -> None:
    angles = "-1.22f, -1.23f, 0.52f, 0.53f, 3.0f, 0.0f"
    values = {"declared": BICYCLE_DECLARED, "wheels": "probed_wheels"}
    if function == "configuration":
        values["declared"] += " probed_configuration_in rates = {0};"
    rates = ", &rates" if function == "configuration" else ""
    values["arguments"] = f"&pose, &in{rates}, &out, &x_rate, &y_rate, &theta_rate"
    assert printed(tmp_path, BICYCLE, ANGLE.format(function=function, angles=angles, **values)) == ""


def test_a_virtual_wheel_keeps_those_of_its_wheels(tmp_path: Path) -> None:
    angles = "0.87f, 0.88f, -0.87f, -0.88f, 3.0f, 0.0f"
    declared = "const probed_pose pose = {0.0f, 0.0f, 0.0f}; probed_posture_out out;"
    values = {"declared": declared, "wheels": "probed_posture_in", "arguments": "&pose, &in, &out"}
    assert printed(tmp_path, CAR, ANGLE.format(function="posture", angles=angles, **values)) == ""


def test_rates_keep_theirs(tmp_path: Path) -> None:
    assert printed(tmp_path, BICYCLE, RATES) == ""
