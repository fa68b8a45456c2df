"""The node of the ROS 2 package, run on ROS 2: eight robots, and the faults. Another Python has ROS, see `ros_python`.

Expected: the closed form of a figure of eight. `test_ros2` tests the same core without ROS, with more faults."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from math import pi, remainder
from pathlib import Path
from typing import Any

import pytest

from tests.codegen.packages.eight import ROBOTS, figure_of_eight, named
from tests.codegen.packages.made import of_gallery
from tests.codegen.packages.test_ros2 import core_of
from tests.conftest import ROOT, put
from tests.external_tools import missing, need
from wmrgen import derive, load

DRIVER = Path(__file__).parent / "ros2_driver.py"
DOMAIN = str(100 + os.getpid() % 100)  # so that two runs of the tests do not hear each other


def ros_python() -> str:
    """Return the Python that has rclpy: that of ``ROS_PYTHON``, of build/ros, or this one."""
    for python in (
        os.environ.get("ROS_PYTHON"),
        str(ROOT / "build" / "ros" / "bin" / "python"),
        sys.executable,
    ):
        if python and Path(python).exists():
            asked = subprocess.run([python, "-c", "import rclpy"], capture_output=True)
            if asked.returncode == 0:
                return python
    missing("rclpy is not installed")
    raise AssertionError


def driven(folder: Path, script: dict[str, Any]) -> dict[str, Any]:
    """Run the node of a package with the messages of a script, and return what it published and logged."""
    python = ros_python()
    (folder / "script.json").write_text(json.dumps(script))
    environment = os.environ | {
        "ROS_DOMAIN_ID": DOMAIN,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_LOG_DIR": str(folder / "log"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    done = subprocess.run(
        [python, DRIVER, folder / "script.json"],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result: dict[str, Any] = json.loads((folder / "result.json").read_text())
    return result


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_odometry_and_transform_of_a_figure_of_eight(robot: str, tmp_path: Path) -> None:
    ros_python()
    path = ROOT / "robots" / f"{robot}.yaml"
    core, _ = core_of(tmp_path, path)
    moments = list(figure_of_eight(derive(load(path)), *ROBOTS[robot]))
    steps = [
        {"do": "joint_states", "stamp": moment.time, **named(moment.joints, core.JOINTS), "wait": k > 0}
        for k, moment in enumerate(moments)
    ]
    script = {"robot": robot, "parameters": {"long_step": 10.0, "longest_step": 10.0}, "steps": steps}
    result = driven(tmp_path, script)
    assert len(result["odom"]) == len(moments) - 1
    for got, moment in zip(result["odom"], moments[1:], strict=True):
        assert got["stamp"] == moment.time and got["frames"] == ["odom", core.BASE_FRAME]
        assert got["pose"][:2] == pytest.approx(moment.pose[:2], abs=1e-6)
        assert abs(remainder(got["pose"][2] - moment.pose[2], 2 * pi)) < 1e-6
        assert got["twist"] == pytest.approx(moment.twist, abs=1e-9)
        assert got["transform"] == {key: got[key] for key in ("stamp", "frames", "pose")}


@pytest.mark.slow
def test_faults_have_their_behaviour_and_one_line_each(tmp_path: Path) -> None:
    ros_python()
    robot = "pioneer3dx"
    core_of(tmp_path, ROOT / "robots" / f"{robot}.yaml")
    names, second = ["left_spin", "right_spin"], 1_000_000_000

    def joints(stamp: float, wait: bool = True, name: list[str] = names) -> dict[str, Any]:
        still = [1.0, 1.0]
        return {
            "do": "joint_states",
            "stamp": round(stamp * second),
            "name": name,
            "position": [],
            "velocity": still,
            "wait": wait,
        }

    def command(vx: float, publisher: int = 0) -> dict[str, Any]:
        return {"do": "cmd_vel", "twist": [vx, 0.0, 0.0], "publisher": publisher}

    steps = [
        joints(1.0, wait=False),
        command(99.0), joints(1.05),             # beyond its limits
        command(0.2, publisher=1), joints(1.1),  # a second publisher
        joints(1.5),                             # lost messages
        joints(11.5, wait=False),                # a gap
        joints(11.6),
        joints(11.6, wait=False),                # a second driver
        joints(11.7, wait=False, name=["left", "right_spin"]),
        {"do": "sleep", "seconds": 1.0},         # the publishers are dead
    ]  # fmt: skip
    result = driven(tmp_path, {"robot": robot, "parameters": {}, "steps": steps})
    travelled = [got["pose"][0] for got in result["odom"]]
    assert travelled == pytest.approx([0.05 * 0.0975, 0.1 * 0.0975, 0.5 * 0.0975, 0.6 * 0.0975], abs=1e-9)
    speeds = [got["velocity"][0] for got in result["commands"]]
    assert max(speeds) > 0 and speeds[-1] == 0
    words = ["limits", "publish cmd_vel", "integrated", "did not change", "not newer", "left_spin"]
    for word in words:
        assert len([line for line in result["log"] if word in line]) == 1, (word, result["log"])


@pytest.mark.slow
def test_colcon_builds_the_packages(tmp_path: Path) -> None:
    """Those of eight robots in one workspace. ament_cmake belongs to the system's Python, whose folders come first."""
    need("cmake", "gcc")
    if shutil.which("colcon") is None:  # it cannot print its version
        missing("colcon is not installed")
    for robot in ROBOTS:
        put(tmp_path / "src" / robot, of_gallery(robot, "ros2"))
    environment = os.environ | {"PATH": f"/usr/bin:/bin:{os.environ['PATH']}"}
    done = subprocess.run(["colcon", "build"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    for robot in ROBOTS:
        place = tmp_path / "install" / f"{robot}_kinematics" / "lib" / f"{robot}_kinematics"
        names = {path.name for path in place.iterdir()}
        assert names == {f"lib{robot}_bridge.so", f"{robot}_node", f"{robot}_core.py"}
