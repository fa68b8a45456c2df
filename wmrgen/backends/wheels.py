"""The wheel table of a banner: where each wheel stands, and the conventions most often confused."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import SupportsFloat

from wmrgen.layout.records import Robot, Wheel
from wmrgen.wheels import WheelType

_Concerns = Callable[[WheelType], bool]
_LEGEND: tuple[tuple[_Concerns, str], ...] = (
    (
        lambda kind: True,
        "x, y: wheel pivot seen from P. For a wheel beside P, |y| is the half-track, not the track.",
    ),
    (
        lambda kind: kind.directed,
        "heading: rolling direction at spin > 0, from the x axis (steered: at steer 0).",
    ),
    (lambda kind: kind.swivels, "d: contact point minus pivot, along the rolling direction."),
    (
        lambda kind: kind.rollers,
        "gamma: from the wheel plane to the axis of the roller at the ground; the rollers seen on top "
        "lean the other way.",
    ),
)


def _number(value: SupportsFloat) -> str:
    """Six significant digits, no negative zero."""
    return f"{round(float(value), 12) + 0.0:.6g}"


def wheel_line(wheel: Wheel) -> str:
    """``left: fixed, x 0 m, y 0.1655 m, heading 0 deg, r 0.0975 m`` and what else the type has."""
    g = wheel.nominal
    parts = [f"{wheel.name}: {wheel.type}, x {_number(g.x)} m, y {_number(g.y)} m"]
    if wheel.kind.directed:
        parts.append(f"heading {_number(degrees(wheel.heading))} deg")
    parts.append(f"r {_number(g.r)} m")
    if g.d:
        parts.append(f"d {_number(g.d)} m")
    if g.o:
        parts.append(f"offset_y {_number(g.o)} m")
    if wheel.kind.rollers:
        parts.append(f"gamma {_number(degrees(wheel.gamma))} deg")
    return ", ".join(parts)


def wheel_lines(robot: Robot) -> tuple[str, ...]:
    """One line per wheel in file order, then the legend that these wheel types need."""
    return (
        *(wheel_line(wheel) for wheel in robot.wheels),
        *(text for concerns, text in _LEGEND if any(concerns(w.kind) for w in robot.wheels)),
    )
