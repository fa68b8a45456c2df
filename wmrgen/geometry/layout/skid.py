"""Robots that turn by skidding, with the track that is measured of how they turn.

Fixed wheels on several parallel axles cannot all roll in a curve. On even ground such a robot turns as a differential
drive does whose track is larger: its effective track (Martínez, Mandow, Morales, Pedraza, García-Cerezo 2005 measure
it as the distance between the centres of rotation of left and right wheels). The wheels of a side stand for one wheel.
Steered wheels beside them keep their places: they point along the motion that the differential drive leaves.
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

_PARALLEL = 1e-9  # sine of the angle between axles that are taken for parallel
_MIDDLE = 1e-6  # of the track: as far from the middle a wheel is on neither side
_LEFT, _RIGHT = 1, -1
T = TypeVar("T", Poly, float)


def effective_track(quantity: Quantity | None, scope: Scope, wheels: Sequence[Wheel]) -> Length | None:
    """The track in its views. RobotFileError where it is not positive, and for wheels that do not turn by skidding."""
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
    """Which robot of these wheels cannot have an effective track, and why; nothing where it can."""
    fixed = [w for w in wheels if w.kind.fixed_axle]
    across = [w for w in wheels if w.kind.rolls_across]
    if across:
        what = f"effective_track of a robot with the {across[0].kind.noun} {across[0].name}"
        return what, "It says how a robot turns whose wheels cannot move across their rolling direction."
    if not parallel([w.zero_heading for w in fixed]):
        return (
            "effective_track of a robot whose fixed wheels are not parallel",
            "They have no left and right.",
        )
    if not fixed or not {*sides([w.pivot for w in fixed], fixed[0].zero_heading)} >= {_LEFT, _RIGHT}:
        what = "effective_track of a robot with fixed wheels on one side alone"
        return what, "It is the distance between left and right wheels."
    return "", ""


def parallel(headings: Sequence[complex]) -> bool:
    """Whether wheels of these headings, points of the unit circle, point the same way, forwards or backwards."""
    return all(abs((h * headings[0].conjugate()).imag) < _PARALLEL for h in headings)


def sides(pivots: Sequence[complex], heading: complex) -> list[int]:
    """On which side of the middle each of parallel wheels stands, seen along ``heading``: 1 left, -1 right, 0
    neither."""
    across = [(pivot * heading.conjugate()).imag for pivot in pivots]
    middle, width = (max(across) + min(across)) / 2, max(across) - min(across)
    return [0 if abs(y - middle) <= _MIDDLE * width else _LEFT if y > middle else _RIGHT for y in across]


def placed(
    points: Sequence[tuple[T, T]], heading: tuple[T, T], own: Sequence[int], track: T
) -> list[tuple[T, T]]:
    """Where fixed wheels, at ``points`` on the sides ``own``, count as standing in the differential drive: ``track``
    apart about the middle of the sides, at the mean of the wheels along the unit vector ``heading``."""
    c, s = heading
    ahead = _mean([x * c + y * s for x, y in points])
    rows = [
        [y * c - x * s for (x, y), k in zip(points, own, strict=True) if k == side]
        for side in (_LEFT, _RIGHT)
    ]
    middle = _mean([_mean(row) for row in rows if row])
    across = [middle + track * Fraction(k, 2) for k in own]
    return [(ahead * c - y * s, ahead * s + y * c) for y in across]


def driven(robot: Robot) -> Robot:
    """What wheel speeds and motion follow from: the robot itself, or where it has an effective track, the differential
    drive that turns as it does. Its axle stands at the mean of the wheels, in the middle between the sides."""
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
    """Wheel index -> geometry in a view, at the place where the fixed wheel counts as standing."""
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    seen = [view(w) for w in fixed]
    own = sides([w.pivot for w in fixed], fixed[0].zero_heading)
    places = placed([(g.x, g.y) for g in seen], (seen[0].ch, seen[0].sh), own, track)
    return {w.index: replace(g, x=x, y=y) for w, g, (x, y) in zip(fixed, seen, places, strict=True)}


def _mean(values: Sequence[T]) -> T:
    return sum(values[1:], start=values[0]) * Fraction(1, len(values))
