"""Skid-steer robots, modelled as a differential drive with an effective track.

Fixed wheels on several parallel axles cannot all roll in a curve. On even ground such a robot turns like a differential
drive with a larger track, its effective track: the distance between the instantaneous centres of rotation of the left
and the right wheels (Martínez, Mandow, Morales, Pedraza, García-Cerezo 2005). The wheels of each side are replaced by
one virtual wheel. Steered wheels keep their positions and steer along the motion of the differential drive.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TypeVar

from wmrgen.errors import RobotFileError
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.records import Geometry, Length, Robot, Wheel
from wmrgen.robotfile.records import Quantity

_PARALLEL = 1e-9  # sine of the angle between axles: above the rounding of doubles
_MIDDLE = 1e-6  # relative to the track: a wheel closer to the middle is on neither side
_LEFT, _RIGHT = 1, -1
T = TypeVar("T", Poly, float)


def effective_track(quantity: Quantity | None, scope: Scope, wheels: Sequence[Wheel]) -> Length | None:
    """Return the effective track of a robot.

    Args:
        quantity: The effective track in the robot file; None if there is none.
        scope: The parameters of the robot file.
        wheels: The wheels of the robot.

    Returns:
        The track [m] in its views, or None.

    Raises:
        RobotFileError: If the track is not positive, or if a robot with these wheels has no effective track.
    """
    if quantity is None:
        return None
    track = scope.length(quantity)
    what, why = f"effective_track is {quantity.text}, which is not positive", ""
    if track.nominal.sign > 0:
        what, why = no_track(wheels)
    if what:
        raise RobotFileError(
            what, quantity.mark, why, "Write a length, such as 1.5 times the track; or delete it."
        )
    return track


def no_track(wheels: Sequence[Wheel]) -> tuple[str, str]:
    """Return why a robot with these wheels has no effective track, as what and why of an error; "" if it has one."""
    fixed = [w for w in wheels if w.kind.fixed_axle]
    across = [w for w in wheels if w.kind.rolls_across]
    if across:
        what = f"effective_track of a robot with the {across[0].kind.noun} {across[0].name}"
        return (
            what,
            "It describes robots that turn by skidding, and this wheel moves sideways without skidding.",
        )
    if not parallel([w.zero_heading for w in fixed]):
        what = "effective_track of a robot whose fixed wheels are not parallel"
        return what, "The wheels have no left and right side."
    if not fixed or not {*sides([w.pivot for w in fixed], fixed[0].zero_heading)} >= {_LEFT, _RIGHT}:
        what = "effective_track of a robot with fixed wheels on one side at most"
        return what, "It is the distance between left and right wheels."
    return "", ""


def parallel(headings: Sequence[complex]) -> bool:
    """Return whether wheels are parallel, given their headings as points of the unit circle."""
    return all(abs((h * headings[0].conjugate()).imag) < _PARALLEL for h in headings)


def sides(pivots: Sequence[complex], heading: complex) -> list[int]:
    """Return the side of each of several parallel wheels, seen along ``heading``: 1 left, -1 right, 0 neither."""
    across = [(pivot * heading.conjugate()).imag for pivot in pivots]
    middle, width = (max(across) + min(across)) / 2, max(across) - min(across)
    return [0 if abs(y - middle) <= _MIDDLE * width else _LEFT if y > middle else _RIGHT for y in across]


def placed(
    points: Sequence[tuple[T, T]], heading: tuple[T, T], own: Sequence[int], track: T
) -> list[tuple[T, T]]:
    """Return the positions of fixed wheels in the equivalent differential drive.

    They are ``track`` apart about the middle between the sides, at the mean position of the wheels along the heading.

    Args:
        points: The positions of the wheels [m].
        heading: Cosine and sine of the heading of the wheels.
        own: The side of each wheel, as from `sides`.
        track: The effective track [m].

    Returns:
        One position [m] for each wheel.
    """
    c, s = heading
    ahead = _mean([x * c + y * s for x, y in points])
    centres = []
    for side in (_LEFT, _RIGHT):
        row = [y * c - x * s for (x, y), k in zip(points, own, strict=True) if k == side]
        if row:
            centres.append(_mean(row))
    middle = _mean(centres)
    across = [middle + track * Fraction(k, 2) for k in own]
    return [(ahead * c - y * s, ahead * s + y * c) for y in across]


def driven(robot: Robot) -> Robot:
    """Return the robot from which kinematics are derived.

    It is the robot itself, or the equivalent differential drive if there is an effective track. The axle of that drive
    is at the mean of the wheels, in the middle between the sides.
    """
    track = robot.effective_track
    if track is None:
        return robot
    views = [
        _placed(robot, lambda w: w.symbolic, track.symbolic),
        _placed(robot, lambda w: w.working, track.working),
        _placed(robot, lambda w: w.nominal.mapped(Poly.of), Poly.of(track.nominal)),
    ]
    wheels = list(robot.wheels)
    for i, symbolic in views[0].items():
        nominal = views[2][i].mapped(lambda p: p.constant or ZERO)
        wheels[i] = replace(wheels[i], symbolic=symbolic, working=views[1][i], nominal=nominal)
    return replace(robot, wheels=tuple(wheels), effective_track=None)


def _placed(robot: Robot, view: Callable[[Wheel], Geometry[Poly]], track: Poly) -> dict[int, Geometry[Poly]]:
    """Return the geometry of each fixed wheel at its position in the differential drive, by wheel index."""
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    seen = [view(w) for w in fixed]
    own = sides([w.pivot for w in fixed], fixed[0].zero_heading)
    places = placed([(g.x, g.y) for g in seen], (seen[0].ch, seen[0].sh), own, track)
    return {w.index: replace(g, x=x, y=y) for w, g, (x, y) in zip(fixed, seen, places, strict=True)}


def _mean(values: Sequence[T]) -> T:
    return sum(values[1:], start=values[0]) * Fraction(1, len(values))
