"""Trailers in line behind a robot, seen from above."""

from __future__ import annotations

from math import atan2, degrees

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
    unit,
)
from wmrgen.backends.drawing.view import View
from wmrgen.constraints import nominal_view
from wmrgen.functions.models.axle import leading_axle
from wmrgen.robot import Derivation

# Name; where the axle in front, the coupling and the own axle are [m].
Train = list[tuple[str, Point, Point, Point]]


def train(derivation: Derivation) -> Train:
    """The trailers, all in line behind the fixed axle, or behind P where there is none."""
    robot = derivation.driven.robot
    ex, ey, x, y = leading_axle(robot, derivation.driven.mobility, nominal_view).nominal
    places: Train = []
    for t in robot.trailers:
        front, hitch, length = (x, y), float(t.hitch.nominal), float(t.length.nominal)
        coupling = (x - ex * hitch, y - ey * hitch)
        x, y = coupling[0] - ex * length, coupling[1] - ey * length
        places.append((t.name, front, coupling, (x, y)))
    return places


def towed(places: Train, half: float, view: View, paper: Paper) -> tuple[list[str], list[str]]:
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
