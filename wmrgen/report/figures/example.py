"""Choose the motion that figures show: an admissible twist with a visible ICR, and headings at which wheels roll."""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterable
from math import acos, cos, hypot, pi, radians, remainder, sin
from typing import NamedTuple

from wmrgen.analysis.mobility.configure import pivot_velocity
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.exact.poly import triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.figures.paper import Point, bounds, distance, middle

Twist = tuple[float, float, float]

_SLANT = radians(25)  # direction of travel if the robot can only translate: visibly off both axes
_PLACES = (  # candidates for the ICR, from the centre, in units of half the size of the robot
    (-0.35, 1.35), (0.35, 1.35), (-0.6, 1.6), (0.6, 1.6), (-1.0, 2.0), (-0.35, -1.35), (0.0, 2.5), (0.0, 4.0),
)  # fmt: skip
# The same along the line on which the ICR of a robot with two degrees of freedom is.
_DISTANCES = (1.3, 1.7, 2.2, 2.8, 3.6, 5.0, 8.0, -1.3, -2.2, -3.6, 12.0)


class Example(NamedTuple):
    """A motion with the headings of all wheels."""

    twist: Twist  # of P [m/s, rad/s]
    headings: dict[str, float]  # rolling direction of each wheel [rad]
    icr: Point | None  # [m]; None without rotation


def extent(wheels: tuple[Wheel, ...]) -> tuple[Point, float]:
    """Return the centre of the box around all pivots, and half its diagonal but at least two wheel radii [m]."""
    box = bounds([(float(w.nominal.x), float(w.nominal.y)) for w in wheels])
    size = distance(box[:2], box[2:]) / 2
    return middle(box), max(size, 2 * max(float(w.nominal.r) for w in wheels), 1e-3)


def largest_radius(wheels: tuple[Wheel, ...]) -> float:
    """Return the largest radius of the wheels [m]."""
    return max(*(float(w.nominal.r) for w in wheels), 1e-9)


def example(robot: Robot, mobility: Mobility) -> Example | None:
    """Return a motion, within the steering limits if a candidate is; None if the robot cannot move."""
    twist = _twist(robot, mobility, [w for w in robot.wheels if w.kind.steers])
    return None if twist is None else moving(robot, twist)


def moving(robot: Robot, twist: Twist) -> Example:
    """Return the headings of wheels during an admissible twist. Castors trail; coupled castors are at angle 0."""
    headings = {}
    free = {m[0].index for m in robot.together("steer", robot.wheels) if len(m) == 1 and m[0].kind.swivels}
    for w in robot.wheels:
        swing = swung(robot, w, twist) if w.kind.steers else _trail(w, twist) if w.index in free else 0.0
        headings[w.name] = w.heading + swing
    return Example(twist, headings, icr(twist, extent(robot.wheels)[1]))


def _twist(robot: Robot, mobility: Mobility, steered: list[Wheel]) -> Twist | None:
    """Return the twist of the figure; None if the robot cannot move."""
    admissible = mobility.admissible
    centre, size = extent(robot.wheels)
    if not admissible.dimension:
        return None
    basis = [_floats(row) for row in admissible.basis]
    if not admissible.linear or len(basis) == 1:
        return _floats(admissible.sample)
    rotations: list[Twist] = [(y, -x, 1.0) for x, y in _centres(basis, centre, size)]  # 1 rad/s
    candidates = rotations or [_translation(basis)]
    return next((t for t in candidates if _allowed(robot, steered, t, size)), candidates[0])


def _floats(values: Iterable[float]) -> Twist:
    return triple(map(float, values))


def _centres(rows: list[Twist], centre: Point, size: float) -> list[Point]:
    """Return admissible candidates for the ICR; [] if the robot can only translate."""
    if len(rows) == 3:
        return [(centre[0] + a * size, centre[1] + b * size) for a, b in _PLACES]
    p, q = rows
    turning = max(rows, key=lambda t: abs(t[2]))
    if abs(turning[2]) < 1e-9:
        return []
    straight = (p[0] * q[2] - q[0] * p[2], p[1] * q[2] - q[1] * p[2])  # the combination without rotation
    length = hypot(*straight)
    along = (-straight[1] / length, straight[0] / length)  # the ICR moves across it
    if (along[1] if abs(along[1]) > 1e-9 else along[0]) < 0:  # to the left first
        along = (-along[0], -along[1])
    start = (-turning[1] / turning[2], turning[0] / turning[2])
    foot = (centre[0] - start[0]) * along[0] + (centre[1] - start[1]) * along[1]
    return [
        (start[0] + (foot + k * size) * along[0], start[1] + (foot + k * size) * along[1]) for k in _DISTANCES
    ]


def _translation(rows: list[Twist]) -> Twist:
    """Return a translation, 25° off the x axis if all directions are admissible, else the only one."""
    p, q = rows
    if abs(p[0] * q[1] - p[1] * q[0]) > 1e-9:
        return cos(_SLANT), sin(_SLANT), 0.0
    return p


def swung(robot: Robot, w: Wheel, t: Twist) -> float:
    """Return the steering angle in [-pi/2, pi/2] at which a wheel rolls, or the opposite one if only that is within
    limits.

    Args:
        robot: the robot.
        w: the wheel.
        t: the twist of P [m/s, rad/s].

    Returns:
        The angle [rad].
    """
    velocity = pivot_velocity(w, t)
    if abs(velocity) < 1e-12:
        return 0.0
    turn = remainder(phase(velocity) - w.heading, pi)
    other = turn - pi if turn > 0 else turn + pi
    return other if not inside(robot, w, turn) and inside(robot, w, other) else turn


def _trail(w: Wheel, t: Twist) -> float:
    """Return the steady steering angle of a castor: its axle passes through the ICR, its contact is behind its pivot.

    It is 0 if there is no such angle, because the pivot is closer to the ICR than the castor offset.
    """
    velocity = pivot_velocity(w, t)
    speed, d = abs(velocity), float(w.nominal.d)
    if speed < 1e-12 or speed <= abs(d * t[2]):
        return 0.0
    # e . (C - A) = d, where the ICR C lies speed / omega to the left of the velocity.
    aside = acos(max(-1.0, min(1.0, d * t[2] / speed)))  # from the direction to C's side, to e
    left = phase(velocity) + pi / 2
    return remainder(left + (aside if d > 0 else -aside) - w.heading, 2 * pi)


def inside(robot: Robot, w: Wheel, turn: float) -> bool:
    """Return whether the limits of a wheel allow a steering angle [rad].

    Args:
        robot: the robot.
        w: the wheel.
        turn: the angle [rad].

    Returns:
        Whether it is within the limits.
    """
    limit = robot.limit(w, "steer")
    return limit is None or float(limit.low) - 1e-9 <= turn <= float(limit.high) + 1e-9


def _allowed(robot: Robot, steered: list[Wheel], t: Twist, size: float) -> bool:
    far = all(abs(pivot_velocity(w, t)) > 0.35 * size * abs(t[2]) for w in steered)
    return far and all(inside(robot, w, swung(robot, w, t)) for w in steered)


def icr(t: Twist, size: float) -> Point | None:
    """Return the instantaneous centre of rotation [m]; None if a robot of ``size`` [m] does not turn visibly."""
    if abs(t[2]) * size < 1e-6 * hypot(t[0], t[1]):
        return None
    return -t[1] / t[2] + 0.0, t[0] / t[2] + 0.0
