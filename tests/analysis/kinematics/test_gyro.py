"""A yaw-rate sensor is a row of `forward`: against numpy's lstsq with that row, and in everything made of `forward`."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.oracle import oracle, weighted
from tests.oracle.compare import evaluated
from tests.oracle.harness import Model, robot_text
from tests.oracle.weighted import LAYOUTS
from tests.robots import of_text
from tests.tools.lint.test_rules import linted
from wmrgen.errors import RobotFileError
from wmrgen.tools.calibration.calibrate import increments_of

PODS = [
    {"type": "swedish", "x": x, "y": y, "heading": turned, "gamma": 0.0, "sensed": ["spin"], "actuated": []}
    for x, y, turned in ((0.02, 0.13, 0.0), (-0.08, 0.01, np.pi / 2))
]
_DRIVES = [
    {"type": "swedish", "x": x, "y": y, "gamma": 0.8 * x * y, "sensed": []}
    for x, y in ((1, 1), (1, -1), (-1, 1))
]
TRACKED = weighted.layout(*PODS, *_DRIVES)
ROBOTS = {
    name: LAYOUTS[name] for name in ("differential", "swerve", "wide castors", "bicycle", "mixed", "offset")
}
ROBOTS["two tracking wheels"] = TRACKED
TWIST = ("vx", "vy", "omega")


def with_gyro(layout: dict[str, Any], weight: float, noise: str = "") -> tuple[dict[str, Any], str]:
    """The layout of the oracle, and the text of the robot file."""
    return {**layout, "gyro": weight}, robot_text(layout, extra=f"gyro: {{weight: {weight}{noise}}}\n")


def drawn(model: Model, rng: random.Random) -> dict[str, float]:
    return {p.name: rng.uniform(-2, 2) for p in model.derivation.formula("forward").inputs}


@pytest.mark.parametrize("name", ROBOTS)
def test_the_row_of_the_yaw_rate(name: str, tmp_path: Path) -> None:
    """Every way in which `forward` solves its rows; one robot in every backend."""
    rng = random.Random(name)
    layout, text = with_gyro(ROBOTS[name], rng.choice([0.5, 1.0, 20.0]))
    model = Model.of(text, tmp_path)
    for _ in range(3):
        sensed = drawn(model, rng)
        twist, slip = weighted.forward(layout, sensed)
        results = (
            evaluated(model, "forward", sensed) if name == "mixed" else {"": model.numpy.forward(**sensed)}
        )
        for backend, found in results.items():
            values = [float(found[k]) for k in (*TWIST, "slip")]
            assert values == pytest.approx([*twist, slip], rel=1e-8, abs=1e-8), backend


def test_two_tracking_wheels_and_a_gyro_show_every_twist(tmp_path: Path) -> None:
    """Any twist comes back without slip; without the gyro, lint says what would do it."""
    layout, text = with_gyro(TRACKED, 1.0)
    model, rng = Model.of(text, tmp_path), random.Random(1)
    for _ in range(5):
        twist = np.array([rng.uniform(-2, 2) for _ in TWIST])
        spins = oracle.inverse(layout, twist, {})
        sensed = {p.name: spins.get(p.name, twist[2]) for p in model.derivation.formula("forward").inputs}
        found = model.numpy.forward(**sensed)
        assert [float(found[k]) for k in TWIST] == pytest.approx(list(twist), abs=1e-12)
        assert found["slip"] == 0
    for gyro, expected in (("gyro: {}\n", False), ("", True)):
        path = tmp_path / f"pods{len(gyro)}.yaml"
        path.write_text(robot_text(TRACKED, extra=gyro))
        (*found_,) = (f.instead for f in linted(path) if f.code == "WMR022")
        assert bool(found_) is expected and all("gyro:" in instead for instead in found_)


@pytest.mark.parametrize("name", ["two tracking wheels", "swerve", "wide castors"])
def test_its_noise_goes_through_the_least_squares(name: str) -> None:
    """The covariance is J S J^T, J the differences of numpy's lstsq, S the noise of joints and gyro."""
    layout = {**ROBOTS[name], "gyro": 4.0}
    extra = (
        "noise: {spin: {constant: 0.2 rad/s}}\ngyro: {weight: 4, constant: 0.03 rad/s, proportional: 0.1}\n"
    )
    d = of_text(robot_text(ROBOTS[name], extra=extra), ["forward", "forward_covariance"])
    twist = np.array([0.4, 0.3, -0.7])
    present = {f"{w['name']}.steer": 0.3 for w in layout["wheels"] if w["type"] in oracle.STEERABLE}
    joints = present | oracle.inverse(layout, twist, present)
    sensed = {
        p.name: joints.get(p.name, twist[2] if p.name == "gyro" else 0.0) for p in d.formula("forward").inputs
    }
    wanted = np.zeros((3, 3))
    for port, value in sensed.items():
        sigma = {"gyro": np.hypot(0.03, 0.1 * value)}.get(port, 0.2 * port.endswith("spin"))
        sides = [weighted.forward(layout, sensed | {port: value + step})[0] for step in (1e-5, -1e-5)]
        wanted += sigma**2 * np.outer(*[(sides[0] - sides[1]) / 2e-5] * 2)
    values = sensed | dict(zip(TWIST, twist, strict=True)) | {"slip": 0.0}
    inputs = [p.name for p in d.formula("forward_covariance").inputs]
    result = d.numpy().forward_covariance(**{n: values[n] for n in inputs})
    for i, a in enumerate(TWIST):
        for j, b in enumerate(TWIST[i:], i):
            assert float(result[a + b]) == pytest.approx(wanted[i, j], abs=1e-6 * np.trace(wanted))


def test_a_step_of_angles_takes_the_angle_of_the_gyro() -> None:
    """Half a second at constant rates is one arc."""
    layout, text = with_gyro(LAYOUTS["differential"], 9.0)
    d = of_text(text, ["odometry_from_angles"])
    sensed = {"w0.spin": 3.0, "w1.spin": 1.0, "gyro": -0.4}
    wanted = oracle.step(np.array([1.0, 2.0, 0.3]), weighted.forward(layout, sensed)[0], 0.5)
    steps = {f"{name}_step": 0.5 * value for name, value in sensed.items()}
    pose = d.numpy().odometry_from_angles(x=1.0, y=2.0, theta=0.3, **steps)
    assert [float(pose[k]) for k in ("x", "y", "theta")] == pytest.approx(list(wanted), abs=1e-12)


def test_calibration_goes_by_the_joints() -> None:
    tunable = "parameters: {h: {value: 0.2, tunable: true}}\ngyro: {}\n"
    d = of_text(robot_text(LAYOUTS["differential"], extra=tunable).replace("y: 0.2,", "y: h,"))
    assert set(increments_of(d)[0].joints) == {"w0.spin", "w1.spin"}


@pytest.mark.parametrize(
    ("gyro", "code", "at", "instead"),
    [("gyro: {weight: 0}", "WMR109", "0}", "0.25"), ("gyro: {constant: -1 rad/s}", "WMR109", "-1 rad/s", "0"),
     ("gyro: {sigma: 1 rad/s}", "WMR102", "sigma", "constant"), ("imu: {}", "WMR102", "imu", "gyro"),
     ("gyro: yes", "WMR104", "yes", "gyro: {"), ("gyro: {}\nparameters: {gyro: 1}", "WMR109", "1}", "name")],
)  # fmt: skip
def test_gyros_that_make_no_sense(gyro: str, code: str, at: str, instead: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        _ = of_text(robot_text(LAYOUTS["differential"], extra=f"{gyro}\n")).robot
    mark = caught.value.mark
    assert caught.value.code == code and instead in caught.value.instead
    assert mark is not None and mark.text[mark.column - 1 :].startswith(at)
