"""The content of a robot file as frozen records. Nothing is evaluated: quantities remain expressions.

Expressions are trees of the classes below, with exact rational leaves. Units are already applied:
``150 mm`` is ``Num(3/20)``; ``45 deg`` is ``Binary("*", Num(1/4), Pi())``.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType


@dataclass(frozen=True, slots=True)
class Num:
    """An exact number."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Pi:
    """The number pi."""


@dataclass(frozen=True, slots=True)
class Param:
    """A named parameter of the robot file."""

    name: str


@dataclass(frozen=True, slots=True)
class Binary:
    """An operation on two values. The right side of ** is a whole Num from -4 to 4."""

    op: str  # one of + - * / **
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Neg:
    """The negative of a value."""

    arg: Expr


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function."""

    function: str  # one of sqrt sin cos tan atan2
    args: tuple[Expr, ...]


Expr = Num | Pi | Param | Binary | Neg | Call


def children(expr: Expr) -> tuple[Expr, ...]:
    """Return the direct subtrees of a tree."""
    match expr:
        case Neg(arg):
            return (arg,)
        case Binary(_, left, right):
            return (left, right)
        case Call(_, args):
            return args
    return ()


def parameters_in(expr: Expr) -> set[str]:
    """Return the names of the parameters that occur in a tree."""
    if isinstance(expr, Param):
        return {expr.name}
    return set().union(*(parameters_in(child) for child in children(expr)))


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity as written, in SI units and radians."""

    expr: Expr
    text: str  # as in the file
    mark: Mark


class ParameterSpec(NamedTuple):
    """A named length, angle or number."""

    name: str
    value: Quantity
    tunable: bool  # whether it remains an input of the generated code
    range: tuple[Quantity, Quantity] | None = (
        None  # lowest and highest value of a tunable parameter, if given
    )
    symbol: str = ""  # its letter in reports, if given


class Limit(NamedTuple):
    """A range, low <= value <= high, in SI units."""

    name: str  # a key of limits, such as vx, omega_rate or spin
    low: Quantity
    high: Quantity
    mark: Mark


class NoiseSpec(NamedTuple):
    """Standard deviations of a measurement; None is 0."""

    joint: str  # spin, steer, steer_rate or gyro
    proportional: Quantity | None  # per value [1]
    constant: Quantity | None  # [rad/s] or [rad]


class EncoderSpec(NamedTuple):
    """The encoder of a joint, a counter."""

    joint: str  # spin or steer
    counts: Quantity  # per turn of the encoder's shaft
    gear: Quantity | None  # turns of the shaft per turn of the joint; None is 1
    reversed: bool  # whether it counts down when the joint turns in its positive direction
    bits: Quantity | None  # the counter wraps at 2**bits; None is 32
    modulus: Quantity | None = None  # the counter wraps here, in place of 2**bits
    offset: Quantity | None = None  # reading of an absolute encoder when the joint is at 0; None: incremental


class JointName(NamedTuple):
    """The name of a joint in other tools."""

    name: str
    reversed: bool = False  # whether a positive angle there is a negative angle here

    @property
    def sign(self) -> int:
        """The angle here for an angle of 1 rad there: 1 or -1."""
        return -1 if self.reversed else 1


class GyroSpec(NamedTuple):
    """A yaw-rate sensor."""

    noise: NoiseSpec
    weight: Quantity | None  # in the least squares of forward; None is 1


@dataclass(frozen=True, slots=True)
class WheelSpec:
    """One entry of ``wheels``, or one direction in which a ball is driven.

    It has either l and alpha or x and y. It has either beta or heading; a castor or spherical wheel may have neither.
    """

    name: str
    type: str  # a name of WHEEL_TYPES
    mark: Mark
    # For a driven direction: the name of its ball in the file. The heading of this record is the direction.
    ball: str = ""
    r: Quantity | None = None  # None if the type does not require it
    l: Quantity | None = None
    alpha: Quantity | None = None
    x: Quantity | None = None
    y: Quantity | None = None
    beta: Quantity | None = None
    heading: Quantity | None = None
    gamma: Quantity | None = None
    d: Quantity | None = None
    offset_y: Quantity | None = None
    r_sw: Quantity | None = None
    per_steer: Quantity | None = None
    weight: Quantity | None = None
    actuated: tuple[str, ...] = ()  # joints; defaults are already applied
    sensed: tuple[str, ...] = ()
    limits: tuple[Limit, ...] = ()
    noise: tuple[NoiseSpec, ...] = ()
    encoders: tuple[EncoderSpec, ...] = ()
    lag: tuple[tuple[str, Quantity], ...] = ()  # joint, time constant
    joints: tuple[tuple[str, JointName], ...] = ()  # joint, its name in other tools

    @property
    def kind(self) -> WheelType:
        """The record of the wheel's type; for a driven ball, that of a driven direction."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if self.ball and kind.powered else kind


class Coupling(NamedTuple):
    """Joints of several wheels that a mechanism couples."""

    joint: str  # spin or steer
    wheels: tuple[str, ...]
    mark: Mark
    ratios: tuple[Quantity, ...] = ()  # turns of each joint per turn of their shaft; empty if all are equal


class TrailerSpec(NamedTuple):
    """One entry of ``trailers``."""

    name: str
    length: Quantity  # from its hitch to its axle [m]
    hitch: Quantity | None  # from the axle in front back to its hitch [m]; None is 0
    mark: Mark


class VirtualSpec(NamedTuple):
    """One entry of ``virtual``."""

    name: str
    role: str  # steers or drives
    wheels: tuple[str, ...]  # that it represents
    x: Quantity | None  # position in the robot frame [m]; None: the centre of its wheels
    y: Quantity | None
    mark: Mark


class PointSpec(NamedTuple):
    """The centre of gravity in the robot frame [m]."""

    x: Quantity
    y: Quantity
    z: Quantity  # above the ground


class FunctionSpec(NamedTuple):
    """A function that the file requests; `wmrgen.functions.registry` knows all functions."""

    name: str
    mark: Mark


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """A robot file whose keys and forms have been checked. The fields are the keys of the file."""

    name: str
    parameters: tuple[ParameterSpec, ...]  # each after those that it uses
    wheels: tuple[WheelSpec, ...]
    description: str = ""
    source: str = ""
    frame: str = ""  # the name of the robot frame in other tools; "" is the default
    snap: bool = True
    tolerance: Quantity | None = None
    couplings: tuple[Coupling, ...] = ()
    limits: tuple[Limit, ...] = ()
    noise: tuple[NoiseSpec, ...] = ()
    encoders: tuple[EncoderSpec, ...] = ()
    gyro: GyroSpec | None = None
    lag: tuple[tuple[str, Quantity], ...] = ()  # joint, time constant
    virtual: tuple[VirtualSpec, ...] = ()
    trailers: tuple[TrailerSpec, ...] = ()
    slip: bool = False
    precise: bool = False
    cg: PointSpec | None = None
    gains: tuple[tuple[str, Quantity], ...] = ()
    deadband: Quantity | None = None
    effective_track: Quantity | None = None
    functions: tuple[FunctionSpec, ...] = ()
