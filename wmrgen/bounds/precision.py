"""What rounding does in a floating-point format, and what is taken for granted of library functions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np

from wmrgen.exact.number import Exact
from wmrgen.ir.interval import Array
from wmrgen.ir.kernels.choice import AVR, INLINE, Choice
from wmrgen.ir.kernels.constants import Worst, worst
from wmrgen.ir.nodes import Op
from wmrgen.ir.rounding import to_float32, to_float64

_EXPONENT = 0x7FF << 52  # of a double
_LEAST = 2.0**-1000


@dataclass(frozen=True, slots=True)
class Format:
    """A binary format: ``bits`` of precision, least subnormal 2**``lowest``, finite below 2**``highest``.

    ``relative``: errors of roundings are counted in proportion to the result, though they grow by steps.
    """

    name: str
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


SINGLE = Format("float", 24, -149, 128)
DOUBLE = Format("double", 53, -1074, 1024)


@dataclass(frozen=True, slots=True)
class Library:
    """Largest error of sin, cos (of results up to 1), atan and atan2, in units in the last place of the result.

    The C standard bounds none of them: these are what is assumed of a libm, or was found of a kernel by trying every
    float. ``circle``: whether the error of sin and cos counts in that unit of 1, however small the result; for angles
    up to ``reach`` [rad], and atan for arguments up to ``slope``. ``sine``: of angles up to pi/2, in
    units in the last place of their own sine.
    """

    name: str
    sin: float
    cos: float
    atan: float
    atan2: float
    sine: float
    circle: bool = False
    reach: float = math.inf
    slope: float = math.inf

    def ulps(self, op: Op) -> float:
        return self.table().get(op.name, op.ulps)

    def table(self) -> dict[str, float]:
        """Operation -> units in the last place."""
        return {"sin": self.sin, "cos": self.cos, "atan": self.atan, "atan2": self.atan2}


LIBM = Library("libm", Op.SIN.ulps, Op.COS.ulps, Op.ATAN.ulps, Op.ATAN2.ulps, 1.0)


def _kernel(errors: Worst) -> Library:
    """What `wmrgen.ir.kernels` is found to hold.

    atan2 is the arctangent of a quotient (whose rounding counts 1 ulp), taken from pi/2 and from pi: two more
    roundings and those of the constants, not 3 ulp.
    """
    circle, arctangent = float(errors.circle), float(errors.arctangent)
    return Library(
        "kernels", circle, circle, arctangent, arctangent + 3.0, float(errors.sine), True, 100.0, 1.0
    )


def library(choice: Choice) -> Library:
    """The sines and arctangents of C as it is printed."""
    if choice.math != INLINE or choice.target == AVR:
        return LIBM
    return _kernel(worst(choice.target))


@cache
def constant(value: Exact, name: str) -> tuple[float, float, float, bool]:
    """(lo, hi, error, is a power of two): an enclosure of ``value`` and of its rounding, and how far they differ."""
    printed = to_float32(value) if name == "float" else to_float64(value)
    nearest = to_float64(value)
    low, high = min(printed, nearest), max(printed, nearest)
    if value.is_rational:
        difference = abs(Fraction(printed) - value.rational())
        error = float(difference) * (1 + 2.0**-50) if difference else 0.0
    else:
        error = (abs(printed - nearest) + abs(nearest) * 2.0**-52) * (1 + 2.0**-50)
    lo, hi = (low, high) if not error else (np.nextafter(low, -np.inf), np.nextafter(high, np.inf))
    return float(lo), float(hi), error, abs(np.frexp(printed)[0]) == 0.5
