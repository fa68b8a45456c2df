"""The top view of a robot as an SVG picture: wheels to scale, axle lines, rollers at the ground, the ICR."""

from __future__ import annotations

from math import cos, degrees, floor, log10, pi, sin
from typing import TYPE_CHECKING

from wmrgen.backends.drawing.example import Example, example, extent
from wmrgen.backends.drawing.marks import Placed, body, contact, direction, icr_mark, legend
from wmrgen.backends.drawing.paper import (
    Box,
    Paper,
    Point,
    Segment,
    along,
    arrow,
    bounds,
    clip,
    distance,
    hull,
    line,
    middle,
    num,
    pair,
    polygon,
    text,
    unit,
)  # fmt: skip
from wmrgen.render import render
from wmrgen.wheels import WHEEL_TYPES

if TYPE_CHECKING:
    from wmrgen.backends.registry import Facts
    from wmrgen.layout.records import Robot, Wheel
    from wmrgen.robot import Derivation

FILE = "layout.svg"
_WIDTH, _TALLEST = 720.0, 560.0
_MARGIN = (92.0, 52.0, 92.0, 64.0)
_CROWD = 24  # from this many wheels on, names that find no free place are left to the tooltips


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """``layout.svg``"""
    return {FILE: picture(derivation).encode()}


def picture(derivation: Derivation) -> str:
    """The SVG text."""
    robot = derivation.robot
    shown = _near(robot, example(robot, derivation.mobility))
    scale, origin, height = _view(_points(robot, shown))
    paper = Paper((14.0, 14.0, _WIDTH - 14.0, height - 14.0))
    placed = [_placed(w, shown.headings[w.name], scale, origin) for w in robot.wheels]
    icr = _on_paper(shown.icr, scale, origin) if shown.icr else None
    axles = _axles(placed, icr, paper.area)
    signs = [*_frame(origin, paper), *(_icr(icr, paper) if icr else []), *_scale_bar(scale, height, paper)]
    groups = [
        ("", _chassis(placed)),
        ("", [line(*axle, "axle") for axle in axles]),
        *(_group(p) for p in placed),
        ("", [element for p in placed for element in direction(p)]),
        ("", signs),
        ("", _names(placed, paper, axles)),
    ]
    kinds = [kind for name, kind in WHEEL_TYPES.items() if any(w.type == name for w in robot.wheels)]
    keys, extra = legend(kinds, bool(axles), bool(icr), _WIDTH, height + 6)
    return render(
        "drawing/layout.svg.j2", width=num(_WIDTH), height=num(height + extra + 4), name=robot.name,
        scale=repr(round(scale, 6)), origin=pair(origin), rule=num(height - 8), page_width=num(_WIDTH - 1),
        page_height=num(height + extra + 3), right=num(_WIDTH - 16), groups=groups, keys=keys,
        fills=[(name, kind.glyph.fill) for name, kind in WHEEL_TYPES.items()],
    )  # fmt: skip


def _near(robot: Robot, shown: Example) -> Example:
    """An ICR too far away to be drawn is left out; its axle lines still point there."""
    centre, size = extent(robot.wheels)
    far = shown.icr is not None and distance(shown.icr, centre) > 4 * size
    return Example(shown.headings, None) if far else shown


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


def _view(points: list[Point]) -> tuple[float, Point, float]:
    """The scale [px/m] that shows all points [m], where P lies on paper, and the height of the page."""
    box = back, right, front, left = bounds(points)
    inner_x, inner_y = _WIDTH - _MARGIN[0] - _MARGIN[2], _TALLEST - _MARGIN[1] - _MARGIN[3]
    scale = min(inner_x / max(left - right, 1e-6), inner_y / max(front - back, 1e-6))
    height = max(scale * (front - back), 170.0) + _MARGIN[1] + _MARGIN[3]
    x, y = middle(box)
    centre = (_MARGIN[0] + inner_x / 2, _MARGIN[1] + (height - _MARGIN[1] - _MARGIN[3]) / 2)
    return scale, (centre[0] + y * scale, centre[1] + x * scale), height


def _on_paper(p: Point, scale: float, origin: Point) -> Point:
    """A point of the robot frame [m] on paper: x forward is up, y left is left."""
    return origin[0] - p[1] * scale, origin[1] - p[0] * scale


def _placed(w: Wheel, heading: float, scale: float, origin: Point) -> Placed:
    """The wheel on paper at a heading [rad]."""
    radius = max(float(w.nominal.r) * scale, 2.5)
    width = max(w.kind.glyph.width * radius / 2, min(3.5, 0.9 * radius))
    pivot = (float(w.nominal.x), float(w.nominal.y))
    centre, ahead = contact(w, heading), (-sin(heading), -cos(heading))
    return Placed(
        w, _on_paper(pivot, scale, origin), _on_paper(centre, scale, origin), ahead, (radius, width), heading
    )


def _group(p: Placed) -> tuple[str, list[str]]:
    """Attributes and elements of a wheel."""
    name, kind = p.wheel.name, p.wheel.type
    attributes = f' data-wheel="{name}" data-type="{kind}" data-contact="{pair(p.centre)}"'
    return attributes, [f"<title>{name}: {kind}</title>", *body(p)]


def _axles(placed: list[Placed], icr: Point | None, area: Box) -> list[Segment]:
    """Zero-motion lines: to the ICR and a little beyond, or across the page where there is none.

    Wheels on one line share it: the longest piece stays.
    """
    longest: dict[tuple[float, float], Segment] = {}
    for p in placed:
        if not p.wheel.kind.constrains:
            continue
        towards = icr is not None and not p.wheel.kind.fixed_axle
        cut = _towards(p, icr, area) if icr and towards else clip(p.centre, p.left, area)
        if cut:
            longest[_line(p)] = max(longest.get(_line(p), cut), cut, key=lambda piece: distance(*piece))
    return list(longest.values())


def _line(p: Placed) -> tuple[float, float]:
    """The zero-motion line of a wheel: direction [deg] and distance from the page's corner [px], rounded."""
    angle = round(degrees(p.heading) % 180, 1) % 180
    nx, ny = cos(p.heading % pi), sin(p.heading % pi)
    return angle, round(p.centre[0] * ny + p.centre[1] * nx, 0)


def _towards(p: Placed, target: Point, area: Box) -> Segment | None:
    if distance(p.centre, target) < 1.0:
        return clip(p.centre, p.left, area)
    way = unit(p.centre, target)
    ends = along(p.centre, way, -p.half[1] - 16.0), along(target, way, 22.0)
    inside = all(area[0] <= x <= area[2] and area[1] <= y <= area[3] for x, y in ends)
    return ends if inside else clip(p.centre, way, area)


def _chassis(placed: list[Placed]) -> list[str]:
    """A pale shape through all pivots: where the body is."""
    points = hull([p.pivot for p in placed])
    if len(points) < 2:
        return []
    return [polygon(points, "chassis") if len(points) > 2 else line(points[0], points[1], "chassis")]


def _frame(p: Point, paper: Paper) -> list[str]:
    """P with the x and y axes of the robot frame."""
    size = 46.0
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


def _icr(p: Point, paper: Paper) -> list[str]:
    paper.boxes += [bounds([p], 7), bounds([(p[0], p[1] - 15)], 10)]
    return [*icr_mark(p), text((p[0], p[1] - 11), "ICR", "icr-name")]


def _scale_bar(scale: float, height: float, paper: Paper) -> list[str]:
    """A round length of 60 to 150 px, bottom right."""
    power = 10.0 ** floor(log10(150 / scale))
    length = next(k for k in (5, 2, 1) if k * power * scale <= 150) * power
    right, y = _WIDTH - 26.0, height - 24.0
    left = right - length * scale
    paper.boxes.append((left - 6, y - 18, right + 6, y + 8))
    ticks = [line((x, y - 4), (x, y + 4), "scale") for x in (left, right)]
    name = text(((left + right) / 2, y - 6), f"{length:.6g} m", "scale-name")
    return [line((left, y), (right, y), "scale"), *ticks, name]


def _names(placed: list[Placed], paper: Paper, axles: list[Segment]) -> list[str]:
    """Names of all wheels, clear of what is drawn."""
    for p in placed:
        paper.boxes.append(p.box)
        if p.wheel.has_spin:
            paper.boxes.append(bounds([along(p.centre, p.ahead, p.half[0]), p.nose], 4))
        if p.wheel.turns:
            paper.boxes.append(bounds([p.pivot], 4))
    paper.segments += axles
    away = middle(bounds([p.centre for p in placed]))
    return [e for p in placed for e in paper.put(p.wheel.name, _reach(p), away, len(placed) > _CROWD)]


def _reach(p: Placed) -> Box:
    """The box of a wheel and of its pivot, of a castor with all that it swivels over."""
    if not p.wheel.turns:
        return p.box
    a, b = p.box, bounds([p.pivot], distance(p.centre, p.pivot) if p.wheel.kind.swivels else 0.0)
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])
