"""The functions that a robot may have. Each is declared by a decorator at its builder, and nowhere else:

    @function(source="Tzafestas (2.57)")
    def pursuit(robot, mobility): ...

`wmrgen.functions.standard` declares the functions that every robot has; the other modules below `wmrgen.functions`
declare the rest. The module of a function is found by its text, so a look-up imports only that module. A function from
outside the package is known as soon as its module is imported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum, StrEnum
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from wmrgen.errors import Code, ErrorCollector, Mark, NotDerivableError, RobotFileError, UsageError
from wmrgen.geometry.ports import Limits
from wmrgen.robotfile.text import nearest, quoted, suggestion

if TYPE_CHECKING:
    from wmrgen.analysis.kinematics.records import Formula
    from wmrgen.analysis.mobility.records import Mobility
    from wmrgen.functions.system import System
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.robotfile.records import FunctionSpec

    Builder = Callable[[Robot, Mobility], Formula]
    SystemBuilder = Callable[[Robot, Mobility, bool], System]


_SystemBuilder = TypeVar("_SystemBuilder", bound="SystemBuilder")  # keeps the defaults of arguments


class Kind(Enum):
    """For which robots a function is generated, and whether C has it."""

    FIRMWARE = "every robot, also in C"
    STANDARD = "every robot that has it; in C if the robot file lists it"
    OPTIONAL = "if the robot file lists it"


class Declaration(NamedTuple):
    """A declared function."""

    name: str
    build: Builder  # raises NotDerivableError if a robot cannot have the function
    source: str  # equations of the texts in their corrected form, or that it is ours
    kind: Kind
    limits: Limits  # see `Limits`
    exists: Callable[[Robot], bool]  # whether a robot has a STANDARD function
    # its twist or wheels may replace those of its inputs, in languages that can express it
    # (`wmrgen.codegen.signature`)
    in_place: bool
    # it is about the contacts of the wheels, also for a robot with an effective track (`layout.skid`)
    contacts: bool
    reads: tuple[str, ...] = ()  # which of `SECTIONS` it uses


# Sections of a robot file that may be there without any function that uses them.
SECTIONS = ("trailers", "cg", "encoder", "noise")
FUNCTIONS: dict[str, Declaration] = {}  # declared so far; `names` and `declaration` import what is missing
SYSTEMS: dict[str, SystemBuilder] = {}


def function(
    source: str,
    kind: Kind = Kind.OPTIONAL,
    limits: Limits = Limits.NONE,
    exists: Callable[[Robot], bool] = lambda _: True,
    in_place: bool = False,
    contacts: bool = False,
    reads: tuple[str, ...] = (),
) -> Callable[[Builder], Builder]:
    """Declare the function with the name of the decorated builder.

    Args:
        source: Equations of the texts in their corrected form, or that it is ours.
        kind: For which robots it is generated.
        limits: Which limits of the robot bound its inputs.
        exists: Whether a robot has it, for a STANDARD function.
        in_place: Whether it may write its results over its inputs.
        contacts: Whether it is about the contacts of the wheels with the ground.
        reads: Which of `SECTIONS` it uses.

    Raises:
        ValueError: If another module has declared the function.
    """

    def declare(build: Builder) -> Builder:
        name = build.__name__
        other = FUNCTIONS.get(name)
        if other is not None and other.build.__module__ != build.__module__:
            raise ValueError(
                f"function {name} of {build.__module__} is already declared in {other.build.__module__}"
            )
        FUNCTIONS[name] = Declaration(name, build, source, kind, limits, exists, in_place, contacts, reads)
        return build

    return declare


def system(name: str) -> Callable[[_SystemBuilder], _SystemBuilder]:
    """Declare the decorated builder for the model ``name``, a control system q' = G(q) u."""

    def declare(build: _SystemBuilder) -> _SystemBuilder:
        SYSTEMS[name] = build
        return build

    return declare


class Reason(StrEnum):
    """Why a robot cannot have a function: a key for programs. The message says it in full."""

    OTHER = "other"  # no key of its own
    NO_LIMIT = "no limit"  # the robot file lacks a limit that the function needs
    ONE_SIDED_LIMIT = "limit on one side of 0"  # a limit excludes one direction
    LIMIT_TOO_WIDE = "limit too wide"  # a limit of steering is 90 degrees or more
    LIMIT_TOO_NARROW = "limit too narrow"  # a limit leaves no room
    STEERING_STOPS = "steering stops"  # a wheel cannot reach an angle between its stops
    SHARED_MOTOR = "shared motor"  # wheels on one motor would need motors of their own
    CASTOR = "swinging castor"  # a castor swings by itself
    BESIDE_STEERING_AXIS = "beside the steering axis"  # a wheel rolls while it is steered
    NOT_STEERED = "not steered"
    NOT_DRIVEN = "not driven"
    NOT_A_CAR = "not a car"  # the function is for cars only
    CAR = "car"  # the function is not for cars
    SKEWED_WHEEL = "skewed wheel"  # a wheel does not point straight ahead at steering angle 0
    WHEELS_ON_ONE_LINE = "wheels on one line"
    AXLES = "axles"  # the axles do not allow the motion, or do not determine it
    COUPLINGS = "couplings"  # couplings between wheels prevent it
    MOBILITY = "mobility"  # the degree of mobility does not allow it
    UNSTABLE_GAINS = "unstable gains"
    NO_ENCODER = "no encoder"
    NO_NOISE = "no noise"
    UNOBSERVABLE = "unobservable"  # the sensed joints do not determine it
    NO_CENTRE_OF_GRAVITY = "no centre of gravity"
    CENTRE_OF_GRAVITY = "centre of gravity"  # the centre of gravity is at the wrong height or place
    NO_POLYGON = "no support polygon"
    TOO_LONG = "too long"  # the formulas would be too long
    NO_TRAILERS = "no trailers"
    NO_ROLLERS = "no rollers"  # no roller and no sphere has a radius
    HITCH = "hitch off the axle"  # a trailer is not coupled on the axle
    ROBOT_TYPE = "robot type"  # the function is for other types (Campion)
    FLAT_OUTPUTS = "flat outputs without formulas"  # flat outputs are known, but no formulas
    ACKERMANN = "Ackermann condition"  # virtual steering does not determine the ICR
    NOT_PARALLEL = "not parallel"  # the wheels of a virtual wheel differ
    NO_VIRTUAL_WHEEL = "no virtual wheel"


class UnderivableError(NotDerivableError):
    """A function, or a form of a model, that a robot cannot have."""

    def __init__(self, what: str, reason: Reason = Reason.OTHER, mark: Mark | None = None) -> None:
        super().__init__(what, mark)
        self.reason = reason


def underivable(robot: Robot, what: str, why: str, reason: Reason = Reason.OTHER) -> UnderivableError:
    """Return the error of a builder: the robot cannot have a function.

    Args:
        robot: The robot.
        what: The function, or the form of a model.
        why: The reason, and what to write instead.
        reason: The reason as a key, for tests and other programs.
    """
    return UnderivableError(f"{robot.name} has no {what}: {why}", reason)


def declaration(name: str) -> Declaration:
    """Return the function called ``name``. Raise RobotFileError if there is none."""
    if not has_function(name):
        what = f"there is no function {quoted(name)}"
        raise RobotFileError(what, instead=suggestion(name, names()), code=Code.UNDECLARED)
    return FUNCTIONS[name]


def has_function(name: str) -> bool:
    """Return whether a function is called ``name``."""
    return _declared(name, FUNCTIONS)


def has_system(name: str) -> bool:
    """Return whether a model is called ``name``."""
    return _declared(name, SYSTEMS)


def system_builder(name: str) -> SystemBuilder:
    """Return the builder of the model called ``name``. Raise UsageError if there is none."""
    if not has_system(name):
        names()  # every module declares its models
        raise UsageError(f"models have no form {quoted(name)}. {suggestion(name, sorted(SYSTEMS))}")
    return SYSTEMS[name]


def standard() -> tuple[Declaration, ...]:
    """Return the functions that are generated for every robot, in the order in which they are emitted."""
    import_module(f"{__package__}.standard")
    return tuple(d for d in FUNCTIONS.values() if d.kind is not Kind.OPTIONAL)


def names() -> tuple[str, ...]:
    """Return every function that a robot may have: the standard ones, then the others by name. Imports all modules."""
    first = tuple(d.name for d in standard())
    for path in _sources():
        import_module(path)
    return (*first, *sorted(FUNCTIONS.keys() - set(first)))


def optional_names() -> tuple[str, ...]:
    """Return the functions that a robot file may list under `functions`."""
    return tuple(name for name in names() if FUNCTIONS[name].kind is not Kind.FIRMWARE)


def check(requests: Iterable[FunctionSpec]) -> None:
    """Raise RobotFileError for functions that do not exist or that every robot has."""
    collector = ErrorCollector()
    for request in requests:
        with collector:
            if not has_function(request.name):
                near, instead = nearest(request.name, names()), suggestion(request.name, optional_names())
                if near and FUNCTIONS[near].kind is Kind.FIRMWARE:
                    instead = f"Leave it out if {near} is meant, which is generated for every robot."
                raise RobotFileError(
                    f"there is no function {quoted(request.name)}", request.mark,
                    instead=instead, code=Code.UNDECLARED,
                )  # fmt: skip
            if FUNCTIONS[request.name].kind is Kind.FIRMWARE:
                raise RobotFileError(
                    f"{request.name} is generated for every robot", request.mark, instead="Leave it out here."
                )
    collector.end()


def _declared(name: str, table: dict[str, Declaration] | dict[str, SystemBuilder]) -> bool:
    """Return whether ``table`` has ``name``, after importing the modules that may declare it."""
    if name not in table:
        lines = f"\ndef {name}(", f'\n@system("{name}")\n'
        for path, text in _sources().items():
            if any(line in text for line in lines):
                import_module(path)
    return name in table


@cache
def _sources() -> dict[str, str]:
    """Return the text of each module below this package, by its import path."""
    folder = Path(__file__).parent
    files = {file.relative_to(folder).with_suffix("").parts: file for file in sorted(folder.rglob("*.py"))}
    return {
        ".".join((__package__, *parts)): file.read_text(encoding="utf-8")
        for parts, file in files.items()
        if parts[-1] != "__init__"
    }
