"""A wheel layout: every quantity exact, in three views of the same geometry.

``symbolic`` keeps every named parameter as a symbol, ``working`` only the tunable ones, ``nominal`` is numbers. Robot
frame: x forward, y left, origin P. SI units, radians.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from typing import Generic, NamedTuple, TypeVar

from wmrgen.errors import Mark, UsageError
from wmrgen.geometry.exact.evaluate import number, parameters_in
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.tolerance import EXACT, Near, Tolerance
from wmrgen.geometry.ports import GYRO, Reading
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType

T = TypeVar("T", Poly, Exact)
U = TypeVar("U", Poly, Exact)
_RATIOS = ("ch", "sh", "cg", "sg", "per_steer")  # the constants of a wheel that are no lengths


@dataclass(frozen=True, slots=True)
class Geometry(Generic[T]):
    """One wheel's constants.

    (x, y): pivot A [m]. (ch, sh): cosine and sine of the zero heading alpha + beta - pi/2.
    (cg, sg): cosine and sine of gamma, wheel plane to roller axis at the ground. r: wheel radius [m];
    d: castor offset along the rolling direction e [m]; o: lateral offset along n [m]; r_sw: roller radius [m].
    per_steer: turn of the spin joint for 1 rad of steering while the wheel does not roll.
    """

    x: T
    y: T
    ch: T
    sh: T
    cg: T
    sg: T
    r: T
    d: T
    o: T
    r_sw: T
    per_steer: T

    def mapped(self, function: Callable[[T], U]) -> Geometry[U]:
        """Every constant put through a function."""
        return Geometry(*(function(getattr(self, f.name)) for f in fields(self)))

    def seen_from(self, x: Fraction, y: Fraction, unit: Fraction) -> Geometry[T]:
        """The same wheel in a frame with its origin in (x, y) [m], and lengths in ``unit`` [m]."""
        moved, per = replace(self, x=self.x - x, y=self.y - y), 1 / unit
        lengths = [f.name for f in fields(self) if f.name not in _RATIOS]
        return replace(moved, **{name: getattr(moved, name) * per for name in lengths})

    @property
    def rolling_radius(self) -> T:
        """r cos gamma [m]: speed in the rolling row per spin. Without rollers gamma is 0."""
        return self.r * self.cg

    @property
    def steer_arm(self) -> T:
        """Speed in the rolling row per steering rate [m]: -r times the turn of the spin joint for 1 rad of steering
        alone, by the contact beside the axis and by the gears of the drive."""
        return self.o - self.rolling_radius * self.per_steer


class Interval(NamedTuple):
    """low <= quantity <= high, SI units."""

    low: Exact
    high: Exact

    def times(self, k: Exact) -> Interval:
        """The interval of k times the quantity, k not 0."""
        ends = self.low * k, self.high * k
        return Interval(*ends) if k.sign > 0 else Interval(*reversed(ends))


class Noise(NamedTuple):
    """What is measured of a joint has the variance (``proportional`` value)**2 + ``constant``**2, SI units."""

    proportional: Exact
    constant: Exact


class Encoder(NamedTuple):
    """A counter of a joint: ``turn`` counts per turn of the joint, negative where it counts down."""

    turn: Exact
    reading: Reading


class Gyro(NamedTuple):
    """A yaw-rate sensor. ``weight``: how much it counts, in proportion to the wheels (`kinematics.sensing`)."""

    weight: Exact
    noise: Noise


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel of the layout, or one driven direction of a ball: two of these stand in one place, with the directions
    for their headings. ``alpha``, ``beta``, ``gamma``, ``heading``: nominal angles [rad], for display.

    ``weight``: how much its measurements count, in proportion to those of other wheels.
    """

    index: int
    name: str
    type: str  # a name of WHEEL_TYPES
    symbolic: Geometry[Poly]
    working: Geometry[Poly]
    nominal: Geometry[Exact]
    l: float
    alpha: float
    beta: float
    gamma: float
    heading: float
    actuated: tuple[str, ...]
    sensed: tuple[str, ...]
    limits: dict[str, Interval]
    weight: Exact = ONE
    noise: Mapping[str, Noise] = field(default_factory=dict)
    encoders: Mapping[str, Encoder] = field(default_factory=dict)
    lag: Mapping[str, Exact] = field(default_factory=dict)  # joint -> time constant [s]
    steer_sign: int = (
        1  # its steering angle for 1 rad of the wheel that leads its coupled set: 1, or -1 against it
    )
    ball: str = ""  # of a driven direction of a ball: the ball's name in the robot file

    @property
    def kind(self) -> WheelType:
        """What the wheel's type says of it."""
        kind = WHEEL_TYPES[self.type]
        return kind.powered if self.ball and kind.powered else kind

    @property
    def has_spin(self) -> bool:
        """It rolls about an axle."""
        return self.kind.has_spin

    @property
    def turns(self) -> bool:
        """Its rolling direction is a joint."""
        return self.kind.turns

    @property
    def rolls_when_steered(self) -> bool:
        """Steering alone turns its spin joint, and `inverse` chooses its angle: see `Geometry.steer_arm`."""
        return self.kind.steers and bool(self.nominal.steer_arm)

    @property
    def pivot(self) -> complex:
        """Where it stands at nominal parameters: x + iy [m]."""
        return complex(float(self.nominal.x), float(self.nominal.y))

    @property
    def zero_heading(self) -> complex:
        """The rolling direction at joint angle zero, a point of the unit circle, at nominal parameters."""
        return complex(float(self.nominal.ch), float(self.nominal.sh))

    def contact(self, heading: complex) -> complex:
        """Where it touches the ground [m] when it rolls along ``heading``: A + d e + o n, at nominal parameters."""
        return self.pivot + complex(float(self.nominal.d), float(self.nominal.o)) * heading

    def commands(self, joint: str) -> bool:
        """Whether ``joint``, spin or steer, is commanded: it is driven, or its angle is chosen."""
        return joint in self.actuated or (joint == "steer" and self.kind.steers)


class Parameter(NamedTuple):
    """A named length or angle; pi is kept.

    ``working`` refers to tunable parameters alone (to itself where it is tunable), ``value`` to none. A tunable one may
    be anything from ``low`` to ``high``, which is ``nominal`` for others.
    """

    name: str
    value: Poly
    working: Poly
    nominal: Exact
    tunable: bool
    low: Exact
    high: Exact


class Length(NamedTuple):
    """One quantity in the three views."""

    symbolic: Poly
    working: Poly
    nominal: Exact

    @property
    def in_symbols(self) -> Length:
        """The quantity with every named parameter as a symbol."""
        return self._replace(working=self.symbolic)


class Need(NamedTuple):
    """What tunable parameters must keep: ``value``, a polynomial of them, positive (``strict``) or not negative.

    ``problem``: what is wrong where it is not; ``mark``: where the robot file has the value.
    """

    value: Poly
    strict: bool
    problem: str
    mark: Mark

    def broken_at(self, values: Mapping[str, Exact]) -> bool:
        """Whether it does not hold for these values of the tunable parameters."""
        value = number(self.value, {name: Poly.of(v) for name, v in values.items()})
        return value.sign < 0 or (self.strict and not value)

    def where(self, values: Mapping[str, Exact]) -> str:
        """``radius = 0 and track = 0.4``: those of the values that it depends on."""
        own = sorted(parameters_in(self.value), key=[*values].index)
        return " and ".join(f"{name} = {float(values[name]):.6g}" for name in own)


@dataclass(frozen=True, slots=True)
class Trailer:
    """A trailer: ``length`` [m] from its coupling to its axle, ``hitch`` [m] from the axle in front to the coupling."""

    name: str
    length: Length
    hitch: Length
    mark: Mark


class Virtual(NamedTuple):
    """A wheel that is not there, at (x, y): its angle (``steers``) or its speed (``drives``) stands for those of
    ``wheels``. Its heading at zero steering is that of the first of them."""

    name: str
    role: str  # steers drives
    wheels: tuple[str, ...]
    x: Length
    y: Length
    mark: Mark


class Point(NamedTuple):
    """A point in the robot frame [m], z above the ground."""

    x: Length
    y: Length
    z: Length


@dataclass(frozen=True, slots=True, repr=False)
class Robot:
    """A layout, ready for derivation.

    ``steer_group`` and ``spin_group`` give, per wheel index, the first wheel of its coupled set
    (itself when uncoupled), ``spin_ratios`` its spin for a spin of 1 of that wheel. ``notes``, names in
    backticks, are the snaps made. ``deadband``: share of the limits of the twist that counts as standstill. ``near``:
    axles that are nearly one, those taken for one within the ``tolerance`` among them. ``needs``: of the tunable
    parameters, those of parts of a value before those of the whole.
    """

    name: str
    description: str
    source: str
    parameters: tuple[Parameter, ...]
    wheels: tuple[Wheel, ...]
    steer_group: tuple[int, ...]
    spin_group: tuple[int, ...]
    couplings: tuple[tuple[str, tuple[str, ...]], ...]
    spin_ratios: tuple[Exact, ...]
    limits: dict[str, Interval]
    notes: tuple[str, ...]
    virtual: tuple[Virtual, ...] = ()
    trailers: tuple[Trailer, ...] = ()
    slip: bool = False
    precise: bool = False  # velocities of pivots as sums that are compensated: see `kinematics.pivots`
    cg: Point | None = None
    gains: dict[str, Length] = field(default_factory=dict)
    deadband: Exact = ZERO
    effective_track: Length | None = None  # see `layout.skid`
    functions: tuple[str, ...] = ()
    noise: Mapping[str, Noise] = field(default_factory=dict)
    encoders: Mapping[str, Encoder] = field(default_factory=dict)
    lag: Mapping[str, Exact] = field(default_factory=dict)
    gyro: Gyro | None = None
    tolerance: Tolerance = EXACT
    near: tuple[Near, ...] = ()
    needs: tuple[Need, ...] = ()

    @property
    def bodies(self) -> tuple[Wheel, ...]:
        """The wheels, of the driven directions of a ball the first."""
        return tuple({w.ball or w.name: w for w in reversed(self.wheels)}.values())[::-1]

    def __repr__(self) -> str:
        """``<Robot pioneer3dx: 2 fixed, 1 castor>``"""
        types = Counter(w.type for w in self.wheels)
        return f"<Robot {self.name}: {', '.join(f'{n} {name}' for name, n in types.items())}>"

    @property
    def tunable(self) -> tuple[Parameter, ...]:
        """The parameters that stay inputs of the generated code."""
        return tuple(p for p in self.parameters if p.tunable)

    def refuse(self, values: Mapping[str, Exact]) -> None:
        """UsageError where tunable parameters have values for which the robot has no geometry; those that are not among
        ``values`` are nominal."""
        of = {p.name: values.get(p.name, p.nominal) for p in self.tunable}
        if any(of[p.name] != p.nominal for p in self.tunable):
            for need in self.needs:
                if need.broken_at(of):
                    raise UsageError(
                        f"with {need.where(of)}: {need.problem} ({need.mark}). Write other values."
                    )

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
        """The wheel's own limit of ``steer``, ``steer_rate``, ``steer_acceleration``, ``spin`` or ``spin_rate``, else
        the robot's.

        The robot's is a limit of commands: a joint that turns along has none but its own.
        """
        joint = quantity.partition("_")[0]
        return wheel.limits.get(quantity) or (self.limits.get(quantity) if wheel.commands(joint) else None)

    def limit_of(self, name: str) -> Interval | None:
        """The limit of a quantity by its contract name: ``vx``, ``gyro`` as omega has one, or ``left.spin`` as `limit`
        has it."""
        owner, _, quantity = name.rpartition(".")
        if name == GYRO.name:
            return self.limits.get("omega") if self.gyro else None
        if not owner:
            return self.limits.get(name)
        return next((self.limit(w, quantity) for w in self.wheels if w.name == owner), None)

    def noise_of(self, wheel: Wheel, joint: str) -> Noise | None:
        """The wheel's own noise of ``spin``, ``steer`` or ``steer_rate``, else the robot's."""
        return wheel.noise.get(joint) or self.noise.get(joint)

    def encoder_of(self, wheel: Wheel, joint: str) -> Encoder | None:
        """The encoder of a wheel's ``spin`` or ``steer``: its own, else the robot's where the joint is sensed."""
        return wheel.encoders.get(joint) or (self.encoders.get(joint) if joint in wheel.sensed else None)

    def lag_of(self, wheel: Wheel, joint: str) -> Exact | None:
        """The time constant [s] of a wheel's joint: its own, else the robot's; None where it follows at once."""
        return wheel.lag.get(joint) or self.lag.get(joint)

    def together(self, joint: str, wheels: Iterable[Wheel]) -> list[list[Wheel]]:
        """``wheels`` in the sets whose ``joint``, spin or steer, is coupled; a wheel alone is a set of one."""
        leaders = self.spin_group if joint == "spin" else self.steer_group
        sets: dict[int, list[Wheel]] = {}
        for w in wheels:
            sets.setdefault(leaders[w.index], []).append(w)
        return list(sets.values())

    def partners(self, wheel: Wheel) -> list[Wheel]:
        """The wheels that steer as one with ``wheel``, itself among them."""
        group = self.steer_group
        return [w for w in self.wheels if group[w.index] == group[wheel.index]]

    def spin_ratio(self, wheel: Wheel) -> Exact:
        """The spin of a wheel for a spin of 1 of the first that it is coupled to."""
        return self.spin_ratios[wheel.index]

    def per_turn(self, wheel: Wheel, g: Geometry[T]) -> T:
        """What the wheel rolls per radian that the first of its coupled set turns [m]."""
        return g.rolling_radius * self.spin_ratio(wheel)

    def turn_ratio(self, joint: str, wheel: Wheel) -> Exact:
        """How far the ``joint`` of a wheel, spin or steer, turns for 1 rad of the first that it is coupled to."""
        return self.spin_ratio(wheel) if joint == "spin" else Exact(wheel.steer_sign)

    def ratios(self, joint: str, names: Sequence[str]) -> tuple[Exact, ...]:
        """The turns of a coupled ``joint`` of these wheels for 1 rad of the first; none where they are equal."""
        turns = [self.turn_ratio(joint, self.wheel(name)) for name in names]
        return tuple(k / turns[0] for k in turns) if len(set(turns)) > 1 else ()

    def wheel(self, name: str) -> Wheel:
        """The wheel called ``name``. KeyError when there is none."""
        return {w.name: w for w in self.wheels}[name]
