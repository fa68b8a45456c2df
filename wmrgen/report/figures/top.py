"""Draw the top view: wheels to scale at steering angle 0, names, dimensions, and trailers in line with the robot."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import hypot

from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.axle import leading_axle
from wmrgen.geometry.constraints import nominal_view
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.figures.example import largest_radius
from wmrgen.report.figures.figure import WIDTH, Figure, Group, View, attribute, figure, fitted, panel
from wmrgen.report.figures.marks import (
    Placed,
    body,
    chassis,
    direction,
    entries,
    extremes,
    frame,
    legend,
    placed,
    towed,
)
from wmrgen.report.figures.paper import (
    Paper,
    Point,
    along,
    arrow,
    bounds,
    circle,
    distance,
    line,
    metres,
    middle,
    pair,
    text,
    unit,
    width,
)
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

FILE = "layout.svg"
_TALL, _SIDE, _EDGE, _TYRE = 290.0, 84.0, 36.0, 48.0  # px: height, side margin, upper margin, largest radius


def top_view(derivation: Derivation) -> Figure:
    """Return ``layout.svg``."""
    robot = derivation.robot
    trailers = _train(derivation)
    points = [p for w in robot.wheels for p in extremes(w, w.heading)] + [(0.0, 0.0)]
    points += [axle for *_, axle in trailers]
    view = fitted(points, (_SIDE, _EDGE, WIDTH - _SIDE, _TALL), most=_TYRE / largest_radius(robot.wheels))
    top, bottom = bounds([view.on(p) for p in points])[1::2]
    view = View(view.scale, (view.origin[0], view.origin[1] + _EDGE - top))
    height = bottom - top + 2 * _EDGE
    wheels = [placed(w, w.heading, view) for w in robot.wheels]
    paper = Paper((4.0, 4.0, WIDTH - 4.0, height + 30.0))
    axes = min(30.0, max(18.0, 0.12 * height))
    signs = frame(view, ("x", "y", "P"), paper, axes)
    _occupy(wheels, paper)
    sizes = _dimensions(robot, wheels, view, paper, height - 14.0, axes)
    height += 26.0
    types = {w.type for w in robot.wheels}
    kinds = [kind for name, kind in WHEEL_TYPES.items() if name in types]
    signed = entries(kinds, robot.wheels) + [("trailer", "trailer (its width is not in the file)")] * bool(
        trailers
    )
    keys, more = legend(signed, height, paper)
    half = max(abs(p.centre[0] - view.origin[0]) for p in wheels)
    behind, lengths = _towed(trailers, max(half, 12.0), view, paper)
    names = _names(wheels, paper)
    groups: list[Group] = [
        (panel(view), chassis([p.pivot for p in wheels])), ("", behind),
        *(_group(p) for p in wheels),
        ("", [element for p in wheels for element in direction(p)]), (' class="fine"', sizes),
        ("", signs), (' class="fine"', [*names, *lengths]), (' class="fine"', keys),
    ]  # fmt: skip
    count = f"{len(robot.bodies)} wheel{'s' * (len(robot.bodies) > 1)}"
    nouns = ", ".join(dict.fromkeys(w.kind.noun for w in robot.wheels))
    alt = f"Top view of {robot.name}, x forward is up: {count} ({nouns}) to scale"
    return figure(FILE, f"{alt}{', with its trailers behind it' if trailers else ''}.", height + more, groups)


def _group(p: Placed) -> Group:
    name, kind = p.wheel.name, p.wheel.type
    attributes = attribute("wheel", name) + attribute("type", kind) + attribute("contact", pair(p.centre))
    return attributes, [text((0, 0), f"{name}: {kind}", "").replace("text", "title"), *body(p)]


def _occupy(wheels: list[Placed], paper: Paper) -> None:
    """Mark the places of wheels as taken, so that words keep clear of them."""
    for p in wheels:
        paper.boxes.append(p.box)
        if p.wheel.has_spin:
            paper.boxes.append(bounds([along(p.centre, p.ahead, p.half[0]), p.nose], 3))
        if p.wheel.turns:
            paper.boxes.append(bounds([p.pivot], 4))


def _names(wheels: list[Placed], paper: Paper) -> list[str]:
    """Write the names of all wheels at free places."""
    away = middle(bounds([p.centre for p in wheels]))
    return [e for p in wheels for e in paper.put(p.wheel.name, p.reach, away)]


# ---- Dimension lines: distances between wheels, or from P to all of them.

_SAME = 1e-6  # of the size of the robot: positions closer than this are equal
_GAP = 17.0  # px: least distance of two numbers above each other


def _dimensions(
    robot: Robot, wheels: list[Placed], view: View, paper: Paper, base: float, frame: float
) -> list[str]:
    """Draw distances between wheels along x (on the left) and along y (below), or the distance from P to all wheels.

    Args:
        robot: the robot.
        wheels: its wheels on paper.
        view: the view.
        paper: the paper.
        base: height of the line with the distances along y [px].
        frame: length of the axes of the frame [px].

    Returns:
        The SVG elements.
    """
    bearing = [
        w for w in robot.wheels if w.kind.constrains or w.kind.rolls_across or w.actuated
    ] or robot.wheels
    size = max(hypot(w.pivot.real, w.pivot.imag) for w in robot.wheels)
    if not size:
        return []
    if _round(bearing, size):
        return _radius(bearing, view, paper)
    elements: list[str] = []
    xs = _places([w.pivot.real for w in bearing], size)
    if len(xs) == 2 and xs[0] * xs[1] < 0 and abs(xs[0] + xs[1]) > _SAME * size:
        xs = [xs[0], 0.0, xs[1]]  # P is between its axles, nearer to one
    if any((b - a) * view.scale < _GAP for a, b in pairwise(xs)) or len(xs) > 4:
        xs = [xs[0], xs[-1]]
    widest = max((width(metres(b - a)) for a, b in pairwise(xs)), default=0.0)
    left = max(min(*(p.reach[0] for p in wheels), view.origin[0] - frame) - 16.0, widest + 12.0)
    for a, b in pairwise(xs):
        if (b - a) * view.scale >= _GAP:
            ends = [(left, view.on((x, 0.0))[1]) for x in (a, b)]
            paper.boxes.append(bounds(ends, 5))
            elements += [_tick(ends[0], (1, 0)), _tick(ends[1], (1, 0)), *_measured(*ends)]
            where = (left - 6, (ends[0][1] + ends[1][1]) / 2 + 4)
            elements.append(paper.write(where, metres(b - a), "words", "end"))
    ys = _places([w.pivot.imag for w in bearing], size)
    if len(ys) > 1 and (ys[-1] - ys[0]) * view.scale > _GAP:
        ends = [(view.on((0.0, y))[0], base) for y in (ys[-1], ys[0])]
        paper.boxes.append(bounds(ends, 5))
        elements += [_tick(ends[0], (0, 1)), _tick(ends[1], (0, 1)), *_measured(*ends)]
        words = f"{'track ' * _track(bearing, ys, size)}{metres(ys[-1] - ys[0])}"
        elements.append(paper.write(((ends[0][0] + ends[1][0]) / 2, base + 15), words, "words", "middle"))
    return elements


def _places(values: Sequence[float], size: float) -> list[float]:
    """Return the distinct values in ascending order. ``size``: size of the robot [m]."""
    distinct: list[float] = []
    for value in sorted(values):
        if not distinct or value - distinct[-1] > _SAME * size:
            distinct.append(value)
    return distinct


def _track(wheels: Sequence[Wheel], ys: list[float], size: float) -> bool:
    """Return whether the outermost wheels are side by side and roll forward.

    Args:
        wheels: the wheels.
        ys: their distinct y positions [m], ascending.
        size: size of the robot [m].

    Returns:
        Whether the distance of the outermost wheels is a track.
    """
    sides = [[w for w in wheels if abs(w.pivot.imag - y) <= _SAME * size] for y in (ys[0], ys[-1])]
    if not all(abs(w.zero_heading.imag) < _SAME for side in sides for w in side):
        return False
    left, right = ([w.pivot.real for w in side] for side in sides)
    return _places(left, size) == _places(right, size)


def _round(wheels: Sequence[Wheel], size: float) -> bool:
    """Return whether the wheels are on a circle about P, but not in the corners of a rectangle."""
    sides = zip(*((abs(w.pivot.real), abs(w.pivot.imag)) for w in wheels), strict=True)
    corners = all(len(_places(side, size)) == 1 for side in sides)
    return len(wheels) > 2 and not corners and len(_places([abs(w.pivot) for w in wheels], size)) == 1


def _radius(wheels: Sequence[Wheel], view: View, paper: Paper) -> list[str]:
    """Draw the circle through all pivots, and its radius."""
    w = wheels[0]
    tip = view.on((w.pivot.real, w.pivot.imag))
    length = distance(view.origin, tip)
    centre = along(view.origin, unit(view.origin, tip), 0.62 * length)
    paper.segments.append((view.origin, tip))
    label = paper.put(f"l = {metres(abs(w.pivot))}", bounds([centre], 2), view.origin)
    return [circle(view.origin, length, "swivel"), *arrow(view.origin, tip, "size", 4), *label]


def _tick(p: Point, way: Point) -> str:
    return line(along(p, way, -4), along(p, way, 4), "size")


def _measured(a: Point, b: Point) -> list[str]:
    """Draw a dimension line with arrow heads at both ends."""
    centre = middle(bounds([a, b]))
    return [*arrow(centre, a, "size", 4), *arrow(centre, b, "size", 4)]


# ---- Trailers.

# Name, and positions of the axle in front, the coupling and the own axle [m].
_Train = list[tuple[str, Point, Point, Point]]


def _train(derivation: Derivation) -> _Train:
    """Place the trailers in line behind the fixed axle, or behind P if there is none."""
    robot = derivation.driven.robot
    ex, ey, x, y = leading_axle(robot, derivation.driven.mobility, nominal_view).nominal
    places: _Train = []
    for t in robot.trailers:
        front, hitch, length = (x, y), float(t.hitch.nominal), float(t.length.nominal)
        coupling = (x - ex * hitch, y - ey * hitch)
        x, y = coupling[0] - ex * length, coupling[1] - ey * length
        places.append((t.name, front, coupling, (x, y)))
    return places


def _towed(places: _Train, half: float, view: View, paper: Paper) -> tuple[list[str], list[str]]:
    """Draw the trailers: bars, couplings and axles, and their names with lengths.

    Args:
        places: the trailers.
        half: half the length of an axle [px].
        view: the view.
        paper: the paper.

    Returns:
        The SVG elements of the trailers, and of their names.
    """
    elements: list[str] = []
    for _, front, coupling, axle in places:
        a, b, c = view.on(front), view.on(coupling), view.on(axle)
        drawn, ends = towed(a, b, c, half)
        elements += drawn
        paper.boxes += [bounds([b, c], 4), bounds(list(ends), 9)]
    names: list[str] = []
    for name, _, coupling, axle in places:
        centre = view.on(axle)
        end = along(centre, (1.0, 0.0), half + 4)
        words = f"{name}, {metres(distance(coupling, axle))}"
        names += paper.put(words, bounds([centre, end], 4), along(centre, (-1.0, 0.0), half))
    return elements, names
