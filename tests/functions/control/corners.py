"""Robots with limits, and their functions in float64."""

from __future__ import annotations

import random

from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.ir.interpret import FLOAT32, FLOAT64, Arithmetic, evaluate_module

CORNERS = {"fl": (1, 1), "fr": (1, -1), "bl": (-1, 1), "br": (-1, -1)}
SWERVE = "\n".join(
    f"  - {{name: {n}, type: steered, x: {0.3 * a}, y: {0.25 * b}, heading: 0, r: 0.05}}"
    for n, (a, b) in CORNERS.items()
)
MECANUM = "\n".join(
    f"  - {{name: {n}, type: swedish, x: {0.3 * a}, y: {0.25 * b}, heading: 0, gamma: {-45 * a * b} deg, r: 0.1}}"
    for n, (a, b) in CORNERS.items()
)


def robot_text(wheels: str, *lines: str) -> str:
    return "\n".join(["wmrgen: 1", "name: tried", "wheels:", wheels, *lines]) + "\n"


def derived(text: str, *functions: str) -> Derivation:
    return of_text(text, ["inverse", "forward", *functions])


def call(
    d: Derivation, name: str, values: dict[str, float], arithmetic: Arithmetic = FLOAT64
) -> dict[str, float]:
    return evaluate_module(d.module, name, values, arithmetic)


def twists(count: int, seed: int = 1) -> list[dict[str, float]]:
    source = random.Random(seed)
    return [{n: source.uniform(-2, 2) for n in ("vx", "vy", "omega")} for _ in range(count)]


def steers(values: list[float]) -> dict[str, float]:
    return {f"{n}.steer": v for n, v in zip(CORNERS, values, strict=True)}


__all__ = ["CORNERS", "FLOAT32", "MECANUM", "SWERVE", "call", "derived", "robot_text", "steers", "twists"]
