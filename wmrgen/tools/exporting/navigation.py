"""Write what a robot file determines of the parameters of Nav2 and of robot_localization.

Names of Nav2: https://docs.nav2.org/configuration/packages/configuring-mppic.html and
https://docs.nav2.org/configuration/packages/configuring-velocity-smoother.html. Names of robot_localization:
https://github.com/cra-ros-pkg/robot_localization/blob/ros2/params/ekf.yaml.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import sin
from typing import Any

from wmrgen import derive
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.drives import drive_with, refusing
from wmrgen.tools.exporting.ros2_control import pointed, yaml_lines
from wmrgen.tools.exporting.text import banner

_TWIST = ("vx", "vy", "omega")
_NOT_RUN = "These parameters were not run: their names are those of the documentation."
_OWN_MODEL = "`wmrgen derive ROBOT.yaml --package ros2` writes a motion model of this robot for Nav2's MPPI."
_MODELS = {2: "DiffDrive", 3: "Omni"}  # degree of maneuverability without steering -> motion model of Nav2


def nav2(robot: Robot) -> dict[str, str]:
    """Return ``<robot>_nav2.yaml``: motion model, turning radius, limits, and the footprint of the wheels.

    Raises:
        NotDerivableError: Nav2 has no motion model for the robot, with the reason.
    """
    own = derive(robot).mobility.robot_type == (1, 1)
    with refusing(f"{robot.name}: Nav2 has no motion model for it", _OWN_MODEL if own else ""):
        follow = _motion_model(robot)
    names = {"vx_max": ("vx", 1), "vx_min": ("vx", -1), "wz_max": ("omega", 1), "ax_max": ("vx_rate", 1)}
    names |= {"ax_min": ("vx_rate", -1), "az_max": ("omega_rate", 1)}
    if follow["motion_model"] == "Omni":
        names |= {"vy_max": ("vy", 1), "ay_max": ("vy_rate", 1), "ay_min": ("vy_rate", -1)}
    for name, (quantity, sign) in names.items():
        limit = robot.limits.get(quantity)
        if limit:
            follow[name] = float(limit.high if sign > 0 else limit.low)
    costmap = {"ros__parameters": {"footprint": f'"{_footprint(robot)}"', "robot_base_frame": robot.frame}}
    tree = {
        "controller_server": {"ros__parameters": {"FollowPath": follow}},
        "velocity_smoother": {"ros__parameters": _smoother(robot)},
        "local_costmap": {"local_costmap": costmap},
        "global_costmap": {"global_costmap": costmap},
    }
    notes = (
        "Parameters of Nav2, to merge into those of your robot. [m], [rad], [s]",
        "The footprint is that of the wheels: enlarge it by the body. Limits that the robot file lacks are left out.",
        _NOT_RUN,
    )
    return {f"{robot.name}_nav2.yaml": _text(robot, notes, tree)}


def robot_localization(robot: Robot) -> dict[str, str]:
    """Return ``<robot>_ekf.yaml``: the velocities that the wheels measure, for an extended Kalman filter.

    Raises:
        NotDerivableError: The sensed joints do not determine the velocity of the robot.
    """
    derivation = derive(robot)
    functions = {function.name for function in derivation.module.functions}
    if not derivation.determined:
        raise NotDerivableError(f"{robot.name}: its sensed joints do not determine its velocity.")
    rows = ["false"] * 15  # x y z, roll pitch yaw, their velocities, accelerations
    for index in (6, 7, 11):  # vx, vy, yaw rate
        rows[index] = "true"
    own = {
        "two_d_mode": "true",
        "odom_frame": "odom",
        "base_link_frame": robot.frame,
        "world_frame": "odom",
        "odom0": "odom",
        "odom0_config": tuple(rows),
    }
    notes = ["Parameters of robot_localization: vx, vy and the yaw rate are measured by the wheels."]
    if {"forward_covariance", "odometry_covariance"} <= functions:
        notes.append("The messages of the node of `derive --package ros2` have their covariances.")
    else:
        notes.append(
            "The robot file has no noise: set twist_variance of the node to the covariances of your robot."
        )
    if robot.gyro:
        notes.append("The odometry has used the gyro: do not give the filter its yaw rate again.")
    notes += ["Set publish_tf of the node to false, because the filter publishes the transform.", _NOT_RUN]
    return {f"{robot.name}_ekf.yaml": _text(robot, notes, {"ekf_filter_node": {"ros__parameters": own}})}


def _text(robot: Robot, notes: tuple[str, ...] | list[str], tree: Mapping[str, Any]) -> str:
    return "".join(f"# {line}\n" for line in (*banner(robot), *notes)) + "".join(yaml_lines(tree))


def _motion_model(robot: Robot) -> dict[str, Any]:
    """Return the motion model, with the least turning radius of cars."""
    mobility = derive(robot).mobility
    if mobility.skids:
        return {"motion_model": "DiffDrive"}
    if mobility.degree_of_maneuverability == 3 or mobility.degree_of_mobility == 2:
        return {"motion_model": _MODELS[mobility.degree_of_maneuverability]}
    if mobility.robot_type != (1, 1):
        raise NotDerivableError(f"its type is {mobility.robot_type}")
    drive, _ = drive_with(robot, lambda kind: kind)
    base, angle = drive.terms.get("wheelbase"), drive.terms.get("least_turn")
    if drive.notes:
        raise NotDerivableError("its fixed axle is not at P, so that the radius of its path is another one")
    if not isinstance(base, float) or not isinstance(angle, float):
        raise NotDerivableError("its least turning radius is not known, because it has no limits of steering")
    return {"motion_model": "Ackermann", "AckermannConstraints": {"min_turning_r": _radius(base, angle)}}


def _radius(base: float, angle: float) -> float:
    """Return the radius [m] of P's path for the wheelbase [m] and the angle [rad] that Gazebo has: base/sin(angle)."""
    return base / sin(angle)


def _smoother(robot: Robot) -> dict[str, Any]:
    """Return the parameters of the velocity smoother; those that need a limit that the robot lacks are left out."""
    names = {
        "max_velocity": ("", 1),
        "min_velocity": ("", -1),
        "max_accel": ("_rate", 1),
        "max_decel": ("_rate", -1),
    }
    parameters: dict[str, Any] = {}
    holonomic = derive(robot).mobility.degree_of_maneuverability == 3
    for name, (ending, sign) in names.items():
        values = []
        for quantity in _TWIST:
            limit = robot.limits.get(f"{quantity}{ending}")
            if limit:
                values.append(pointed(float(limit.high if sign > 0 else limit.low)))
            elif quantity == "vy" and not holonomic:
                values.append("0.0")
        if len(values) == len(_TWIST):
            parameters[name] = tuple(values)
    return parameters


def _footprint(robot: Robot) -> str:
    """Return the rectangle around all wheels, as Nav2 writes it."""
    ends: dict[str, list[float]] = {"x": [], "y": []}
    for wheel in robot.wheels:
        g = wheel.nominal
        reach = float(g.r) + abs(float(g.d)) + abs(float(g.o))
        ahead = reach if wheel.turns else reach * abs(float(g.ch))
        aside = reach if wheel.turns else reach * abs(float(g.sh))
        ends["x"] += [float(g.x) - ahead, float(g.x) + ahead]
        ends["y"] += [float(g.y) - aside, float(g.y) + aside]
    (left, right), (low, high) = ((min(values), max(values)) for values in ends.values())
    corners = [(right, high), (left, high), (left, low), (right, low)]
    return "[" + ", ".join(f"[{pointed(x)}, {pointed(y)}]" for x, y in corners) + "]"
