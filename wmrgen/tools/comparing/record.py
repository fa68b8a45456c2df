"""What is compared, how it differs, and what that does. Metres and radians in each file's own frame, all in doubles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType
from wmrgen.tools.controllers.parameters import Terms
from wmrgen.tools.controllers.record import ControllerType, Distro
from wmrgen.tools.importing.records import Controller

Value = float | str | tuple[float, float] | None
Silent = tuple[list[str], list[str]]  # what the first file does not say, and the second, and the other does
# Forms of files.
ROBOT_FILE, DESCRIPTION, HEADER, CONTROLLER = "robot file", "description", "header", "controller"
JOINTS = ("spin", "steer")  # which couplings join
SAME = 2e-3  # of a length, or rad: what differs less is equal


class JointName(NamedTuple):
    """A joint of a wheel as other software names it."""

    name: str
    sign: int = 1  # -1 if the joint counts against the wheel's own angle, as a steering axis that points down


@dataclass(frozen=True, slots=True)
class Side:
    """A wheel as one file has it. ``names``: its own and those of its joints. ``values``: x y heading r d offset_y
    gamma, as far as the file says; ``marks``: where a value stands, "" the wheel. ``actuated`` is None where the file
    does not say."""

    names: tuple[str, ...]
    type: str
    values: Mapping[str, float]
    marks: Mapping[str, Mark] = field(default_factory=dict)
    actuated: tuple[str, ...] | None = None
    joints: Mapping[str, JointName] = field(
        default_factory=dict
    )  # spin and steer, as far as the file names them

    @property
    def name(self) -> str:
        return self.names[0]

    @property
    def kind(self) -> WheelType:
        """What the wheel's type says of it. A ball with a radius and a heading is driven along that heading."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if kind.powered and {"r", "heading"} <= self.values.keys() else kind

    @property
    def drives(self) -> bool:
        """Its joints take commands, as far as is known; a castor only where the file says so."""
        kind = self.kind
        return bool(self.actuated) if self.actuated is not None else kind.has_spin and not kind.swivels

    @property
    def pivot(self) -> complex:
        return complex(self.values["x"], self.values["y"])

    def of(self, key: str) -> float:
        """A value; 0 where the file does not say."""
        return self.values.get(key, 0.0)


@dataclass(frozen=True, slots=True)
class Tie:
    """All joints, spin or steer, of one shaft: wheel -> its ``turns`` for one of the first, which has the motor.
    ``marks``: the couplings of a file that say so."""

    joint: str
    turns: Mapping[str, float]
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, slots=True)
class Layout:
    """The wheels that a file describes, or, with a ``controller``, lengths of wheels that another file describes.

    ``effective_track``: that of the differential drive as which it turns, which skids [m], and where it is said.
    ``ties``: couplings, None where the file does not say. ``title``: of the controller. ``ordered``: programs know the
    wheels by their order. ``joints``: all that the file has, None where it names none.
    """

    file: str
    form: str
    wheels: tuple[Side, ...] = ()
    ordered: bool = False
    joints: frozenset[str] | None = None
    controller: Controller | None = None
    title: str = ""
    effective_track: tuple[float, Mark] | None = None
    ties: tuple[Tie, ...] | None = None
    evaluable: tuple[ControllerType, Terms] | None = (
        None  # the controller's record and what the file gives of it
    )
    distro: Distro | None = None  # whose names and formula the controller has
    limits: Mapping[str, float] = field(default_factory=dict)  # of the twist, as "vx.high" [m/s, rad/s]

    @property
    def source(self) -> str:
        return f"{self.file}: {self.title}" if self.title else self.file


@dataclass(frozen=True, slots=True)
class Difference:
    """``a`` and ``b``: metres, radians, words or a point. ``marks``: where it is said, of the second file first."""

    code: str
    quantity: str
    wheel: str
    a: Value
    b: Value
    words: str
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, slots=True)
class Effect:
    """What becomes of a motion (straight, strafe, turn) of the first robot when the second file's commands drive it:
    ``ratio`` to the motion by its own commands; ``words`` are empty where nothing changes."""

    motion: str
    ratio: float
    words: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """Without the differences that a comment says to ignore. ``effects``: of the motions that the robot can do, none
    where too little is known. ``unsaid``: what one file alone says."""

    a: Layout
    b: Layout
    differences: tuple[Difference, ...]
    effects: tuple[Effect, ...]
    notes: tuple[str, ...]
    unsaid: tuple[str, ...]
    compared: bool = True  # the two files have something in common
