"""Drives of Gazebo: the systems of gz-sim, and the classic plugins of gazebo_ros_pkgs with the same formula.

The classic Ackermann and tricycle plugins have no record: they take angular.z as a steering angle, and measure their
lengths in the simulation.
"""

from __future__ import annotations

import math
import re

from wmrgen.tools.controllers.mecanum import CORNERS, rates
from wmrgen.tools.controllers.record import Commands, ControllerType, Numbers, Twist

_TRACTION = ("right_traction", "left_traction")
_STEERING = ("right_steering", "left_steering")


def diff_drive(t: Numbers, twist: Twist) -> Commands:
    """Return the wheel rates [rad/s], (v -+ omega track / 2) / radius.

    `DiffDrivePrivate::UpdateVelocity` of gz-sim; `UpdateWheelVelocities` of gazebo_ros_diff_drive and
    `getWheelVelocities` of gazebo_ros_skid_steer_drive in gazebo_ros_pkgs.
    """
    half = twist.omega * t["separation"] / 2
    return {"left": ((twist.vx - half) / t["radius"],), "right": ((twist.vx + half) / t["radius"],)}


def mecanum(t: Numbers, twist: Twist) -> Commands:
    """Return the wheel rates [rad/s]: `MecanumDrivePrivate::UpdateVelocity` of gz-sim."""
    return rates(t["radius"], (t["wheelbase"] + t["track"]) / 2, twist)


def ackermann(t: Numbers, twist: Twist) -> Commands:
    """Return traction [rad/s] and steering [rad]: `AckermannSteeringPrivate::UpdateVelocity` of gz-sim.

    The right wheel steers by atan(L / (R + kingpin width / 2)) with R = v / omega, the left one with the other sign.
    """
    curvature, base = twist.omega / twist.vx, t["wheelbase"]
    result = {}
    for sign, traction, steering in zip((1, -1), _TRACTION, _STEERING, strict=True):
        result[traction] = (twist.vx * (1 + sign * t["traction_track"] * curvature / 2) / t["radius"],)
        result[steering] = (math.atan(base * curvature / (1 + sign * t["steering_track"] * curvature / 2)),)
    return result


TYPES = (
    ControllerType(
        "DiffDrive",
        "differential",
        re.compile("(gz|ignition)-sim.*diff-drive|DiffDrive$|gazebo_ros_(diff|skid_steer)_drive"),
        {
            "left_joint": "left",
            "right_joint": "right",
            "wheel_separation": "separation",
            "wheel_radius": "radius",
            "min_linear_velocity": "vx.low",
            "max_linear_velocity": "vx.high",
            "min_angular_velocity": "omega.low",
            "max_angular_velocity": "omega.high",
        },
        diff_drive,
        {"left": ("left",), "right": ("right",)},
        {"separation": "track", "radius": "radius"},
        tag="diff-drive",
    ),
    ControllerType(
        "MecanumDrive",
        "mecanum",
        re.compile("(gz|ignition)-sim.*mecanum-drive|systems::MecanumDrive$"),
        {
            **{f"{corner.replace('rear', 'back')}_joint": corner for corner in CORNERS},
            "wheelbase": "wheelbase",
            "wheel_separation": "track",
            "wheel_radius": "radius",
        },
        mecanum,
        {corner: (corner.replace("_", " "),) for corner in CORNERS},
        {"wheelbase": "wheelbase", "track": "track", "radius": "radius"},
        strafes=True,
        tag="mecanum-drive",
    ),
    ControllerType(
        "AckermannSteering",
        "ackermann",
        re.compile("(gz|ignition)-sim.*ackermann-steering|AckermannSteering$"),
        {
            "right_joint": "right_traction",
            "left_joint": "left_traction",
            "right_steering_joint": "right_steering",
            "left_steering_joint": "left_steering",
            "wheel_base": "wheelbase",
            "wheel_separation": "traction_track",
            "kingpin_width": "steering_track",
            "wheel_radius": "radius",
            "steering_limit": "least_turn",
            "min_velocity": "vx.low",
            "max_velocity": "vx.high",
        },
        ackermann,
        {
            **{name: (f"rigid {name.split('_')[0]}",) for name in _TRACTION},
            **{name: (f"steering {name.split('_')[0]}",) for name in _STEERING},
        },
        {
            "wheelbase": "wheelbase",
            "traction_track": "track",
            "steering_track": "steering_track",
            "radius": "radius",
        },
        steering=frozenset(_STEERING),
        turns_on_spot=False,
        tag="ackermann-steering",
    ),
)
