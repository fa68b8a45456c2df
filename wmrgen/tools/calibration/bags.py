"""Logs from ROS bags: joint readings from `sensor_msgs/JointState`, reference poses from an odometry or pose topic.

The library rosbags reads bags of ROS 1 and ROS 2 without ROS.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from wmrgen.errors import EnvironmentFailure, UsageError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.calibration.path import Reals

_POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
)
Columns = dict[str, Reals]


def tables(
    bag: Path, robot: Robot, joints: Sequence[str], poses: str, states: str
) -> tuple[Columns, Columns]:
    """Return the joint readings and the reference poses of a bag, as columns by name.

    Args:
        bag: A folder of ROS 2, or a file of ROS 1.
        robot: For the names of its joints in ROS, the key `joints` of a wheel, or `<wheel>_<joint>`.
        joints: Readings that the robot's `forward` takes, such as ``left.spin``.
        poses: Topic of an odometry or a pose of the tracked body.
        states: Topic of the joint readings.

    Returns:
        The log and its reference, in seconds from the first reading on. UsageError if the bag does not have them.
    """
    readings = list(_messages(bag, states, ("sensor_msgs/msg/JointState",)))
    start = readings[0][0]
    columns = [_joint(bag, robot, joint, readings, start) for joint in joints]
    # Joints may come in separate messages. All are taken at the times of the one that comes least often.
    t = min((times for _, times, _ in columns), key=len)
    log = {"t": t} | {name: np.interp(t, times, values) for name, times, values in columns}
    rows = [_pose(message) for message in _messages(bag, poses, _POSES)]
    x, y, theta, at = np.array(rows).T
    return log, {"t": at - start, "x": x, "y": y, "theta": theta}


def _messages(bag: Path, topic: str, types: Sequence[str]) -> Iterator[tuple[float, Any]]:
    """Yield time [s] and message of a topic. UsageError if it is not there, or has another type."""
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise EnvironmentFailure("--bag needs rosbags: pip install 'wmrgen[bag]'") from None
    try:
        reader = AnyReader([bag], default_typestore=get_typestore(Stores.LATEST))
        reader.open()
    except (AnyReaderError, OSError) as error:
        raise UsageError(f"{bag}: it cannot be read as a bag: {error}") from None
    with closing(reader):
        found = [c for c in reader.connections if c.topic == topic]
        if not found:
            topics = ", ".join(sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections}))
            raise UsageError(f"{bag}: there is no topic {topic}. It has {topics or 'none'}")
        if found[0].msgtype not in types:
            raise UsageError(f"{bag}: {topic} is {found[0].msgtype}, not {' or '.join(types)}")
        count = 0
        for connection, received, data in reader.messages(found):
            message: Any = reader.deserialize(data, connection.msgtype)
            stamp = message.header.stamp
            seconds = stamp.sec + 1e-9 * stamp.nanosec
            yield (seconds or 1e-9 * received), message  # a stamp of 0 means that there is no stamp
            count += 1
        if not count:
            raise UsageError(f"{bag}: {topic} has no message")


def _joint(
    bag: Path, robot: Robot, joint: str, readings: Sequence[tuple[float, Any]], start: float
) -> tuple[str, Reals, Reals]:
    """Return the column of a joint, its times [s] and its readings.

    Args:
        bag: For messages.
        robot: For the joint's name in ROS.
        joint: Such as ``left.spin``.
        readings: Times and messages of all joints.
        start: [s] time of the first reading.
    """
    wheel, quantity = joint.rsplit(".", 1)
    kind = "spin" if quantity == "spin" else "steer"
    name = next(w for w in robot.wheels if w.name == wheel).joint_name(kind)
    has = [(at - start, m, list(m.name).index(name.name)) for at, m in readings if name.name in m.name]
    placed = [(at, m.position[k]) for at, m, k in has if len(m.position) > k]
    moving = [(at, m.velocity[k]) for at, m, k in has if len(m.velocity) > k]
    if len(placed) > 1:
        times, values = np.array(placed).T
        return f"{wheel}.{'angle' if kind == 'spin' else 'steer'}", times, name.sign * values
    if len(moving) > 1 and kind == "spin":
        times, values = np.array(moving).T
        return joint, times, name.sign * values
    names = sorted({n for _, m in readings for n in m.name})
    raise UsageError(
        f"{bag}: there are no readings of {joint}, which is the joint {name.name}. Joints of the bag are "
        f"{', '.join(names)}. Write joints: {{{kind}: NAME}} at the wheel in the robot file"
    )


def _pose(stamped: tuple[float, Any]) -> tuple[float, float, float, float]:
    """Return x, y [m], heading [rad] and time [s] of a message."""
    at, message = stamped
    pose = getattr(message.pose, "pose", message.pose)
    q = pose.orientation
    heading = float(np.arctan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y**2 + q.z**2)))
    return pose.position.x, pose.position.y, heading, at
