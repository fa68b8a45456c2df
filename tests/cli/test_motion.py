"""motion and icr: units, bare wheel names, and notes on what cannot be."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

Cli = Callable[..., Outcome]


PIONEER = ROOT / "robots" / "pioneer3dx.yaml"


CAR = """\
wmrgen: 1
name: car
wheels:
  - {name: left,  type: fixed, x: -0.3, y: 0.6,  heading: 0, r: 0.3}
  - {name: right, type: fixed, x: -0.3, y: -0.6, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 2.2, y: 0, heading: 0, r: 0.3, actuated: [steer]}
"""


@pytest.fixture
def car(tmp_path: Path) -> Path:
    path = tmp_path / "car.yaml"
    path.write_text(CAR, encoding="utf-8")
    return path


@pytest.mark.parametrize("time", ["2.5", "2.5s", "2.5 s", "5/2", "25e-1 s", "2500ms", "2500 ms"])
def test_a_time_may_have_its_unit(time: str, wmrgen_cli: Cli) -> None:
    found = json.loads(wmrgen_cli("motion", PIONEER, "left=4", "right=4", "--time", time, "--json").out)
    assert found["x"] == pytest.approx(2.5 * 4 * 0.0975)


@pytest.mark.parametrize("time", ["2.5m", "2.5 kg", "30 deg", "2.5 rad/s"])
def test_another_unit_is_no_time(time: str, wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("motion", PIONEER, "left=4", "right=4", "--time", time)
    assert (done.code, done.out) == (2, "") and done.err.startswith(f"error[WMR112]: dt = {time!r}: ")


def test_a_bare_wheel_is_its_only_joint(car: Path, wmrgen_cli: Cli) -> None:
    short = wmrgen_cli("motion", car, "left=1", "right=1.2", "front=0.1", "--time", "1", "--json")
    long = wmrgen_cli(
        "motion", car, "left.spin=1", "right.spin=1.2", "front.steer=0.1", "--time", "1", "--json"
    )
    assert short.code == 0 and short.out == long.out


def test_a_centre_that_the_fixed_wheels_refuse_is_said(car: Path, wmrgen_cli: Cli) -> None:
    assert wmrgen_cli("icr", car, "icr.x=-0.3", "icr.y=3").err == ""
    assert wmrgen_cli("icr", car, "icr.x=1", "icr.y=3").err.startswith("car: ")


def test_turning_on_the_axle_centre_has_no_dust(car: Path, wmrgen_cli: Cli) -> None:
    found = json.loads(wmrgen_cli("icr", car, "front=pi/2", "--json").out)
    assert found["icr"] == pytest.approx([-0.3, 0.0], abs=1e-12)


def test_a_centre_at_infinity_lies_to_the_left_of_travel(wmrgen_cli: Cli) -> None:
    robot = ROOT / "robots" / "festo_robotino.yaml"
    found = json.loads(wmrgen_cli("icr", robot, "vx=0.3", "vy=0.4", "--json").out)
    assert found["travel"] == pytest.approx(math.atan2(0.4, 0.3))
    assert found["direction"] == pytest.approx(found["travel"] + math.pi / 2)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["vx=0"], "icr = none: standstill\n"),
        (["vy=1"], f"slip = {math.sqrt(2):.6g} m/s\n"),
        (["vx=1", "omega=1", "point.x=1"], "point_velocity = (1.0, 1.0) m/s\npoint_radius   = 1.4142135623730951 m\n"),
    ],
)  # fmt: skip
def test_a_centre_of_a_twist_in_words(car: Path, wmrgen_cli: Cli, words: list[str], told: str) -> None:
    done = wmrgen_cli("icr", car, *words)
    assert done.code == 0 and told in (done.out + done.err)


def test_segments_in_words(tmp_path: Path, wmrgen_cli: Cli) -> None:
    """0.5 m/s and 1 rad/s of wheels of radius 0.0975 m, 0.1655 m beside P."""
    file = tmp_path / "segments.json"
    file.write_text('[{"vx": 0.5, "dt": 2}, {"omega": 1, "dt": 1}]')
    ahead, turning = 0.5 / 0.0975, 0.1655 / 0.0975
    assert wmrgen_cli("motion", PIONEER, "--segments", file).out.splitlines() == [
        f"   0.000 s  drive 2 s  left.spin={ahead:.6g} right.spin={ahead:.6g}  ->  x=1 y=0 theta=0",
        f"   2.000 s  drive 1 s  left.spin={-turning:.6g} right.spin={turning:.6g}  ->  x=1 y=0 theta=1",
    ]


def test_no_segments_and_a_wrong_unit_in_one(tmp_path: Path, wmrgen_cli: Cli) -> None:
    file = tmp_path / "segments.json"
    file.write_text("[]")
    done = wmrgen_cli("motion", PIONEER, "--segments", file)
    assert done.code == 2 and done.err.startswith(f"error[WMR112]: {file} ")
    file.write_text('[{"theta_rate": "90 deg", "dt": 1}]')
    done = wmrgen_cli("motion", PIONEER, "--segments", file)
    assert done.code == 2 and done.err.count("segments.json") == 1 and "deg/s" in done.err


def test_beyond_a_double_is_no_bug(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("motion", PIONEER, "left=1e308", "--time", "1e308")
    assert (done.code, done.out) == (2, "") and "\nerror[WMR112]" in done.err


def test_a_centre_that_only_the_steering_limits_refuse_is_not_blamed_on_fixed_wheels(wmrgen_cli: Cli) -> None:
    """The centre (0, 3) m is on the rear axle of the car; atan(2.5/2.25) is more than its limit of 40 deg."""
    car = ROOT / "robots" / "ackermann_car.yaml"
    for words in (["icr.x=0", "icr.y=3"], ["vx=3", "omega=1"]):
        said = wmrgen_cli("icr", car, *words).err
        assert "front_left.steer" in said and "rear" not in said
    said = wmrgen_cli("icr", car, "icr.x=1", "icr.y=9").err
    assert "rear_left" in said and "front_left" not in said


@pytest.mark.parametrize("words", [["vx=1", "front.steer=0.1"], ["icr.x=1", "vx=1"], ["left.spin=1"]])
def test_inputs_of_two_kinds_and_wheel_speeds_are_refused(
    car: Path, wmrgen_cli: Cli, words: list[str]
) -> None:
    done = wmrgen_cli("icr", car, *words)
    assert done.code == 2 and "WMR112" in done.err and "there is no input" not in done.err


@pytest.mark.parametrize("words", [["3", "8", "1.5"], ["k_rho"], ["k_rho=", "k_beta=-1"]])
def test_gains_need_their_names(wmrgen_cli: Cli, words: list[str]) -> None:
    done = wmrgen_cli("gains", *words)
    assert done.code == 2 and "WMR112" in done.err and "k_rho=" in done.err


def test_a_form_of_a_model_is_an_option(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("model", ROOT / "robots" / "bicycle.yaml", "posture")
    assert done.code == 2 and "--form posture" in done.err
