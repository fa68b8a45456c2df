"""What a robot file says, as frozen records. Nothing is evaluated here: quantities stay expressions.

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
    """``op`` is one of + - * / ** ; the right side of ** is a whole Num from -4 to 4."""

    op: str
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Neg:
    """``arg`` with the other sign."""

    arg: Expr


@dataclass(frozen=True, slots=True)
class Call:
    """``function`` is one of sqrt sin cos tan atan2."""

    function: str
    args: tuple[Expr, ...]


Expr = Num | Pi | Param | Binary | Neg | Call


def children(expr: Expr) -> tuple[Expr, ...]:
    """The trees of which a tree is made."""
    match expr:
        case Neg(arg):
            return (arg,)
        case Binary(_, left, right):
            return (left, right)
        case Call(_, args):
            return args
    return ()


def parameters_in(expr: Expr) -> set[str]:
    """Names of the parameters that occur in the tree."""
    if isinstance(expr, Param):
        return {expr.name}
    return set().union(*(parameters_in(child) for child in children(expr)))


@dataclass(frozen=True, slots=True)
class Quantity:
    """A length [m], angle [rad] or rate as written: tree, source text and place."""

    expr: Expr
    text: str
    mark: Mark


class ParameterSpec(NamedTuple):
    """A named length or angle; one that is tunable stays an input of the generated code.

    ``range``: the lowest and the highest value that a tunable one may have, where the file states them.
    """

    name: str
    value: Quantity
    tunable: bool
    range: tuple[Quantity, Quantity] | None = None


class Limit(NamedTuple):
    """low <= value <= high, in SI units. ``name``: vx vy omega, their rates, spin steer steer_rate."""

    name: str
    low: Quantity
    high: Quantity
    mark: Mark


class NoiseSpec(NamedTuple):
    """Standard deviations of what is measured of ``joint`` (spin, steer or steer_rate); None is 0."""

    joint: str
    proportional: Quantity | None
    constant: Quantity | None


class EncoderSpec(NamedTuple):
    """A counter of ``joint``, spin or steer: ``counts`` per turn of its shaft, which turns ``gear`` times as far.

    It wraps at 2**``bits`` or at ``modulus``. ``offset``: reading of an absolute encoder where the joint is at 0.
    """

    joint: str
    counts: Quantity
    gear: Quantity | None
    reversed: bool
    bits: Quantity | None
    modulus: Quantity | None = None
    offset: Quantity | None = None


class GyroSpec(NamedTuple):
    """A yaw-rate sensor; ``weight``: None is 1."""

    noise: NoiseSpec
    weight: Quantity | None


@dataclass(frozen=True, slots=True)
class WheelSpec:
    """One entry of ``wheels``, or one driven direction of a ball. Exactly one placement (l, alpha) or (x, y); beta or
    heading, not both; a castor or spherical wheel may have neither."""

    name: str
    type: str  # a name of WHEEL_TYPES
    mark: Mark
    ball: str = (
        ""  # the name in the file of the ball whose driven direction this is; its heading is that direction
    )
    r: Quantity | None = None  # None where the type does not require it
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
    actuated: tuple[str, ...] = ()  # defaults already applied
    sensed: tuple[str, ...] = ()
    limits: tuple[Limit, ...] = ()
    noise: tuple[NoiseSpec, ...] = ()
    encoders: tuple[EncoderSpec, ...] = ()
    lag: tuple[tuple[str, Quantity], ...] = ()  # joint, time constant

    @property
    def kind(self) -> WheelType:
        """What the wheel's type says of it."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if self.ball and kind.powered else kind


class Coupling(NamedTuple):
    """Joints of several wheels that a mechanism couples. ``joint``: spin or steer. ``ratios``: the turns of each joint
    per turn of their shaft; none where they are equal."""

    joint: str
    wheels: tuple[str, ...]
    mark: Mark
    ratios: tuple[Quantity, ...] = ()


class TrailerSpec(NamedTuple):
    """One entry of ``trailers``. ``length``: from its hitch to its axle; ``hitch``: from the axle in front
    back to its hitch."""

    name: str
    length: Quantity
    hitch: Quantity | None
    mark: Mark


class VirtualSpec(NamedTuple):
    """One entry of ``virtual``. ``role``: steers or drives."""

    name: str
    role: str
    wheels: tuple[str, ...]
    x: Quantity | None
    y: Quantity | None
    mark: Mark


class PointSpec(NamedTuple):
    """The centre of gravity, in the robot's frame."""

    x: Quantity
    y: Quantity
    z: Quantity


class FunctionSpec(NamedTuple):
    """A function that the file asks for; `wmrgen.functions.registry` knows which there are."""

    name: str
    mark: Mark


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """A robot file, read and checked for form. Each parameter stands after those it uses."""

    name: str
    parameters: tuple[ParameterSpec, ...]
    wheels: tuple[WheelSpec, ...]
    description: str = ""
    source: str = ""
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
