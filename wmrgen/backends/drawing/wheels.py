"""How each wheel looks from above."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, sin
from typing import TYPE_CHECKING

from wmrgen.backends.drawing.svg import arrow, bar, circle, line
from wmrgen.backends.drawing.view import Box, Point, View, along, bounds, clip, distance

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
        ends = [along(self.centre, self.ahead, i * self.half[0]) for i in (1, 1, -1, -1)]
        return [along(end, self.left, j * self.half[1]) for end, j in zip(ends, (1, -1, -1, 1), strict=True)]

    def box(self) -> Box:
        """The box around the outline."""
        return bounds(self.corners())

    def nose(self) -> Point:
        """Where the rolling-direction arrow ends."""
        return along(self.centre, self.ahead, self.half[0] + ARROW)


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
        lines.append(circle(p.pivot, distance(p.pivot, p.centre), "swivel"))
    lines.append(
        bar(p.centre, (p.half[1], p.half[0]), min(3.0, p.half[1]), -degrees(p.heading), f"wheel {w.type}")
    )
    if w.kind.rollers:
        lines += [line(a, b, "roller") for a, b in _rollers(p)]
    if w.turns:
        if distance(p.pivot, p.centre) > 0.5:
            lines.append(line(p.pivot, p.centre, "arm"))
        lines.append(circle(p.pivot, 3.2, "pivot"))
    return lines


def direction(p: Placed) -> list[str]:
    """The arrow of positive rolling."""
    if not p.wheel.has_spin:
        return []
    return arrow(along(p.centre, p.ahead, p.half[0] + 2), p.nose(), "roll", 4.2)


def _rollers(p: Placed) -> list[tuple[Point, Point]]:
    """Roller axes at the ground, cut at the tyre: parallel lines at gamma from the wheel plane."""
    c, s = cos(p.wheel.gamma), sin(p.wheel.gamma)
    a, b = p.half[0] - 1.2, p.half[1] - 1.2
    reach = abs(s) * a + abs(c) * b
    gap = min(9.0, max(5.0, b / 2.5))
    count = int(reach / gap)
    axes = []
    for k in range(-count, count + 1):
        cut = clip((-s * k * gap, c * k * gap), (c, s), (-a, -b, a, b))
        if cut:
            axes.append((_out(p, cut[0]), _out(p, cut[1])))
    return axes


def _out(p: Placed, q: Point) -> Point:
    """From the wheel's own frame (along e, along n) to paper."""
    return along(along(p.centre, p.ahead, q[0]), p.left, q[1])
