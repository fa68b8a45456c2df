"""Draw wheels seen from above, frames and the ICR, and the legend that explains their symbols."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, cos, degrees, hypot, pi, sin
from typing import NamedTuple

from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.figures.figure import AT_ORIGIN, WIDTH, Pose, View, moved
from wmrgen.report.figures.paper import (
    Box,
    Paper,
    Point,
    Segment,
    along,
    arrow,
    bar,
    bounds,
    circle,
    clip,
    distance,
    hull,
    line,
    metres,
    polygon,
    unit,
    width,
)
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType

_ARROW = 13.0  # px: length of the arrow of the rolling direction
_SYMBOL, _SPACE, _ROW = (
    22.0,
    12.0,
    18.0,
)  # px: width of a symbol in the legend, space after an entry, row height


class Placed(NamedTuple):
    """A wheel on paper."""

    wheel: Wheel
    pivot: Point  # A
    centre: Point  # contact point B
    ahead: Point  # rolling direction e
    half: Point  # half its length and half its width [px]

    @property
    def left(self) -> Point:
        """Return the lateral direction n on paper."""
        return self.ahead[1], -self.ahead[0]

    @property
    def box(self) -> Box:
        """Return the box around the outline."""
        ends = [along(self.centre, self.ahead, i * self.half[0]) for i in (1, -1)]
        return bounds([along(end, self.left, j * self.half[1]) for end in ends for j in (1, -1)])

    @property
    def nose(self) -> Point:
        """Return the end of the arrow of the rolling direction."""
        return along(self.centre, self.ahead, self.half[0] + _ARROW)

    @property
    def reach(self) -> Box:
        """Return the box around the wheel and its pivot; for a castor, around the area over which it swivels."""
        if not self.wheel.turns:
            return self.box
        arm = distance(self.centre, self.pivot) if self.wheel.kind.swivels else 3.0
        a, b = self.box, bounds([self.pivot], arm)
        return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def contact(w: Wheel, heading: float) -> Point:
    """Return the contact point B = A + d e + o n [m] at a heading [rad]."""
    b = w.contact(complex(cos(heading), sin(heading)))
    return b.real, b.imag


def placed(w: Wheel, heading: float, view: View, pose: Pose = AT_ORIGIN) -> Placed:
    """Place a wheel on paper.

    Args:
        w: the wheel.
        heading: its heading in the robot frame [rad].
        view: the view of the frame in which the pose is given.
        pose: the pose of the robot.

    Returns:
        The wheel on paper.
    """
    radius = max(float(w.nominal.r) * view.scale, 2.5)
    wide = max(w.kind.glyph.width * radius / 2, min(3.0, 0.9 * radius))
    pivot, centre = (view.on(moved(p, pose)) for p in ((w.pivot.real, w.pivot.imag), contact(w, heading)))
    return Placed(w, pivot, centre, view.way(heading + pose[2]), (radius, wide))


def extremes(w: Wheel, heading: float) -> list[Point]:
    """Return points [m] whose box contains the drawing of a wheel."""
    (x, y), r = contact(w, heading), float(w.nominal.r)
    c, s = (r, r) if w.kind.glyph.ball else (r * cos(heading), r * sin(heading))
    a, b, arm = w.pivot.real, w.pivot.imag, hypot(float(w.nominal.d), float(w.nominal.o)) * w.kind.swivels
    return [(a + arm, b + arm), (a - arm, b - arm), (x + c, y + s), (x - c, y - s)]


def body(p: Placed, fine: bool = True) -> list[str]:
    """Draw tyre or ball, the arm of a castor and the pivot; if ``fine``, also rollers and the circle of a castor."""
    w = p.wheel
    if w.kind.glyph.ball:
        return [circle(p.centre, p.half[0], f"wheel {w.type}"), circle(p.centre, 1.6, "dot")]
    offset = distance(p.pivot, p.centre)
    elements = [circle(p.pivot, offset, "swivel")] if w.kind.swivels and fine else []
    turn = degrees(atan2(p.ahead[0], -p.ahead[1]))
    elements.append(bar(p.centre, (p.half[1], p.half[0]), min(3.0, p.half[1]), turn, f"wheel {w.type}"))
    if w.kind.rollers and fine:
        elements += [line(a, b, "roller") for a, b in _rollers(p)]
    if w.turns and offset:
        elements.append(line(p.pivot, p.centre, "arm"))
    return [*elements, circle(p.pivot, 2.8, "pivot")] if w.turns else elements


def direction(p: Placed) -> list[str]:
    """Draw the arrow of positive rolling."""
    if not p.wheel.has_spin:
        return []
    return arrow(along(p.centre, p.ahead, p.half[0] + 2), p.nose, "roll", 4.0)


def _rollers(p: Placed) -> Iterator[Segment]:
    """Yield the roller axes at the ground: parallel lines at gamma from the wheel plane, cut at the tyre."""
    c, s = cos(p.wheel.gamma), sin(p.wheel.gamma)
    a, b = p.half[0] - 1.2, p.half[1] - 1.2
    gap = min(9.0, max(4.5, b / 2.5))
    count = int((abs(s) * a + abs(c) * b) / gap)
    for k in range(-count, count + 1):
        cut = clip((-s * k * gap, c * k * gap), (c, s), (-a, -b, a, b))  # in the wheel's own frame, e and n
        if cut:
            first, last = (along(along(p.centre, p.ahead, q[0]), p.left, q[1]) for q in cut)
            yield first, last


def chassis(pivots: Sequence[Point]) -> list[str]:
    """Draw the body as a pale shape through all pivots."""
    points = hull(list(pivots))
    if len(points) < 2:
        return []
    return [polygon(points, "chassis") if len(points) > 2 else line(points[0], points[1], "chassis")]


def frame(view: View, names: tuple[str, str, str], paper: Paper, size: float = 34.0) -> list[str]:
    """Draw the axes of a frame.

    Args:
        view: the view of the frame.
        names: names of the x axis, the y axis and the origin.
        paper: the paper, on which the places are marked as taken.
        size: length of the axes [px].

    Returns:
        The SVG elements.
    """
    p = view.origin
    x, y = view.x, view.way(pi / 2)
    tips = along(p, x, size), along(p, y, size)
    paper.boxes += [bounds([p, tip], 3) for tip in tips]
    lines = [line(p, tip, "halo") for tip in tips]
    for tip in tips:
        lines += arrow(p, tip, "frame")
    places = (
        along(along(p, x, size - 2), y, -8),
        along(along(p, y, size - 2), x, -8),
        along(along(p, x, -8), y, -8),
    )
    for name, (left, base) in zip(names, places, strict=True):
        lines.append(paper.write((left, base + 4), name, "letter", "middle"))
    return lines


def towed(front: Point, coupling: Point, axle: Point, half: float) -> tuple[list[str], tuple[Point, Point]]:
    """Draw a trailer.

    Args:
        front: the axle in front of it, on paper.
        coupling: its coupling, on paper.
        axle: its axle, on paper.
        half: half the length of its axle [px].

    Returns:
        The SVG elements, and the ends of its axle.
    """
    way = unit(axle, coupling)
    side, turn = (way[1], -way[0]), degrees(atan2(way[0], -way[1]))
    ends = along(axle, side, half), along(axle, side, -half)
    elements = [
        line(front, coupling, "line"), line(coupling, axle, "bar"), line(*ends, "bar"), circle(coupling, 2.8, "pivot"),
        *(bar(end, (2.5, 8.0), 2.0, turn, "trailer") for end in ends),
    ]  # fmt: skip
    return elements, ends


def icr_mark(p: Point) -> list[str]:
    """Draw the mark of the ICR."""
    return [circle(p, 5.0, "icr"), circle(p, 1.7, "icr-dot")]


def legend(entries: Sequence[tuple[str, str]], top: float, paper: Paper) -> tuple[list[str], float]:
    """Draw a legend.

    Args:
        entries: symbols with their words.
        top: upper end of the legend [px].
        paper: the paper.

    Returns:
        The SVG elements, and the height of the legend [px].
    """
    x, y = 16.0, top + 8
    lines: list[str] = []
    for symbol, words in entries:
        size = _SYMBOL + width(words) + _SPACE
        if x + size > WIDTH - 4 and x > 16:
            x, y = 16.0, y + _ROW
        lines += [*_symbol(symbol, x + 8, y), paper.write((x + _SYMBOL, y + 4), words, "key")]
        x += size
    return lines, y + 10 - top


def entries(kinds: list[WheelType], wheels: Sequence[Wheel]) -> list[tuple[str, str]]:
    """Return the entries of the legend: each wheel type with its radii, and the marks that occur."""
    found = []
    for kind in kinds:
        alike = [w for w in wheels if w.kind is kind]
        found.append((kind.name, kind.noun + _radii(alike)))
    if any(kind.has_spin for kind in kinds):
        found.append(("roll", "positive rolling"))
    if any(kind.turns for kind in kinds):
        found.append(("pivot", "pivot"))
    if any(kind.rollers for kind in kinds):
        found.append(("roller", "roller axis at the ground"))
    return found


def _radii(wheels: Sequence[Wheel]) -> str:
    different = {float(w.nominal.r) for w in wheels if w.nominal.r}
    radii = [metres(r) for r in sorted(different)]
    return f", r = {', '.join(radii[:2])}{', …' * (len(radii) > 2)}" if radii else ""


def _symbol(symbol: str, x: float, y: float) -> list[str]:
    if symbol in WHEEL_TYPES:
        glyph = WHEEL_TYPES[symbol].glyph
        if glyph.ball:
            return [circle((x, y), 6, f"wheel {symbol}"), circle((x, y), 1.4, "dot")]
        return [bar((x, y), (glyph.sign, 7), 2, 0, f"wheel {symbol}")]
    symbols = {
        "roll": arrow((x - 8, y), (x + 9, y), "roll", 4.0),
        "pivot": [circle((x, y), 2.8, "pivot")],
        "roller": [line((x - 6, y + 5), (x + 6, y - 5), "roller")],
        "axle": [line((x - 9, y), (x + 10, y), "axle")],
        "icr": icr_mark((x, y)),
        "trailer": [bar((x, y), (6, 4), 1, 0, "trailer")],
    }
    return symbols[symbol]
