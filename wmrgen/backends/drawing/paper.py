"""The page: points and boxes on it, finished SVG elements, and free places for names.

Coordinates are pixels, x to the right and y down, printed with at most two decimals whatever the locale.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from html import escape
from math import cos, hypot, pi, sin

Point = tuple[float, float]
Segment = tuple[Point, Point]
Box = tuple[float, float, float, float]  # left, top, right, bottom

CHARACTER, HEIGHT = 7.25, 14.0  # a monospaced character at 12 px
_GAPS = (4.0, 12.0, 22.0, 36.0, 54.0)  # between a name and its wheel
_LEADER = 14.0  # from this gap on a line leads from the name to the wheel
_DIRECTIONS = 24


def along(p: Point, direction: Point, reach: float) -> Point:
    """The point ``reach`` steps from p in a direction."""
    return p[0] + reach * direction[0], p[1] + reach * direction[1]


def distance(a: Point, b: Point) -> float:
    """How far two points are apart."""
    return hypot(b[0] - a[0], b[1] - a[1])


def unit(a: Point, b: Point) -> Point:
    """The direction from a to b; up when they coincide."""
    size = distance(a, b)
    return ((b[0] - a[0]) / size, (b[1] - a[1]) / size) if size > 1e-9 else (0.0, -1.0)


def middle(box: Box) -> Point:
    """The middle of a box."""
    return (box[0] + box[2]) / 2, (box[1] + box[3]) / 2


def bounds(points: list[Point], grow: float = 0.0) -> Box:
    """The box around points, ``grow`` wider on every side."""
    xs, ys = zip(*points, strict=True)
    return min(xs) - grow, min(ys) - grow, max(xs) + grow, max(ys) + grow


def overlap(a: Box, b: Box) -> float:
    """The common area of two boxes."""
    if a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3]:
        return 0.0
    return (min(a[2], b[2]) - max(a[0], b[0])) * (min(a[3], b[3]) - max(a[1], b[1]))


def clip(p: Point, direction: Point, area: Box) -> Segment | None:
    """The part of the line through p that lies in the box (Liang-Barsky); None when it misses it."""
    low, high = -1e9, 1e9
    for at, step, lower, upper in zip(p, direction, area[:2], area[2:], strict=True):
        if abs(step) < 1e-12:
            if not lower <= at <= upper:
                return None
            continue
        a, b = sorted(((lower - at) / step, (upper - at) / step))
        low, high = max(low, a), min(high, b)
    return (along(p, direction, low), along(p, direction, high)) if low < high else None


def hull(points: list[Point]) -> list[Point]:
    """Convex hull (monotone chain)."""
    ordered = sorted({(round(x, 3), round(y, 3)) for x, y in points})
    if len(ordered) < 3:
        return ordered

    def turn(a: Point, b: Point, c: Point) -> float:
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    def half(sequence: list[Point]) -> list[Point]:
        chain: list[Point] = []
        for p in sequence:
            while len(chain) > 1 and turn(chain[-2], chain[-1], p) <= 1e-9:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(ordered) + half(ordered[::-1])


def num(value: float) -> str:
    """At most two decimals, no negative zero: ``12.5``, ``-3``."""
    shown = f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")
    return "0" if shown == "-0" else shown


def pair(p: Point) -> str:
    """``x,y``"""
    return f"{num(p[0])},{num(p[1])}"


def line(a: Point, b: Point, cls: str) -> str:
    """A straight line."""
    return f'<line x1="{num(a[0])}" y1="{num(a[1])}" x2="{num(b[0])}" y2="{num(b[1])}" class="{cls}"/>'


def circle(c: Point, r: float, cls: str) -> str:
    """A circle about c."""
    return f'<circle cx="{num(c[0])}" cy="{num(c[1])}" r="{num(r)}" class="{cls}"/>'


def polygon(points: Iterable[Point], cls: str) -> str:
    """A filled shape."""
    return f'<polygon points="{" ".join(pair(p) for p in points)}" class="{cls}"/>'


def bar(centre: Point, half: Point, radius: float, degrees: float, cls: str) -> str:
    """A rounded rectangle, turned clockwise by ``degrees`` on paper."""
    rotate = f' transform="rotate({num(degrees)} {num(centre[0])} {num(centre[1])})"'
    turn = rotate if num(degrees) != "0" else ""
    return (
        f'<rect x="{num(centre[0] - half[0])}" y="{num(centre[1] - half[1])}" width="{num(2 * half[0])}" '
        f'height="{num(2 * half[1])}" rx="{num(radius)}" class="{cls}"{turn}/>'
    )


def text(p: Point, words: str, cls: str) -> str:
    """Words about p."""
    return f'<text x="{num(p[0])}" y="{num(p[1])}" class="{cls}">{escape(words)}</text>'


def arrow(a: Point, b: Point, cls: str, head: float = 5.0) -> list[str]:
    """A shaft from a towards b with a filled head that ends in b."""
    ux, uy = unit(a, b)
    root = along(b, (ux, uy), -1.5 * head)
    tip = (b, along(root, (-uy, ux), 0.62 * head), along(root, (uy, -ux), 0.62 * head))
    return [line(a, root, cls), polygon(tip, f"{cls} head")]


@dataclass(slots=True)
class Paper:
    """What is already drawn: boxes that names must not touch, segments that they had better not cross."""

    area: Box
    boxes: list[Box] = field(default_factory=list)
    segments: list[Segment] = field(default_factory=list)

    def put(self, words: str, target: Box, away: Point, crowded: bool = False) -> list[str]:
        """``words`` at the best place beside the box ``target``, seen from ``away``; with a line to it where they
        stand apart.

        Greedy: the next name keeps clear of this one. On a crowded page a name that finds no free place is left out.
        """
        half = (len(words) * CHARACTER / 2 + 1, HEIGHT / 2)
        outward = unit(away, middle(target)) if distance(middle(target), away) > 2 else (1.0, 0.0)
        best: tuple[float, Point, float] | None = None
        count = _DIRECTIONS // 3 if crowded else _DIRECTIONS
        for gap in _GAPS[:2] if crowded else _GAPS:
            for k in range(count):
                c, s = cos(2 * pi * k / count), sin(2 * pi * k / count)
                cost = 0.9 * gap + 7 * (1 - (c * outward[0] + s * outward[1]))
                if best is not None and cost >= best[0]:
                    continue
                centre = _clear_of(target, half, (c, s), gap)
                cost += self._cost(_box(centre, half, 1), not crowded)
                if best is None or round(cost, 3) < round(best[0], 3):
                    best = (cost, centre, gap)
        assert best is not None
        cost, centre, gap = best
        if crowded and cost > 400:
            return []
        box = _box(centre, half)
        leader = _leader(box, target) if gap >= _LEADER else None
        self.boxes.append(box)
        if leader:
            self.segments.append(leader)
        name = text((centre[0], centre[1] + 4.1), words, "name")
        return [line(*leader, "leader"), name] if leader else [name]

    def _cost(self, box: Box, lines: bool) -> float:
        """What is wrong with a name in ``box``: boxes that it touches, paper that ends, ``lines`` that it crosses."""
        hits = sum(500 + common for other in self.boxes if (common := overlap(box, other)) > 0)
        outside = (box[2] - box[0]) * (box[3] - box[1]) - overlap(box, self.area)
        crossed = sum(14.0 for a, b in self.segments if lines and _crosses(a, b, box))
        return hits + (2000 + outside if outside > 1e-6 else 0.0) + crossed


def _box(centre: Point, half: Point, grow: float = 0.0) -> Box:
    x, y = half[0] + grow, half[1] + grow
    return centre[0] - x, centre[1] - y, centre[0] + x, centre[1] + y


def _clear_of(target: Box, half: Point, direction: Point, gap: float) -> Point:
    """The centre of a name that clears ``target`` by ``gap`` in a direction."""
    c, s = direction
    reach_x = (target[2] - target[0]) / 2 + half[0] + gap
    reach_y = (target[3] - target[1]) / 2 + half[1] + gap
    scale = min(reach_x / abs(c) if abs(c) > 1e-9 else 1e9, reach_y / abs(s) if abs(s) > 1e-9 else 1e9)
    return along(middle(target), direction, scale)


def _leader(box: Box, target: Box) -> Segment | None:
    centre = middle(box)
    way = unit(centre, middle(target))
    out, into = clip(centre, way, box), clip(centre, way, target)
    return (out[1], into[0]) if out and into else None


def _crosses(a: Point, b: Point, box: Box) -> bool:
    step = (b[0] - a[0], b[1] - a[1])
    part = clip(a, step, box)
    if part is None:
        return False
    size = step[0] * step[0] + step[1] * step[1] or 1.0
    first, last = (((p[0] - a[0]) * step[0] + (p[1] - a[1]) * step[1]) / size for p in part)
    return last > 0 and first < 1
