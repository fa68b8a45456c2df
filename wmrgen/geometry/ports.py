"""Named inputs and outputs: the contract's names with their roles and units, and what a robot's file says of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from typing import NamedTuple

from wmrgen.geometry.exact.number import Exact


class Role(StrEnum):
    """What an input is, which decides when it is known."""

    GEOMETRY = "geometry"  # a tunable parameter: known before the step
    PREPARED = "prepared"  # an output of prepare(): a function of the geometry alone
    STATE = "state"  # steering angles, pose
    COMMAND = "command"  # twists, joint rates, dt


class Limits(StrEnum):
    """Which inputs of a function the limits of the robot bound, as far as checked code is concerned."""

    NONE = "none"  # joints are measured; a twist, if there is one, is neither commanded nor driven
    COMMANDED = "commanded"  # twists are commands, kept inside their limits; joints are measured
    MEASURED = "measured"  # twists and joints are measured
    ASKED = (
        "asked"  # beyond them: twists, and joint rates as `inverse` gives them for a twist inside its limits
    )


class Reading(NamedTuple):
    """What an encoder shows: a whole number from 0 to ``modulus`` - 1. ``offset``: the reading of an absolute encoder
    where its joint is at 0; None for an incremental one, which starts anywhere."""

    modulus: int
    offset: int | None = None

    @property
    def width(self) -> int:
        """The bits of the smallest unsigned integer that holds it: 8, 16 or 32."""
        return next(w for w in (8, 16, 32) if self.modulus <= 1 << w)

    @property
    def wraps_as_integer(self) -> bool:
        """Whether it wraps where that integer does."""
        return self.modulus == 1 << self.width


@dataclass(frozen=True, slots=True)
class Port:
    """A named input or output: contract name (``vx``, ``left.spin``), role, unit, one line of text.

    ``default`` is the nominal value of a tunable parameter, else None; ``range``: the values that it may have, see
    `usual_range` for one without. ``reading``: of the encoder whose difference a port takes; None if there is none.
    """

    name: str
    role: Role
    unit: str
    text: str = ""
    default: Exact | None = None
    reading: Reading | None = None
    range: tuple[Exact, Exact] | None = None


def output(name: str, unit: str, text: str) -> Port:
    """The port of a result."""
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
    """The upper triangle of a symmetric matrix, row by row; ``per``: what its units are divided by."""
    units = {(0, 2): "m rad", (1, 2): "m rad", (2, 2): "rad^2"}
    return tuple(
        Port(
            of[i].name + of[j].name,
            Role.STATE,
            units.get((i, j), "m^2") + per,
            f"variance of {of[i].name}"
            if i == j
            else f"covariance of {of[i].name} and {of[j].name} of the {what}",
        )
        for i in range(3)
        for j in range(i, 3)
    )


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

TIMES = ("now", "wanted", "last")  # of a quantity: ``vx_wanted`` keeps the limits of ``vx``


def timeless(name: str) -> str:
    """The contract name of a quantity without the time that stands behind it."""
    plain, _, time = name.rpartition("_")
    return plain if time in TIMES else name


SPREAD = Fraction(1, 10)  # of a tunable parameter about its nominal value
SPAN = Fraction(1, 100)  # of one that is nominally zero [m, rad]


def usual_range(nominal: Exact) -> tuple[Exact, Exact]:
    """The values (low, high) of a tunable parameter for which the robot file has no range."""
    spread = (nominal if nominal.sign >= 0 else -nominal) * SPREAD if nominal else Exact(SPAN)
    return nominal - spread, nominal + spread


OVERSHOOT = 1.25  # of what is measured: a joint that stands at its limit must not stop the robot


def overshot(low: float, high: float) -> tuple[float, float]:
    """The measurements of a joint that are believed: `OVERSHOOT` as far from the middle of its limits."""
    middle, half = (low + high) / 2, OVERSHOOT * (high - low) / 2
    return middle - half, middle + half


@dataclass(frozen=True, slots=True)
class Site:
    """What a robot's file says of its functions, as numbers.

    ``limits``: contract name -> (low, high), SI units; ``pivots``: wheel, x, y [m]. ``reach``: component of the twist
    -> what `forward` gives while every joint keeps its `overshot` limits, where that is bounded. ``unmotored``: no
    motor commands some of the robot's motions.
    """

    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    pivots: tuple[tuple[str, float, float], ...] = ()
    reach: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    unmotored: bool = False


NO_SITE = Site()
