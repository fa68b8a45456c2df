"""Dimension lines of a top view: distances between wheels, or from P to all of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import hypot

from wmrgen.backends.drawing.figure import View
from wmrgen.backends.drawing.marks import Placed
from wmrgen.backends.drawing.paper import (
    Paper,
    Point,
    along,
    arrow,
    bounds,
    circle,
    distance,
    line,
    metres,
    middle,
    unit,
    width,
)
from wmrgen.layout.records import Robot, Wheel

_SAME = 1e-6  # of the robot's size: places that a dimension does not tell apart
_GAP = 17.0  # between two numbers one above the other [px]


def dimensions(
    robot: Robot, wheels: list[Placed], view: View, paper: Paper, base: float, frame: float
) -> list[str]:
    """Distances between wheels: along x on the left side, along y on the line ``base``; or that from P to all.

    ``frame``: how long the axes of the frame are drawn [px].
    """
    bearing = [w for w in robot.wheels if w.kind.constrains or w.kind.rollers or w.actuated] or robot.wheels
    size = max(hypot(w.pivot.real, w.pivot.imag) for w in robot.wheels)
    if not size:
        return []
    if _round(bearing, size):
        return _radius(bearing, view, paper)
    elements: list[str] = []
    xs = _places([w.pivot.real for w in bearing], size)
    if len(xs) == 2 and xs[0] * xs[1] < 0 and abs(xs[0] + xs[1]) > _SAME * size:
        xs = [xs[0], 0.0, xs[1]]  # P stands between its axles, nearer to one
    if any((b - a) * view.scale < _GAP for a, b in pairwise(xs)) or len(xs) > 4:
        xs = [xs[0], xs[-1]]
    widest = max((width(metres(b - a)) for a, b in pairwise(xs)), default=0.0)
    left = max(min(*(p.reach[0] for p in wheels), view.origin[0] - frame) - 16.0, widest + 12.0)
    for a, b in pairwise(xs):
        if (b - a) * view.scale >= _GAP:
            ends = [(left, view.on((x, 0.0))[1]) for x in (a, b)]
            paper.boxes.append(bounds(ends, 5))
            elements += [_tick(ends[0], (1, 0)), _tick(ends[1], (1, 0)), *_measured(*ends)]
            where = (left - 6, (ends[0][1] + ends[1][1]) / 2 + 4)
            elements.append(paper.write(where, metres(b - a), "words", "end"))
    ys = _places([w.pivot.imag for w in bearing], size)
    if len(ys) > 1 and (ys[-1] - ys[0]) * view.scale > _GAP:
        ends = [(view.on((0.0, y))[0], base) for y in (ys[-1], ys[0])]
        paper.boxes.append(bounds(ends, 5))
        elements += [_tick(ends[0], (0, 1)), _tick(ends[1], (0, 1)), *_measured(*ends)]
        words = f"{'track ' * _track(bearing, ys, size)}{metres(ys[-1] - ys[0])}"
        elements.append(paper.write(((ends[0][0] + ends[1][0]) / 2, base + 15), words, "words", "middle"))
    return elements


def _places(values: Sequence[float], size: float) -> list[float]:
    """Distinct values in ascending order."""
    distinct: list[float] = []
    for value in sorted(values):
        if not distinct or value - distinct[-1] > _SAME * size:
            distinct.append(value)
    return distinct


def _track(wheels: Sequence[Wheel], ys: list[float], size: float) -> bool:
    """Whether the outermost wheels stand side by side and roll forward."""
    sides = [[w for w in wheels if abs(w.pivot.imag - y) <= _SAME * size] for y in (ys[0], ys[-1])]
    ahead = all(abs(w.zero_heading.imag) < _SAME for side in sides for w in side)
    return ahead and len({tuple(_places([w.pivot.real for w in side], size)) for side in sides}) == 1


def _round(wheels: Sequence[Wheel], size: float) -> bool:
    """Whether the wheels stand on a circle about P and not in the corners of a rectangle."""
    sides = zip(*((abs(w.pivot.real), abs(w.pivot.imag)) for w in wheels), strict=True)
    corners = all(len(_places(side, size)) == 1 for side in sides)
    return len(wheels) > 2 and not corners and len(_places([abs(w.pivot) for w in wheels], size)) == 1


def _radius(wheels: Sequence[Wheel], view: View, paper: Paper) -> list[str]:
    """The circle on which the pivots stand, and its radius."""
    w = wheels[0]
    tip = view.on((w.pivot.real, w.pivot.imag))
    length = distance(view.origin, tip)
    centre = along(view.origin, unit(view.origin, tip), 0.62 * length)
    paper.segments.append((view.origin, tip))
    label = paper.put(f"l = {metres(abs(w.pivot))}", bounds([centre], 2), view.origin)
    return [circle(view.origin, length, "swivel"), *arrow(view.origin, tip, "size", 4), *label]


def _tick(p: Point, way: Point) -> str:
    return line(along(p, way, -4), along(p, way, 4), "size")


def _measured(a: Point, b: Point) -> list[str]:
    """A dimension line with heads at both ends."""
    centre = middle(bounds([a, b]))
    return [*arrow(centre, a, "size", 4), *arrow(centre, b, "size", 4)]
