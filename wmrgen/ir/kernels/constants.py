"""Coefficients of the float kernels. ``python -m benchmarks kernels`` computes them and their worst errors.

Every value is a float32, given as the decimal that reads back as it.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from wmrgen.exact.number import Exact
from wmrgen.ir.kernels.choice import M0, M4F
from wmrgen.ir.rounding import to_float32

RINT32 = Exact(12582912)  # 1.5 * 2**23: floats this large are whole numbers
EVEN32 = Exact(25165824)  # 1.5 * 2**24: floats this large are even
RINT64 = Exact(6755399441055744)  # 1.5 * 2**52


def _floats(*decimals: str) -> tuple[Exact, ...]:
    return tuple(Exact(Fraction(to_float32(Exact(Fraction(text))))) for text in decimals)


# sin(r) = r + r s (c3 + c5 s + c7 s**2 + c9 s**3), s = r**2, |r| <= pi/2
SIN = _floats("-0.16666657", "0.008333009", "-0.0001980605", "2.5989211e-06")
# cos(r) = 1 + s (c2 + c4 s + ... + c10 s**4)
COS = _floats("1", "-0.5", "0.041666657", "-0.0013888585", "2.477018e-05", "-2.620902e-07")
# atan(q) = q + q t (c3 + c5 t + ... + c17 t**7), t = q**2, |q| <= 1
ATAN = _floats(
    "-0.33333313", "0.1999624", "-0.14225537", "0.10709304", "-0.0762479", "0.04390253",
    "-0.016716665", "0.002993259",
)  # fmt: skip

PER_PI, QUARTER, HALF = _floats("0.31830987", "1.5707964", "3.1415927")  # 1/pi, pi/2, pi
# pi = PI_HIGH - LESS_PI_LOW within 3.4e-13. PI_HIGH has 12 bits, so k PI_HIGH is exact for |k| <= 4096.
PI_HIGH, LESS_PI_LOW = _floats("3.1416016", "8.90891e-06")
# pi = HALF - LESS_HALF_LOW within 1.5e-15, for a product that is not rounded.
LESS_HALF_LOW = _floats("8.742278e-08")[0]
# 2/pi, and pi/2 = QUARTER - LESS_QUARTER_LOW within 1e-15
PER_QUARTER, LESS_QUARTER_LOW = _floats("0.63661975", "4.371139e-08")


@dataclass(frozen=True, slots=True)
class Worst:
    """Worst errors over every float. ``sine``, ``arctangent``: of angles up to pi/2 and of arguments up to 1, in ulp;
    ``circle``: of the sine and cosine of angles up to 100 rad, in units of 2**-24."""

    sine: str
    circle: str
    arctangent: str


FUSED = Worst(sine="1.68", circle="2.36", arctangent="1.19")  # where a product that is added is not rounded
WHOLE = Worst(sine="15.34", circle="0.73", arctangent="6.67")  # in integers
PLAIN = Worst(sine="1.90", circle="2.93", arctangent="1.23")


def worst(target: str) -> Worst:
    """Of the kernels of a target that has its own."""
    return {M4F: FUSED, M0: WHOLE}.get(target, PLAIN)
