"""Finite results over the stated range: inputs up to 1e9 in float (angles 12000 rad) and 1e100 in double."""

from __future__ import annotations

import math
import random

import pytest

from tests.laws.common import NAMES
from tests.robots import of_gallery
from wmrgen.ir.interpret import FLOAT32, FLOAT64, Arithmetic, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import INLINE, LIBM
from wmrgen.ir.nodes import Function, Role

STEER = 3.2
ANGLE = 12000.0


def cases(function: Function, largest: float, count: int) -> list[dict[str, float]]:
    """All at the limit with every sign, one alone, and sizes of every order from 1e-30 to the limit."""
    source = random.Random(f"{function.name} {largest}")
    names = [p.name for p in function.inputs if p.role is not Role.PREPARED and p.default is None]
    bound = {n: STEER if n.endswith(".steer") else largest for n in names}
    if largest < 1e10:  # the range of the kernels, for the pose and for omega dt
        bound |= {n: b for n, b in {"theta": ANGLE, "dt": ANGLE / largest}.items() if n in bound}
    if largest > 1e10 and "thetatheta" in names:
        bound["dt"] = 1.0  # a variance times the square of a way, as the header says
    found = [dict.fromkeys(names, 0.0), bound]
    found += [dict.fromkeys(names, 0.0) | {n: bound[n]} for n in names]
    for k in range(count):
        case = {}
        for n in names:
            size = 1.0 if k % 2 else 10 ** -source.uniform(0, 30 + math.log10(largest))
            sign = source.choice((-1, 0, 1) if k % 3 == 0 else (-1, 1))
            angle = source.choice((source.uniform(-STEER, STEER), 0.0, math.pi / 2, -math.pi, STEER))
            case[n] = angle if n.endswith(".steer") else sign * size * bound[n]
        found.append(case)
    return found


@pytest.mark.parametrize(
    ("arithmetic", "largest"), [(FLOAT32, 1e9), (FLOAT64, 1e100)], ids=["float", "double"]
)
@pytest.mark.parametrize("name", NAMES)
def test_finite(name: str, arithmetic: Arithmetic, largest: float) -> None:
    scalar = "float" if arithmetic is FLOAT32 else "double"
    module = expand(of_gallery(name).c_module, scalar, INLINE if arithmetic is FLOAT32 else LIBM)
    for function in module.functions:
        for case in cases(function, largest, 20):
            for name, value in evaluate_module(module, function.name, case, arithmetic).items():
                assert math.isfinite(value), (function.name, name, value, case)
