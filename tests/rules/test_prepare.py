"""`prepare_checked` rejects parameters that are far from nominal; the robot then runs with nominal ones."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS
from tests.depth import everyday
from tests.rules.probe import printed

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")

TUNABLE = """
wmrgen: 1
name: probed
parameters:
  radius: {value: 0.1, tunable: true}
  toe: {value: 0 deg, tunable: true}
  behind: {value: -0.5, tunable: true}
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.25,  heading: 0, r: radius}
  - {name: right, type: fixed, x: 0, y: -0.25, heading: 0, r: radius}
  - {name: front, type: steered, x: behind, y: 0, heading: toe, r: radius}
limits: {vx: 2, omega: 3}
"""
BODY = """
    probed_params params, nominal;
    probed_prepared prepared, expected, normal;
    const probed_twist in = {1.0f, 0.0f, 0.0f};
    probed_wheels out;
    const SCALAR radii[6] = {0.0, 1.0, -0.1, 0.0899, 0.1101, 1e30};
    const SCALAR toes[4] = {0.0101, -0.0101, 3.0, -1e-1};
    const SCALAR places[4] = {0.5, -0.4499, -0.5501, 0.0};
    memset(&out, 0, sizeof out);
    probed_params_default(&nominal);
    probed_prepare(&nominal, &normal);
#define REFUSED(status) do { \\
        memset(&prepared, 0xff, sizeof prepared); \\
        EXPECT(probed_prepare_checked(&params, &prepared) == (status)); \\
        EXPECT(memcmp(&prepared, &normal, sizeof normal) == 0); \\
        EXPECT(probed_inverse_checked(&prepared, &in, &out, &out) == PROBED_OK); \\
        EXPECT(fabs((double)out.left.spin - 10.0) < 1e-4); \\
    } while (0)
#define ACCEPTED do { \\
        EXPECT(probed_prepare_checked(&params, &prepared) == PROBED_OK); \\
        probed_prepare(&params, &expected); \\
        EXPECT(memcmp(&prepared, &expected, sizeof expected) == 0); \\
        params = nominal; \\
    } while (0)
    memset(&params, 0, sizeof params); /* never set */
    REFUSED(PROBED_OUT_OF_RANGE);
    memset(&params, 0xff, sizeof params); /* erased flash: NaN */
    REFUSED(PROBED_NOT_A_NUMBER);
    for (k = 0; k < 3; ++k) {
        params = nominal;
        params.radius = (SCALAR)bad[k];
        REFUSED(PROBED_NOT_A_NUMBER);
        params = nominal;
        params.toe = (SCALAR)bad[k];
        REFUSED(PROBED_NOT_A_NUMBER);
    }
    for (k = 0; k < 6; ++k) {
        params = nominal;
        params.radius = radii[k];
        REFUSED(PROBED_OUT_OF_RANGE);
    }
    for (k = 0; k < 4; ++k) {
        params = nominal;
        params.toe = toes[k];
        REFUSED(PROBED_OUT_OF_RANGE);
        params = nominal;
        params.behind = places[k];
        REFUSED(PROBED_OUT_OF_RANGE);
    }
    params = nominal;
    ACCEPTED;
    EXPECT(memcmp(&prepared, &normal, sizeof normal) == 0);
    params.radius = 0.0901;
    ACCEPTED;
    EXPECT(memcmp(&prepared, &normal, sizeof normal) != 0);
    params.radius = 0.1099;
    params.toe = 0.0099; /* 0.01 about a nominal zero */
    params.behind = -0.5499;
    ACCEPTED;
    params.toe = -0.0099;
    params.behind = -0.4501;
    ACCEPTED;
"""


@pytest.mark.parametrize("scalar", everyday(["float", "double"], ["float"]))
def test_parameters_far_from_nominal_are_rejected(scalar: str, tmp_path: Path) -> None:
    body = BODY.replace("SCALAR", scalar)
    assert printed(tmp_path, TUNABLE, body, scalar) == ""


def test_without_tunable_parameters_nothing_is_checked(tmp_path: Path) -> None:
    """Without tunable parameters, neither code nor comments mention a check of parameters."""
    fixed = TUNABLE.replace(", tunable: true", "")
    assert printed(tmp_path, fixed, "    (void)bad; (void)k;\n") == ""
    assert "arameter" not in (tmp_path / "probed_checked.h").read_text()
