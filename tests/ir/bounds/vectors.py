"""Functions of vectors that may vanish, and points at which these vectors have any length."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np

from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role

NAMES = ("x", "y", "z")
RANGES = {"x": (-2.0, 2.0), "y": (-2.0, 2.0), "z": (-3.0, 3.0)}
STILL = Fraction(1, 10**20)


def function(make: Callable[[Builder, int, int, int], list[int]]) -> Function:
    b = Builder()
    at = [b.input(n) for n in NAMES]
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in NAMES)
    results = make(b, *at)
    outputs = tuple(Port(f"o{k}", Role.COMMAND, "1", "an output") for k in range(len(results)))
    return b.function("control", ports, outputs, results)


def heading_of(b: Builder, v: int, w: int) -> tuple[int, int]:
    """Return the heading of the line along (v, w), by the half-angle formula, and the length of (v, w)."""
    size = b.sqrt(b.add(b.square(v), b.square(w)))
    kept = b.max(size, b.const(STILL))
    return b.mul(b.with_sign_of(b.const(2), v), b.atan(b.div(w, b.add(kept, b.abs(v))))), size


def _steered(b: Builder, x: int, y: int, z: int) -> list[int]:
    """The heading of a wheel, limited to 1 rad, and its speed along that heading."""
    v, w = b.sub(x, b.mul(b.const(Fraction(3, 10)), z)), b.add(y, b.mul(b.const(Fraction(7, 10)), z))
    heading, size = heading_of(b, v, w)
    limited = b.apply(Op.CLAMP, (heading, b.const(1)))
    return [limited, b.mul(size, b.cos(b.sub(limited, heading)))]


def _leaning(b: Builder, x: int, y: int, z: int) -> list[int]:
    """The angle of a slope between limits, and the component of the vector along it."""
    v, w = b.sub(x, b.mul(b.const(Fraction(3, 10)), z)), b.mul(b.const(2), z)
    t = b.apply(Op.CLAMP, (b.div(w, b.apply(Op.AT_LEAST, (v, b.const(STILL)))), b.const(1)))
    return [b.atan(t), b.add(v, b.mul(w, t))]


def _quadrant(b: Builder, x: int, y: int, z: int) -> list[int]:
    v, w = b.abs(b.sub(x, b.mul(b.const(Fraction(3, 10)), z))), b.add(y, z)
    angle = b.atan2(w, v)
    return [angle, b.mul(v, b.cos(angle))]


def _turning(b: Builder, x: int, y: int, z: int) -> list[int]:
    """Products of length and angle, in which errors across the vector count; with a choice and without."""
    v, w = b.sub(x, b.mul(b.const(Fraction(3, 10)), z)), b.add(y, b.mul(b.const(Fraction(7, 10)), z))
    heading, size = heading_of(b, v, w)
    half = b.const(Fraction(355, 226))
    chosen = b.select(half, heading, b.sub(heading, half), heading)
    return [b.mul(size, heading), b.mul(w, chosen), b.mul(b.div(size, b.const(3)), chosen)]


CASES = {"steered": _steered, "leaning": _leaning, "quadrant": _quadrant, "turning": _turning}


def points(seed: int, count: int = 40000) -> dict[str, np.ndarray]:
    """Draw points, many of which have short vectors."""
    rng = np.random.default_rng(seed)
    z = rng.uniform(-1, 1, count)
    short = 10.0 ** rng.uniform(-9, 0.3, count)
    angle = rng.uniform(-np.pi, np.pi, count)
    along = {"x": 0.3 * z + short * np.cos(angle), "y": -0.7 * z + short * np.sin(angle), "z": z}
    return {n: np.clip(v, *RANGES[n]).astype(np.float32) for n, v in along.items()}
