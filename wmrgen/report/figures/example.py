"""The motion that figures show: a twist that the robot can drive, off-centre, and the headings that let it roll."""

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

_SLANT = radians(25)  # direction of travel shown when only translation is admissible
_PLACES = (  # ICR candidates from the centre, in units of the robot's half extent
    (-0.35, 1.35), (0.35, 1.35), (-0.6, 1.6), (0.6, 1.6), (-1.0, 2.0), (-0.35, -1.35), (0.0, 2.5), (0.0, 4.0),
)  # fmt: skip
_DISTANCES = (1.3, 1.7, 2.2, 2.8, 3.6, 5.0, 8.0, -1.3, -2.2, -3.6, 12.0)


class Example(NamedTuple):
    """``twist`` of P [m/s, rad/s]. ``headings``: rolling direction by wheel [rad]. ``icr``: None without rotation."""

    twist: Twist
    headings: dict[str, float]
    icr: Point | None


def extent(wheels: tuple[Wheel, ...]) -> tuple[Point, float]:
    """Centre of the pivots' bounding box, and half its diagonal (at least two wheel radii) [m]."""
    box = bounds([(float(w.nominal.x), float(w.nominal.y)) for w in wheels])
    size = distance(box[:2], box[2:]) / 2
    return middle(box), max(size, 2 * max(float(w.nominal.r) for w in wheels), 1e-3)


def largest_radius(wheels: tuple[Wheel, ...]) -> float:
    """Of the wheels that have one [m]."""
    return max(*(float(w.nominal.r) for w in wheels), 1e-9)


def example(robot: Robot, mobility: Mobility) -> Example | None:
    """A motion that the steering limits allow if a candidate does; None where the robot cannot move."""
    twist = _twist(robot, mobility, [w for w in robot.wheels if w.kind.steers])
    return None if twist is None else moving(robot, twist)


def moving(robot: Robot, twist: Twist) -> Example:
    """What the wheels do under an admissible twist; castors stand as they trail when it lasts, on belts at 0."""
    headings = {}
    free = {m[0].index for m in robot.together("steer", robot.wheels) if len(m) == 1 and m[0].kind.swivels}
    for w in robot.wheels:
        swing = swung(robot, w, twist) if w.kind.steers else _trail(w, twist) if w.index in free else 0.0
        headings[w.name] = w.heading + swing
    return Example(twist, headings, icr(twist, extent(robot.wheels)[1]))


def _twist(robot: Robot, mobility: Mobility, steered: list[Wheel]) -> Twist | None:
    """The twist that the picture shows; None where the robot cannot move."""
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
    """ICR candidates inside the admissible twists; [] when they only translate."""
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
    """A translation 25 degrees off the x axis when both directions are free, else the only one."""
    p, q = rows
    if abs(p[0] * q[1] - p[1] * q[0]) > 1e-9:
        return cos(_SLANT), sin(_SLANT), 0.0
    return p


def swung(robot: Robot, w: Wheel, t: Twist) -> float:
    """The steering angle in [-pi/2, pi/2] that rolls, or the opposite one if only that is within limits."""
    velocity = pivot_velocity(w, t)
    if abs(velocity) < 1e-12:
        return 0.0
    turn = remainder(phase(velocity) - w.heading, pi)
    other = turn - pi if turn > 0 else turn + pi
    return other if not inside(robot, w, turn) and inside(robot, w, other) else turn


def _trail(w: Wheel, t: Twist) -> float:
    """The steering angle of a castor that a lasting motion pulls: its axle runs through the ICR, its contact lies
    behind its pivot. 0 where there is none: its pivot is closer to the ICR than its contact can be."""
    velocity = pivot_velocity(w, t)
    speed, d = abs(velocity), float(w.nominal.d)
    if speed < 1e-12 or speed <= abs(d * t[2]):
        return 0.0
    # e . (C - A) = d, where the ICR C lies speed / omega to the left of the velocity.
    aside = acos(max(-1.0, min(1.0, d * t[2] / speed)))  # from the direction to C's side, to e
    left = phase(velocity) + pi / 2
    return remainder(left + (aside if d > 0 else -aside) - w.heading, 2 * pi)


def inside(robot: Robot, w: Wheel, turn: float) -> bool:
    """Whether the limits of a wheel allow a steering angle [rad]."""
    limit = robot.limit(w, "steer")
    return limit is None or float(limit.low) - 1e-9 <= turn <= float(limit.high) + 1e-9


def _allowed(robot: Robot, steered: list[Wheel], t: Twist, size: float) -> bool:
    far = all(abs(pivot_velocity(w, t)) > 0.35 * size * abs(t[2]) for w in steered)
    return far and all(inside(robot, w, swung(robot, w, t)) for w in steered)


def icr(t: Twist, size: float) -> Point | None:
    """The instantaneous centre of rotation [m]; None where a robot of this size does not turn."""
    if abs(t[2]) * size < 1e-6 * hypot(t[0], t[1]):
        return None
    return -t[1] / t[2] + 0.0, t[0] / t[2] + 0.0
