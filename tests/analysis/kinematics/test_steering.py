"""Steering at its edges, alike in every arithmetic and for every target: standstill, 90 degrees, all sizes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import pytest

from tests.robots import of_gallery
from wmrgen.codegen import arrays, casadi
from wmrgen.ir.interpret import EXACT, FLOAT32, FLOAT64, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import TARGETS

Case = dict[str, float]
STEERED = ("wpilib_swervebot", "agilex_ranger", "ackermann_car", "textbook_tricycle", "synchro_drive", "pr2")
SIZES = (1e-45, 1e-38, 1e-30, 1e-23, 1e-10, 1.0, 1e9)


@cache
def every(robot: str) -> tuple[tuple[str, object], ...]:
    derivation = of_gallery(robot)
    c = derivation.c_module
    evaluators: list[tuple[str, object]] = [
        (f"float {target} {math_}", expand(c, "float", math_, target))
        for target in TARGETS
        for math_ in ("inline", "libm")
    ]
    evaluators.append(("double", expand(c, "double", "libm")))
    return (
        *evaluators,
        ("exact", derivation.raw_module),
        ("casadi", derivation.module),
        ("numpy", derivation.module),
    )


def inverses(robot: str, case: Case) -> Iterator[tuple[str, Case]]:
    for name, module in every(robot):
        if name == "casadi":
            yield name, casadi.evaluate(module, [("inverse", case)])[0]
        elif name == "numpy":
            yield name, arrays.evaluate(module, [("inverse", case)])[0]
        else:
            kind = EXACT if name == "exact" else FLOAT64 if name == "double" else FLOAT32
            found = evaluate_module(module, "inverse", case, kind)
            yield name, {key: float(value) for key, value in found.items()}


def steers(robot: str, angle: float) -> Case:
    ports = of_gallery(robot).raw_module.function("inverse").inputs
    return {p.name: angle for p in ports if p.name.endswith(".steer")}


@pytest.mark.parametrize("robot", STEERED)
def test_standstill_holds_every_angle(robot: str) -> None:
    present = steers(robot, 0.25)
    for name, found in inverses(robot, {"vx": 0.0, "vy": 0.0, "omega": 0.0, **present}):
        for key, value in found.items():
            assert value == (0.25 if key in present else 0.0), (name, key)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_swing_of_90_degrees_drives_forwards(side: float) -> None:
    for name, found in inverses(
        "wpilib_swervebot", {"vx": 0.0, "vy": side, "omega": 0.0, **steers("wpilib_swervebot", 0.0)}
    ):
        for key, value in found.items():
            if key.endswith(".steer"):
                assert value == pytest.approx(side * math.pi / 2, abs=3e-7), (name, key)
            elif key.endswith(".spin"):
                assert value == pytest.approx(1 / 0.0508, rel=1e-6), (name, key)


@pytest.mark.parametrize("robot", STEERED)
def test_all_sizes_give_numbers_inside_the_limits(robot: str) -> None:
    for size in SIZES:
        for case in ({"vx": size, "vy": -size, "omega": size}, {"vx": -size, "vy": 0.0, "omega": 0.0}):
            for name, found in inverses(robot, {**case, **steers(robot, 0.7)}):
                assert all(math.isfinite(value) for value in found.values()), (name, size)
                if robot == "ackermann_car":
                    assert all(
                        abs(v) <= math.radians(40) + 1e-6 for k, v in found.items() if k.endswith(".steer")
                    )
