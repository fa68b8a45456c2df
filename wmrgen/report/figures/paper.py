"""Compute points and boxes on paper, write SVG elements, and find free places for names.

Coordinates are pixels, x to the right and y down, printed with at most two decimals in any locale.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from html import escape
from math import cos, hypot, inf, pi, sin

Point = tuple[float, float]
Segment = tuple[Point, Point]
Box = tuple[float, float, float, float]  # left, top, right, bottom

FIRM = "\u00a0"
# Of curves, told apart by colour-blind readers too (Okabe, Ito).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#767676")
SIZE, LETTER = 12.0, 14.0  # px: font size of words, and of letters in formulas
HEIGHT = 14.0  # px: height of a line of words
_NARROW, _WIDE = frozenset(" iljft.,:;'|!()[]°/\""), frozenset("mwMW@%=+<>±×→ω−—")
_GAPS = (4.0, 12.0, 22.0, 36.0, 54.0)  # px: distances between a name and its wheel that are tried
_LEADER = 14.0  # px: from this distance on, a line connects the name and the wheel
_DIRECTIONS = 24  # directions that are tried, every 15°
_CROSSED, _MOST_CROSSED = (
    14.0,
    400.0,
)  # cost of each line that a name crosses, in px of distance, and of all lines


def width(words: str, size: float = SIZE) -> float:
    """Estimate the largest width [px] of words in sans-serif fonts, or of an italic letter."""
    if len(words) == 1:
        return 0.87 * size
    return size * sum(
        0.42 if c in _NARROW else 1.0 if c in _WIDE else 0.76 if c.isupper() else 0.64 for c in words
    )


def wrapped(words: str, wide: float) -> list[str]:
    """Break words into lines of at most ``wide`` px; a longer word gets its own line. `FIRM` spaces are not broken."""
    lines = [""]
    for word in words.split(" "):
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and width(longer) > wide:
            lines.append(word)
        else:
            lines[-1] = longer
    return [line.replace(FIRM, " ") for line in lines]


def along(p: Point, direction: Point, reach: float) -> Point:
    """Return the point at distance ``reach`` from p in a direction.

    Args:
        p: a point [px].
        direction: the direction, a unit vector.
        reach: the distance [px]; if it is negative, the point is on the other side of p.

    Returns:
        The point [px].
    """
    return p[0] + reach * direction[0], p[1] + reach * direction[1]


def distance(a: Point, b: Point) -> float:
    """Return the distance of two points."""
    return hypot(b[0] - a[0], b[1] - a[1])


def unit(a: Point, b: Point) -> Point:
    """Return the direction from a to b; up if they coincide."""
    size = distance(a, b)
    return ((b[0] - a[0]) / size, (b[1] - a[1]) / size) if size > 1e-9 else (0.0, -1.0)


def middle(box: Box) -> Point:
    """Return the middle of a box."""
    return (box[0] + box[2]) / 2, (box[1] + box[3]) / 2


def bounds(points: list[Point], grow: float = 0.0) -> Box:
    """Return the box around points, enlarged by ``grow`` on every side."""
    xs, ys = zip(*points, strict=True)
    return min(xs) - grow, min(ys) - grow, max(xs) + grow, max(ys) + grow


def _meet(a: Box, b: Box) -> bool:
    """Return whether two boxes overlap."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def overlap(a: Box, b: Box) -> float:
    """Return the common area of two boxes."""
    if not _meet(a, b):
        return 0.0
    return (min(a[2], b[2]) - max(a[0], b[0])) * (min(a[3], b[3]) - max(a[1], b[1]))


def clip(p: Point, direction: Point, area: Box) -> Segment | None:
    """Return the part of a line inside a box (Liang-Barsky).

    Args:
        p: a point of the line [px].
        direction: the direction of the line, a unit vector.
        area: the box [px].

    Returns:
        The first and the last point inside the box, in this direction [px]; None if the line misses the box.
    """
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
    """Return the convex hull (monotone chain)."""
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


def metres(length: float) -> str:
    """Return a length with four significant digits: in m, from 10 km on in km, below 10 mm in mm."""
    unit, size = ("km", 1e3) if length >= 1e4 else ("mm", 1e-3) if 0 < length < 0.01 else ("m", 1.0)
    return f"{float(f'{length / size:.4g}'):.12g} {unit}"


def num(value: float) -> str:
    """Return a number with at most two decimals and without negative zero: ``12.5``, ``-3``."""
    shown = f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")
    return "0" if shown == "-0" else shown


def pair(p: Point) -> str:
    """Return the coordinates as ``x,y``."""
    return f"{num(p[0])},{num(p[1])}"


def line(a: Point, b: Point, cls: str) -> str:
    """Return a straight line."""
    return f'<line x1="{num(a[0])}" y1="{num(a[1])}" x2="{num(b[0])}" y2="{num(b[1])}" class="{cls}"/>'


def circle(c: Point, r: float, cls: str) -> str:
    """Return a circle with centre c."""
    return f'<circle cx="{num(c[0])}" cy="{num(c[1])}" r="{num(r)}" class="{cls}"/>'


def polygon(points: Iterable[Point], cls: str) -> str:
    """Return a filled polygon."""
    return f'<polygon points="{" ".join(pair(p) for p in points)}" class="{cls}"/>'


def bar(centre: Point, half: Point, radius: float, degrees: float, cls: str) -> str:
    """Return a rectangle with rounded corners.

    Args:
        centre: its centre.
        half: half its width and half its height.
        radius: radius of the corners.
        degrees: clockwise rotation on paper.
        cls: class of the SVG element.

    Returns:
        The SVG element.
    """
    rotate = f' transform="rotate({num(degrees)} {num(centre[0])} {num(centre[1])})"'
    turn = rotate if num(degrees) != "0" else ""
    return (
        f'<rect x="{num(centre[0] - half[0])}" y="{num(centre[1] - half[1])}" width="{num(2 * half[0])}" '
        f'height="{num(2 * half[1])}" rx="{num(radius)}" class="{cls}"{turn}/>'
    )


def text(p: Point, words: str, cls: str) -> str:
    """Return words at p."""
    return f'<text x="{num(p[0])}" y="{num(p[1])}" class="{cls}">{escape(words)}</text>'


def lines(points: Iterable[Point], cls: str) -> str:
    """Return an open line through points."""
    return f'<polyline points="{" ".join(pair(p) for p in points)}" class="{cls}"/>'


def arc(centre: Point, start: Point, end: Point, turn: float, cls: str) -> str:
    """Return an arc about ``centre``.

    Args:
        centre: its centre.
        start: its first point.
        end: its last point.
        turn: angle that it sweeps [rad], counter-clockwise as seen.
        cls: class of the SVG element.

    Returns:
        The SVG element.
    """
    radius, large = num(distance(centre, start)), int(abs(turn) > pi)
    return (
        f'<path d="M{pair(start)} A{radius},{radius} 0 {large} {int(turn < 0)} {pair(end)}" class="{cls}"/>'
    )


def arrow(a: Point, b: Point, cls: str, head: float = 5.0) -> list[str]:
    """Return an arrow from a to b: a line and a filled head.

    Args:
        a: its start [px].
        b: its tip [px].
        cls: class of the SVG elements.
        head: two thirds of the length of the head [px].

    Returns:
        The SVG elements.
    """
    ux, uy = unit(a, b)
    root = along(b, (ux, uy), -1.5 * head)
    tip = (b, along(root, (-uy, ux), 0.62 * head), along(root, (uy, -ux), 0.62 * head))
    return [line(a, root, cls), polygon(tip, f"{cls} head")]


@dataclass(slots=True)
class Paper:
    """An area with the places that are already taken."""

    area: Box
    boxes: list[Box] = field(default_factory=list)  # words must not touch these
    segments: list[Segment] = field(default_factory=list)  # words avoid crossing these

    def write(self, p: Point, words: str, cls: str = "words", anchor: str = "start") -> str:
        """Write words with their base line through p, and mark their place as taken.

        Args:
            p: a point of the base line.
            words: the words.
            cls: class of the SVG element.
            anchor: whether p is the start, the middle or the end of the words.

        Returns:
            The SVG element.
        """
        size = width(words, LETTER if cls == "letter" else SIZE) * (1.1 if cls == "title" else 1.0)
        left = p[0] - {"start": 0.0, "middle": size / 2, "end": size}[anchor]
        self.boxes.append((left, p[1] - 10.5, left + size, p[1] + 3.5))
        return text(p, words, f"{cls} {anchor}")

    def put(self, words: str, target: Box, away: Point, cls: str = "words") -> list[str]:
        """Write words at the best free place near a box, and mark this place as taken.

        Args:
            words: the words.
            target: the box that the words name.
            away: a point; places on the far side of the box are preferred.
            cls: class of the SVG element.

        Returns:
            The words, with a line to the box if they are far from it; [] if there is no free place.
        """
        half = (width(words, LETTER if cls == "letter" else SIZE) / 2 + 1, HEIGHT / 2)
        outward = unit(away, middle(target)) if distance(middle(target), away) > 2 else (1.0, 0.0)
        x, y = (2 * h + max(_GAPS) + 2 for h in half)
        zone = target[0] - x, target[1] - y, target[2] + x, target[3] + y
        sizes = sorted(((overlap(b, zone), b) for b in self.boxes), reverse=True)
        near = [b for size, b in sizes if size > 0]
        best: tuple[float, Point, float] = (inf, (0.0, 0.0), 0.0)
        for gap in _GAPS:
            for k in range(_DIRECTIONS):
                c, s = cos(2 * pi * k / _DIRECTIONS), sin(2 * pi * k / _DIRECTIONS)
                cost = 0.9 * gap + 7 * (1 - (c * outward[0] + s * outward[1]))
                if cost >= best[0]:
                    continue
                centre = _clear_of(target, half, (c, s), gap)
                around = _box(centre, half, 1)
                if not self._inside(around) or any(_meet(around, box) for box in near):
                    continue
                cost += self._crossed(around)
                if round(cost, 3) < round(best[0], 3):
                    best = (cost, centre, gap)
        cost, centre, gap = best
        if cost == inf:
            return []
        box = _box(centre, half)
        leader = _leader(box, target) if gap >= _LEADER else None
        self.boxes.append(box)
        if leader:
            self.segments.append(leader)
        name = text((centre[0], centre[1] + 4.1), words, f"{cls} middle")
        return [line(*leader, "leader"), name] if leader else [name]

    def _inside(self, box: Box) -> bool:
        """Return whether a box is inside the area."""
        return (box[2] - box[0]) * (box[3] - box[1]) - overlap(box, self.area) <= 1e-6

    def _crossed(self, box: Box) -> float:
        """Return the cost of the lines that words in a box would cross."""
        return min(_CROSSED * sum(_crosses(a, b, box) for a, b in self.segments), _MOST_CROSSED)


def _box(centre: Point, half: Point, grow: float = 0.0) -> Box:
    x, y = half[0] + grow, half[1] + grow
    return centre[0] - x, centre[1] - y, centre[0] + x, centre[1] + y


def _clear_of(target: Box, half: Point, direction: Point, gap: float) -> Point:
    """Return the centre of a name at distance ``gap`` from ``target`` in a direction; ``half``: half its size."""
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
