"""The whole picture of a robot, layer by layer."""

from __future__ import annotations

from math import cos, degrees, floor, log10, pi, sin
from typing import TYPE_CHECKING

from wmrgen.backends.drawing.example import Example, example, extent
from wmrgen.backends.drawing.labels import Label, Paper
from wmrgen.backends.drawing.legend import Signs, icr_mark, legend
from wmrgen.backends.drawing.svg import arrow, line, num, pair, polygon, text
from wmrgen.backends.drawing.view import (
    Box,
    Point,
    View,
    along,
    bounds,
    clip,
    distance,
    fit,
    hull,
    inside,
    middle,
    unit,
)
from wmrgen.backends.drawing.wheels import Placed, body, contact, direction, place
from wmrgen.render import render
from wmrgen.wheels import WHEEL_TYPES

if TYPE_CHECKING:
    from wmrgen.layout.records import Robot
    from wmrgen.robot import Derivation

WIDTH, TALLEST = 720.0, 560.0
MARGIN = (92.0, 52.0, 92.0, 64.0)
_CROWD = 24  # from this many wheels on, names that find no free place are left to the tooltips


def picture(derivation: Derivation) -> str:
    """The SVG text."""
    robot = derivation.robot
    shown = example(robot, derivation.mobility)
    shown = _near(robot, shown)
    view, height = fit(_points(robot, shown), WIDTH, TALLEST, MARGIN)
    placed = [place(w, shown.headings[w.name], view) for w in robot.wheels]
    axles = _axles(placed, shown, view)
    paper = Paper(view.area)
    frame = _frame(view, paper)
    icr = _icr(shown, view, paper)
    scale = _scale_bar(view, height, paper)
    labels = _names(placed, paper, axles)
    kinds = tuple(kind for name, kind in WHEEL_TYPES.items() if any(w.type == name for w in robot.wheels))
    signs = Signs(kinds, bool(axles), bool(icr), any(w.turns for w in robot.wheels))
    fills = [(name, kind.glyph.fill) for name, kind in WHEEL_TYPES.items()]
    keys, extra = legend(signs, WIDTH, height + 6)
    return render(
        "drawing/layout.svg.j2", width=num(WIDTH), height=num(height + extra + 4), name=robot.name,
        scale=repr(round(view.scale, 6)), origin=pair(view.origin), fills=fills, rule=num(height - 8),
        page_width=num(WIDTH - 1), page_height=num(height + extra + 3), right=num(WIDTH - 16),
        chassis=_chassis(placed), axles=[line(a, b, "axle") for a, b in axles],
        wheels=[(p.wheel.name, p.wheel.type, pair(p.centre), body(p)) for p in placed],
        arrows=[e for p in placed for e in direction(p)], frame=frame, icr=icr, scale_bar=scale,
        labels=labels, keys=keys,
    )  # fmt: skip


def _near(robot: Robot, shown: Example) -> Example:
    """An ICR too far away to be drawn is left out; its axle lines still point there."""
    centre, size = extent(robot.wheels)
    if shown.icr is None or distance(shown.icr, centre) <= 4 * size:
        return shown
    return Example(shown.headings, None)


def _points(robot: Robot, shown: Example) -> list[Point]:
    """What must be on the page [m]: tyres, pivots, P and the ICR."""
    points: list[Point] = [(0.0, 0.0)]
    for w in robot.wheels:
        h, r = shown.headings[w.name], float(w.nominal.r)
        x, y = contact(w, h)
        points.append((float(w.nominal.x), float(w.nominal.y)))
        points += [(x + k * r * cos(h), y + k * r * sin(h)) for k in (-1, 1)]
        if w.kind.glyph.ball:
            points += [(x, y - r), (x, y + r)]
    r = 2.5 * max(float(w.nominal.r) for w in robot.wheels)  # a lone wheel does not fill the page
    return [*points, (-r, -r), (r, r), *([shown.icr] if shown.icr else [])]


def _axles(placed: list[Placed], shown: Example, view: View) -> list[tuple[Point, Point]]:
    """Zero-motion lines: to the ICR and a little beyond, or across the page where there is none.

    Wheels on one line share it: the longest piece stays.
    """
    longest: dict[tuple[float, float], tuple[Point, Point]] = {}
    target = view.at(*shown.icr) if shown.icr else None
    for p in placed:
        if not p.wheel.kind.constrains:
            continue
        if target is None or p.wheel.kind.fixed_axle:
            cut = clip(p.centre, p.left, view.area)
        else:
            cut = _towards(p, target, view.area)
        if cut:
            key = _line(p)
            old = longest.get(key)
            longest[key] = cut if old is None or distance(*cut) > distance(*old) else old
    return list(longest.values())


def _line(p: Placed) -> tuple[float, float]:
    """The zero-motion line of a wheel: direction [deg] and distance from the page's corner [px], rounded."""
    angle = round(degrees(p.heading) % 180, 1) % 180
    nx, ny = cos(p.heading % pi), sin(p.heading % pi)
    return angle, round(p.centre[0] * ny + p.centre[1] * nx, 0)


def _towards(p: Placed, target: Point, area: Box) -> tuple[Point, Point] | None:
    if distance(p.centre, target) < 1.0:
        return clip(p.centre, p.left, area)
    way = unit(p.centre, target)
    ends = along(p.centre, way, -p.half[1] - 16.0), along(target, way, 22.0)
    return ends if all(inside(e, area) for e in ends) else clip(p.centre, way, area)


def _chassis(placed: list[Placed]) -> list[str]:
    """A pale shape through all pivots: where the body is."""
    points = hull([p.pivot for p in placed])
    if len(points) < 2:
        return []
    return [polygon(points, "chassis")] if len(points) > 2 else [line(points[0], points[1], "chassis")]


def _frame(view: View, paper: Paper) -> list[str]:
    """P with the x and y axes of the robot frame."""
    p, size = view.origin, 46.0
    tip_x, tip_y = (p[0], p[1] - size), (p[0] - size, p[1])
    paper.boxes += [bounds([p, tip_x], 4), bounds([p, tip_y], 4)]
    paper.boxes += [bounds([(tip_x[0] + 9, tip_x[1] + 6)], 6), bounds([(tip_y[0] + 4, tip_y[1] - 9)], 6)]
    paper.boxes.append(bounds([(p[0] + 8, p[1] + 11)], 6))
    return [
        line(p, tip_x, "halo"), line(p, tip_y, "halo"),
        *arrow(p, tip_x, "x-axis"), *arrow(p, tip_y, "y-axis"),
        text((tip_x[0] + 9, tip_x[1] + 9), "x", "axis"), text((tip_y[0] + 4, tip_y[1] - 6), "y", "axis"),
        text((p[0] + 8, p[1] + 14), "P", "axis"),
    ]  # fmt: skip


def _icr(shown: Example, view: View, paper: Paper) -> list[str]:
    if shown.icr is None:
        return []
    p = view.at(*shown.icr)
    paper.boxes.append(bounds([p], 7))
    paper.boxes.append(bounds([(p[0], p[1] - 15)], 10))
    return [*icr_mark(p), text((p[0], p[1] - 11), "ICR", "icr-name")]


def _scale_bar(view: View, height: float, paper: Paper) -> list[str]:
    """A round length of 60 to 150 px, bottom right."""
    power = 10.0 ** floor(log10(150 / view.scale))
    length = next(k for k in (5, 2, 1) if k * power * view.scale <= 150) * power
    right, y = WIDTH - 26.0, height - 24.0
    left = right - length * view.scale
    paper.boxes.append((left - 6, y - 18, right + 6, y + 8))
    words = f"{length:.6g} m"
    ticks = [line((x, y - 4), (x, y + 4), "scale") for x in (left, right)]
    return [
        line((left, y), (right, y), "scale"),
        *ticks,
        text(((left + right) / 2, y - 6), words, "scale-name"),
    ]


def _around(a: Box, b: Box) -> Box:
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def _names(placed: list[Placed], paper: Paper, axles: list[tuple[Point, Point]]) -> list[str]:
    """Names of all wheels, clear of what is drawn."""
    for p in placed:
        paper.boxes.append(p.box())
        if p.wheel.has_spin:
            paper.boxes.append(bounds([along(p.centre, p.ahead, p.half[0]), p.nose()], 4))
        if p.wheel.turns:
            paper.boxes.append(bounds([p.pivot], 4))
    paper.segments += axles
    away = middle(bounds([p.centre for p in placed]))
    labels: list[Label | None] = []
    for p in placed:
        swing = distance(p.centre, p.pivot) if p.wheel.kind.swivels else 0.0
        target = _around(p.box(), bounds([p.pivot], swing)) if p.wheel.turns else p.box()
        labels.append(paper.put(p.wheel.name, target, away, len(placed) > _CROWD))
    lines: list[str] = []
    for label in filter(None, labels):
        lines += [line(*label.leader, "leader")] if label.leader else []
        lines.append(text(label.at, label.words, "name"))
    return lines
