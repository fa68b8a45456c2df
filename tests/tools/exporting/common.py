"""Robots to export: files as texts, and drawn ones of each kind of drive."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any
from xml.etree.ElementTree import Element

from defusedxml.ElementTree import fromstring

import wmrgen
from tests.robots import of_gallery
from wmrgen.geometry.layout.records import Robot


def load(tmp_path: Path, *wheels: str, more: str = "", name: str = "drawn") -> Robot:
    """The robot of a file with these wheels, each the inside of a mapping."""
    path = tmp_path / f"{name}.yaml"
    text = "".join(f"  - {{{wheel}}}\n" for wheel in wheels)
    path.write_text(f"wmrgen: 1\nname: {name}\nsnap: false\nwheels:\n{text}{more}", encoding="utf-8")
    return wmrgen.load(path)


def gallery(name: str) -> Robot:
    return of_gallery(name).robot


def root(text: str) -> Element:
    element: Element = fromstring(text)
    return element


def near(draw: Random, low: float, high: float) -> str:
    """A length or an angle with few digits."""
    return f"{draw.uniform(low, high):.4f}"


def drives(draw: Random) -> dict[str, tuple[list[str], str]]:
    """Kind -> wheels of a drawn robot of that kind, beside passive castors and balls, and further keys."""
    x, y, r, base = (near(draw, *span) for span in ((-0.3, 0.3), (0.05, 0.4), (0.02, 0.2), (0.2, 1.5)))
    front, narrow = f"{float(x) + float(base):.4f}", near(draw, 0.05, 0.4)
    n, turn, ring = draw.randint(3, 6), draw.uniform(0, 360), near(draw, 0.1, 0.4)
    spare = [
        f"name: tail, type: castor, x: -0.5, y: 0.1, d: -0.03, heading: {near(draw, -3, 3)}, r: 0.03",
        "name: ball, type: spherical, x: 0.5, y: 0, r: 0.02",
    ]
    signs = [draw.choice(("0", "pi")) for _ in "lr"]
    wide = near(draw, 0.02, 0.2)
    axle = [f"name: rl, type: fixed, x: {x}, y: {y}, heading: 0, r: {r}",
            f"name: rr, type: fixed, x: {x}, y: -{y}, heading: 0, r: {r}"]  # fmt: skip
    steers = "type: steered, heading: 0, actuated: [steer], limits: {steer: [-1.2, 1.1]}"
    pair = [f"name: fl, x: {front}, y: {narrow}, r: {r}, offset_y: 0.01, {steers}",
            f"name: fr, x: {front}, y: -{narrow}, r: {r}, offset_y: -0.01, {steers}"]  # fmt: skip
    idle = [f"{w}, actuated: [], sensed: [spin]" for w in axle]
    corners = [("fl", 1, 1, -1), ("fr", 1, -1, 1), ("rl", -1, 1, 1), ("rr", -1, -1, -1)]
    mx, my = near(draw, -0.2, 0.2), near(draw, -0.2, 0.2)
    return {
        "differential": ([f"name: a, type: fixed, x: {x}, y: {y}, heading: {signs[0]}, r: {r}",
                          f"name: b, type: fixed, x: {x}, y: -{y}, heading: {signs[1]}, r: {wide}", *spare], ""),
        "mecanum": ([f"name: {n}, type: swedish, x: {float(mx) + sx * float(base)}, y: {float(my) + sy * float(y)}, "
                     f"heading: 0, gamma: {45 * t} deg, r: {r}" for n, sx, sy, t in corners] + spare, ""),
        "omni": ([f"name: w{k}, type: swedish, l: {ring}, alpha: {turn + 360 * k / n} deg, beta: 0, gamma: 0, r: {r}"
                  for k in draw.sample(range(n), n)] + spare, ""),
        "front-wheel": ([*idle, f"name: front, type: steered, x: {front}, y: 0, heading: 0, r: {r}", *spare], ""),
        "bicycle": ([f"name: rear, type: fixed, x: {x}, y: 0, heading: 0, r: {r}",
                     f"name: front, x: {front}, y: 0, r: {r}, {steers}"], ""),
        "tricycle": ([*axle, f"name: front, x: {front}, y: 0, r: {r}, {steers}", *spare], ""),
        "ackermann": ([*axle, *pair], "limits: {vx: 2, vx_rate: 1, omega: [-1, 2]}\n"),
    }  # fmt: skip


def twists(draw: Random, axle: float | None) -> list[dict[str, Any]]:
    """Twists; with ``axle`` only such as a fixed axle at that x allows."""
    found = []
    for _ in range(3):
        vx, vy, omega = draw.uniform(0.5, 1), draw.uniform(-1, 1), draw.uniform(-0.1, 0.1)
        found.append({"vx": vx, "vy": vy if axle is None else -axle * omega, "omega": omega})
    return found


def speeds(robot: Robot, twist: dict[str, float]) -> dict[str, float]:
    """Joint -> command, by the exact inverse kinematics."""
    from fractions import Fraction

    from wmrgen.geometry.exact.number import Exact

    found = wmrgen.derive(robot, ["inverse"]).evaluate(
        "inverse", {name: Exact(Fraction(value)) for name, value in twist.items()}
    )
    return {name.replace(".", "_"): float(value) for name, value in found.items()}


def same_angle(a: float, b: float) -> bool:
    return abs(math.remainder(a - b, 2 * math.pi)) < 1e-9
