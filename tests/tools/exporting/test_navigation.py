"""Parameters of Nav2 and robot_localization. Expected: computed by hand from the robot files of the gallery."""

from __future__ import annotations

from collections.abc import Callable
from math import tan
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.conftest import DIFFERENTIAL, ROOT
from wmrgen import load
from wmrgen.errors import NotDerivableError
from wmrgen.tools.exporting.navigation import nav2, robot_localization

ROBOTS = ROOT / "robots"


def written(files: dict[str, str]) -> Any:
    """Return the tree of the one file."""
    (text,) = files.values()
    return yaml.safe_load(text)


@pytest.mark.parametrize(
    ("robot", "model"),
    [
        ("pioneer3dx", "DiffDrive"),
        ("clearpath_a200", "DiffDrive"),
        ("kuka_youbot", "Omni"),
        ("wpilib_swervebot", "Omni"),
        ("ackermann_car", "Ackermann"),
    ],
)
def test_the_motion_model_is_that_of_the_mobility(robot: str, model: str) -> None:
    follow = written(nav2(load(ROBOTS / f"{robot}.yaml")))["controller_server"]["ros__parameters"][
        "FollowPath"
    ]
    assert follow["motion_model"] == model
    assert ("vy_max" in follow) <= (model == "Omni")


def test_limits_and_footprint_of_a_differential_drive(tmp_path: Path) -> None:
    robot = tmp_path / "pair.yaml"
    robot.write_text(DIFFERENTIAL + "limits: {vx: [-0.5, 1], omega: 2, vx_rate: 0.6, omega_rate: 3}\n")
    tree = written(nav2(load(robot)))
    follow = tree["controller_server"]["ros__parameters"]["FollowPath"]
    assert [follow[name] for name in ("vx_max", "vx_min", "wz_max", "ax_max", "az_max")] == [
        1,
        -0.5,
        2,
        0.6,
        3,
    ]
    smoother = tree["velocity_smoother"]["ros__parameters"]
    assert smoother["max_velocity"] == [1, 0, 2] and smoother["min_velocity"] == [-0.5, 0, -2]
    assert smoother["max_accel"] == [0.6, 0, 3] and smoother["max_decel"] == [-0.6, 0, -3]
    for name in ("local_costmap", "global_costmap"):
        costmap = tree[name][name]["ros__parameters"]
        corners = yaml.safe_load(costmap["footprint"])
        wanted = [(0.0975, 0.1655), (-0.0975, 0.1655), (-0.0975, -0.1655), (0.0975, -0.1655)]
        for corner, right in zip(corners, wanted, strict=True):
            assert corner == pytest.approx(right)


def test_the_turning_radius_is_that_of_p(tmp_path: Path) -> None:
    """The inner wheel at its limit: the radius of P is wheelbase / tan(limit) plus half the track."""
    text = "wmrgen: 1\nname: car\nwheels:\n"
    for side, y in (("left", 0.2), ("right", -0.2)):
        text += f"  - {{name: rear_{side}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1}}\n"
        text += (
            f"  - {{name: front_{side}, type: steered, x: 0.6, y: {y}, heading: 0, r: 0.1, actuated: [steer],"
        )
        text += " limits: {steer: 0.5}}\n"
    robot = tmp_path / "car.yaml"
    robot.write_text(text)
    follow = written(nav2(load(robot)))["controller_server"]["ros__parameters"]["FollowPath"]
    assert follow["AckermannConstraints"]["min_turning_r"] == pytest.approx(0.6 / tan(0.5) + 0.2)
    robot.write_text(text.replace(" limits: {steer: 0.5}", ""))
    with pytest.raises(NotDerivableError) as refusal:
        nav2(load(robot))
    assert "--package ros2" in refusal.value.instead  # it has a motion model of its own


def test_the_filter_takes_the_velocities_of_the_wheels() -> None:
    own = written(robot_localization(load(ROBOTS / "pioneer3dx.yaml")))["ekf_filter_node"]["ros__parameters"]
    assert [k for k, used in enumerate(own["odom0_config"]) if used] == [6, 7, 11]
    assert len(own["odom0_config"]) == 15 and own["two_d_mode"] is True
    with pytest.raises(NotDerivableError):
        robot_localization(load(ROBOTS / "office_chair.yaml"))


@pytest.mark.parametrize("to", ["nav2", "robot_localization"])
def test_the_command_writes_the_file(tmp_path: Path, wmrgen_cli: Callable[..., Any], to: str) -> None:
    done = wmrgen_cli("export", ROBOTS / "pioneer3dx.yaml", "--to", to, "-o", tmp_path)
    assert done.code == 0 and len(list(tmp_path.iterdir())) == 1
