"""Decimals for exports, and the lines at the top of their files."""

from __future__ import annotations

from typing import SupportsFloat

from wmrgen import __version__
from wmrgen.geometry.layout.records import Robot


def decimal(value: SupportsFloat) -> str:
    """Return a number with fifteen significant digits, which hide rounding errors; zero has no sign."""
    return f"{round(float(value), 15) + 0.0:.15g}"


def decimals(*values: SupportsFloat) -> str:
    """Return numbers with spaces between them."""
    return " ".join(map(decimal, values))


def banner(robot: Robot) -> list[str]:
    """Return lines about the robot and its file. No line has two hyphens, because they end an XML comment."""
    about = " ".join(robot.description.split())
    while "--" in about:
        about = about.replace("--", "- -")
    lines = [
        f"{robot.name}: {about}" if about else robot.name,
        f"Written by wmrgen {__version__} from a robot file: write it again instead of editing it.",
    ]
    if robot.tunable:
        names = ", ".join(p.name for p in robot.tunable)
        lines.append(f"Tunable parameters are at their nominal values: {names}.")
    if robot.trailers:
        lines.append("The trailers of the robot file are left out.")
    return lines
