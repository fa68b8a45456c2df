"""Heading and speed of a steered wheel about whose pivot the robot nearly turns: the C against 60 digits.

The centre of rotation is 1e-8 m to 1 m away, half of the time as near as floats allow. Inputs are exact floats; the
true heading counts modulo half a turn, for the wheel may run backwards.
"""

from __future__ import annotations

import math
import random
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import mpmath

import wmrgen
from wmrgen.codegen.c import evaluate
from wmrgen.ir.kernels.choice import HOST, INLINE, M0, M4F
from wmrgen.ir.nodes import Module
from wmrgen.ir.rounding import nearest_float32

ROBOT = """
wmrgen: 1
name: modules
precise: {precise}
wheels:
  - {{name: one,   type: steered, x: 0.381,  y: 0.2345, heading: 0, r: 0.0508}}
  - {{name: two,   type: steered, x: 1/3,    y: -0.7,   heading: 1.2, r: 0.1}}
  - {{name: three, type: steered, x: -0.25,  y: 0.1234567, heading: pi/2, r: 0.05}}
"""
PLACES = {"one": ("0.381", "0.2345", "0", "0.0508"), "two": ("1/3", "-0.7", "1.2", "0.1")}
PLACES["three"] = ("-0.25", "0.1234567", "pi/2", "0.05")
TARGETS = (M4F, HOST, M0)
NEAR = 100_000
HEADING, SPEED = 5e-7, 3.0  # rad, ulp
LEAST = 1e-8  # [m]
DIGITS = 60

Values = dict[str, float]
Compute = Callable[[Module, str, Sequence[Values]], list[Values]]


def module(precise: bool = True) -> Module:
    """Three steered wheels whose places are no round numbers; ``precise``: as the robot file asks."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "modules.yaml"
        path.write_text(ROBOT.format(precise=str(precise).lower()), encoding="utf-8")
        return wmrgen.derive(wmrgen.load(path)).c_module


def number(text: str) -> mpmath.mpf:
    if text == "pi/2":
        return mpmath.pi / 2
    above, _, below = text.partition("/")
    return mpmath.mpf(above) / mpmath.mpf(below or "1")


def twists(count: int, source: random.Random, apart: float | None = None) -> list[tuple[str, Values]]:
    """(wheel, inputs): rotations about points near the wheel; ``apart``: all so far from it [m]."""
    drawn = []
    for k in range(count):
        name = source.choice(sorted(PLACES))
        x, y = (float(number(text)) for text in PLACES[name][:2])
        omega = nearest_float32(source.uniform(-4, 4))
        near = (0.0, 10 ** source.uniform(-8.3, -2), 10 ** source.uniform(-2, 0))[k % 3]
        near = near if apart is None else apart
        to = source.uniform(-math.pi, math.pi)
        vx = nearest_float32(y * omega + near * omega * math.cos(to))
        vy = nearest_float32(-x * omega + near * omega * math.sin(to))
        present = {f"{n}.steer": nearest_float32(source.uniform(-1.6, 1.6)) for n in PLACES}
        drawn.append((name, {"vx": vx, "vy": vy, "omega": omega, **present}))
    return drawn


def worst(module: Module, cases: Sequence[tuple[str, Values]], compute: Compute) -> tuple[float, float, int]:
    """(heading [rad], speed [ulp], cases nearer than 1e-5 m): errors where the centre is `LEAST` away or more."""
    heading = speed = 0.0
    near = 0
    results = compute(module, "inverse", [case for _, case in cases])
    with mpmath.workdps(DIGITS):
        places = {name: tuple(map(number, texts)) for name, texts in PLACES.items()}
        for (name, case), outputs in zip(cases, results, strict=True):
            x, y, zero, radius = places[name]
            omega = case["omega"]
            a, b = case["vx"] - y * omega, case["vy"] + x * omega
            size = mpmath.hypot(a, b)
            if size < LEAST * abs(omega):
                continue
            near += bool(size < 1e-5 * abs(omega))
            turns = (mpmath.atan2(b, a) - zero - outputs[f"{name}.steer"]) / mpmath.pi
            heading = max(heading, float(abs(turns - mpmath.nint(turns)) * mpmath.pi))
            wanted = size / radius * (-1) ** int(mpmath.nint(turns))
            ulp = math.ldexp(1.0, math.frexp(float(wanted))[1] - 24)
            speed = max(speed, float(abs(outputs[f"{name}.spin"] - wanted)) / ulp)
    return heading, speed, near


def nearby(target: str, count: int = NEAR) -> tuple[float, float]:
    """Return the worst errors of the compiled C for a target."""

    def compiled(module: Module, name: str, cases: Sequence[Values]) -> list[Values]:
        return evaluate(module, [(name, case) for case in cases], math=INLINE, target=target)

    return worst(module(), twists(count, random.Random(f"near {target}")), compiled)[:2]
