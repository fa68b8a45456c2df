"""What bounds are based on: the float format, the errors of library functions, and the ranges of inputs.

Inputs are within the limits of the robot file. An input without a limit has this range:

* vy, and speeds of virtual wheels: as vx
* steering angles: two turns about zero
* spins and steering rates: what `inverse` commands within the limits of the twist
* poses: 100 m and two turns about the origin; headings of trailers alike
* time steps: at most 0.1 s; rotations of wheels in a step: what they turn in that time
* residuals: at most 1 m/s; covariances: at most 1 in SI units
* tunable parameters: 10 % around their nominal value

vx and omega have no default: without their limits nothing can be proved. A rate that no function commands needs a limit
as well. Functions that limit joint rates are analysed for all that `inverse` commands. Functions that limit twists are
analysed for `BEYOND` times the limits, see `Limits.ASKED`.
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
from wmrgen.geometry.ports import GYRO, TWIST_NAMES, without_time_suffix
from wmrgen.ir.kernels.choice import AVR, INLINE, Choice
from wmrgen.ir.kernels.trigonometry import Worst, worst
from wmrgen.ir.nodes import Function, Limits, Op, Port, Role
from wmrgen.ir.rounding import to_float32, to_float64, tuned

_EXPONENT = 0x7FF << 52  # the bits of the exponent of a float64
_LEAST = 2.0**-1000  # a positive normal float64 below every float32: zero has no power of two below it


class Format(NamedTuple):
    """A binary floating-point format."""

    bits: int  # of precision
    lowest: int  # the least subnormal number is 2**lowest
    highest: int  # finite numbers are below 2**highest
    # Whether the error of a rounding is taken as proportional to the result. It is then an upper bound of the true
    # error, which has a step at each power of two.
    relative: bool = False

    @property
    def unit(self) -> float:
        """Return the unit roundoff: the largest relative error of one rounding."""
        return float(2.0**-self.bits)

    @property
    def tiny(self) -> float:
        """Return half the least subnormal number: the error that underflow may add."""
        return float(np.ldexp(1.0, max(self.lowest - 1, -1074)))

    @property
    def largest(self) -> float:
        """Return the largest finite number."""
        return float(np.ldexp(2.0 - 2.0 ** (1 - self.bits), self.highest - 1))

    def half_ulp(self, size: Array) -> Array:
        """Return half a unit in the last place of ``size``: the largest error of rounding a number up to that size."""
        if self.relative:
            return np.asarray(size * self.unit + self.tiny)
        # A power of two is exact, and numbers just below it have the finer spacing. So take the float64 before
        # ``size``; without the bits of its mantissa it is the power of two at or below it.
        before = np.maximum(size, _LEAST).view(np.int64) - 1
        return np.asarray(np.maximum((before & _EXPONENT).view(np.float64) * self.unit, self.tiny))


SINGLE = Format(24, -149, 128)


class Library(NamedTuple):
    """The largest errors of sines and arctangents, in units in the last place of the result (ulp).

    The C standard gives no bounds. For a C library these are assumptions. For our own kernels they were found by trying
    every float.
    """

    name: str
    sin: float
    cos: float
    atan: float
    atan2: float
    circle: bool = False  # whether sin and cos count in ulp of 1, however small the result is
    reach: float = math.inf  # the largest angle for which the errors of sin and cos hold [rad]
    slope: float = math.inf  # the largest argument for which the error of atan holds

    def ulps(self, op: Op) -> float:
        """Return the largest error of an operation [ulp]."""
        return self.table().get(op.name, op.ulps)

    def table(self) -> dict[str, float]:
        """Return the errors [ulp] by name of the operation."""
        return {"sin": self.sin, "cos": self.cos, "atan": self.atan, "atan2": self.atan2}


LIBM = Library("libm", Op.SIN.ulps, Op.COS.ulps, Op.ATAN.ulps, Op.ATAN2.ulps)


def _kernel(errors: Worst) -> Library:
    """Return the errors of our own kernels (`wmrgen.ir.kernels`).

    atan2 is the arctangent of a quotient, subtracted from pi/2 and from pi where necessary. The rounding of the
    quotient is 1 ulp; the two subtractions and the roundings of pi/2 and pi are less than 2 ulp together.
    """
    circle, arctangent = float(errors.circle), float(errors.arctangent)
    return Library("kernels", circle, circle, arctangent, arctangent + 3.0, True, 100.0, 1.0)


def library(choice: Choice) -> Library:
    """Return the errors of the sines and arctangents that the printed C uses."""
    if choice.math != INLINE or choice.target == AVR:
        return LIBM
    return _kernel(worst(choice.target))


@cache
def constant(value: Exact) -> tuple[float, float, float, bool]:
    """Return (low, high, error, whether it is a power of two) of a constant.

    low and high enclose the exact value and its float32; error bounds the difference of the two.
    """
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
# Ranges in SI units, by input name.
POSE_RANGES = {
    "x": (-100.0, 100.0), "y": (-100.0, 100.0), "theta": (-TURNS, TURNS), "dt": (0.0, 0.1),
    "x_rest": (-4e-6, 4e-6), "y_rest": (-4e-6, 4e-6), "theta_rest": (-5e-7, 5e-7),  # half a last place of the pose
    "slip": (0.0, 1.0),
    **{n + n: (0.0, 1.0) for n in ("x", "y", "theta", *TWIST_NAMES)},
    **dict.fromkeys(("xy", "xtheta", "ytheta", "vxvy", "vxomega", "vyomega"), (-1.0, 1.0)),
}  # fmt: skip
BEYOND = 4.0  # times the limits of the twist: how far inputs of functions that limit twists are analysed [1]
_JOINTS = ("spin", "steer", "steer_rate")
_RATES = {"spin_step": "spin", "gyro_step": "gyro"}
_EXAMPLES = {"vx": "1.0", "omega": "2.0", "spin": "20.0", "steer_rate": "2.0", "steer": "60 deg"}

Range = tuple[float, float]


@dataclass(slots=True)
class Domain:
    """The ranges of all inputs of a robot's functions."""

    robot: Robot
    declared: dict[str, Range]  # limits of the robot file, by input name
    # Ranges of the results of `inverse`, by output name.
    commanded: dict[str, Range] = field(default_factory=dict)

    def missing(self) -> tuple[str, ...]:
        """Return the names of missing limits without which nothing can be proved."""
        return tuple(name for name in ("vx", "omega") if name not in self.declared)

    def of(self, function: Function) -> tuple[dict[str, Range], list[str]]:
        """Return the range of every input of a function, and the names of inputs without a range."""
        ranges: dict[str, Range] = {}
        unknown = []
        for port in function.inputs:
            interval = self._beyond_limits(port) if function.limits is Limits.ASKED else self._range(port)
            if interval is None:
                unknown.append(port.name)
            else:
                ranges[port.name] = interval
        return ranges, unknown

    def _beyond_limits(self, port: Port) -> Range | None:
        """Return the range of an input of a function that enforces limits: larger than the limits."""
        if port.name.rpartition(".")[2] in ("spin", "steer_rate"):
            return self.commanded.get(port.name)
        usual = self._range(port)
        if port.name not in TWIST_NAMES or usual is None:
            return usual
        return BEYOND * usual[0], BEYOND * usual[1]

    def _range(self, port: Port) -> Range | None:
        """Return the range of an input, None if it has none."""
        name = port.name
        if name in self.declared:
            return self.declared[name]
        if port.role is Role.GEOMETRY and port.default is not None:
            return tuned(port)
        if name == "vy":
            return self.declared.get("vx")
        if name in POSE_RANGES:
            return inside(*POSE_RANGES[name])
        owner, _, joint = name.rpartition(".")
        real = owner in {w.name for w in self.robot.wheels}
        limit = self.robot.limits.get(joint) if joint in _JOINTS and not real else None
        if limit is not None:  # a virtual wheel has the limits of the robot
            self.declared[name] = _floats(limit.low, limit.high)
            return self.declared[name]
        if joint.endswith("_step"):  # the rotation of a wheel in a time step
            rate = self._range(replace(port, name=f"{owner}.{_RATES[joint]}".removeprefix(".")))
            return rate and inside(*(end * POSE_RANGES["dt"][1] for end in rate))
        if joint == "steer_wanted":  # a result of `inverse`
            return self.commanded.get(f"{owner}.steer")
        if without_time_suffix(name) != name:
            return self._range(replace(port, name=without_time_suffix(name)))
        if joint in ("steer", "theta"):
            return inside(-TURNS, TURNS)
        return self.declared.get("vx") if joint == "speed" else self.commanded.get(name)


def domain(robot: Robot) -> Domain:
    """Return the limits that a robot declares; limits of a wheel take precedence over those of the robot."""
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
    """Return an example of the missing limits, as a line of the robot file."""
    names = dict.fromkeys(name.rpartition(".")[2] for name in missing)
    examples = [f"{name}: {_EXAMPLES.get(name, '1.0')}" for name in names]
    return f"limits: {{{', '.join(examples)}}}"


def _floats(low: Exact, high: Exact) -> Range:
    return inside(to_float64(low), to_float64(high))
