"""A wheel layout in exact quantities, with three views of the same geometry.

``symbolic`` has every named parameter as a symbol, ``working`` only the tunable ones, and ``nominal`` has numbers. The
robot frame has x forward, y left and the origin P. Units are SI, angles in radians.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from math import ceil
from typing import Generic, NamedTuple, TypeVar

from wmrgen.errors import Mark, UsageError
from wmrgen.geometry.exact.evaluate import number, parameters_in
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.ports import GYRO, Reading
from wmrgen.robotfile.records import JointName
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType

T = TypeVar("T", Poly, Exact)
U = TypeVar("U", Poly, Exact)
DEFAULT_FRAME = "base_link"  # the name of the robot frame in ROS (REP 105)
_RATIOS = ("ch", "sh", "cg", "sg", "per_steer")  # the fields of `Geometry` that are not lengths


@dataclass(frozen=True, slots=True)
class Geometry(Generic[T]):
    """The constants of one wheel."""

    x: T  # pivot A [m]
    y: T
    ch: T  # cosine and sine of the zero heading alpha + beta - pi/2
    sh: T
    cg: T  # cosine and sine of gamma, the angle from the wheel plane to the roller axis at the ground
    sg: T
    r: T  # wheel radius [m]
    d: T  # castor offset along the rolling direction e [m]
    o: T  # lateral offset along n [m]
    r_sw: T  # roller radius [m]
    per_steer: T  # rotation of the spin joint for 1 rad of steering while the wheel does not roll

    def mapped(self, function: Callable[[T], U]) -> Geometry[U]:
        """Return the geometry with ``function`` applied to every constant."""
        return Geometry(*(function(getattr(self, f.name)) for f in fields(self)))

    def seen_from(self, x: Fraction, y: Fraction, unit: Fraction) -> Geometry[T]:
        """Return the geometry in another frame and another unit of length.

        Args:
            x: The origin of the frame [m].
            y: The origin of the frame [m].
            unit: The unit of lengths [m].

        Returns:
            The same wheel with its position relative to (x, y) and all lengths in ``unit``.
        """
        moved, per = replace(self, x=self.x - x, y=self.y - y), 1 / unit
        lengths = [f.name for f in fields(self) if f.name not in _RATIOS]
        return replace(moved, **{name: getattr(moved, name) * per for name in lengths})

    @property
    def rolling_radius(self) -> T:
        """r cos gamma [m], the speed in the rolling row per spin. Without rollers gamma is 0."""
        return self.r * self.cg

    @property
    def steer_arm(self) -> T:
        """Speed in the rolling row per steering rate [m].

        It is -r times the rotation of the spin joint for 1 rad of steering, which has two causes: a contact that is not
        under the steering axis, and the gears of the drive.
        """
        return self.o - self.rolling_radius * self.per_steer


class Interval(NamedTuple):
    """low <= quantity <= high, SI units."""

    low: Exact
    high: Exact

    def times(self, k: Exact) -> Interval:
        """Return the interval of k times the quantity, k not 0."""
        ends = self.low * k, self.high * k
        return Interval(*ends) if k.sign > 0 else Interval(*reversed(ends))


class Noise(NamedTuple):
    """Noise of a measurement, with the variance (``proportional`` value)**2 + ``constant``**2 in SI units."""

    proportional: Exact
    constant: Exact


class Encoder(NamedTuple):
    """An encoder of a joint."""

    turn: Exact  # counts per turn of the joint, negative if it counts down
    reading: Reading


class Gyro(NamedTuple):
    """A yaw-rate sensor."""

    weight: Exact  # weight in the least squares of `forward`, relative to the wheels (`kinematics.sensing`)
    noise: Noise


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel of the layout, or one driven direction of a ball.

    A ball with two driven directions is two wheels in the same position, with the directions as headings.
    """

    index: int
    name: str
    type: str  # a name of WHEEL_TYPES
    symbolic: Geometry[Poly]
    working: Geometry[Poly]
    nominal: Geometry[Exact]
    l: float  # nominal distance from P to the pivot [m], for display as the angles below
    alpha: float  # nominal angles [rad]
    beta: float
    gamma: float
    heading: float
    actuated: tuple[str, ...]  # joints: spin, steer
    sensed: tuple[str, ...]  # joints: spin, steer
    limits: dict[str, Interval]  # quantity, as in `Robot.limit` -> limits
    # Weight of its measurements in the least squares of `forward`, relative to other wheels.
    weight: Exact = ONE
    noise: Mapping[str, Noise] = field(default_factory=dict)
    encoders: Mapping[str, Encoder] = field(default_factory=dict)
    lag: Mapping[str, Exact] = field(default_factory=dict)  # joint -> time constant [s]
    joints: Mapping[str, JointName] = field(default_factory=dict)  # joint -> its name in other tools
    steer_sign: int = 1  # steering angle for 1 rad of the leading wheel of its coupled set: 1 or -1
    ball: str = ""  # for a driven direction of a ball, the name of the ball in the robot file

    @property
    def kind(self) -> WheelType:
        """The wheel type; for a driven direction of a ball, the type of a powered ball."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if self.ball and kind.powered else kind

    @property
    def has_spin(self) -> bool:
        """Whether the wheel rolls about an axle."""
        return self.kind.has_spin

    @property
    def turns(self) -> bool:
        """Whether the rolling direction is a joint angle."""
        return self.kind.turns

    @property
    def rolls_when_steered(self) -> bool:
        """Whether steering a commanded wheel also turns its spin joint: see `Geometry.steer_arm`."""
        return self.kind.steers and bool(self.nominal.steer_arm)

    @property
    def pivot(self) -> complex:
        """The position of the pivot at nominal parameters: x + iy [m]."""
        return complex(float(self.nominal.x), float(self.nominal.y))

    @property
    def zero_heading(self) -> complex:
        """The rolling direction at joint angle zero and nominal parameters, a point of the unit circle."""
        return complex(float(self.nominal.ch), float(self.nominal.sh))

    def contact(self, heading: complex) -> complex:
        """Return the contact point A + d e + o n [m] for a rolling direction ``heading``, at nominal parameters."""
        return self.pivot + complex(float(self.nominal.d), float(self.nominal.o)) * heading

    def commands(self, joint: str) -> bool:
        """Return whether ``joint`` is commanded: it is actuated, or it is the steering of a steered wheel."""
        return joint in self.actuated or (joint == "steer" and self.kind.steers)

    def joint_name(self, joint: str) -> JointName:
        """Return what other tools call ``spin`` or ``steer``: the robot file's name, else ``<wheel>_<joint>``."""
        return self.joints.get(joint) or JointName(f"{self.name}_{joint}")


class Parameter(NamedTuple):
    """A named length or angle."""

    name: str
    value: Poly  # a polynomial in pi alone
    working: Poly  # a polynomial in tunable parameters; the parameter itself if it is tunable
    nominal: Exact
    tunable: bool
    low: Exact  # lower end of the range; the nominal value if the parameter is not tunable
    high: Exact  # upper end of the range
    symbol: str = ""  # its letter in reports, with an index or not; "": as its name is written


class Length(NamedTuple):
    """One quantity in three views."""

    symbolic: Poly
    working: Poly
    nominal: Exact

    @property
    def in_symbols(self) -> Length:
        """The quantity with every named parameter as a symbol."""
        return self._replace(working=self.symbolic)


class Need(NamedTuple):
    """A condition on tunable parameters."""

    value: Poly  # a polynomial in the tunable parameters
    strict: bool  # it must be positive; else it must not be negative
    problem: str  # what is wrong if the condition does not hold
    mark: Mark  # place of the value in the robot file

    def broken_at(self, values: Mapping[str, Exact]) -> bool:
        """Return whether the condition does not hold for these values of the tunable parameters."""
        value = number(self.value, {name: Poly.of(v) for name, v in values.items()})
        return value.sign < 0 or (self.strict and not value)

    def where(self, values: Mapping[str, Exact]) -> str:
        """Return ``radius = 0 and track = 0.4`` for those values that the condition depends on."""
        own = sorted(parameters_in(self.value), key=[*values].index)
        return " and ".join(f"{name} = {float(values[name]):.6g}" for name in own)


@dataclass(frozen=True, slots=True)
class Trailer:
    """A trailer."""

    name: str
    length: Length  # from its coupling back to its axle [m]
    hitch: Length  # from the axle in front back to the coupling [m]
    mark: Mark


class Virtual(NamedTuple):
    """A virtual wheel, whose angle or speed represents the angles or speeds of several real wheels."""

    name: str
    role: str  # "steers": its angle represents the wheels; "drives": its speed does
    wheels: tuple[str, ...]  # the real wheels; at zero steering it has the heading of the first one
    x: Length  # position [m]
    y: Length
    mark: Mark


class Point(NamedTuple):
    """A point in the robot frame [m], z above the ground."""

    x: Length
    y: Length
    z: Length


class Tolerance(NamedTuple):
    """The tolerance within which axles are treated as one."""

    length: float  # [m] axles at this distance or less are treated as one
    size: float  # [m] size of the robot: the largest distance from the rim of one wheel to the rim of another
    written: bool  # the robot file gives the length

    @property
    def angle(self) -> float:
        """The angle [rad] whose tangent is the tolerance over the robot's size."""
        return self.length / self.size if self.size else 0.0

    def __str__(self) -> str:
        default = "" if self.written else " (1 mm per metre of the robot's size)"
        return f"the tolerance of {1000 * self.length:.3g} mm{default}"


EXACT = Tolerance(0.0, 0.0, True)


class Near(NamedTuple):
    """Axles that nearly coincide."""

    text: str  # the clause that names the wheels, in backticks, and the distance of their axles
    wheel: str  # the last of the wheels
    tolerance: float  # [m] the least tolerance that treats them as one: the distance of the farthest two
    apart: float  # [m] distance between those sets of them that already coincide
    instead: str  # what to write in the robot file to make the axles coincide
    moves: str = ""  # how the wheels were moved; "" if they are farther apart than the robot's tolerance

    def sentence(self, tolerance: Tolerance) -> str:
        """Return a sentence about these axles and the robot's tolerance, without a full stop."""
        if self.moves:
            return f"{self.text}, within {tolerance}, and are treated as one: {self.moves}"
        equal_in_print = self.tolerance < 1.005 * tolerance.length  # both have three digits in the sentence
        return f"{self.text}, {'a little ' if equal_in_print else ''}more than {tolerance}"

    @property
    def remedies(self) -> str:
        """What to write in the robot file, as a sentence."""
        if self.moves:
            return f"Write {self.instead}; or write tolerance: 0 to keep them apart."
        enough = f"{1000 * rounded_up(self.tolerance):.6g} mm"
        return f"If they share one axle, write {self.instead}, or write tolerance: {enough} to treat them as one."


def rounded_up(length: float) -> float:
    """Round a length [m] up to hundredths of a millimetre, for the proposal of a tolerance."""
    return max(1, ceil(round(length * 1e5, 6))) / 1e5


@dataclass(frozen=True, slots=True, repr=False)
class Robot:
    """The exact layout of a robot, ready for derivation."""

    name: str
    description: str
    source: str
    parameters: tuple[Parameter, ...]
    wheels: tuple[Wheel, ...]
    # For each wheel the index of the first wheel that its steering is coupled to.
    steer_group: tuple[int, ...]
    spin_group: tuple[int, ...]  # for each wheel the index of the first wheel that its spin is coupled to
    couplings: tuple[tuple[str, tuple[str, ...]], ...]  # joint, names of wheels
    # For each wheel its spin when the first wheel of its coupled set has a spin of 1.
    spin_ratios: tuple[Exact, ...]
    limits: dict[str, Interval]
    notes: tuple[str, ...]  # sentences about snapped angles and aligned axles, with names in backticks
    virtual: tuple[Virtual, ...] = ()
    trailers: tuple[Trailer, ...] = ()
    slip: bool = False  # the slips of wheels are columns of the Pfaffian matrix
    precise: bool = False  # velocities of pivots are compensated sums: see `kinematics.pivots`
    cg: Point | None = None  # centre of gravity
    gains: dict[str, Length] = field(default_factory=dict)
    deadband: Exact = ZERO  # fraction of the twist limits below which the robot stands still
    effective_track: Length | None = None  # see `layout.skid`
    functions: tuple[str, ...] = ()
    noise: Mapping[str, Noise] = field(default_factory=dict)  # joint -> noise of wheels without their own
    # Joint -> encoder of wheels without their own.
    encoders: Mapping[str, Encoder] = field(default_factory=dict)
    # Joint -> time constant [s] of wheels without their own.
    lag: Mapping[str, Exact] = field(default_factory=dict)
    gyro: Gyro | None = None
    frame: str = DEFAULT_FRAME  # the name of the robot frame in other tools
    tolerance: Tolerance = EXACT
    near: tuple[Near, ...] = ()  # axles that nearly coincide, within the tolerance or not
    needs: tuple[Need, ...] = ()  # conditions on tunable parameters, parts of a value before the whole

    @property
    def bodies(self) -> tuple[Wheel, ...]:
        """The wheels, with only the first driven direction of each ball."""
        return tuple({w.ball or w.name: w for w in reversed(self.wheels)}.values())[::-1]

    def __repr__(self) -> str:
        """Return ``<Robot pioneer3dx: 2 fixed, 1 castor>``."""
        types = Counter(w.type for w in self.wheels)
        return f"<Robot {self.name}: {', '.join(f'{n} {name}' for name, n in types.items())}>"

    @property
    def letters(self) -> dict[str, str]:
        """The symbols that the robot file gives to parameters, for `notation.with_symbols`."""
        return {p.name: p.symbol for p in self.parameters if p.symbol}

    @property
    def tunable(self) -> tuple[Parameter, ...]:
        """The parameters that are inputs of the generated code."""
        return tuple(p for p in self.parameters if p.tunable)

    def refuse(self, values: Mapping[str, Exact]) -> None:
        """Raise UsageError if the robot has no geometry for these values of tunable parameters.

        Parameters that are not in ``values`` are nominal.
        """
        every = {p.name: values.get(p.name, p.nominal) for p in self.tunable}
        if any(every[p.name] != p.nominal for p in self.tunable):
            for need in self.needs:
                if need.broken_at(every):
                    problem = f"with {need.where(every)}: {need.problem} ({need.mark})"
                    raise UsageError(f"{problem}. Write other values.")

    @property
    def in_symbols(self) -> Robot:
        """The same robot with every named parameter as a symbol, as if all were tunable."""
        names = (p._replace(working=Poly.gen("param", p.name), tunable=True) for p in self.parameters)
        return replace(
            self,
            parameters=tuple(names),
            wheels=tuple(replace(w, working=w.symbolic) for w in self.wheels),
            virtual=tuple(v._replace(x=v.x.in_symbols, y=v.y.in_symbols) for v in self.virtual),
            trailers=tuple(
                replace(t, length=t.length.in_symbols, hitch=t.hitch.in_symbols) for t in self.trailers
            ),
            cg=self.cg and Point(*(length.in_symbols for length in self.cg)),
            gains={name: length.in_symbols for name, length in self.gains.items()},
            effective_track=self.effective_track and self.effective_track.in_symbols,
        )

    @property
    def constants(self) -> dict[str, Poly]:
        """The parameters that are not tunable: values, or polynomials in tunable ones."""
        return {p.name: p.working for p in self.parameters if not p.tunable}

    def limit(self, wheel: Wheel, quantity: str) -> Interval | None:
        """Return the limit of ``steer``, ``steer_rate``, ``steer_acceleration``, ``spin`` or ``spin_rate`` of a wheel.

        It is the wheel's own limit. If there is none, it is the robot's limit, but only for commanded joints.
        """
        joint = quantity.partition("_")[0]
        return wheel.limits.get(quantity) or (self.limits.get(quantity) if wheel.commands(joint) else None)

    def limit_of(self, name: str) -> Interval | None:
        """Return the limit of a quantity by its contract name, such as ``vx`` or ``left.spin`` (see `limit`).

        ``gyro`` has the limit of omega.
        """
        owner, _, quantity = name.rpartition(".")
        if name == GYRO.name:
            return self.limits.get("omega") if self.gyro else None
        if not owner:
            return self.limits.get(name)
        return next((self.limit(w, quantity) for w in self.wheels if w.name == owner), None)

    def noise_of(self, wheel: Wheel, joint: str) -> Noise | None:
        """Return the noise of ``spin``, ``steer`` or ``steer_rate``: the wheel's own, else the robot's."""
        return wheel.noise.get(joint) or self.noise.get(joint)

    def encoder_of(self, wheel: Wheel, joint: str) -> Encoder | None:
        """Return the encoder of ``spin`` or ``steer``: the wheel's own, else the robot's if the joint is sensed."""
        return wheel.encoders.get(joint) or (self.encoders.get(joint) if joint in wheel.sensed else None)

    def lag_of(self, wheel: Wheel, joint: str) -> Exact | None:
        """Return the time constant [s] of a wheel's joint: its own, else the robot's; None if there is no lag."""
        return wheel.lag.get(joint) or self.lag.get(joint)

    def together(self, joint: str, wheels: Iterable[Wheel]) -> list[list[Wheel]]:
        """Return ``wheels`` in sets whose ``joint`` (spin or steer) is coupled; an uncoupled wheel is a set of one."""
        leaders = self.spin_group if joint == "spin" else self.steer_group
        sets: dict[int, list[Wheel]] = {}
        for w in wheels:
            sets.setdefault(leaders[w.index], []).append(w)
        return list(sets.values())

    def partners(self, wheel: Wheel) -> list[Wheel]:
        """Return the wheels whose steering is coupled to that of ``wheel``, including itself."""
        group = self.steer_group
        return [w for w in self.wheels if group[w.index] == group[wheel.index]]

    def spin_ratio(self, wheel: Wheel) -> Exact:
        """Return the spin of a wheel when the first wheel that it is coupled to has a spin of 1."""
        return self.spin_ratios[wheel.index]

    def per_turn(self, wheel: Wheel, g: Geometry[T]) -> T:
        """Return the distance [m] that a wheel rolls per radian of the first wheel that it is coupled to."""
        return g.rolling_radius * self.spin_ratio(wheel)

    def turn_ratio(self, joint: str, wheel: Wheel) -> Exact:
        """Return how far a ``joint`` (spin or steer) turns for 1 rad of the first wheel that it is coupled to."""
        return self.spin_ratio(wheel) if joint == "spin" else Exact(wheel.steer_sign)

    def ratios(self, joint: str, names: Sequence[str]) -> tuple[Exact, ...]:
        """Return how far a coupled ``joint`` of each wheel turns for 1 rad of the first one; () if all are equal."""
        turns = [self.turn_ratio(joint, self.wheel(name)) for name in names]
        return tuple(k / turns[0] for k in turns) if len(set(turns)) > 1 else ()

    def wheel(self, name: str) -> Wheel:
        """Return the wheel called ``name``. Raise KeyError if there is none."""
        return {w.name: w for w in self.wheels}[name]
