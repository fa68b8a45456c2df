"""A figure: its file, what is seen on it, the SVG text; and where its panels show the plane: scale, place and turn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from math import cos, sin
from typing import NamedTuple

from wmrgen.codegen.render import render
from wmrgen.report.figures.paper import Box, Point, along, arc, bounds, middle, num, pair, polygon
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

WIDTH, SHOWN = 480.0, 420.0  # of every figure, and how wide it is shown: two side by side, words 10.5 px high
Group = tuple[str, Sequence[str]]  # attributes and elements
UP, RIGHT = (0.0, -1.0), (1.0, 0.0)  # where the x axis points on paper: top views, the world
Pose = tuple[float, float, float]
AT_ORIGIN: Pose = (0.0, 0.0, 0.0)


class View(NamedTuple):
    """``scale`` [px/m]; ``origin``: of the frame, on paper; ``x``: its x axis on paper. y points to the left of x."""

    scale: float
    origin: Point
    x: Point = UP

    def on(self, p: Point) -> Point:
        """A point of the frame [m] on paper."""
        (a, b), k = self.x, self.scale
        return self.origin[0] + k * (p[0] * a + p[1] * b), self.origin[1] + k * (p[0] * b - p[1] * a)

    def way(self, angle: float) -> Point:
        """A direction of the frame [rad] on paper."""
        (a, b), c, s = self.x, cos(angle), sin(angle)
        return c * a + s * b, c * b - s * a

    def around(self, centre: Point, radius: float, first: float, turn: float, cls: str) -> list[str]:
        """An arc that sweeps ``turn`` [rad] from the direction ``first``, with a head; ``centre`` and ``radius`` on
        paper."""
        start, end = (along(centre, self.way(first + k * turn), radius) for k in (0, 1))
        back = self.way(first + turn - (6.0 / radius if turn > 0 else -6.0 / radius))
        root, out = along(centre, back, radius), self.way(first + turn)
        head = (end, along(root, out, 2.4), along(root, out, -2.4))
        return [arc(centre, start, end, turn, cls), polygon(head, f"{cls} head")]


def fitted(points: Sequence[Point], area: Box, x: Point = UP, most: float = float("inf")) -> View:
    """The view that shows all points [m] in the middle of ``area``, at most ``most`` px/m."""
    raw = View(1.0, (0.0, 0.0), x)
    box = bounds([raw.on(p) for p in points])
    wide, high = max(box[2] - box[0], 1e-9), max(box[3] - box[1], 1e-9)
    scale = min((area[2] - area[0]) / wide, (area[3] - area[1]) / high, most)
    (x0, y0), (x1, y1) = middle(box), middle(area)
    return View(scale, (x1 - scale * x0, y1 - scale * y0), x)


def moved(p: Point, pose: Pose) -> Point:
    """A point of the robot frame in the frame that the pose is given in."""
    x, y, theta = pose
    return x + cos(theta) * p[0] - sin(theta) * p[1], y + sin(theta) * p[0] + cos(theta) * p[1]


class Figure(NamedTuple):
    """``alt``: a sentence that says what is seen."""

    file: str
    alt: str
    svg: str


def figure(file: str, alt: str, height: float, groups: Iterable[Group]) -> Figure:
    """The figure of finished elements."""
    svg = render(
        "drawing/figure.svg.j2", width=num(WIDTH), height=num(height), title=escape(alt),
        shown_width=num(SHOWN), shown_height=num(height * SHOWN / WIDTH), groups=list(groups),
        fills=[(name, kind.glyph.fill) for name, kind in WHEEL_TYPES.items()],
    )  # fmt: skip
    return Figure(file, alt, svg)


def panel(view: View) -> str:
    """Attributes of a group that say where it shows the plane: ``data-scale`` [px/m], ``data-origin`` [px]."""
    return f' data-scale="{view.scale:.6g}" data-origin="{pair(view.origin)}"'


def attribute(name: str, value: str) -> str:
    """An attribute, its value as text."""
    return f' data-{name}="{escape(value)}"'
