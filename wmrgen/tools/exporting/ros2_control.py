"""ros2_control: a URDF whose <ros2_control> names the joints and what is commanded and measured of each, and the
parameters of the controller of ros2_controllers that has the robot's kinematics.

Names and formulas are those of ros2_controllers 5 and later (Kilted, Lyrical), page "Wheeled Mobile Robot Kinematics".
diff_drive_controller divides by the product of radius and multiplier, so a negative one is a side that rolls backward;
no other controller has a sign for a joint.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.bodies import BASE
from wmrgen.tools.exporting.drives import CORNERS, drive_of, limits_of, refusing
from wmrgen.tools.exporting.text import banner, decimal
from wmrgen.tools.exporting.urdf import urdf

NAME = "base_controller"
_STEERING = {
    "traction_joints_names": "traction", "steering_joints_names": "steering", "wheelbase": "wheelbase",
}  # fmt: skip
_LIMITED = {"max_velocity": "high", "min_velocity": "low"}
_LIMITED_RATE = {
    "max_acceleration": "high", "max_deceleration": "low",
    "max_acceleration_reverse": "-high", "max_deceleration_reverse": "-low",
}  # fmt: skip


def _limits(**axes: str) -> dict[str, str]:
    """Parameters of the limits of a twist: ``linear_x="vx"``."""
    both = (("", _LIMITED), ("_rate", _LIMITED_RATE))
    return {
        f"{axis.replace('_', '.')}.{key}": f"{name}{rate}.{end}"
        for axis, name in axes.items()
        for rate, ends in both
        for key, end in ends.items()
    }


_CONTROLLERS = {
    "differential": (
        "diff_drive_controller/DiffDriveController",
        {"left_wheel_names": "left", "right_wheel_names": "right", "wheel_separation": "separation",
         "wheel_radius": "left_radius", "left_wheel_radius_multiplier": "left_share",
         "right_wheel_radius_multiplier": "right_share", **_limits(linear_x="vx", angular_z="omega")},
    ),
    "mecanum": (
        "mecanum_drive_controller/MecanumDriveController",
        {**{f"{corner}_wheel_command_joint_name": corner for corner in CORNERS},
         **{f"kinematics.base_frame_offset.{key}": f"offset_{key}" for key in ("x", "y", "theta")},
         "kinematics.wheels_radius": "radius", "kinematics.sum_of_robot_center_projection_on_X_Y_axis": "sum",
         **_limits(linear_x="vx", linear_y="vy", angular_z="omega")},
    ),
    "omni": (
        "omni_wheel_drive_controller/OmniWheelDriveController",
        {"robot_radius": "distance", "wheel_radius": "radius", "wheel_offset": "offset", "wheel_names": "ring"},
    ),
    "front-wheel": (
        "tricycle_controller/TricycleController",
        {"traction_joint_name": "traction", "steering_joint_name": "steering", "wheelbase": "wheelbase",
         "wheel_radius": "radius", "steering.max_position": "steer.high", "steering.min_position": "steer.low"},
    ),
    "bicycle": (
        "bicycle_steering_controller/BicycleSteeringController",
        {**_STEERING, "traction_wheel_radius": "radius"},
    ),
    "tricycle": (
        "tricycle_steering_controller/TricycleSteeringController",
        {**_STEERING, "traction_track_width": "traction_track", "traction_wheels_radius": "radius"},
    ),
    "ackermann": (
        "ackermann_steering_controller/AckermannSteeringController",
        {**_STEERING, "traction_track_width": "traction_track", "steering_track_width": "steering_track",
         "traction_wheels_radius": "radius"},
    ),
}  # fmt: skip


def ros2_control(robot: Robot) -> dict[str, str]:
    """``<robot>.urdf`` and ``<robot>_controllers.yaml``. NotDerivableError where no controller fits, and why."""
    with refusing(f"{robot.name}: no controller of ros2_controllers fits"):
        drive = drive_of(robot, _CONTROLLERS)
        kind, names = _CONTROLLERS[drive.kind]
        values = drive.named(names, limits_of(robot))
    manager = {
        "update_rate": 100,
        "joint_state_broadcaster": {"type": "joint_state_broadcaster/JointStateBroadcaster"},
        NAME: {"type": kind},
    }
    own: dict[str, Any] = {"base_frame_id": BASE, "odom_frame_id": "odom"}
    for path, value in values.items():
        *groups, key = path.split(".")
        place = own
        for group in groups:
            place = place.setdefault(group, {})
        place[key] = value if isinstance(value, float) or key.endswith("names") else value[0]
    lines = [*banner(robot), "Parameters of ros2_controllers 5 and later. [m], [rad], [s]", *drive.notes]
    tree = {name: {"ros__parameters": v} for name, v in (("controller_manager", manager), (NAME, own))}
    return {
        f"{robot.name}.urdf": urdf(robot, control=True),
        f"{robot.name}_controllers.yaml": "".join(f"# {line}\n" for line in lines) + "".join(_yaml(tree)),
    }


def _yaml(tree: Mapping[str, Any], indent: str = "") -> list[str]:
    """YAML of words and numbers. A float has a point, for ROS keeps types."""
    lines = []
    for key, value in tree.items():
        if isinstance(value, Mapping):
            lines += [f"{indent}{key}:\n", *_yaml(value, f"{indent}  ")]
        else:
            written = f"[{', '.join(value)}]" if isinstance(value, tuple) else value
            lines.append(f"{indent}{key}: {_pointed(value) if isinstance(value, float) else written}\n")
    return lines


def _pointed(value: float) -> str:
    digits, e, exponent = decimal(value).partition("e")
    return digits + ("" if "." in digits else ".0") + e + exponent
