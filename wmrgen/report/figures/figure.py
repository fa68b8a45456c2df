"""Assemble a figure: its file, a description and the SVG text; and the views that map the plane to paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from math import cos, sin
from typing import NamedTuple

from wmrgen.codegen.render import render
from wmrgen.report.figures.paper import Box, Point, along, arc, bounds, middle, num, pair, polygon
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

WIDTH, SHOWN = 480.0, 420.0  # px: width of every figure, and its width on a page, where two fit side by side
Group = tuple[str, Sequence[str]]  # attributes of an SVG group, and its elements
UP, RIGHT = (0.0, -1.0), (1.0, 0.0)  # direction of the x axis on paper: in top views, in the world frame
Pose = tuple[float, float, float]  # x, y [m], theta [rad]
AT_ORIGIN: Pose = (0.0, 0.0, 0.0)


class View(NamedTuple):
    """A map from a frame to paper."""

    scale: float  # px/m
    origin: Point  # origin of the frame, on paper
    x: Point = UP  # direction of the x axis on paper; y points to its left

    def on(self, p: Point) -> Point:
        """Return a point of the frame [m] on paper."""
        (a, b), k = self.x, self.scale
        return self.origin[0] + k * (p[0] * a + p[1] * b), self.origin[1] + k * (p[0] * b - p[1] * a)

    def way(self, angle: float) -> Point:
        """Return a direction of the frame [rad] as a unit vector on paper."""
        (a, b), c, s = self.x, cos(angle), sin(angle)
        return c * a + s * b, c * b - s * a

    def around(self, centre: Point, radius: float, first: float, turn: float, cls: str) -> list[str]:
        """Draw an arc with an arrow head.

        Args:
            centre: centre on paper [px].
            radius: radius on paper [px].
            first: direction of the start, in the frame [rad].
            turn: angle that the arc sweeps [rad].
            cls: class of the SVG elements.

        Returns:
            The SVG elements.
        """
        start, end = (along(centre, self.way(first + k * turn), radius) for k in (0, 1))
        back = self.way(first + turn - (6.0 / radius if turn > 0 else -6.0 / radius))
        root, out = along(centre, back, radius), self.way(first + turn)
        head = (end, along(root, out, 2.4), along(root, out, -2.4))
        return [arc(centre, start, end, turn, cls), polygon(head, f"{cls} head")]


def fitted(points: Sequence[Point], area: Box, x: Point = UP, most: float = float("inf")) -> View:
    """Return the view that shows all points in the middle of an area.

    Args:
        points: points of the frame [m].
        area: area on paper [px].
        x: direction of the x axis on paper.
        most: largest scale [px/m].

    Returns:
        The view.
    """
    raw = View(1.0, (0.0, 0.0), x)
    box = bounds([raw.on(p) for p in points])
    wide, high = max(box[2] - box[0], 1e-9), max(box[3] - box[1], 1e-9)
    scale = min((area[2] - area[0]) / wide, (area[3] - area[1]) / high, most)
    (x0, y0), (x1, y1) = middle(box), middle(area)
    return View(scale, (x1 - scale * x0, y1 - scale * y0), x)


def moved(p: Point, pose: Pose) -> Point:
    """Transform a point of the robot frame to the frame of the pose."""
    x, y, theta = pose
    return x + cos(theta) * p[0] - sin(theta) * p[1], y + sin(theta) * p[0] + cos(theta) * p[1]


class Figure(NamedTuple):
    """A finished figure."""

    file: str
    alt: str  # a sentence that describes the figure
    svg: str


def figure(file: str, alt: str, height: float, groups: Iterable[Group]) -> Figure:
    """Return the figure of finished elements.

    Args:
        file: file name.
        alt: a sentence that describes the figure.
        height: height [px].
        groups: groups of SVG elements.

    Returns:
        The figure.
    """
    svg = render(
        "drawing/figure.svg.j2", width=num(WIDTH), height=num(height), title=escape(alt),
        shown_width=num(SHOWN), shown_height=num(height * SHOWN / WIDTH), groups=list(groups),
        fills=[(name, kind.glyph.fill) for name, kind in WHEEL_TYPES.items()],
    )  # fmt: skip
    return Figure(file, alt, svg)


def panel(view: View) -> str:
    """Return attributes that describe the view of a group: ``data-scale`` [px/m], ``data-origin`` [px]."""
    return f' data-scale="{view.scale:.6g}" data-origin="{pair(view.origin)}"'


def attribute(name: str, value: str) -> str:
    """Return a data attribute with an escaped value."""
    return f' data-{name}="{escape(value)}"'
