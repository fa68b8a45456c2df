"""Named inputs and outputs of functions, with their roles and units, and their limits from the robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from typing import NamedTuple

from wmrgen.geometry.exact.number import Exact


class Role(StrEnum):
    """The role of an input. It decides when its value is known."""

    GEOMETRY = "geometry"  # a tunable parameter: known before the step
    PREPARED = "prepared"  # an output of prepare(): depends only on tunable parameters
    STATE = "state"  # steering angles, pose
    COMMAND = "command"  # twists, joint rates, dt


class Limits(StrEnum):
    """How the limits of the robot bound the inputs of a function in checked code."""

    NONE = "none"  # joints are measured; a twist, if any, is neither commanded nor driven
    COMMANDED = "commanded"  # twists are commands inside their limits; joints are measured
    MEASURED = "measured"  # twists and joints are measured
    # Twists may exceed their limits, and joint rates are what `inverse` returns for a twist inside its limits.
    ASKED = "asked"


class Reading(NamedTuple):
    """The reading of an encoder: a whole number of counts."""

    modulus: int  # readings run from 0 to modulus - 1 and then wrap
    # Reading of an absolute encoder when its joint is at 0; None for an incremental one.
    offset: int | None = None

    @property
    def width(self) -> int:
        """Return the width in bits of the smallest unsigned integer that holds the reading: 8, 16 or 32."""
        return next(w for w in (8, 16, 32) if self.modulus <= 1 << w)

    @property
    def wraps_as_integer(self) -> bool:
        """Return whether the reading wraps at the same value as an unsigned integer of its `width`."""
        return self.modulus == 1 << self.width


@dataclass(frozen=True, slots=True)
class Port:
    """A named input or output of a function."""

    name: str  # contract name, such as ``vx`` or ``left.spin``
    role: Role
    unit: str
    text: str = ""  # one line of description
    default: Exact | None = None  # nominal value of a tunable parameter, else None
    reading: Reading | None = None  # the encoder whose count difference is the input; None if there is none
    range: tuple[Exact, Exact] | None = (
        None  # allowed values of a tunable parameter; None: see `default_range`
    )


def output(name: str, unit: str, text: str) -> Port:
    """Return the port of a result of a function.

    Args:
        name: The contract name.
        unit: The unit.
        text: One line of description.

    Returns:
        The port.
    """
    return Port(name, Role.COMMAND, unit, text)


TWIST = (
    output("vx", "m/s", "velocity of P forward, robot frame"),
    output("vy", "m/s", "velocity of P to the left, robot frame"),
    output("omega", "rad/s", "yaw rate, counter-clockwise"),
)
TWIST_NAMES = tuple(port.name for port in TWIST)
POSE = (
    Port("x", Role.STATE, "m", "position of P in the world frame"),
    Port("y", Role.STATE, "m", "position of P in the world frame"),
    Port("theta", Role.STATE, "rad", "heading of the robot, counter-clockwise from world x"),
)
GYRO = Port("gyro", Role.COMMAND, "rad/s", "reading of the yaw-rate sensor, positive counter-clockwise")
DT = Port("dt", Role.COMMAND, "s", "duration of the step")


def _covariance(of: tuple[Port, ...], per: str, what: str) -> tuple[Port, ...]:
    """Return ports for the upper triangle of a covariance matrix, row by row; ``per`` is appended to each unit."""
    units = {(0, 2): "m rad", (1, 2): "m rad", (2, 2): "rad^2"}
    ports = []
    for i in range(3):
        for j in range(i, 3):
            first, second = of[i].name, of[j].name
            text = f"variance of {first}" if i == j else f"covariance of {first} and {second} of the {what}"
            ports.append(Port(first + second, Role.STATE, units.get((i, j), "m^2") + per, text))
    return tuple(ports)


POSE_COVARIANCE = _covariance(POSE, "", "pose")
TWIST_COVARIANCE = _covariance(TWIST, "/s^2", "twist")
JOINTS = {
    joint: output(joint, unit, text)
    for joint, unit, text in (
        ("spin", "rad/s", "wheel speed about its axle, positive rolls along the rolling direction"),
        ("steer", "rad", "steering angle, counter-clockwise from the zero of the robot file"),
        ("steer_rate", "rad/s", "steering rate, counter-clockwise"),
    )
}

TIMES = ("now", "wanted", "last")  # suffixes of quantities: ``vx_wanted`` has the limits of ``vx``


def without_time_suffix(name: str) -> str:
    """Return the contract name of a quantity without its time suffix: ``vx`` for ``vx_wanted``."""
    plain, _, time = name.rpartition("_")
    return plain if time in TIMES else name


# Default half-range of a tunable parameter, relative to its nominal value: build tolerances.
SPREAD = Fraction(1, 10)
SPAN = Fraction(1, 100)  # default half-range [m or rad] of a tunable parameter that is nominally zero


def default_range(nominal: Exact) -> tuple[Exact, Exact]:
    """Return the default range (low, high) of a tunable parameter, used when the robot file gives no range."""
    spread = abs(nominal) * SPREAD if nominal else Exact(SPAN)
    return nominal - spread, nominal + spread


# Factor on the limits of measured joints: a joint slightly beyond its limit must not stop the robot.
OVERSHOOT = 1.25


def overshot(low: float, high: float) -> tuple[float, float]:
    """Return the range of joint measurements that checked code accepts: the limits widened by `OVERSHOOT`."""
    middle, half = (low + high) / 2, OVERSHOOT * (high - low) / 2
    return middle - half, middle + half


@dataclass(frozen=True, slots=True)
class Site:
    """Numbers from a robot file that generated functions are checked and tested with."""

    # Contract name -> (low, high), SI units.
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    pivots: tuple[tuple[str, float, float], ...] = ()  # wheel name, x [m], y [m]
    # Twist component -> range of the result of `forward` while every joint is inside its `overshot` limits. Unbounded
    # components are absent.
    reach: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    unmotored: bool = False  # some motions of the robot are commanded by no motor


NO_SITE = Site()
