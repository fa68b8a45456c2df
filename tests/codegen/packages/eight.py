"""A figure of eight, with the joint states of a robot that drives it and its exact poses.

The joints are those of `inverse` in the interpreter. The poses are points on two circles in closed form, so they come
from no function of the robot.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import cos, pi, sin
from typing import NamedTuple

from wmrgen.derivation.facade import Derivation
from wmrgen.ir.interpret import FLOAT64, evaluate_module
from wmrgen.ir.nodes import Module

# One robot of each kind, with a forward velocity [m/s] and a yaw rate [rad/s] inside its limits.
ROBOTS = {
    "pioneer3dx": (0.3, 0.6),  # differential, with a castor
    "kuka_youbot": (0.3, 0.6),  # mecanum
    "festo_robotino": (0.3, 0.6),  # omni
    "wpilib_swervebot": (0.3, 0.6),  # swerve
    "ackermann_car": (1.8, 0.3),  # car
    "textbook_tricycle": (0.3, 0.3),  # tricycle
    "nomad_xr4000": (0.3, 0.6),  # powered castors
    "jpl_osr": (0.06, 0.03),  # rover
}
STEPS = 60  # in each of the two circles


class Moment(NamedTuple):
    """The robot at the end of a step."""

    time: int  # [ns]
    joints: Mapping[str, float]  # name in the module -> value during the step
    twist: tuple[float, float, float]
    pose: tuple[float, float, float]


def figure_of_eight(derivation: Derivation, vx: float, omega: float) -> Iterator[Moment]:
    """Yield the moments of two circles, to the left and to the right; the first one is the start.

    Args:
        derivation: The robot.
        vx: Forward velocity [m/s].
        omega: Yaw rate [rad/s]; positive.
    """
    module = derivation.module
    step = round(2 * pi / omega / STEPS * 1e9)
    state = {
        port.name: 0.0 for port in module.function("inverse").inputs
    }  # of angles of passive castors as well
    joints = derivation.c_module.joints or ()
    state |= dict.fromkeys(joints, 0.0)
    radius, theta, x, y = vx / omega, 0.0, 0.0, 0.0
    time = 1_000_000_000
    for k in range(2 * STEPS + 1):
        turn = omega if k <= STEPS else -omega
        inputs = state | tunables(module) | {"vx": vx, "vy": 0.0, "omega": turn}
        state |= {n: v for n, v in evaluate_module(module, "inverse", inputs, FLOAT64).items() if n in state}
        if k:
            time += step
            sign, after = turn / omega, theta + turn * step * 1e-9
            x += sign * radius * (sin(after) - sin(theta))
            y -= sign * radius * (cos(after) - cos(theta))
            theta = after
        yield Moment(time, {name: state[name] for name in joints}, (vx, 0.0, turn), (x, y, theta))


def tunables(module: Module) -> dict[str, float]:
    """Return the nominal values of the tunable parameters."""
    ports = module.prepare.inputs if module.prepare else ()
    return {port.name: float(port.default) for port in ports if port.default is not None}


def named(
    joints: Mapping[str, float], core: tuple[tuple[str, str, bool, bool, int], ...]
) -> dict[str, list[object]]:
    """Return name, position and velocity of a joint state.

    Args:
        joints: Values in the order of the module's joints.
        core: ``JOINTS`` of the package's core.

    Returns:
        The fields of a sensor_msgs/JointState.
    """
    names = list(dict.fromkeys(joint[0] for joint in core))
    fields = {"position": dict.fromkeys(names, 0.0), "velocity": dict.fromkeys(names, 0.0)}
    for value, (name, field, _, _, sign) in zip(joints.values(), core, strict=True):
        fields[field][name] = sign * value
    return {"name": list(names), **{field: list(values.values()) for field, values in fields.items()}}
