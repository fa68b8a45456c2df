"""ROS bags: what they give is what the same readings in CSV files give."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import Writer
from rosbags.typesys import Stores, get_typestore

import wmrgen
from tests.conftest import command_line
from wmrgen.errors import UsageError
from wmrgen.tools.calibration.bags import tables

ROBOT = """wmrgen: 1
name: cart
parameters:
  radius: {value: 0.05, tunable: true}
  half_track: {value: 0.15, tunable: true}
wheels:
  - {name: left, type: fixed, x: 0, y: half_track, heading: 0, r: radius, joints: {spin: base_to_left}}
  - {name: right, type: fixed, x: 0, y: -half_track, heading: 0, r: radius, joints: {spin: -base_to_right}}
"""
STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types


def drive(seed: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return joint angles of a robot of radius 0.051 and half track 0.147 m, and its poses."""
    t = np.arange(0, 40, 0.05)
    v, w = 0.3 + 0.1 * np.sin(0.3 * t + seed), 0.6 * np.sin(0.21 * t + 2 * seed)
    steps = np.diff(t, prepend=0)
    turned = np.cumsum(w * steps)
    middle = turned - 0.5 * w * steps
    x, y = np.cumsum(v * steps * np.cos(middle)), np.cumsum(v * steps * np.sin(middle))
    left, right = (np.cumsum((v + sign * 0.147 * w) * steps) / 0.051 for sign in (-1, 1))
    heading = np.angle(np.exp(1j * turned))
    return {"t": t, "left.angle": left, "right.angle": right}, {"t": t, "x": x, "y": y, "theta": heading}


def bag(path: Path, log: dict[str, np.ndarray], poses: dict[str, np.ndarray]) -> Path:
    """Write a bag as two publishers would: each wheel in messages of its own, the right one reversed."""
    stamp, header = TYPES["builtin_interfaces/msg/Time"], TYPES["std_msgs/msg/Header"]
    state, odometry = TYPES["sensor_msgs/msg/JointState"], TYPES["nav_msgs/msg/Odometry"]
    point, quaternion = TYPES["geometry_msgs/msg/Point"], TYPES["geometry_msgs/msg/Quaternion"]
    pose, covered = TYPES["geometry_msgs/msg/Pose"], TYPES["geometry_msgs/msg/PoseWithCovariance"]
    twist, vector = TYPES["geometry_msgs/msg/Twist"], TYPES["geometry_msgs/msg/Vector3"]
    moving, empty = TYPES["geometry_msgs/msg/TwistWithCovariance"], np.zeros(0)
    start = 1_700_000_000

    def head(t: float) -> object:
        whole = int(t)
        return header(stamp(sec=start + whole, nanosec=round(1e9 * (t - whole))), "world")

    with Writer(path, version=9) as writer:
        joints = writer.add_connection("/joint_states", state.__msgtype__, typestore=STORE)
        odom = writer.add_connection("/mocap", odometry.__msgtype__, typestore=STORE)
        still = moving(twist(vector(0.0, 0.0, 0.0), vector(0.0, 0.0, 0.0)), np.zeros(36))
        for k, t in enumerate(log["t"]):
            at = int(1e9 * (start + t))
            for name, value in (
                ("base_to_left", log["left.angle"][k]),
                ("base_to_right", -log["right.angle"][k]),
            ):
                message = state(head(t), [name, f"{name}_arm"], np.array([value, 0.0]), empty, empty)
                writer.write(joints, at, STORE.serialize_cdr(message, state.__msgtype__))
            x, y, theta = (float(poses[n][k]) for n in ("x", "y", "theta"))
            turned = quaternion(0.0, 0.0, np.sin(theta / 2), np.cos(theta / 2))
            placed = odometry(head(t), "base", covered(pose(point(x, y, 0.0), turned), np.zeros(36)), still)
            writer.write(odom, at, STORE.serialize_cdr(placed, odometry.__msgtype__))
    return path


def test_a_bag_gives_what_its_readings_give(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(ROBOT)
    drives = [drive(seed) for seed in (1, 2)]
    bags = [bag(tmp_path / f"bag{k}", *drives[k]) for k in range(2)]
    words = [word for path in bags for word in ("--bag", str(path))]
    found = command_line("calibrate", str(robot), *words, "--poses", "/mocap", "--json")
    assert found.code == 0, found.err
    values = json.loads(found.out)["parameters"]
    assert values["radius"]["value"] == pytest.approx(0.051, rel=1e-3)
    assert values["half_track"]["value"] == pytest.approx(0.147, rel=1e-3)
    same = wmrgen.calibrate(wmrgen.load(robot), [log for log, _ in drives], [poses for _, poses in drives])
    for name, estimate in same.parameters.items():
        assert values[name]["value"] == pytest.approx(estimate.value, rel=1e-6)


def test_a_bag_without_what_is_needed_is_refused(tmp_path: Path) -> None:
    robot = wmrgen.load(ROBOT)
    path = bag(tmp_path / "bag", *drive(1))
    for joints, poses, states in (
        (["left.spin"], "/amcl_pose", "/joint_states"),
        (["left.spin"], "/joint_states", "/joint_states"),
        (["left.spin"], "/mocap", "/mocap"),
        (["left.steer"], "/mocap", "/joint_states"),
    ):
        with pytest.raises(UsageError):
            tables(path, robot, joints, poses, states)
    with pytest.raises(UsageError):
        tables(tmp_path / "none", robot, ["left.spin"], "/mocap", "/joint_states")
