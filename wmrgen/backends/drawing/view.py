"""From robot frame to paper: x forward is up, y left is left."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

Point = tuple[float, float]
Box = tuple[float, float, float, float]  # left, top, right, bottom [px]


@dataclass(frozen=True, slots=True)
class View:
    """``scale`` [px/m]; ``origin``: where P lies [px]; ``area``: the box that lines are cut at."""

    scale: float
    origin: Point
    area: Box

    def at(self, x: float, y: float) -> Point:
        """A point of the robot frame [m] on paper [px]."""
        return self.origin[0] - y * self.scale, self.origin[1] - x * self.scale

    def turn(self, dx: float, dy: float) -> Point:
        """A direction of the robot frame on paper."""
        return -dy, -dx


def fit(points: list[Point], width: float, tallest: float, margin: Box) -> tuple[View, float]:
    """The view that shows all points [m] on a page ``width`` wide, and the height of the page."""
    back, right, front, left = bounds(points)
    wide, long = left - right, front - back
    inner_x, inner_y = width - margin[0] - margin[2], tallest - margin[1] - margin[3]
    scale = min(inner_x / max(wide, 1e-6), inner_y / max(long, 1e-6))
    height = max(scale * long, 170.0) + margin[1] + margin[3]
    x, y = middle((back, right, front, left))
    centre = (margin[0] + inner_x / 2, margin[1] + (height - margin[1] - margin[3]) / 2)
    origin = (centre[0] + y * scale, centre[1] + x * scale)
    return View(scale, origin, (14.0, 14.0, width - 14.0, height - 14.0)), height


def clip(p: Point, direction: Point, area: Box) -> tuple[Point, Point] | None:
    """The part of the line through p that lies in the box (Liang-Barsky); None when it misses it."""
    low, high = -1e9, 1e9
    for at, step, lower, upper in (
        (p[0], direction[0], area[0], area[2]),
        (p[1], direction[1], area[1], area[3]),
    ):
        if abs(step) < 1e-12:
            if not lower <= at <= upper:
                return None
            continue
        a, b = sorted(((lower - at) / step, (upper - at) / step))
        low, high = max(low, a), min(high, b)
    if low >= high:
        return None
    return along(p, direction, low), along(p, direction, high)


def along(p: Point, direction: Point, reach: float) -> Point:
    """The point ``reach`` steps from p in a direction."""
    return p[0] + reach * direction[0], p[1] + reach * direction[1]


def distance(a: Point, b: Point) -> float:
    """How far two points are apart."""
    return hypot(b[0] - a[0], b[1] - a[1])


def middle(box: Box) -> Point:
    """The middle of a box."""
    return (box[0] + box[2]) / 2, (box[1] + box[3]) / 2


def inside(p: Point, area: Box) -> bool:
    """True for a point in the box."""
    return area[0] <= p[0] <= area[2] and area[1] <= p[1] <= area[3]


def bounds(points: list[Point], grow: float = 0.0) -> Box:
    """The box around points, ``grow`` wider on every side."""
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs) - grow, min(ys) - grow, max(xs) + grow, max(ys) + grow


def overlap(a: Box, b: Box) -> float:
    """The common area of two boxes."""
    if a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3]:
        return 0.0
    return (min(a[2], b[2]) - max(a[0], b[0])) * (min(a[3], b[3]) - max(a[1], b[1]))


def unit(a: Point, b: Point) -> Point:
    """The direction from a to b; up when they coincide."""
    size = distance(a, b)
    return ((b[0] - a[0]) / size, (b[1] - a[1]) / size) if size > 1e-9 else (0.0, -1.0)


def hull(points: list[Point]) -> list[Point]:
    """Convex hull (monotone chain)."""
    ordered = sorted({(round(x, 3), round(y, 3)) for x, y in points})
    if len(ordered) < 3:
        return ordered

    def half(sequence: list[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in sequence:
            while len(chain) > 1 and _left(chain[-2], chain[-1], p) <= 1e-9:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(ordered) + half(ordered[::-1])


def _left(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
