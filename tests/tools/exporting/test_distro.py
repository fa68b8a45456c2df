"""Parameters of a release of ROS 2: `export --distro` writes what `compare --distro` reads."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.conftest import Outcome

Cli = Callable[..., Outcome]
CAR = """
wmrgen: 1
name: car
wheels:
  - {name: rl, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}
  - {name: rr, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
  - {name: fl, type: steered, x: 0.8, y: 0.3, heading: 0, r: 0.1, actuated: [steer]}
  - {name: fr, type: steered, x: 0.8, y: -0.3, heading: 0, r: 0.1, actuated: [steer]}
"""
NARROW = CAR.replace("0.8, y: 0.3", "0.8, y: 0.25").replace("0.8, y: -0.3", "0.8, y: -0.25")
TRIKE = CAR.replace("0.8, y: 0.3", "0.8, y: 0").replace(CAR[CAR.index("  - {name: fr") :], "")
BICYCLE = TRIKE.replace(TRIKE[TRIKE.index("  - {name: rr") : TRIKE.index("  - {name: fl")], "").replace(
    "0.3", "0"
)
PAIR = CAR[: CAR.index("  - {name: fl")] + "limits: {vx: 2, omega: 1, vx_rate: 3}\n"
OMNI = """
wmrgen: 1
name: omni
wheels:
  - {name: a, type: swedish, x: 0.2, y: 0, heading: -pi/2, r: 0.05, gamma: 0}
  - {name: b, type: swedish, x: -0.1, y: 0.1*sqrt(3), heading: pi/6, r: 0.05, gamma: 0}
  - {name: c, type: swedish, x: -0.1, y: -0.1*sqrt(3), heading: 5*pi/6, r: 0.05, gamma: 0}
"""
DISTROS = ["humble", "jazzy", "kilted", "rolling"]


def exported(wmrgen_cli: Cli, folder: Path, robot: str, *options: str) -> tuple[Path, Path, dict[str, Any]]:
    """Write a robot and its parameters; return both files and the controller's parameters."""
    source = folder / "robot.yaml"
    source.write_text(robot, encoding="utf-8")
    done = wmrgen_cli("export", source, "--to", "ros2_control", "-o", folder / "out", *options)
    assert done.code == 0, done.err
    file = next((folder / "out").glob("*_controllers.yaml"))
    tree = yaml.safe_load(file.read_text(encoding="utf-8"))
    return source, file, tree["base_controller"]["ros__parameters"]


@pytest.mark.parametrize("distro", DISTROS)
@pytest.mark.parametrize("robot", [CAR, TRIKE, BICYCLE, PAIR], ids=["car", "trike", "bicycle", "pair"])
def test_a_release_reads_what_is_written_for_it(
    wmrgen_cli: Cli, tmp_path: Path, robot: str, distro: str
) -> None:
    source, file, _ = exported(wmrgen_cli, tmp_path, robot, "--distro", distro)
    done = wmrgen_cli("compare", source, file, "--distro", distro)
    assert done.code == 0, done.out + done.err


@pytest.mark.parametrize("robot", [CAR, TRIKE, BICYCLE], ids=["car", "trike", "bicycle"])
def test_humble_does_not_read_the_names_of_rolling(wmrgen_cli: Cli, tmp_path: Path, robot: str) -> None:
    source, file, _ = exported(wmrgen_cli, tmp_path, robot, "--distro", "rolling")
    assert wmrgen_cli("compare", source, file, "--distro", "humble").code != 0


def test_humble_has_front_and_rear_wheels(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Its formula has no track of the steered axle, which `compare` finds."""
    source, file, own = exported(wmrgen_cli, tmp_path, NARROW, "--distro", "humble")
    assert wmrgen_cli("compare", source, file, "--distro", "humble").code == 1
    assert own["front_steering"] is True and "traction_joints_names" not in own
    assert own["front_wheels_names"] == ["fr_steer", "fl_steer"]
    assert own["rear_wheels_names"] == ["rr_spin", "rl_spin"]
    assert (own["front_wheel_track"], own["rear_wheel_track"], own["wheelbase"]) == (0.5, 0.6, 0.8)
    assert own["front_wheels_radius"] == own["rear_wheels_radius"] == 0.1


def test_humble_enables_the_limits_that_are_written(wmrgen_cli: Cli, tmp_path: Path) -> None:
    *_, own = exported(wmrgen_cli, tmp_path, PAIR, "--distro", "humble")
    assert own["linear"]["x"] == {
        "max_velocity": 2.0, "min_velocity": -2.0, "has_velocity_limits": True,
        "max_acceleration": 3.0, "min_acceleration": -3.0, "has_acceleration_limits": True,
    }  # fmt: skip
    assert own["angular"]["z"] == {"max_velocity": 1.0, "min_velocity": -1.0, "has_velocity_limits": True}
    *_, newest = exported(wmrgen_cli, tmp_path, PAIR, "--distro", "jazzy")
    assert "has_velocity_limits" not in newest["linear"]["x"]


@pytest.mark.parametrize(("distro", "code"), [("humble", 3), ("jazzy", 0), ("kilted", 0), ("rolling", 0)])
def test_a_release_without_the_controller_is_refused(
    wmrgen_cli: Cli, tmp_path: Path, distro: str, code: int
) -> None:
    source = tmp_path / "omni.yaml"
    source.write_text(OMNI, encoding="utf-8")
    assert wmrgen_cli("export", source, "--to", "ros2_control", "--distro", distro).code == code


def test_other_descriptions_have_no_release(wmrgen_cli: Cli, tmp_path: Path) -> None:
    source = tmp_path / "car.yaml"
    source.write_text(CAR, encoding="utf-8")
    assert wmrgen_cli("export", source, "--to", "urdf", "--distro", "humble").code == 2
