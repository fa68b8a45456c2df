"""The records of a comparison: wheels of a file, differences, effects. Metres and radians in each file's own frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from wmrgen.errors import Mark
from wmrgen.robotfile.records import JointName
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType
from wmrgen.tools.controllers.parameters import Terms
from wmrgen.tools.controllers.record import ControllerType, Distro
from wmrgen.tools.importing.records import Controller

Value = float | str | tuple[float, float] | None
Silent = tuple[list[str], list[str]]  # values that the first file lacks, and those that the second file lacks
# Forms of files.
ROBOT_FILE, DESCRIPTION, HEADER, CONTROLLER = "robot file", "description", "header", "controller"
JOINTS = ("spin", "steer")  # which couplings join
SAME = 2e-3  # share of a length or of a rate, or rad: a smaller difference counts as equal


@dataclass(frozen=True, slots=True)
class Side:
    """A wheel as one file has it."""

    names: tuple[str, ...]  # its own and those of its joints
    type: str
    values: Mapping[str, float]  # x y heading r d offset_y gamma, as far as the file has them
    marks: Mapping[str, Mark] = field(default_factory=dict)  # the places of the values, "" of the wheel
    actuated: tuple[str, ...] | None = None  # None if the file does not show it
    # Spin and steer, as far as the file names them.
    joints: Mapping[str, JointName] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the name of the wheel."""
        return self.names[0]

    @property
    def kind(self) -> WheelType:
        """Return the record of the wheel's type. A ball with a radius and a heading is driven along that heading."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if kind.powered and {"r", "heading"} <= self.values.keys() else kind

    @property
    def drives(self) -> bool:
        """Return whether a motor drives the wheel; if the file does not show it, castors have none, others have one."""
        kind = self.kind
        return bool(self.actuated) if self.actuated is not None else kind.has_spin and not kind.swivels

    @property
    def pivot(self) -> complex:
        """Return the position of the pivot [m]."""
        return complex(self.values["x"], self.values["y"])

    def of(self, key: str) -> float:
        """Return a value; 0 if the file lacks it."""
        return self.values.get(key, 0.0)


@dataclass(frozen=True, slots=True)
class Tie:
    """All joints of one shaft. The first wheel has the motor."""

    joint: str  # spin or steer
    turns: Mapping[str, float]  # wheel -> its turns for one turn of the first
    marks: tuple[Mark, ...] = ()  # the couplings of the file


@dataclass(frozen=True, slots=True)
class Layout:
    """The wheels that a file describes; with a ``controller``, the lengths of wheels that another file describes."""

    file: str
    form: str
    wheels: tuple[Side, ...] = ()
    ordered: bool = False  # programs know the wheels by their order
    joints: frozenset[str] | None = None  # all joints of the file; None if it names none
    controller: Controller | None = None
    title: str = ""  # of the controller
    effective_track: tuple[float, Mark] | None = None  # of a robot that skids [m], and its place
    ties: tuple[Tie, ...] | None = None  # couplings; None if the file does not show them
    # The controller's record, and the terms that the file gives.
    evaluable: tuple[ControllerType, Terms] | None = None
    distro: Distro | None = None  # whose names and formula the controller has
    limits: Mapping[str, float] = field(default_factory=dict)  # of the twist, as "vx.high" [m/s, rad/s]

    @property
    def source(self) -> str:
        """Return the file, and the controller in it."""
        return f"{self.file}: {self.title}" if self.title else self.file


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that the two files have otherwise."""

    code: str
    quantity: str
    wheel: str  # "" for the whole robot
    a: Value  # of the first file: metres, radians, words or a point
    b: Value  # of the second file
    words: str
    marks: tuple[Mark, ...] = ()  # its places, those of the second file first


@dataclass(frozen=True, slots=True)
class Effect:
    """The change of a motion of the first robot if the second file's commands drive it."""

    motion: str  # straight, strafe or turn
    ratio: float  # to the motion by its own commands
    words: str  # "" if nothing changes


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of a comparison."""

    a: Layout
    b: Layout
    differences: tuple[Difference, ...]  # without those that a comment says to ignore
    effects: tuple[Effect, ...]  # on the motions that the robot can do; none if too little is known
    notes: tuple[str, ...]
    unsaid: tuple[str, ...]  # values that only one file has
    compared: bool = True  # the two files have something in common
