"""How each wheel looks from above."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, sin
from typing import TYPE_CHECKING

from wmrgen.backends.drawing.svg import arrow, bar, circle, line
from wmrgen.backends.drawing.view import Box, Point, View, bounds, clip

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel

ARROW = 17.0  # px


@dataclass(frozen=True, slots=True)
class Placed:
    """A wheel on paper. ``pivot``: A; ``centre``: contact B; ``ahead``: e; ``half``: half length, width."""

    wheel: Wheel
    pivot: Point
    centre: Point
    ahead: Point
    half: Point
    heading: float

    @property
    def left(self) -> Point:
        """The lateral direction n on paper."""
        return self.ahead[1], -self.ahead[0]

    def corners(self) -> list[Point]:
        """The corners of the wheel's outline."""
        (a, b), (ex, ey), (nx, ny) = self.half, self.ahead, self.left
        x, y = self.centre
        return [
            (x + i * a * ex + j * b * nx, y + i * a * ey + j * b * ny)
            for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ]

    def box(self) -> Box:
        """The box around the outline."""
        return bounds(self.corners())

    def nose(self) -> Point:
        """Where the rolling-direction arrow ends."""
        reach = self.half[0] + ARROW
        return self.centre[0] + reach * self.ahead[0], self.centre[1] + reach * self.ahead[1]


def contact(w: Wheel, heading: float) -> Point:
    """B = A + d e + o n [m]."""
    g = w.nominal
    x, y, d, o = float(g.x), float(g.y), float(g.d), float(g.o)
    return x + d * cos(heading) - o * sin(heading), y + d * sin(heading) + o * cos(heading)


def place(w: Wheel, heading: float, view: View) -> Placed:
    """The wheel on paper at a heading [rad]."""
    radius = max(float(w.nominal.r) * view.scale, 2.5)
    width = max(w.kind.glyph.width * radius / 2, min(3.5, 0.9 * radius))
    return Placed(
        w, view.at(float(w.nominal.x), float(w.nominal.y)), view.at(*contact(w, heading)),
        view.turn(cos(heading), sin(heading)), (radius, width), heading,
    )  # fmt: skip


def body(p: Placed) -> list[str]:
    """Tyre or ball, rollers, the arm of a castor, the pivot."""
    w = p.wheel
    if w.kind.glyph.ball:
        return [circle(p.centre, p.half[0], f"wheel {w.type}"), circle(p.centre, 1.6, "dot")]
    lines = []
    if w.kind.swivels:
        lines.append(circle(p.pivot, _distance(p.pivot, p.centre), "swivel"))
    lines.append(
        bar(p.centre, (p.half[1], p.half[0]), min(3.0, p.half[1]), -degrees(p.heading), f"wheel {w.type}")
    )
    if w.kind.rollers:
        lines += [line(a, b, "roller") for a, b in _rollers(p)]
    if w.turns:
        if _distance(p.pivot, p.centre) > 0.5:
            lines.append(line(p.pivot, p.centre, "arm"))
        lines.append(circle(p.pivot, 3.2, "pivot"))
    return lines


def direction(p: Placed) -> list[str]:
    """The arrow of positive rolling."""
    if not p.wheel.has_spin:
        return []
    start = (p.centre[0] + (p.half[0] + 2) * p.ahead[0], p.centre[1] + (p.half[0] + 2) * p.ahead[1])
    return arrow(start, p.nose(), "roll", 4.2)


def _distance(a: Point, b: Point) -> float:
    return float(((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5)


def _rollers(p: Placed) -> list[tuple[Point, Point]]:
    """Roller axes at the ground, cut at the tyre: parallel lines at gamma from the wheel plane."""
    c, s = cos(p.wheel.gamma), sin(p.wheel.gamma)
    a, b = p.half[0] - 1.2, p.half[1] - 1.2
    reach = abs(s) * a + abs(c) * b
    gap = min(9.0, max(5.0, b / 2.5))
    count = int(reach / gap)
    found = []
    for k in range(-count, count + 1):
        cut = clip((-s * k * gap, c * k * gap), (c, s), (-a, -b, a, b))
        if cut:
            found.append((_out(p, cut[0]), _out(p, cut[1])))
    return found


def _out(p: Placed, q: Point) -> Point:
    """From the wheel's own frame (along e, along n) to paper."""
    (ex, ey), (nx, ny) = p.ahead, p.left
    return p.centre[0] + q[0] * ex + q[1] * nx, p.centre[1] + q[0] * ey + q[1] * ny
