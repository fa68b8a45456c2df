"""What is drawn of a wheel seen from above and of the ICR, and the line of symbols that explains the picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, degrees, sin
from typing import TYPE_CHECKING

from wmrgen.backends.drawing.paper import (
    Box,
    Point,
    Segment,
    along,
    arrow,
    bar,
    bounds,
    circle,
    clip,
    distance,
    line,
    text,
)
from wmrgen.wheels import WHEEL_TYPES

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel
    from wmrgen.wheels import WheelType

_ARROW = 17.0  # length of the rolling-direction arrow
_CHARACTER = 5.7  # mean width of a sans-serif character at 11.5 px, with reserve
_SYMBOL, _SPACE, _ROW = 24.0, 14.0, 20.0  # of an entry of the legend


@dataclass(frozen=True, slots=True)
class Placed:
    """A wheel on paper. ``pivot``: A; ``centre``: contact B; ``ahead``: e; ``half``: half length, width."""

    wheel: Wheel
    pivot: Point
    centre: Point
    ahead: Point
    half: Point
    heading: float  # [rad]

    @property
    def left(self) -> Point:
        """The lateral direction n on paper."""
        return self.ahead[1], -self.ahead[0]

    @property
    def box(self) -> Box:
        """The box around the outline."""
        ends = [along(self.centre, self.ahead, i * self.half[0]) for i in (1, -1)]
        return bounds([along(end, self.left, j * self.half[1]) for end in ends for j in (1, -1)])

    @property
    def nose(self) -> Point:
        """Where the rolling-direction arrow ends."""
        return along(self.centre, self.ahead, self.half[0] + _ARROW)


def contact(w: Wheel, heading: float) -> Point:
    """B = A + d e + o n [m]."""
    g = w.nominal
    x, y, d, o = float(g.x), float(g.y), float(g.d), float(g.o)
    return x + d * cos(heading) - o * sin(heading), y + d * sin(heading) + o * cos(heading)


def body(p: Placed) -> list[str]:
    """Tyre or ball, rollers, the arm of a castor, the pivot."""
    w = p.wheel
    if w.kind.glyph.ball:
        return [circle(p.centre, p.half[0], f"wheel {w.type}"), circle(p.centre, 1.6, "dot")]
    arm = distance(p.pivot, p.centre)
    lines = [circle(p.pivot, arm, "swivel")] if w.kind.swivels else []
    half = (p.half[1], p.half[0])
    lines.append(bar(p.centre, half, min(3.0, p.half[1]), -degrees(p.heading), f"wheel {w.type}"))
    if w.kind.rollers:
        lines += [line(a, b, "roller") for a, b in _rollers(p)]
    if w.turns and arm:
        lines.append(line(p.pivot, p.centre, "arm"))
    return [*lines, circle(p.pivot, 3.2, "pivot")] if w.turns else lines


def direction(p: Placed) -> list[str]:
    """The arrow of positive rolling."""
    if not p.wheel.has_spin:
        return []
    return arrow(along(p.centre, p.ahead, p.half[0] + 2), p.nose, "roll", 4.2)


def _rollers(p: Placed) -> Iterator[Segment]:
    """Roller axes at the ground, cut at the tyre: parallel lines at gamma from the wheel plane."""
    c, s = cos(p.wheel.gamma), sin(p.wheel.gamma)
    a, b = p.half[0] - 1.2, p.half[1] - 1.2
    gap = min(9.0, max(5.0, b / 2.5))
    count = int((abs(s) * a + abs(c) * b) / gap)
    for k in range(-count, count + 1):
        cut = clip((-s * k * gap, c * k * gap), (c, s), (-a, -b, a, b))  # in the wheel's own frame, e and n
        if cut:
            first, last = (along(along(p.centre, p.ahead, q[0]), p.left, q[1]) for q in cut)
            yield first, last


def icr_mark(p: Point) -> list[str]:
    """The sign of the ICR."""
    return [circle(p, 5.5, "icr"), circle(p, 1.8, "icr-dot")]


def legend(
    kinds: list[WheelType], axles: bool, icr: bool, width: float, top: float
) -> tuple[list[str], float]:
    """Lines that explain what occurs in the picture, and their height."""
    x, y = 24.0, top
    lines: list[str] = []
    for symbol, words in _entries(kinds, axles, icr):
        size = _SYMBOL + len(words) * _CHARACTER + _SPACE
        if x + size > width - 16 and x > 24:
            x, y = 24.0, y + _ROW
        lines += [*_symbol(symbol, x + 8, y), text((x + _SYMBOL, y + 4), words, "key")]
        x += size
    return lines, y + _ROW - top


def _entries(kinds: list[WheelType], axles: bool, icr: bool) -> list[tuple[str, str]]:
    occurring = (
        ("roll", "positive rolling", any(kind.has_spin for kind in kinds)),
        ("pivot", "pivot", any(kind.turns for kind in kinds)),
        ("roller", "roller axis at the ground (on top: mirrored)", any(kind.rollers for kind in kinds)),
        ("axle", "zero-motion line", axles),
        ("icr", "instantaneous centre of rotation", icr),
    )
    return [
        *((kind.name, kind.noun) for kind in kinds),
        *((s, words) for s, words, occurs in occurring if occurs),
    ]


def _symbol(symbol: str, x: float, y: float) -> list[str]:
    if symbol in WHEEL_TYPES:
        glyph = WHEEL_TYPES[symbol].glyph
        if glyph.ball:
            return [circle((x, y), 6, f"wheel {symbol}"), circle((x, y), 1.4, "dot")]
        return [bar((x, y), (glyph.sign, 7), 2, 0, f"wheel {symbol}")]
    symbols = {
        "roll": arrow((x - 8, y), (x + 9, y), "roll", 4.2),
        "pivot": [circle((x, y), 3.2, "pivot")],
        "roller": [line((x - 6, y + 5), (x + 6, y - 5), "roller")],
        "axle": [line((x - 9, y), (x + 10, y), "axle")],
        "icr": icr_mark((x, y)),
    }
    return symbols[symbol]
