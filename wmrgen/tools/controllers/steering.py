"""Steering controllers of ros2_controllers: bicycle, tricycle and Ackermann steering, and tricycle_controller.

`traction` and `steering` are terms of joints; of two joints the right one comes first, as in the controllers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from wmrgen.tools.controllers.record import Commands, ControllerType, Distro, Names, Numbers, Release, Twist

_STEERS = frozenset({"steering"})
_READ_BOTH: frozenset[Distro] = frozenset({"jazzy"})
_READ_OLDER: frozenset[Distro] = frozenset({"humble"})
_RIGID, _STEERED = ("rigid right", "rigid left"), ("steering right", "steering left")


def steering_angle(t: Numbers, twist: Twist) -> float:
    """Return the angle [rad] of a wheel in the middle of the steered axle.

    `SteeringKinematics::convert_twist_to_steering_angle` of ros2_controllers: atan(wheelbase omega / v). The formula
    has no other sign for a steered axle that is behind the traction axle.
    """
    return math.atan(t["wheelbase"] * twist.omega / twist.vx)


def bicycle(t: Numbers, twist: Twist) -> Commands:
    """Return traction [rad/s] and steering [rad]: BICYCLE_CONFIG of `SteeringKinematics::get_commands`."""
    return {"traction": (twist.vx / t["radius"],), "steering": (steering_angle(t, twist),)}


def _tractions(t: Numbers, twist: Twist) -> tuple[float, float]:
    """Return the rates [rad/s] of the right and the left traction wheel."""
    share = t["traction_track"] / 2 * math.tan(steering_angle(t, twist)) / t["wheelbase"]
    middle = twist.vx / t["radius"]
    return middle * (1 + share), middle * (1 - share)


def tricycle(t: Numbers, twist: Twist) -> Commands:
    """Return traction [rad/s] and steering [rad]: TRICYCLE_CONFIG of `SteeringKinematics::get_commands`."""
    return {"traction": _tractions(t, twist), "steering": (steering_angle(t, twist),)}


def ackermann(t: Numbers, twist: Twist) -> Commands:
    """Return traction [rad/s] and steering [rad]: ACKERMANN_CONFIG of `SteeringKinematics::get_commands`.

    The right wheel steers by atan2(2 L sin phi, 2 L cos phi + track sin phi), the left one with the other sign. A
    steering track that is left out is the traction track.
    """
    phi, base = steering_angle(t, twist), t["wheelbase"]
    track = t["steering_track"] or t["traction_track"]
    angles = []
    for sign in (1, -1):
        across = 2 * base * math.cos(phi) + sign * track * math.sin(phi)
        angles.append(math.atan2(2 * base * math.sin(phi), across))
    return {"traction": _tractions(t, twist), "steering": tuple(angles)}


def ackermann_of_humble(t: Numbers, twist: Twist) -> Commands:
    """Return the commands of Humble, whose `AckermannSteeringController::configure_odometry` uses the traction track
    for the steered axle, too."""
    return ackermann({**t, "steering_track": t["traction_track"]}, twist)


def front_wheel(t: Numbers, twist: Twist) -> Commands:
    """Return traction [rad/s] and steering [rad] of one wheel that does both.

    `TricycleController::twist_to_ackermann` of ros2_controllers: v / (radius cos(angle)); a quarter turn on the spot.
    """
    if twist.vx == 0:
        angle = math.copysign(math.pi / 2, twist.omega)
        return {"traction": (abs(twist.omega) * t["wheelbase"] / t["radius"],), "steering": (angle,)}
    angle = steering_angle(t, twist)
    return {"traction": (twist.vx / (t["radius"] * math.cos(angle)),), "steering": (angle,)}


def older(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the names of Humble, by `front_steering`: if it is false, the rear wheels steer, the front ones drive."""
    steering, traction = ("front", "rear")
    if texts.get("front_steering", "true").lower() == "false":
        steering, traction = traction, steering
    return {
        f"{traction}_wheels_names": "traction",
        f"{steering}_wheels_names": "steering",
        f"{traction}_wheel_track": "traction_track",
        f"{steering}_wheel_track": "steering_track",
        "wheel_track": "traction_track",
        f"{traction}_wheels_radius": "radius",
        f"{traction}_wheel_radius": "radius",
        "wheelbase": "wheelbase",
    }


_NAMES = {
    "traction_joints_names": "traction",
    "steering_joints_names": "steering",
    "wheelbase": "wheelbase",
}
_LENGTHS = {"wheelbase": "wheelbase", "radius": "radius", "traction_track": "track"}


def _pattern(name: str) -> re.Pattern[str]:
    words = "".join(part.title() for part in name.split("_"))
    return re.compile(f"^{name}/{words}$")


# Steered wheels do not drive, so the formula does not use their radius, but Humble requires a positive number.
_RADII = {"front_wheels_radius": "radius", "rear_wheels_radius": "radius"}
_TRACKS = {"front_wheel_track": "steering_track", "rear_wheel_track": "traction_track"}


def _humble(names: Names) -> Release:
    """Return the parameters of Humble: doc/migration.rst of ros2_controllers, Humble to Jazzy."""
    joints = {"front_wheels_names": "steering", "rear_wheels_names": "traction", "wheelbase": "wheelbase"}
    return Release({**joints, **names}, {"front_steering": ("true", "")})


TYPES = (
    ControllerType(
        "tricycle_controller/TricycleController",
        "front-wheel",
        _pattern("tricycle_controller"),
        {
            "traction_joint_name": "traction",
            "steering_joint_name": "steering",
            "wheelbase": "wheelbase",
            "wheel_radius": "radius",
            "steering.max_position": "steer.high",
            "steering.min_position": "steer.low",
        },
        front_wheel,
        {"traction": ("steering",), "steering": ("steering",)},
        {"wheelbase": "wheelbase", "radius": "radius"},
        steering=_STEERS,
    ),
    ControllerType(
        "bicycle_steering_controller/BicycleSteeringController",
        "bicycle",
        _pattern("bicycle_steering_controller"),
        {**_NAMES, "traction_wheel_radius": "radius"},
        bicycle,
        {"traction": ("rigid",), "steering": ("steering",)},
        {"wheelbase": "wheelbase", "radius": "radius"},
        older=older,
        reads_older=_READ_BOTH,
        reads_only_older=_READ_OLDER,
        releases={"humble": _humble({"front_wheel_radius": "radius", "rear_wheel_radius": "radius"})},
        steering=_STEERS,
        turns_on_spot=False,
    ),
    ControllerType(
        "tricycle_steering_controller/TricycleSteeringController",
        "tricycle",
        _pattern("tricycle_steering_controller"),
        {**_NAMES, "traction_track_width": "traction_track", "traction_wheels_radius": "radius"},
        tricycle,
        {"traction": _RIGID, "steering": ("steering",)},
        _LENGTHS,
        older=older,
        reads_older=_READ_BOTH,
        reads_only_older=_READ_OLDER,
        releases={"humble": _humble({"wheel_track": "traction_track", **_RADII})},
        steering=_STEERS,
        turns_on_spot=False,
    ),
    ControllerType(
        "ackermann_steering_controller/AckermannSteeringController",
        "ackermann",
        _pattern("ackermann_steering_controller"),
        {
            **_NAMES,
            "traction_track_width": "traction_track",
            "steering_track_width": "steering_track",
            "traction_wheels_radius": "radius",
        },
        ackermann,
        {"traction": _RIGID, "steering": _STEERED},
        {**_LENGTHS, "steering_track": "steering_track"},
        defaults={"steering_track": 0.0},
        older=older,
        reads_older=_READ_BOTH,
        reads_only_older=_READ_OLDER,
        older_commands={"humble": ackermann_of_humble},
        releases={"humble": _humble({**_TRACKS, **_RADII})},
        steering=_STEERS,
        turns_on_spot=False,
    ),
)
