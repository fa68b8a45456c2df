"""Steering next to a singularity: the centre of rotation down to 1e-8 m from a wheel.

Heading within 5e-7 rad, speed within 3 ulp of the true values of the float32 inputs, with and without a fused
multiply-add.
"""

from __future__ import annotations

import math
import random
from pathlib import Path

import mpmath
import pytest

from wmrgen import derive, load
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.rounding import nearest_float32

ROBOT = """
wmrgen: 1
name: modules
wheels:
  - {name: one,   type: steered, x: 0.381,  y: 0.2345, heading: 0, r: 0.0508}
  - {name: two,   type: steered, x: 1/3,    y: -0.7,   heading: 1.2, r: 0.1}
  - {name: three, type: steered, x: -0.25,  y: 0.1234567, heading: pi/2, r: 0.05}
"""
PLACES = {"one": ("0.381", "0.2345", "0", "0.0508"), "two": ("1/3", "-0.7", "1.2", "0.1")}
PLACES["three"] = ("-0.25", "0.1234567", "pi/2", "0.05")


def number(text: str) -> mpmath.mpf:
    if text == "pi/2":
        return mpmath.pi / 2
    above, _, below = text.partition("/")
    return mpmath.mpf(above) / mpmath.mpf(below or "1")


CHOICES = [("inline", "m4f", 3), ("libm", "m4f", 3), ("inline", "host", 3), ("inline", "m0", 3)]


@pytest.mark.parametrize(("math_", "target", "speeds"), CHOICES)
def test_heading_and_speed(tmp_path: Path, math_: str, target: str, speeds: int) -> None:
    path = tmp_path / "modules.yaml"
    path.write_text(ROBOT)
    module = expand(derive(load(path)).c_module, "float", math_, target)
    source = random.Random(f"{math_} {target}")
    inverse = module.function("inverse")
    near = 0
    with mpmath.workdps(60):
        for k in range(150):
            name = source.choice(sorted(PLACES))
            x, y, zero, radius = map(number, PLACES[name])
            omega = nearest_float32(source.uniform(-4, 4))
            away, to = 10 ** source.uniform(-8.3, -2) if k % 3 else 0.0, source.uniform(-math.pi, math.pi)
            vx = nearest_float32(float(y) * omega + away * omega * math.cos(to))
            vy = nearest_float32(-float(x) * omega + away * omega * math.sin(to))
            present = {f"{n}.steer": nearest_float32(source.uniform(-1.6, 1.6)) for n in PLACES}
            found = evaluate(inverse, {"vx": vx, "vy": vy, "omega": omega, **present}, FLOAT32)
            a, b = vx - y * omega, vy + x * omega
            size = mpmath.hypot(a, b)
            if size < 1e-8 * abs(omega):
                continue
            near += size < 1e-5 * abs(omega)
            steer, spin = found[f"{name}.steer"], found[f"{name}.spin"]
            turns = (mpmath.atan2(b, a) - zero - steer) / mpmath.pi
            assert abs(turns - mpmath.nint(turns)) * mpmath.pi <= 5e-7, (vx, vy, omega, name)
            wanted = size / radius * (-1) ** int(mpmath.nint(turns))
            ulp = math.ldexp(1.0, math.frexp(float(wanted))[1] - 24)
            assert abs(spin - wanted) <= speeds * ulp, (vx, vy, omega, name)
    assert near > 40
