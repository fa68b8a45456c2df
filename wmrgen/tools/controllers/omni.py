"""omni_wheel_drive_controller of ros2_controllers."""

from __future__ import annotations

import math
import re

from wmrgen.tools.controllers.record import Commands, ControllerType, Numbers, Twist


def commands(t: Numbers, twist: Twist) -> Commands:
    """Return the wheel rates [rad/s] of ``count`` wheels.

    `OmniWheelDriveController::compute_and_set_wheel_velocities` of ros2_controllers: the wheel k is at the angle
    a = offset + 2 pi k / count and rolls at (sin(a) vx - cos(a) vy - distance omega) / radius.
    """
    count = round(t["count"])
    result = []
    for k in range(count):
        angle = t["offset"] + 2 * math.pi * k / count
        speed = math.sin(angle) * twist.vx - math.cos(angle) * twist.vy - t["distance"] * twist.omega
        result.append(speed / t["radius"])
    return {"ring": tuple(result)}


TYPES = (
    ControllerType(
        "omni_wheel_drive_controller/OmniWheelDriveController",
        "omni",
        re.compile(r"^omni_wheel_drive_controller/OmniWheelDriveController$"),
        {
            "robot_radius": "distance",
            "wheel_radius": "radius",
            "wheel_offset": "offset",
            "wheel_names": "ring",
        },
        commands,
        {"ring": ()},
        {"distance": "ring", "radius": "radius"},
        strafes=True,
    ),
)
