"""Draw how the velocity of a wheel follows from the twist: v + ω ẑ × A, and its parts along e and n.

The drawing is the same for every robot, apart from its title. x is up, and lengths are not to scale.
"""

from __future__ import annotations

from math import pi, radians

from wmrgen.geometry.layout.records import Robot
from wmrgen.report.figures.figure import WIDTH, Figure, View, attribute, figure
from wmrgen.report.figures.paper import Paper, Point, along, arrow, bar, bounds, circle, line, middle

FILE = "contact.svg"
_HEIGHT = 226.0  # px
_P: Point = (110.0, 210.0)  # px
_L, _V, _TURN, _AXES, _TYRE = 170.0, 74.0, 62.0, 112.0, 32.0  # px: l, |v|, |ω l|, e and n, half a tyre
_ALPHA, _HEADING, _COURSE = radians(-70), radians(-42), radians(0)  # of A, e and v, as seen from P


def contact(robot: Robot) -> Figure:
    """Return ``contact.svg``."""
    view = View(1.0, _P)
    turned = view.way(_ALPHA + pi / 2)
    e, n = view.way(_HEADING), view.way(_HEADING + pi / 2)
    a = along(_P, view.way(_ALPHA), _L)
    at_p, at_a = (along(start, view.way(_COURSE), _V) for start in (_P, a))
    tip = along(at_a, turned, _TURN)
    feet = [along(a, axis, _component(a, tip, axis)) for axis in (e, n)]
    ends = [along(a, axis, _AXES) for axis in (e, n)]
    tyre = bar(a, (0.42 * _TYRE / 2, _TYRE), 3.0, 42.0, "wheel fixed")
    elements = [
        *(line(tip, foot, "help") for foot in feet), line(_P, a, "line"), line(a, at_a, "help"), tyre,
        *(part for end in ends for part in arrow(a, end, "roll")),
        *arrow(_P, at_p, "velocity"), *arrow(at_a, tip, "way"), *arrow(a, tip, "velocity"),
        circle(_P, 2.4, "dot"), circle(a, 3.0, "pivot"),
    ]  # fmt: skip
    paper = Paper((4.0, 4.0, WIDTH - 4.0, _HEIGHT - 4.0))
    paper.boxes += [bounds([p], 3) for p in (_P, a, tip, at_p, *ends)]
    paper.segments += [(_P, a), (_P, at_p), (a, at_a), (at_a, tip), (a, tip), *((a, end) for end in ends)]
    names: list[tuple[str, Point, Point]] = [
        ("P", _P, a),
        ("A", a, tip),
        ("v", middle(bounds([_P, at_p])), a),
        ("v", middle(bounds([a, at_a])), tip),
        ("ω ẑ × A", middle(bounds([at_a, tip])), a),
        ("v + ω ẑ × A", tip, a),
        ("e", ends[0], a),
        ("n", ends[1], a),
        ("l", middle(bounds([_P, a])), at_p),
    ]
    labels = []
    for name, at, away in names:
        labels += paper.put(name, bounds([at], 1), away, "letter" if len(name) == 1 else "words")
    return figure(
        FILE,
        f"The velocity of a wheel of {robot.name}: its pivot A moves at v + ω ẑ × A, where v is the velocity of P. The "
        "parts along the rolling direction e and along the normal n are what a wheel constrains.",
        _HEIGHT,
        [(attribute("contact", "A"), [*elements, *labels])],
    )


def _component(a: Point, b: Point, axis: Point) -> float:
    """Return the length of the part of b - a along an axis, which is a unit vector."""
    return (b[0] - a[0]) * axis[0] + (b[1] - a[1]) * axis[1]
