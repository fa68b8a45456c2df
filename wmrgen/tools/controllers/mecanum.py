"""mecanum_drive_controller of ros2_controllers."""

from __future__ import annotations

import math
import re

from wmrgen.tools.controllers.record import Commands, ControllerType, Numbers, Twist, limits

CORNERS = {"front_left": -1, "front_right": 1, "rear_left": 1, "rear_right": -1}  # tan of gamma at the ground


def rates(radius: float, reach: float, twist: Twist) -> Commands:
    """Return the wheel rates of a mecanum drive whose rollers form an O at the ground.

    Args:
        radius: The radius of the wheels [m].
        reach: Half the wheelbase and half the track together [m].
        twist: The twist of the middle of the wheels.

    Returns:
        Corner -> wheel rate [rad/s], (vx + t vy -+ reach omega) / radius with t = tan(gamma).
    """
    result = {}
    for corner, tangent in CORNERS.items():
        side = -1 if corner.endswith("left") else 1
        result[corner] = ((twist.vx + tangent * twist.vy + side * reach * twist.omega) / radius,)
    return result


def commands(t: Numbers, twist: Twist) -> Commands:
    """Return the wheel rates [rad/s].

    `MecanumDriveController::update_and_write_commands` of ros2_controllers: the linear velocity is turned by
    base_frame_offset.theta, then the offset's velocity is added.
    """
    c, s = math.cos(t["offset_theta"]), math.sin(t["offset_theta"])
    vx = c * twist.vx - s * twist.vy + t["offset_y"] * twist.omega
    vy = s * twist.vx + c * twist.vy - t["offset_x"] * twist.omega
    return rates(t["radius"], t["sum"], Twist(vx, vy, twist.omega))


TYPES = (
    ControllerType(
        "mecanum_drive_controller/MecanumDriveController",
        "mecanum",
        re.compile(r"^mecanum_drive_controller/MecanumDriveController$"),
        {
            **{f"{corner}_wheel_command_joint_name": corner for corner in CORNERS},
            **{f"kinematics.base_frame_offset.{key}": f"offset_{key}" for key in ("x", "y", "theta")},
            "kinematics.wheels_radius": "radius",
            "kinematics.sum_of_robot_center_projection_on_X_Y_axis": "sum",
            **limits(linear_x="vx", linear_y="vy", angular_z="omega"),
        },
        commands,
        {corner: (corner.replace("_", " "),) for corner in CORNERS},
        {"radius": "radius", "sum": "sum"},
        defaults={"offset_x": 0.0, "offset_y": 0.0, "offset_theta": 0.0},
        strafes=True,
    ),
)
