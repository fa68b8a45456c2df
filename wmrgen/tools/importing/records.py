"""What a URDF or SDF and the parameters of its controllers say of wheels. In metres, frames exact where the file is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from wmrgen.errors import Mark

KINDS = "continuous revolute prismatic floating planar fixed".split()  # of joints
RIGID = KINDS[-1]
SUPPORT = "support"  # what carries a robot beside the wheels that were found
DIGITS = 12  # decimals of a length; those of floating point noise are dropped
MODEL = "__model__"  # the frame of an SDF model, as if it were a link
Vector = tuple[Fraction, Fraction, Fraction]
Matrix = tuple[Vector, Vector, Vector]  # by rows


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame in another: p = rotation p' + origin."""

    rotation: Matrix
    origin: Vector


@dataclass(frozen=True, slots=True)
class Shape:
    """A cylinder along its frame's z, a sphere, or (``radius`` None) a mesh or box; ``role``: collision or visual.
    ``uri`` and ``scale`` are those of a mesh."""

    kind: str
    role: str
    frame: Frame
    radius: Fraction | None
    uri: str = ""
    scale: Vector = (Fraction(1), Fraction(1), Fraction(1))


def endless(kind: str, limits: tuple[Fraction, Fraction] | None) -> bool:
    """Whether a joint turns without end: a continuous one keeps no limits, whatever the file writes beside it."""
    low, high = limits or (Fraction(0), Fraction(0))
    return kind == "continuous" or (kind == "revolute" and (low == high == 0 or high - low >= 100))


@dataclass(frozen=True, slots=True)
class Joint:
    """``frame``: the child's in the parent's. ``axis`` through ``pivot``, both in the child's frame; the axis is None
    where the file has none. ``limits`` [rad] where it has any. ``mark``: where the file has it."""

    name: str
    kind: str
    parent: str
    child: str
    frame: Frame
    axis: Vector | None
    limits: tuple[Fraction, Fraction] | None
    mimic: tuple[str, Fraction, Fraction] | None
    pivot: Vector = (Fraction(0), Fraction(0), Fraction(0))
    mark: Mark | None = field(default=None, compare=False)

    @property
    def turns(self) -> bool:
        return self.kind in ("continuous", "revolute")

    @property
    def moves(self) -> bool:
        return self.kind != RIGID

    @property
    def spins(self) -> bool:
        """It turns without end."""
        return endless(self.kind, self.limits)


@dataclass(frozen=True, slots=True)
class Friction:
    """Directions of friction that a simulator is told: ``direction`` (fdir1) of mu1 in the frame ``link``."""

    direction: Vector
    link: str
    mu1: Fraction
    mu2: Fraction


@dataclass(frozen=True, slots=True)
class Description:
    """``driven``: joints that ros2_control, a transmission or a plugin names, None where the file has none of these.
    ``words``: names of plugins, meshes and the robot, which may say that wheels have rollers. ``controllers``: what
    drive plugins are told. ``closing``: joints that would give a link a second parent. ``transmitted``: driven joints
    that only a transmission names, and not for positions, which is no proof of a motor; ``commanded``: those of them
    that take velocities. ``masses``: link -> its centre of mass, in its frame. ``pushing``: joints and links that
    push air or water."""

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    shapes: dict[str, tuple[Shape, ...]]
    frictions: dict[str, Friction]
    driven: frozenset[str] | None
    words: tuple[str, ...]
    notes: tuple[str, ...]
    controllers: tuple[Controller, ...] = ()
    closing: tuple[Joint, ...] = ()
    transmitted: frozenset[str] = frozenset()
    commanded: frozenset[str] = frozenset()
    pushing: frozenset[str] = frozenset()
    masses: Mapping[str, Vector] = field(default_factory=dict)
    file_of: Callable[[str], bytes | None] = field(default=lambda uri: None)


@dataclass(frozen=True, slots=True)
class Question:
    """What the file does not say; ``hints`` are not taken."""

    wheel: str  # its name, or `SUPPORT`, which is none yet
    key: str  # of the robot file
    text: str
    hints: tuple[str, ...] = ()
    also: tuple[str, ...] = ()  # the other wheels that have the same answer

    @property
    def wheels(self) -> tuple[str, ...]:
        """All wheels that have this answer."""
        return (self.wheel, *self.also)


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel in the base frame. None is what the file does not say. ``remarks``: key -> where its value is from."""

    name: str
    joint: str | None
    steer_joint: str | None
    type: str
    x: Fraction
    y: Fraction
    heading: float | None
    r: Fraction | None
    d: Fraction | None
    offset_y: Fraction | None
    gamma: float | None
    actuated: tuple[str, ...] | None
    steer_limits: tuple[Fraction, Fraction] | None
    remarks: dict[str, str]
    steers_down: bool = False  # whether the axis of the steering joint points down

    @property
    def joints(self) -> dict[str, str]:
        """The names of its joints in the description, as a robot file writes them under ``joints:``."""
        sign = "-" if self.steers_down else ""
        names = {"spin": self.joint, "steer": self.steer_joint and sign + self.steer_joint}
        return {joint: name for joint, name in names.items() if name}


@dataclass(frozen=True, slots=True)
class Coupling:
    """Joints of wheels, as `<wheel>.steer`, that turn alike: the second ``ratio`` times as far as the first."""

    first: str
    second: str
    ratio: Fraction = Fraction(1)
    why: str = "mimic"

    @property
    def joints(self) -> str:
        """What a robot file says of them behind ``equal:``."""
        number = f"{float(self.ratio):.12g}"
        exact = number if Fraction(number) == self.ratio else str(self.ratio)
        return f"[{self.first}, {self.second}]" + (f", ratios: [1, {exact}]" if self.ratio != 1 else "")


@dataclass(frozen=True, slots=True)
class Imported:
    """What was read of a file; ``effective_track``: of a robot that skids [m], and who says it."""

    name: str
    base: str
    wheels: tuple[Wheel, ...]
    questions: tuple[Question, ...]
    couplings: tuple[Coupling, ...]
    notes: tuple[str, ...]
    effective_track: tuple[Fraction, str] | None = None
    answers: Mapping[str, str] = field(default_factory=dict)  # WHEEL.KEY -> value, as YAML


@dataclass(frozen=True, slots=True)
class Setting:
    """A number: m or a factor; ``key`` and ``mark`` (None as XML is read): where it is written."""

    value: Fraction
    key: str
    mark: Mark | None = None


@dataclass(frozen=True, slots=True)
class Named:
    """A joint that is named, without arguments that have no value; ``role``, as "front left", as far as its parameter
    or its name says it."""

    joint: str
    role: str
    steers: bool
    mark: Mark | None = None


@dataclass(frozen=True, slots=True)
class Controller:
    """One controller, driver or plugin.

    ``kind``: differential, mecanum, ackermann, bicycle, tricycle, omni, swerve, "" where the file does not say;
    ``type`` as written. ``lengths``: by the keys of `controllers.LENGTHS`, diameters halved; ``multipliers``, by the
    same keys, are not applied. ``joints``: in the order of the file.
    ``places``: joint or role -> x, y of its pivot. ``notes``: on how its file was read.
    """

    name: str
    kind: str
    type: str
    lengths: Mapping[str, Setting] = field(default_factory=dict)
    multipliers: Mapping[str, Setting] = field(default_factory=dict)
    joints: tuple[Named, ...] = ()
    places: Mapping[str, tuple[Setting, Setting]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
