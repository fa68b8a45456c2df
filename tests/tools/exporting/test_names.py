"""Names of joints and of the frame survive import, export and compare; a joint that points down keeps its sign."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

TEXT = """\
wmrgen: 1
name: names
frame: chassis_base
wheels:
  - {name: rl, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1, joints: {spin: rear_left_wheel_joint}}
  - {name: rr, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1, joints: {spin: rear_right_wheel_joint}}
  - {name: fl, type: steered, x: 0.6, y: 0.2, heading: 0, r: 0.1, actuated: [steer], limits: {steer: [-0.3, 0.6]},
     joints: {spin: front_left_wheel_joint, steer: front_left_steer_joint}}
  - {name: fr, type: steered, x: 0.6, y: -0.2, heading: 0, r: 0.1, actuated: [steer],
     joints: {spin: front_right_wheel_joint, steer: front_right_steer_joint}}
"""
JOINTS = {"rear_left_wheel_joint", "rear_right_wheel_joint", "front_left_wheel_joint", "front_right_wheel_joint",
          "front_left_steer_joint", "front_right_steer_joint"}  # fmt: skip
DOWN = re.sub(r"steer: front", "steer: -front", TEXT)
Cli = Callable[..., Any]


@pytest.mark.parametrize("text", [TEXT, DOWN])
@pytest.mark.parametrize("form", ["urdf", "sdf"])
def test_names_come_back_from_a_description(tmp_path: Path, wmrgen_cli: Cli, text: str, form: str) -> None:
    robot, again = tmp_path / "names.yaml", tmp_path / "again.yaml"
    robot.write_text(text, encoding="utf-8")
    assert wmrgen_cli("export", robot, "--to", form, "-o", tmp_path).code == 0
    (description,) = tmp_path.glob(f"*.{form}")
    written = description.read_text(encoding="utf-8")
    assert set(re.findall(r'<joint name="([^"]*_joint)"', written)) == JOINTS
    assert 'link name="chassis_base"' in written and "base_link" not in written
    assert wmrgen_cli("compare", robot, description).code == 0
    assert wmrgen_cli("import", description, "-o", again).code == 0
    assert wmrgen_cli("compare", again, description).code == 0
    imported = again.read_text(encoding="utf-8")
    assert all(name in imported for name in JOINTS) and ("frame: chassis_base" in imported) == (
        form == "urdf"
    )
    assert ("steer: -front_left_steer_joint" in imported) == (text == DOWN)


def test_limits_of_a_joint_that_points_down_change_places(tmp_path: Path, wmrgen_cli: Cli) -> None:
    robot = tmp_path / "names.yaml"
    robot.write_text(DOWN, encoding="utf-8")
    wmrgen_cli("export", robot, "--to", "urdf", "-o", tmp_path)
    written = (tmp_path / "names.urdf").read_text(encoding="utf-8")
    joint = written[written.index('joint name="front_left_steer_joint"') :]
    assert re.findall(r'axis xyz="(.*)"', joint)[0] == "0 0 -1"
    assert re.findall(r'limit lower="(\S*)" upper="(\S*)"', joint)[0] == ("-0.6", "0.3")


def test_no_controller_gets_joints_that_turn_the_other_way(tmp_path: Path, wmrgen_cli: Cli) -> None:
    robot, plain = tmp_path / "down.yaml", tmp_path / "names.yaml"
    robot.write_text(DOWN, encoding="utf-8")
    plain.write_text(TEXT, encoding="utf-8")
    refused = wmrgen_cli("export", robot, "--to", "ros2_control", "-o", tmp_path)
    assert refused.code == 3 and "WMR113" in refused.err
    assert wmrgen_cli("export", plain, "--to", "ros2_control", "-o", tmp_path).code == 0
    parameters = tmp_path / "names_controllers.yaml"
    assert "base_frame_id: chassis_base" in parameters.read_text(encoding="utf-8")
    assert wmrgen_cli("compare", plain, parameters).code == 0
    apart = wmrgen_cli("compare", robot, parameters)
    assert apart.code == 1 and "WMR052" in apart.out
