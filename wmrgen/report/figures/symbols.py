"""Draw the meaning of l, alpha, beta, heading, psi, gamma, d and the offset, at one wheel of each type.

Angles are true; lengths are not to scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi, radians, remainder, sin
from typing import SupportsFloat

from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.figures.figure import WIDTH, Figure, Group, View, attribute, figure
from wmrgen.report.figures.marks import Placed, body
from wmrgen.report.figures.paper import (
    FIRM,
    Box,
    Paper,
    Point,
    along,
    arrow,
    bounds,
    circle,
    line,
    metres,
    middle,
    width,
    wrapped,
)

FILE = "symbols.svg"
_PANEL, _DRAWN, _ROW = WIDTH / 2, 206.0, 15.0  # px: width and height of a panel, height of a line of words
_L, _D, _O, _TYRE, _AXLE = 88.0, 34.0, 26.0, 30.0, 56.0  # px: l, d, offset, half a tyre, lines from the pivot
_PSI = radians(28)  # the steering angle that is drawn
_FLAT = radians(3)  # smaller angles have no arc, because it would be shorter than its arrow head


def wheel_symbols(robot: Robot) -> Figure:
    """Return ``symbols.svg``."""
    chosen = []
    for kind in dict.fromkeys(w.type for w in robot.wheels):
        alike = [w for w in robot.wheels if w.type == kind]
        chosen.append(max(alike, key=_visible_quantities))
    names = ", ".join(f"{w.name} ({w.kind.noun})" for w in chosen)
    return drawn(FILE, f"The symbols of {robot.name} at {names}.", chosen)


def drawn(file: str, alt: str, wheels: Sequence[Wheel], values: bool = True) -> Figure:
    """Return the figure with a panel for each wheel.

    Args:
        file: file name.
        alt: a sentence that describes the figure.
        wheels: the wheels.
        values: whether to print their values.

    Returns:
        The figure.
    """
    groups: list[Group] = []
    height = 0.0
    for k in range(0, len(wheels), 2):
        pair = wheels[k : k + 2]
        texts = [_values(w) if values else [] for w in pair]
        for j, (w, words) in enumerate(zip(pair, texts, strict=True)):
            left = j * _PANEL if len(pair) == 2 else _PANEL / 2
            groups.append(_panel(w, words, (left + 8, height + 4, left + _PANEL - 8, height + 4 + _DRAWN)))
        height += 8 + _DRAWN + _ROW * max(map(len, texts))
    return figure(file, alt, height + 6, groups)


def _visible_quantities(w: Wheel) -> int:
    """Return how many quantities of a wheel are visible in a drawing."""
    angles = abs(sin(w.alpha)), abs(remainder(w.beta, 2 * pi)), abs(w.gamma)
    return sum((w.l > 0, *(angle > _FLAT for angle in angles), bool(w.nominal.d), bool(w.nominal.o)))


def _values(w: Wheel) -> list[str]:
    """Return the values of a wheel, in lines."""
    g, kind = w.nominal, w.kind
    parts = (
        (True, f"l = {metres(w.l)}"),
        (bool(w.l), f"α = {_degrees(w.alpha)}"),
        (kind.directed, f"β = {_degrees(w.beta)}"),
        (kind.directed, f"heading {_degrees(w.heading)}"),
        (kind.rollers, f"γ = {_degrees(w.gamma)}"),
        (bool(g.d), f"d = {_signed(g.d)}"),
        (bool(g.o), f"o = {_signed(g.o)}"),
        (bool(g.r), f"r = {metres(float(g.r))}"),
    )
    words = ", ".join(text.replace(" ", FIRM) for occurs, text in parts if occurs).replace("-", "−")
    return [_title(w), *wrapped(words, _PANEL - 18)]


def _title(w: Wheel) -> str:
    words = f"{w.name}: {w.kind.noun}"
    return words if 1.1 * width(words) < _PANEL - 16 else w.name[:24] + "…" * (len(w.name) > 24)


def _signed(length: SupportsFloat) -> str:
    return f"{'-' * (float(length) < 0)}{metres(abs(float(length)))}"


def _degrees(angle: float) -> str:
    return f"{round(degrees(angle), 9) + 0.0:.4g}°"


def _panel(w: Wheel, words: list[str], area: Box) -> Group:
    """Draw a wheel with its symbols in ``area``, and lines of words below it."""
    turned = _PSI if w.turns else 0.0
    view = _view(w, turned, area)
    wheel = _wheel(w, view, turned)
    paper = Paper(area)
    written = [
        paper.write((area[0], area[3] + 12 + _ROW * k), text, "words" if k else "title")
        for k, text in enumerate(words)
    ]
    elements, labels = _place(w, view)
    paper.boxes.append(bounds([wheel.centre, along(wheel.nose, wheel.ahead, 4.0)], 2))
    if w.kind.directed:
        more, others = _directions(w, wheel, view, turned)
        elements, labels = elements + more, labels + others
    paper.boxes += [wheel.box, bounds([view.origin], 4)]
    paper.segments += [(view.origin, wheel.pivot)]
    shown = [
        e
        for name, at, away in labels
        for e in paper.put(name, bounds([at], 1), away, "letter" if len(name) == 1 else "words")
    ]
    return attribute("symbols", w.name) + attribute("type", w.type), [
        *body(wheel),
        *elements,
        *shown,
        *written,
    ]


def _view(w: Wheel, turned: float, area: Box) -> View:
    """Return the view that puts the drawing into the middle of ``area``; its unit is px."""
    raw = View(1.0, (0.0, 0.0))
    wheel = _wheel(w, raw, turned)
    reach = _AXLE if w.kind.directed else 0.0
    box = bounds(
        [
            wheel.reach[:2],
            wheel.reach[2:],
            (0.0, -46.0),
            *(along(wheel.pivot, raw.way(w.alpha + k * w.beta), reach) for k in (0, 1)),
        ]
    )
    (x, y), (at_x, at_y) = middle(box), middle(area)
    return View(1.0, (at_x - x, at_y - y))


def _wheel(w: Wheel, view: View, turned: float) -> Placed:
    """Place the wheel, with all lengths replaced by visible ones."""
    g, heading = w.nominal, w.heading + turned
    pivot = along(view.origin, view.way(w.alpha), _L if w.l else 0.0)
    ahead, left = view.way(heading), view.way(heading + pi / 2)
    centre = along(along(pivot, ahead, _sized(float(g.d), _D)), left, _sized(float(g.o), _O))
    half = _TYRE * (0.8 if w.kind.glyph.ball else 1.0)
    return Placed(w, pivot, centre, ahead, (half, w.kind.glyph.width * half / 2))


def _sized(length: float, shown: float) -> float:
    return shown * ((length > 0) - (length < 0))


Label = tuple[str, Point, Point]  # words, the point they name, and a point from which they are kept away


def _place(w: Wheel, view: View) -> tuple[list[str], list[Label]]:
    """Draw P with the x axis, l and alpha."""
    p = view.origin
    a, up = along(p, view.way(w.alpha), _L), along(p, view.x, 46.0)
    elements = [line(p, up, "help"), *arrow(p, along(p, view.x, 30.0), "frame", 4.0), circle(p, 2.4, "dot")]
    labels = [("x", up, p), ("P", p, a if w.l else up)]
    if w.l:
        elements += [line(p, a, "line"), *_angle(view, p, 22.0, 0.0, w.alpha)]
        labels += [
            ("l", middle(bounds([p, a])), along(a, view.way(w.alpha + pi / 2), 99.0)),
            _named(view, p, 22.0, 0.0, w.alpha, "α"),
        ]
    return elements, labels


def _directions(w: Wheel, wheel: Placed, view: View, turned: float) -> tuple[list[str], list[Label]]:
    """Draw axle and heading with beta, psi, gamma, d and the offset.

    Args:
        w: the wheel.
        wheel: the wheel on paper.
        view: the view.
        turned: the steering angle that is drawn [rad].

    Returns:
        The SVG elements, and the labels.
    """
    a, b, away = wheel.pivot, wheel.centre, view.origin
    axle = w.alpha + w.beta
    elements = [line(a, along(a, view.way(w.alpha), _AXLE), "help")] if w.l else []
    elements += [line(a, along(a, view.way(axle), _AXLE), "axle"), *_angle(view, a, 34.0, w.alpha, w.beta)]
    labels = [_named(view, a, 34.0, w.alpha, w.beta, "β")]
    nose = along(b, wheel.ahead, wheel.half[0] + 16.0)
    elements += arrow(along(b, wheel.ahead, wheel.half[0] + 1.0), nose, "roll")
    if turned:
        start = along(a, view.way(w.heading), 52.0)
        elements += [line(a, start, "help"), line(a, along(a, wheel.ahead, 52.0), "help")]
        elements += _angle(view, a, 44.0, w.heading, turned)
        labels += [_named(view, a, 44.0, w.heading, turned, "ψ"), ("heading", start, a)]
    else:
        labels.append(("heading", nose, b))
    if w.kind.rollers:
        axis = w.heading + w.gamma
        elements += [line(along(b, view.way(axis), -52.0), along(b, view.way(axis), 52.0), "roller")]
        elements += _angle(view, b, 44.0, w.heading, w.gamma)
        labels += [_named(view, b, 44.0, w.heading, w.gamma, "γ")]
    middle_d = along(a, wheel.ahead, _sized(float(w.nominal.d), _D) / 2)
    if w.nominal.d:
        labels.append(("d", along(middle_d, wheel.left, 2.0), along(middle_d, wheel.left, -50.0)))
    if w.nominal.o:
        labels.append(("o", middle(bounds([b, along(b, wheel.left, -_sized(float(w.nominal.o), _O))])), away))
    return elements, labels


def _angle(view: View, centre: Point, radius: float, first: float, turn: float) -> list[str]:
    turn = remainder(turn, 2 * pi)
    return view.around(centre, radius, first, turn, "angle") if abs(turn) > _FLAT else []


def _named(view: View, centre: Point, radius: float, first: float, turn: float, name: str) -> Label:
    """Return the label of an angle, at the middle of its arc. An angle without an arc gets its value."""
    turn = remainder(turn, 2 * pi)
    return (
        name if abs(turn) > _FLAT else f"{name} = {_degrees(turn)}",
        along(centre, view.way(first + turn / 2), radius),
        centre,
    )
