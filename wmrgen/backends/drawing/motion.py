"""An example motion: in the robot frame its ICR and velocities, in the world frame the arc of odometry."""

from __future__ import annotations

from wmrgen.backends.drawing.example import Example, example
from wmrgen.backends.drawing.figure import Figure, figure
from wmrgen.backends.drawing.instant import instant, number
from wmrgen.backends.drawing.paper import FIRM, Box, wrapped
from wmrgen.backends.drawing.world import world
from wmrgen.layout.records import Robot
from wmrgen.robot import Derivation

FILE = "motion.svg"
_LEFT: Box = (8.0, 24.0, 236.0, 268.0)
_RIGHT: Box = (248.0, 24.0, 472.0, 268.0)


def motion(derivation: Derivation) -> Figure | None:
    """``motion.svg``; None where the robot cannot move. One with an effective track turns, and its wheels slide."""
    shown = example(derivation.robot, derivation.driven.mobility)
    return None if shown is None else drawn(derivation.robot, shown)


def drawn(robot: Robot, shown: Example) -> Figure:
    """The figure of a motion."""
    where, path = "at infinity: the robot translates", "a straight line"
    if shown.icr:
        where, path = f"at ({number(shown.icr[0])}, {number(shown.icr[1])}) m", "an arc about it"
    values = (
        f"{number(v)}{FIRM}{unit}" for v, unit in zip(shown.twist, ("m/s", "m/s", "rad/s"), strict=True)
    )
    words = ", ".join(f"{name}{FIRM}{value}" for name, value in zip(("vx", "vy", "ω"), values, strict=True))
    alt = (
        f"{robot.name} moving: left the instantaneous centre of rotation {where}, right the same motion in the world, "
        f"{path}."
    )
    lines = wrapped(f"{words}{', wheels slide' if robot.effective_track else ''}", 222)
    groups = [*instant(robot, shown, _LEFT, "robot frame", lines), *world(robot, shown, _RIGHT)]
    return figure(FILE, alt, _LEFT[3] + 6 + 15 * len(lines), groups)
