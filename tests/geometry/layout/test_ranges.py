"""Ranges of tunable parameters: what a robot file may state, and where the range is used."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import wmrgen
from tests.codegen.c.harness import COMPILERS
from tests.rules.probe import printed
from wmrgen.analysis.kinematics.records import tunable_ports
from wmrgen.errors import RobotFileError
from wmrgen.geometry.exact.evaluate import pi_rational
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.bounds.assumptions import domain

PAIR = """\
wmrgen: 1
name: probed
parameters:
  base: 0.3
  half: {{value: 165.5 mm, tunable: {0}}}
  toe: {{value: 0, tunable: {1}}}
wheels:
  - {{name: left,  type: fixed, x: 0, y: half, heading: toe, r: 0.1}}
  - {{name: right, type: fixed, x: 0, y: -half, heading: 0, r: 0.1}}
limits: {{vx: 1, omega: 1}}
"""


def robot(folder: Path, half: str = "true", toe: str = "true") -> Robot:
    path = folder / "probed.yaml"
    path.write_text(PAIR.format(half, toe), encoding="utf-8")
    return wmrgen.load(path)


def ranges(robot: Robot) -> dict[str, tuple[Exact, Exact]]:
    return {p.name: (p.low, p.high) for p in robot.parameters}


def test_ends_are_exact_and_may_be_expressions(tmp_path: Path) -> None:
    angle = pi_rational() / 60
    assert ranges(robot(tmp_path, "[base/2, 200 mm]", "[-3 deg, 3 deg]")) == {
        "base": (Exact.ratio(3, 10),) * 2,
        "half": (Exact.ratio(3, 20), Exact.ratio(1, 5)),
        "toe": (Exact(-angle), Exact(angle)),
    }


def test_without_a_range_it_is_ten_percent(tmp_path: Path) -> None:
    found = ranges(robot(tmp_path))
    assert [*map(float, found["half"])] == pytest.approx([0.14895, 0.18205], rel=1e-15)
    assert [*map(float, found["toe"])] == [-0.01, 0.01]


@pytest.mark.parametrize(
    ("half", "code", "place", "named"),
    [
        ("[0.2, 0.1]", "WMR109", "5:37", ["half", "0.2", "0.1"]),
        ("[0.1655, 0.1655]", "WMR109", "5:37", ["half", "0.1655"]),
        ("[0.17, 0.2]", "WMR109", "5:37", ["half", "0.1655", "0.17", "0.2"]),
        ("[0.1, 0.16]", "WMR109", "5:42", ["half", "0.1655", "0.1", "0.16"]),
        ("[0.1]", "WMR104", "5:36", ["half", "1"]),
        ("[0.1, 0.2, 0.3]", "WMR104", "5:36", ["half", "3"]),
        ("[0.1, 20 deg]", "WMR104", "5:42", ["half", "20", "deg"]),
        ("[0.1, 2*toe]", "WMR109", "5:42", ["half", "toe"]),
        ("[0.1, 2*half]", "WMR109", "5:42", ["half"]),
        ("[0.1, wide]", "WMR107", "5:42", ["wide"]),
        ("0.2", "WMR104", "5:36", ["0.2"]),
    ],
)
def test_refused(half: str, code: str, place: str, named: list[str], tmp_path: Path) -> None:
    with pytest.raises(RobotFileError) as caught:
        robot(tmp_path, half)
    assert (caught.value.code, str(caught.value.mark)[-len(place) - 1 :]) == (code, f":{place}")
    assert {*named} <= {*re.findall(r"[\w.]+", caught.value.what)}


def test_bounds_and_the_model_have_it(tmp_path: Path) -> None:
    one = robot(tmp_path, "[0.15, 0.2]", "[-0.1, 0]")
    of = domain(one)._range
    assert [of(port) for port in tunable_ports(one)] == [
        pytest.approx((0.15, 0.2), rel=1e-7), pytest.approx((-0.1, 0), rel=1e-7),
    ]  # fmt: skip
    said = {p["name"]: p.get("range") for p in wmrgen.derive(one).model()["parameters"]}
    assert said == {"base": None, "half": [0.15, 0.2], "toe": [-0.1, 0.0]}


BODY = """
    probed_params params, nominal;
    probed_prepared prepared;
    const float halves[4] = {0.15f, 0.2f, 0.149f, 0.201f};
    const float toes[4] = {-0.1f, 0.3f, -0.101f, 0.301f};
    (void)bad;
    probed_params_default(&nominal);
    for (k = 0; k < 4; ++k) {
        params = nominal;
        params.half = halves[k];
        EXPECT(probed_prepare_checked(&params, &prepared) == (k < 2 ? PROBED_OK : PROBED_OUT_OF_RANGE));
        params = nominal;
        params.toe = toes[k];
        EXPECT(probed_prepare_checked(&params, &prepared) == (k < 2 ? PROBED_OK : PROBED_OUT_OF_RANGE));
    }
"""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
def test_checked_code_takes_the_range_with_its_ends(tmp_path: Path) -> None:
    assert printed(tmp_path, PAIR.format("[0.15, 0.2]", "[-0.1, 0.3]"), BODY) == ""
