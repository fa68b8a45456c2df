"""What exports are written with: decimals, and what a file says of itself."""

from __future__ import annotations

from typing import SupportsFloat

from wmrgen import __version__
from wmrgen.geometry.layout.records import Robot


def decimal(value: SupportsFloat) -> str:
    """Fifteen significant digits, which the noise of floats does not reach; no negative zero."""
    return f"{round(float(value), 15) + 0.0:.15g}"


def decimals(*values: SupportsFloat) -> str:
    return " ".join(map(decimal, values))


def banner(robot: Robot) -> list[str]:
    """The robot, its description in one line, its frame. No line has two hyphens, which end an XML comment."""
    about = " ".join(robot.description.split())
    while "--" in about:
        about = about.replace("--", "- -")
    lines = [
        f"{robot.name}: {about}" if about else robot.name,
        f"Written by wmrgen {__version__} from a robot file: write it anew rather than edit it.",
    ]
    if robot.tunable:
        names = ", ".join(p.name for p in robot.tunable)
        lines.append(f"Tunable parameters are at their nominal values: {names}.")
    if robot.trailers:
        lines.append("The trailers of the robot file are left out.")
    return lines
