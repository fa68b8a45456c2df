"""Run the node of a ROS 2 package in this process, send it the messages of a script, and write what it publishes.

The tests run this file with a Python that has rclpy: ``python ros2_driver.py script.json``. Messages go through the
middleware. A step waits for the answer of the node, because a queue may drop messages that are sent faster.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from math import atan2
from pathlib import Path

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState

PATIENCE = 5.0  # s to wait for an answer


class Stage:
    """The node of the package, and the publishers and subscriptions that drive it."""

    def __init__(self, package, library, parameters):
        """Start the node, and wait until it is connected."""
        self.result = {"odom": [], "commands": [], "log": []}
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        self.node = package.Kinematics(library, parameter_overrides=overrides)
        self.node.get_logger = lambda: Log(self.result["log"])
        self.other = rclpy.create_node("driver")
        odom, commands = self.result["odom"], self.result["commands"]
        self.other.create_subscription(Odometry, "odom", lambda m: odom.append(pose_of(m, package)), 100)
        self.other.create_subscription(
            JointState, "joint_commands", lambda m: commands.append(command_of(m)), 100
        )
        self.joints = self.other.create_publisher(JointState, "joint_states", qos_profile_sensor_data)
        self.twists = []
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.executor.add_node(self.other)
        self.spin_until(lambda: self.joints.get_subscription_count() and self.other.count_publishers("odom"))
        self.sleep(0.2)  # s: the subscriptions of this side are connected a little later

    def spin_until(self, done, patience=PATIENCE):
        """Pass messages until ``done()``, at most for ``patience`` seconds."""
        end = time.monotonic() + patience
        while not done() and time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def sleep(self, seconds):
        """Pass messages for this time."""
        self.spin_until(lambda: False, seconds)

    def cmd_vel(self, step):
        """Publish a twist, and wait until the node has it."""
        while len(self.twists) <= step["publisher"]:
            self.twists.append(self.other.create_publisher(TwistStamped, "cmd_vel", 10))
            self.spin_until(self._connected)
        message = TwistStamped()
        message.twist.linear.x, message.twist.linear.y, message.twist.angular.z = step["twist"]
        before = self.node.core._commanded
        self.twists[step["publisher"]].publish(message)
        self.spin_until(lambda: self.node.core._commanded != before)

    def _connected(self):
        return self.twists[-1].get_subscription_count() and self.node.count_publishers("cmd_vel") == len(
            self.twists
        )

    def joint_states(self, step):
        """Publish joint states, and wait for the odometry or the commands."""
        message = JointState(name=step["name"], position=step["position"], velocity=step["velocity"])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(step["stamp"], 1_000_000_000)
        answers = self.result["odom" if step["wait"] else "commands"]
        before = len(answers)
        self.joints.publish(message)
        self.spin_until(lambda: len(answers) > before)


def main() -> None:
    """Do the steps of the script."""
    script = Path(sys.argv[1])
    wanted = json.loads(script.read_text())
    sys.path.insert(0, str(script.parent / "node"))
    package = importlib.import_module(f"{wanted['robot']}_node")
    rclpy.init()
    stage = Stage(package, script.parent / f"lib{wanted['robot']}_bridge.so", wanted["parameters"])
    for step in wanted["steps"]:
        if step["do"] == "sleep":
            stage.sleep(step["seconds"])
        elif step["do"] == "cmd_vel":
            stage.cmd_vel(step)
        else:
            stage.joint_states(step)
    script.with_name("result.json").write_text(json.dumps(stage.result))
    rclpy.shutdown()


class Log:
    """A logger that stores its lines."""

    def __init__(self, lines):
        """Store the lines in this list."""
        self.warning = lines.append


def pose_of(message, package):
    """Return an odometry message as numbers, with the transform that belongs to it."""
    turn = message.pose.pose.orientation
    place = message.pose.pose.position
    twist = message.twist.twist
    return {
        "stamp": message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec,
        "frames": [message.header.frame_id, message.child_frame_id],
        "pose": [place.x, place.y, 2 * atan2(turn.z, turn.w)],
        "twist": [twist.linear.x, twist.linear.y, twist.angular.z],
        "transform": transform(package.transform_of(message)),
    }


def transform(message):
    """Return a TransformStamped as numbers."""
    turn, place = message.transform.rotation, message.transform.translation
    return {
        "stamp": message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec,
        "frames": [message.header.frame_id, message.child_frame_id],
        "pose": [place.x, place.y, 2 * atan2(turn.z, turn.w)],
    }


def command_of(message):
    """Return joint commands as numbers."""
    return {
        "name": list(message.name),
        "velocity": list(message.velocity),
        "position": list(message.position),
    }


if __name__ == "__main__":
    main()
