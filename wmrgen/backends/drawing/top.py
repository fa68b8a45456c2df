"""The top view: wheels to scale at steering angle 0, their names, dimensions, trailers in line behind the robot."""

from __future__ import annotations

from math import atan2, degrees

from wmrgen.backends.drawing.dimensions import dimensions
from wmrgen.backends.drawing.example import largest_radius
from wmrgen.backends.drawing.figure import WIDTH, Figure, Group, View, attribute, figure, fitted, panel
from wmrgen.backends.drawing.marks import (
    Placed,
    body,
    chassis,
    direction,
    entries,
    extremes,
    frame,
    legend,
    placed,
)
from wmrgen.backends.drawing.paper import (
    Paper,
    Point,
    along,
    bar,
    bounds,
    circle,
    distance,
    line,
    metres,
    middle,
    pair,
    text,
    unit,
)
from wmrgen.constraints import nominal_view
from wmrgen.functions.models.axle import leading_axle
from wmrgen.robot import Derivation
from wmrgen.wheels import WHEEL_TYPES

FILE = "layout.svg"
_TALL, _SIDE, _EDGE, _TYRE = 290.0, 84.0, 36.0, 48.0


def top_view(derivation: Derivation) -> Figure:
    """``layout.svg``"""
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
    sizes = dimensions(robot, wheels, view, paper, height - 14.0, axes)
    height += 26.0
    kinds = [kind for name, kind in WHEEL_TYPES.items() if any(w.type == name for w in robot.wheels)]
    signed = entries(kinds, robot.wheels) + [("trailer", "trailer (its width is not in the file)")] * bool(
        trailers
    )
    keys, more = legend(signed, WIDTH, height, paper)
    half = max(abs(p.centre[0] - view.origin[0]) for p in wheels)
    behind, lengths = _towed(trailers, max(half, 12.0), view, paper)
    names = _names(wheels, paper)
    groups: list[Group] = [
        (panel(view), chassis([p.pivot for p in wheels])), ("", behind),
        *(_group(p) for p in wheels),
        ("", [element for p in wheels for element in direction(p)]), (' class="fine"', sizes),
        ("", signs), (' class="fine"', [*names, *lengths]), (' class="fine"', keys),
    ]  # fmt: skip
    count = f"{len(robot.wheels)} wheel{'s' * (len(robot.wheels) > 1)}"
    nouns = ", ".join(dict.fromkeys(w.kind.noun for w in robot.wheels))
    alt = f"Top view of {robot.name}, x forward is up: {count} ({nouns}) to scale"
    return figure(FILE, f"{alt}{', with its trailers behind it' if trailers else ''}.", height + more, groups)


def _group(p: Placed) -> Group:
    name, kind = p.wheel.name, p.wheel.type
    attributes = attribute("wheel", name) + attribute("type", kind) + attribute("contact", pair(p.centre))
    return attributes, [text((0, 0), f"{name}: {kind}", "").replace("text", "title"), *body(p)]


def _occupy(wheels: list[Placed], paper: Paper) -> None:
    """Keep words off what is drawn of wheels."""
    for p in wheels:
        paper.boxes.append(p.box)
        if p.wheel.has_spin:
            paper.boxes.append(bounds([along(p.centre, p.ahead, p.half[0]), p.nose], 3))
        if p.wheel.turns:
            paper.boxes.append(bounds([p.pivot], 4))


def _names(wheels: list[Placed], paper: Paper) -> list[str]:
    """Names of all wheels, clear of what is drawn."""
    away = middle(bounds([p.centre for p in wheels]))
    return [e for p in wheels for e in paper.put(p.wheel.name, p.reach, away)]


# ---- trailers

# Name; where the axle in front, the coupling and the own axle are [m].
_Train = list[tuple[str, Point, Point, Point]]


def _train(derivation: Derivation) -> _Train:
    """The trailers, all in line behind the fixed axle, or behind P where there is none."""
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
    """Bars, couplings and axles with wheels ``half`` [px] to either side; names with lengths."""
    elements: list[str] = []
    for _, front, coupling, axle in places:
        a, b, c = view.on(front), view.on(coupling), view.on(axle)
        way = unit(c, b)
        side, turn = (way[1], -way[0]), degrees(atan2(way[0], -way[1]))
        ends = along(c, side, half), along(c, side, -half)
        elements += [line(a, b, "line"), line(b, c, "bar"), line(*ends, "bar"), circle(b, 2.8, "pivot")]
        elements += [bar(end, (2.5, 8.0), 2.0, turn, "trailer") for end in ends]
        paper.boxes += [bounds([b, c], 4), bounds(list(ends), 9)]
    names: list[str] = []
    for name, _, coupling, axle in places:
        centre = view.on(axle)
        end = along(centre, (1.0, 0.0), half + 4)
        words = f"{name}, {metres(distance(coupling, axle))}"
        names += paper.put(words, bounds([centre, end], 4), along(centre, (-1.0, 0.0), half))
    return elements, names
