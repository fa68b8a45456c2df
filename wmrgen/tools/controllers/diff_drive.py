"""diff_drive_controller of ros2_controllers and of ros_controllers (ROS 1)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from wmrgen.tools.controllers.record import Commands, ControllerType, Lengths, Numbers, Twist, limits


def commands(t: Numbers, twist: Twist) -> Commands:
    """Return the wheel rates [rad/s].

    `DiffDriveController::update_and_write_commands` of ros2_controllers: (v -+ omega track / 2) / radius, where track
    and radii are multiplied by their multipliers. A negative multiplier is a side that rolls backward.
    """
    half = twist.omega * t["separation"] * t["separation_factor"] / 2
    left = (twist.vx - half) / (t["left_radius"] * t["left_share"])
    right = (twist.vx + half) / (t["left_radius"] * t["right_share"])
    return {"left": (left,), "right": (right,)}


def own_lengths(numbers: Numbers, keys: Mapping[str, str], own: Lengths) -> dict[str, float]:
    """Replace track and radii by those of a robot, and keep the signs of the multipliers.

    Args:
        numbers: The terms of the controller.
        keys: Unused, because the two radii are one length with a share for each side.
        own: The lengths of the robot [m].

    Returns:
        The terms with every length that the robot has.
    """
    del keys
    result = dict(numbers)
    if "track" in own:
        result |= {"separation": own["track"], "separation_factor": 1.0}
    radii = [own.get(f"{side}_radius", own.get("radius")) for side in ("left", "right")]
    left, right = radii
    if left and right:
        result["left_radius"] = left
        result["left_share"] = math.copysign(1.0, numbers["left_share"])
        result["right_share"] = math.copysign(right / left, numbers["right_share"])
    return result


def older(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the names of ROS 1, whose one multiplier of both radii counts before those of the sides."""
    del texts
    return {
        "left_wheel": "left",
        "right_wheel": "right",
        "wheel_radius_multiplier": "left_share right_share",
    }


TYPES = (
    ControllerType(
        "diff_drive_controller/DiffDriveController",
        "differential",
        re.compile(r"^diff_drive_controller[/:]+DiffDriveController$"),
        {
            "left_wheel_names": "left",
            "right_wheel_names": "right",
            "wheel_separation": "separation",
            "wheel_separation_multiplier": "separation_factor",
            "wheel_radius": "left_radius",
            "left_wheel_radius_multiplier": "left_share",
            "right_wheel_radius_multiplier": "right_share",
            **limits(linear_x="vx", angular_z="omega"),
        },
        commands,
        {"left": ("left",), "right": ("right",)},
        {"separation": "track", "left_radius": "radius"},
        {"separation": ("separation_factor",), "left_radius": ("left_share", "right_share")},
        {"separation_factor": 1.0, "left_share": 1.0, "right_share": 1.0},
        own_lengths,
        older,
    ),
)
