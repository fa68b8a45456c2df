"""The figure that the example of a robot drives: the first of a list that the robot can drive and measure.

Along the figure a share swings from 0 to 1, to -1 and back to 0, in straight lines over time. It scales what turns the
robot or moves it to its side. A robot can drive a figure if, from sampled moments of it to later ones, the loop of the
example gives commands of which `forward` makes the wanted twist. What fails there: curvature beyond a steering stop,
wheels that cannot turn the robot, wheels that skid, limits of rates, and wheels that do not determine the yaw rate. No
figure has a motion that no motor commands.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import dropwhile, product
from math import degrees, hypot, pi
from typing import NamedTuple

from wmrgen.codegen.c.rehearsal import Rehearsal, Twist
from wmrgen.ir.nodes import Module

DURATION = 60  # s
STARTING = 3  # s in which the robot speeds up, and those in which it comes to rest
_SPEEDS = (0.25, 4.0)  # m/s; a fast robot's `limit_twist` takes 0.25 m/s for standstill
_SHARES = (1.0, 0.4, 0.16)  # of the speed that limits leave: in a curve some wheels are faster
_HEADINGS = (2 * pi, pi, pi / 2, pi / 4, pi / 8, pi / 16)  # rad, the change of heading in half of the figure
_SIDEWAYS = (1.0, 0.5, 0.25)  # of the speed ahead
_MOMENTS = (15.0, 45.0, 7.5, 30.0, 52.5, 1.5, 58.0)  # s; the curve is tightest at the first two
_LATER = 0.5  # s from a moment to the later one: long enough that limits of rates show
_TOLERANCE = 1e-3  # of the speed: a tenth of what the drive may be off
_YAW_TOLERANCE = 2.5e-4  # rad/s: in half of the figure the heading is off by 0.0075 rad
_STILL = (0.0, 0.0, 0.0)
_BOTH = "both commanded by its motors and measured by its sensors"


class Figure(NamedTuple):
    """The wanted twist: ``steady`` as long as it drives, and the share times ``swinging`` [m/s, m/s, rad/s]."""

    steady: Twist
    swinging: Twist
    text: str


def figure(module: Module, unmotored: bool) -> Figure:
    """Return the figure for a robot with the C functions of ``module``; standstill if it can drive none.

    ``unmotored``: no motor commands some of its motions.
    """
    robot = Rehearsal(module, _LATER)
    if robot.whole:
        for candidate in _candidates(robot, unmotored):
            if _drives(robot, candidate):
                return candidate
    return Figure(_STILL, _STILL, f"Standstill, because no figure of this example is {_BOTH}.")


def _candidates(robot: Rehearsal, unmotored: bool) -> Iterator[Figure]:
    """Figures that use most of the robot's freedom first; some of them it cannot drive."""
    ways = list(_ways(robot))
    for way in () if unmotored else ways:
        turns, sides = (
            list(dropwhile(lambda f: not _drives(robot, f), each))
            for each in (_turns(robot, way), _sides(way))
        )
        for turn, side in product(turns, sides):
            text = turn.text.replace(" in a", ", partly sideways, in a")
            yield Figure(way, _sum(turn.swinging, side.swinging), text)
        yield from (*turns[:1], *sides[:1])
    for way in ways:
        yield Figure(way, _STILL, f"Straight on for a minute, because {_why(robot, way, unmotored)}.")


def _ways(robot: Rehearsal) -> Iterator[Twist]:
    """Twists without a share: ahead or, if the wheels do not allow that, to the side, at several speeds."""
    for speed in _SPEEDS:
        for asked in ((speed, 0.0, 0.0), (0.0, speed, 0.0)):
            way = robot.driven(asked)
            if hypot(*way[:2]) > _TOLERANCE * speed and abs(way[2]) <= _YAW_TOLERANCE:
                yield from (_times(share, way) for share in _SHARES)
                break


def _turns(robot: Rehearsal, way: Twist) -> Iterator[Figure]:
    """Curves; with them the velocity across ``way`` that fixed wheels ahead of P or behind it force on a turn."""
    speed = hypot(*way[:2])
    for heading in _HEADINGS:
        what = "loop" if heading == 2 * pi else f"curve of {degrees(heading):g} degrees"
        rate = _rate(heading)
        driven = robot.driven(_sum(way, (0.0, 0.0, rate)))
        across = (driven[1] * way[0] - driven[0] * way[1]) / speed
        if abs(across * rate) <= _TOLERANCE * speed * abs(driven[2]):
            across = 0.0
        across *= rate / driven[2] if driven[2] else 0.0
        swinging = (-across * way[1] / speed, across * way[0] / speed, rate)
        yield Figure(way, swinging, f"A {what} to the left and one to the right in a minute.")


def _sides(way: Twist) -> Iterator[Figure]:
    text = "To the left and to the right, while the robot drives on and keeps its heading, in a minute."
    for part in _SIDEWAYS:
        yield Figure(way, (-part * way[1], part * way[0], 0.0), text)


def _rate(heading: float) -> float:
    """The yaw rate at share 1 of a figure with this change of heading in each half."""
    return 4 * heading / DURATION


def _why(robot: Rehearsal, way: Twist, unmotored: bool) -> str:
    """Why the robot drives no curve."""
    if unmotored:
        return "its motors do not command all of its motions"
    if robot.slides(_sum(way, (0.0, 0.0, _rate(_HEADINGS[-1]))), _TOLERANCE):
        return "its wheels would slide in a curve"
    return f"no curve of this robot is {_BOTH}"


def _drives(robot: Rehearsal, figure: Figure) -> bool:
    """Whether the twist of the commands is the wanted one at every moment, and never faster across than ahead."""
    speed = hypot(*figure.steady[:2])
    if hypot(*figure.swinging[:2]) > 1.001 * speed:
        return False
    for moment in _MOMENTS:
        wanted = _wanted(figure, moment + _LATER)
        driven = robot.driven(wanted, _wanted(figure, moment))
        off = _sum(driven, _times(-1.0, wanted))
        if hypot(*off[:2]) > _TOLERANCE * speed or abs(off[2]) > _YAW_TOLERANCE:
            return False
    return True


def _wanted(figure: Figure, time: float) -> Twist:
    """The twist at a ``time`` [s], as the example has it."""
    quarter, started = DURATION / 4, min(time, DURATION - time, STARTING) / STARTING
    swing = time if time < quarter else 2 * quarter - time if time < 3 * quarter else time - DURATION
    return _sum(_times(started, figure.steady), _times(swing / quarter, figure.swinging))


def _sum(a: Twist, b: Twist) -> Twist:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _times(factor: float, twist: Twist) -> Twist:
    return factor * twist[0], factor * twist[1], factor * twist[2]
