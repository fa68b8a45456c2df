"""What bounds rest on: roundings of a format, errors of library functions, and the inputs that they are about.

Inputs lie within the limits of the robot file. Where it has none: vy as vx; steering angles two turns about zero; spins
and steering rates what `inverse` commands within the limits of the twist; a pose 100 m and two turns around the origin,
headings of trailers alike, steps of at most 0.1 s and what wheels turn in them; residuals of at most 1 m/s and
covariances of at most 1 in SI units; speeds of virtual wheels as vx; tunable parameters 10 % around their nominal
value. The limits of vx and omega have no such default: without them there is nothing to prove. A rate that
nothing commands needs a limit, too. What keeps the rates of joints inside their limits is looked at for all that
`inverse` commands, what keeps twists inside theirs for `BEYOND` times as much, see `Limits.ASKED`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.interval import Array, inside
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import GYRO, TWIST_NAMES, timeless
from wmrgen.ir.kernels.choice import AVR, INLINE, Choice
from wmrgen.ir.kernels.trigonometry import Worst, worst
from wmrgen.ir.nodes import Function, Limits, Op, Port, Role
from wmrgen.ir.rounding import to_float32, to_float64, tuned

_EXPONENT = 0x7FF << 52  # of a double
_LEAST = 2.0**-1000


class Format(NamedTuple):
    """A binary format: ``bits`` of precision, least subnormal 2**``lowest``, finite below 2**``highest``.

    ``relative``: errors of roundings are counted in proportion to the result, though they grow by steps.
    """

    bits: int
    lowest: int
    highest: int
    relative: bool = False

    @property
    def unit(self) -> float:
        """Unit roundoff: the largest relative error of one rounding."""
        return float(2.0**-self.bits)

    @property
    def tiny(self) -> float:
        """Half the least subnormal: what underflow may add."""
        return float(np.ldexp(1.0, max(self.lowest - 1, -1074)))

    @property
    def largest(self) -> float:
        """The largest finite number."""
        return float(np.ldexp(2.0 - 2.0 ** (1 - self.bits), self.highest - 1))

    def half_ulp(self, size: Array) -> Array:
        """Half a unit in the last place of the largest value: the error of one rounding up to ``size``."""
        if self.relative:
            return np.asarray(size * self.unit + self.tiny)
        # A power of two is exact, and what lies below it has the finer spacing there: the bits of the number before
        # without those of its mantissa are the power of two at or below it.
        before = np.maximum(size, _LEAST).view(np.int64) - 1
        return np.asarray(np.maximum((before & _EXPONENT).view(np.float64) * self.unit, self.tiny))


SINGLE = Format(24, -149, 128)


class Library(NamedTuple):
    """Largest error of sin, cos (of results up to 1), atan and atan2, in units in the last place of the result.

    The C standard bounds none of them: these are what is assumed of a libm, or was found of a kernel by trying every
    float. ``circle``: whether the error of sin and cos counts in that unit of 1, however small the result; for angles
    up to ``reach`` [rad], and atan for arguments up to ``slope``.
    """

    name: str
    sin: float
    cos: float
    atan: float
    atan2: float
    circle: bool = False
    reach: float = math.inf
    slope: float = math.inf

    def ulps(self, op: Op) -> float:
        return self.table().get(op.name, op.ulps)

    def table(self) -> dict[str, float]:
        """Operation -> units in the last place."""
        return {"sin": self.sin, "cos": self.cos, "atan": self.atan, "atan2": self.atan2}


LIBM = Library("libm", Op.SIN.ulps, Op.COS.ulps, Op.ATAN.ulps, Op.ATAN2.ulps)


def _kernel(errors: Worst) -> Library:
    """What `wmrgen.ir.kernels` is found to hold.

    atan2 is the arctangent of a quotient (whose rounding counts 1 ulp), taken from pi/2 and from pi: two more
    roundings and those of the constants, not 3 ulp.
    """
    circle, arctangent = float(errors.circle), float(errors.arctangent)
    return Library("kernels", circle, circle, arctangent, arctangent + 3.0, True, 100.0, 1.0)


def library(choice: Choice) -> Library:
    """The sines and arctangents of C as it is printed."""
    if choice.math != INLINE or choice.target == AVR:
        return LIBM
    return _kernel(worst(choice.target))


@cache
def constant(value: Exact) -> tuple[float, float, float, bool]:
    """(lo, hi, error, is a power of two): an enclosure of ``value`` and of its float32, and how far they differ."""
    printed, nearest = to_float32(value), to_float64(value)
    low, high = min(printed, nearest), max(printed, nearest)
    if value.is_rational:
        difference = abs(Fraction(printed) - value.rational())
        error = float(difference) * (1 + 2.0**-50) if difference else 0.0
    else:
        error = (abs(printed - nearest) + abs(nearest) * 2.0**-52) * (1 + 2.0**-50)
    lo, hi = (low, high) if not error else (np.nextafter(low, -np.inf), np.nextafter(high, np.inf))
    return float(lo), float(hi), error, abs(np.frexp(printed)[0]) == 0.5


TURNS = 12.5663707  # two turns [rad]
_POSE = {
    "x": (-100.0, 100.0), "y": (-100.0, 100.0), "theta": (-TURNS, TURNS), "dt": (0.0, 0.1),
    "x_rest": (-4e-6, 4e-6), "y_rest": (-4e-6, 4e-6), "theta_rest": (-5e-7, 5e-7),  # half a last place of the pose
    "slip": (0.0, 1.0),
    **{n + n: (0.0, 1.0) for n in ("x", "y", "theta", *TWIST_NAMES)},
    **dict.fromkeys(("xy", "xtheta", "ytheta", "vxvy", "vxomega", "vyomega"), (-1.0, 1.0)),
}  # fmt: skip
BEYOND = 4.0
_JOINTS = ("spin", "steer", "steer_rate")
_RATES = {"spin_step": "spin", "gyro_step": "gyro"}
_EXAMPLES = {"vx": "1.0", "omega": "2.0", "spin": "20.0", "steer_rate": "2.0", "steer": "60 deg"}

Range = tuple[float, float]


@dataclass(slots=True)
class Domain:
    """``declared``: declared limits by input name. ``commanded``: what `inverse` gives, by output name."""

    robot: Robot
    declared: dict[str, Range]
    commanded: dict[str, Range] = field(default_factory=dict)

    def missing(self) -> tuple[str, ...]:
        """Limits without which nothing can be proved."""
        return tuple(name for name in ("vx", "omega") if name not in self.declared)

    def of(self, function: Function) -> tuple[dict[str, Range], list[str]]:
        """Range of every input, and the names of those that have none."""
        ranges: dict[str, Range] = {}
        unknown = []
        for port in function.inputs:
            interval = self._asked(port) if function.limits is Limits.ASKED else self._range(port)
            if interval is None:
                unknown.append(port.name)
            else:
                ranges[port.name] = interval
        return ranges, unknown

    def _asked(self, port: Port) -> Range | None:
        """The range of an input of what keeps limits: beyond them."""
        if port.name.rpartition(".")[2] in ("spin", "steer_rate"):
            return self.commanded.get(port.name)
        usual = self._range(port)
        if port.name not in TWIST_NAMES or usual is None:
            return usual
        return BEYOND * usual[0], BEYOND * usual[1]

    def _range(self, port: Port) -> Range | None:
        name = port.name
        if name in self.declared:
            return self.declared[name]
        if port.role is Role.GEOMETRY and port.default is not None:
            return tuned(port)
        if name == "vy":
            return self.declared.get("vx")
        if name in _POSE:
            return inside(*_POSE[name])
        owner, _, joint = name.rpartition(".")
        real = owner in {w.name for w in self.robot.wheels}
        limit = self.robot.limits.get(joint) if joint in _JOINTS and not real else None
        if limit is not None:  # of a virtual wheel, which has none of its own
            self.declared[name] = _floats(limit.low, limit.high)
            return self.declared[name]
        if joint.endswith("_step"):  # an angle that wheels turn in a step
            rate = self._range(replace(port, name=f"{owner}.{_RATES[joint]}".removeprefix(".")))
            return rate and inside(*(end * _POSE["dt"][1] for end in rate))
        if joint == "steer_wanted":  # as `inverse` gives it
            return self.commanded.get(f"{owner}.steer")
        if timeless(name) != name:
            return self._range(replace(port, name=timeless(name)))
        if joint in ("steer", "theta"):
            return inside(-TURNS, TURNS)
        return self.declared.get("vx") if joint == "speed" else self.commanded.get(name)


def domain(robot: Robot) -> Domain:
    """The declared limits, those of a wheel before those of the robot."""
    declared = {name: _floats(i.low, i.high) for name, i in robot.limits.items() if name in TWIST_NAMES}
    if (gyro := robot.limit_of(GYRO.name)) is not None:
        declared[GYRO.name] = _floats(gyro.low, gyro.high)
    for wheel in robot.wheels:
        for joint in _JOINTS:
            limit = robot.limit(wheel, joint)
            if limit is not None:
                declared[f"{wheel.name}.{joint}"] = _floats(limit.low, limit.high)
    return Domain(robot, declared)


def wanted(missing: tuple[str, ...]) -> str:
    """What to write in the robot file: limits of the robot, those of wheels by the name of their joint."""
    names = dict.fromkeys(name.rpartition(".")[2] for name in missing)
    examples = [f"{name}: {_EXAMPLES.get(name, '1.0')}" for name in names]
    return f"limits: {{{', '.join(examples)}}}"


def _floats(low: Exact, high: Exact) -> Range:
    return inside(to_float64(low), to_float64(high))
