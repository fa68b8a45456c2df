"""Trajectories of segments, and the commands `wmrgen motion` and `wmrgen icr`."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from tests.functions.motion.common import CAR, FOUR_WS, SKEWED, derived, run_cli
from tests.functions.refusals import missing_names, refused
from wmrgen.errors import UsageError
from wmrgen.functions.motion.icr import check_steering
from wmrgen.functions.motion.segments import Phase, Segment, plan, segment
from wmrgen.functions.registry import Reason
from wmrgen.geometry.exact.number import ZERO, Exact

ROBOTS = Path(__file__).parents[3] / "robots"
DIFFERENTIAL = str(ROBOTS / "textbook_differential.yaml")
SWERVE = FOUR_WS.replace("name: four_ws", "name: limited") + "limits: {steer_rate: [-1, 2]}\n"


def values(**given: float) -> Mapping[str, Exact]:
    from fractions import Fraction

    return {k: Exact(Fraction(v)) for k, v in given.items()}


def phases(text: str, *parts: Mapping[str, Exact]) -> list[Phase]:
    d = derived(text)
    segments = [segment(p, f"segment {k}") for k, p in enumerate(parts)]
    return plan(d.robot, segments, d.evaluate, (ZERO, ZERO, ZERO), {})


def test_waits_are_the_slowest_wheels() -> None:
    """Crab motion at 1 rad: every wheel turns by 1 at 2 rad/s; back by 1 at 1 rad/s."""
    crab = values(vx=math.cos(1.0), vy=math.sin(1.0), dt=1.0)
    result = phases(SWERVE, crab, values(vx=1.0, dt=0.5))
    assert [p.action for p in result] == ["steer", "drive", "steer", "drive"]
    np.testing.assert_allclose([float(p.dt) for p in result], [0.5, 1.0, 1.0, 0.5], rtol=1e-12)


def test_the_robot_stands_while_offset_wheels_steer() -> None:
    """Wheels beside their axis roll while they turn: forward kinematics sees no motion."""
    (steer, _) = phases(SWERVE, values(vx=1.0, vy=1.0, omega=1.0, dt=1.0))
    assert steer.action == "steer" and steer.dt > 0
    rates = {f"{n}.spin": v for n, v in steer.spins.items()}
    rates |= {f"{n}.steer_rate": v / steer.dt for n, v in steer.steers.items()}
    rates |= {f"{n}.steer": v / 2 for n, v in steer.steers.items()}
    twist = derived(SWERVE).evaluate("forward", rates)
    assert all(abs(float(v)) < 1e-12 for v in twist.values())


def test_displacements_are_reached_and_add_up() -> None:
    parts = [values(x=0.4, y=0.1, theta=0.8, dt=2.0), values(x=-0.2, y=0.3, theta=-2.0, dt=1.0)]
    result = [p for p in phases(FOUR_WS, *parts) if p.action == "drive"]
    pose = np.array([0.4, 0.1, 0.8])
    np.testing.assert_allclose([float(v) for v in result[0].pose], pose, atol=1e-12)
    c, s = math.cos(0.8), math.sin(0.8)
    pose += [c * -0.2 - s * 0.3, s * -0.2 + c * 0.3, -2.0]
    np.testing.assert_allclose([float(v) for v in result[1].pose], pose, atol=1e-12)


def test_commands_drive_the_twist() -> None:
    """Forward kinematics of the commanded joints is the twist of the phase."""
    for p in phases(FOUR_WS, values(vx=0.5, vy=0.2, omega=-0.4, dt=1.0), values(omega=1.0, dt=1.0)):
        if p.action == "drive":
            rates = {f"{n}.spin": v for n, v in p.spins.items()} | {
                f"{n}.steer": v for n, v in p.steers.items()
            }
            twist = derived(FOUR_WS).evaluate("forward", rates)
            np.testing.assert_allclose(
                [float(twist[k]) for k in ("vx", "vy", "omega")], [float(v) for v in p.twist], atol=1e-12
            )


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"x_rate": 1.0, "theta_rate": 1.0, "dt": 1.0}, ("vx vy omega",)),
        ({"vx": 1.0}, ("dt",)),
        ({"vx": 1.0, "x": 1.0, "dt": 1.0}, ("vx vy omega", "x_rate y_rate theta_rate", "x y theta")),
        ({"dt": 1.0}, ("vx vy omega", "x_rate y_rate theta_rate", "x y theta")),
    ],
)
def test_segments_that_are_none(given: dict[str, float], names: tuple[str, ...]) -> None:
    with pytest.raises(UsageError) as caught:
        segment(values(**given), "segment 0")
    assert missing_names(caught.value, ("segment 0", *names)) == []


def test_driven_castors_have_no_segments() -> None:
    d = derived(SKEWED.replace("r: 0.05}", "r: 0.05, actuated: [spin, steer]}"))
    with refused(Reason.CASTOR, "tail"):
        plan(d.robot, [Segment("twist", (ZERO, ZERO, ZERO), Exact(1))], d.evaluate, (ZERO,) * 3, {})


def test_motion_in_words() -> None:
    out, _ = run_cli("motion", DIFFERENTIAL, "left=4", "right.spin=2", "--time", "2.3", "--json")
    result = json.loads(out)
    assert result["path"] == "circle, clockwise"
    assert set(result) == {"x", "y", "theta", "path", "centre", "radius", "period", "speed", "direction"}
    straight, _ = run_cli("motion", DIFFERENTIAL, "left=4", "right=4", "--time", "1")
    assert "straight line" in straight and "radius" not in straight
    rest, _ = run_cli("motion", DIFFERENTIAL, "left=0", "right=0", "--time", "1")
    assert "standstill" in rest
    spot, _ = run_cli("motion", DIFFERENTIAL, "left=-1", "right=1", "--time", "1")
    assert "turning on the spot, counter-clockwise" in spot


def test_motion_says_what_is_missing_and_what_slides() -> None:
    _, err = run_cli("motion", DIFFERENTIAL, "left=4", "--time", "1")
    assert "taken as 0: right.spin" in err
    words = ["front_left=1", "front_right=1", "rear_left=1", "rear_right=2"]
    _, err = run_cli("motion", str(ROBOTS / "clearpath_do100.yaml"), *words, "--time", "1")
    assert "do not agree" in err


def test_motion_wants_time_or_segments() -> None:
    _, err = run_cli("motion", DIFFERENTIAL, "left=4", code=2)
    assert "--time" in err


def test_a_forbidden_segment_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "s.json"
    file.write_text('[{"vy": 1, "dt": 1}]')
    _, err = run_cli("motion", DIFFERENTIAL, "--segments", str(file), code=2)
    assert "the wheels forbid this motion" in err


@pytest.fixture
def car(tmp_path: Path) -> str:
    path = tmp_path / "car.yaml"
    path.write_text(CAR)
    return str(path)


def test_icr_of_a_car(car: str) -> None:
    out, _ = run_cli("icr", car, "icr.x=0.1", "icr.y=5", "--json")
    to = json.loads(out)
    np.testing.assert_allclose(
        [to["fr.steer"], to["fl.steer"]], [math.atan2(2.4, 5.6), math.atan2(2.4, 4.4)], rtol=1e-12
    )
    out, err = run_cli("icr", car, *(f"{k}={v!r}" for k, v in to.items()), "--json")
    result = json.loads(out)
    assert (
        result["consistent"] and result["rank"] == 2 and result["mobility"] == 1 and "incompatible" not in err
    )
    np.testing.assert_allclose(result["icr"], [0.1, 5.0], rtol=1e-9)


def test_icr_at_infinity(car: str) -> None:
    out, _ = run_cli("icr", car, "fr=0", "fl=0", "--json")
    result = json.loads(out)
    assert result["icr"] == "at infinity" and result["consistent"]
    assert result["direction"] == pytest.approx(math.pi / 2)
    out, _ = run_cli("icr", car, "vx=2", "--json")
    assert json.loads(out)["icr"] == "at infinity"


def test_collinear_two_steer_has_a_line_of_centres(tmp_path: Path) -> None:
    """S-twosteer-singular: rank C1 = 1."""
    path = tmp_path / "two.yaml"
    wheel = "type: steered, y: 0, heading: pi/2, r: 0.1"
    path.write_text(
        f"wmrgen: 1\nname: two\nwheels:\n  - {{name: a, x: 0.5, {wheel}}}\n  - {{name: b, x: -0.5, {wheel}}}\n"
    )
    out, _ = run_cli("icr", str(path), "a=0", "b=0", "--json")
    result = json.loads(out)
    assert result["rank"] == 1 and result["mobility"] == 2 and "anywhere" in result["icr"]
    assert check_steering(derived(path.read_text()).robot, {"a": 0.2, "b": 0.2}).rank == 2


def test_the_odd_wheel_is_named(tmp_path: Path) -> None:
    path = tmp_path / "four.yaml"
    path.write_text(FOUR_WS)
    out, _ = run_cli("icr", str(path), "icr.x=0.3", "icr.y=2", "--json")
    to = json.loads(out)
    to["w3.steer"] += 0.05
    out, err = run_cli("icr", str(path), *(f"{k}={v!r}" for k, v in to.items()), "--json")
    assert "all axles but that of w3 meet" in err
    errors = {k: abs(v["error"]) for k, v in json.loads(out)["wheels"].items()}
    assert max(errors, key=lambda k: errors[k]) == "w3"
