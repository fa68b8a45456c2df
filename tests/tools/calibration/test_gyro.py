"""Scale and bias of a gyro are found from its readings and reference headings."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.tools.calibration.drives import derived
from tests.tools.calibration.simulated import LAYOUTS, Layout, Reals, Tracker, csv, drive
from tests.tools.calibration.test_simulated_robots import ROUGH
from wmrgen.tools.calibration.calibrate import Calibration, calibrate

SCALE, BIAS = 1.03, -0.02  # rad/s
LATE = 0.1  # s


def straight(t: Reals) -> tuple[Reals, Reals, Reals]:
    return 0.4 + 0 * t, 0 * t, 0 * t


def calibrated_with_gyro(
    folder: Path, layout: Layout, walk: float = 0.0, has_gyro: bool = True
) -> Calibration:
    """Calibrate a robot whose gyro reads rate / SCALE + BIAS.

    Args:
        folder: For the logs.
        layout: The robot and its drives.
        walk: [rad/s] deviation of each reading.
        has_gyro: Whether the robot file says so.
    """
    return calibrate(
        derived(layout.text + "gyro: {constant: 0.005 rad/s}\n" * has_gyro), _logs(folder, layout, walk)
    )


def _logs(folder: Path, layout: Layout, walk: float) -> list[Path]:
    random, paths = np.random.default_rng(5), []
    tracker = Tracker(0.03 - 0.02j, 0.4, late=LATE, noise=(0.002, 0.003), every=5)
    for index, twist in enumerate(layout.drives):
        recorded = drive(layout, twist, 60, 20, tracker, ROUGH, seed=index)
        rate = twist(recorded.log["t"])[2]
        reading = rate / SCALE + BIAS + walk * random.standard_normal(len(rate))
        paths.append(folder / f"run-{index}.csv")
        paths[-1].write_text(csv({**recorded.log, "gyro": reading}), encoding="utf-8")
        paths[-1].with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
    return paths


@pytest.mark.parametrize("name", ["differential", "mecanum"])
def test_scale_and_bias(tmp_path: Path, name: str) -> None:
    """With a reference that is turned on the robot, whose clock is late."""
    found = calibrated_with_gyro(tmp_path, LAYOUTS[name], walk=0.01).gyro
    assert found is not None and found.scale.sigma is not None and found.bias.sigma is not None
    assert abs(found.scale.value - SCALE) < 3 * found.scale.sigma < 0.02
    assert abs(found.bias.value - BIAS) < 3 * found.bias.sigma < 0.003


def test_a_gyro_without_noise_is_exact(tmp_path: Path) -> None:
    layout = LAYOUTS["differential"]
    paths = _logs(tmp_path, layout, 0.0)
    found = calibrate(derived(layout.text + "gyro: {constant: 0.005 rad/s}\n"), paths).gyro
    assert found is not None
    assert found.scale.value == pytest.approx(SCALE, abs=2e-3)
    assert found.bias.value == pytest.approx(BIAS, abs=2e-4)


@pytest.mark.parametrize("walk", [0.0, 0.01])
def test_straight_drives_show_the_bias_alone(tmp_path: Path, walk: float) -> None:
    """Without noise the readings are constant, so that scale and bias are the same to them."""
    layout = replace(LAYOUTS["differential"], drives=(straight, straight))
    found = calibrated_with_gyro(tmp_path, layout, walk=walk).gyro
    assert found is not None and found.bias.sigma is not None
    assert found.scale.value == 1 and found.scale.sigma is None
    assert abs(found.bias.value - BIAS) < 3 * found.bias.sigma < 0.003


def test_a_robot_without_gyro_has_none(tmp_path: Path) -> None:
    """A column of that name may be anything then."""
    assert calibrated_with_gyro(tmp_path, LAYOUTS["differential"], has_gyro=False).gyro is None


def test_the_parameters_do_not_depend_on_the_gyro(tmp_path: Path) -> None:
    layout = LAYOUTS["differential"]
    with_it = calibrated_with_gyro(tmp_path, layout, walk=0.01)
    without = calibrated_with_gyro(tmp_path, layout, walk=0.01, has_gyro=False)
    for name, estimate in with_it.parameters.items():
        assert estimate == without.parameters[name]


def test_the_command_prints_it(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    layout = LAYOUTS["differential"]
    robot = tmp_path / "robot.yaml"
    robot.write_text(layout.text + "gyro: {constant: 0.005 rad/s}\n", encoding="utf-8")
    outcome = wmrgen_cli("calibrate", robot, *_logs(tmp_path, layout, 0.01), "--json")
    assert outcome.code == 0
    found = json.loads(outcome.out)["gyro"]
    assert found["scale"]["value"] == pytest.approx(SCALE, abs=0.01)
    assert found["bias"]["value"] == pytest.approx(BIAS, abs=0.002)
