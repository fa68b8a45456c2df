"""Draw a motion in the robot frame, with the velocity of each wheel and the ICR; and singular configurations."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, hypot

import numpy as np

from wmrgen.analysis.mobility import admissible
from wmrgen.analysis.mobility.ranks import null_basis
from wmrgen.analysis.mobility.records import Array, Mobility, Singularity
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.notation import listed, plain
from wmrgen.report.figures.example import Example, Twist, extent, largest_radius, moving
from wmrgen.report.figures.figure import WIDTH, Figure, Group, View, figure, fitted, panel
from wmrgen.report.figures.marks import Placed, body, chassis, contact, extremes, frame, icr_mark, placed
from wmrgen.report.figures.paper import (
    Box,
    Paper,
    Point,
    Segment,
    along,
    arrow,
    bounds,
    clip,
    distance,
    line,
    middle,
    overlap,
    pair,
    unit,
    width,
    wrapped,
)

FAR = 3.3  # in sizes of the robot: an arrow points to an ICR that is farther from its centre
_FASTEST = 30.0  # px: length of the arrow of the largest velocity
_SKEW = 0.02  # of the distance to the ICR: the axle of a wheel that slides misses the ICR by more
_MANY = 12  # robots with more wheels have no arrows of velocities and no lines to the ICR: they would overlap


def number(value: float) -> str:
    """Return a number with three significant digits."""
    return f"{float(f'{round(value, 12) + 0.0:.3g}'):.12g}".replace("-", "−")


def instant(robot: Robot, shown: Example, area: Box, title: str, words: Sequence[str]) -> list[Group]:
    """Draw a robot from above during a motion, x up: axle lines, velocities, and the ICR or an arrow to it.

    Args:
        robot: the robot.
        shown: the motion.
        area: area on paper [px].
        title: words above the area.
        words: lines of words below the area.

    Returns:
        Groups of SVG elements.
    """
    centre, size = extent(robot.wheels)
    near = shown.icr is not None and distance(shown.icr, centre) <= FAR * size
    points = [p for w in robot.wheels for p in extremes(w, shown.headings[w.name])] + [(0.0, 0.0)]
    if near and shown.icr:
        points.append(shown.icr)
    inner = (area[0] + 26, area[1] + 22, area[2] - 26, area[3] - 26)
    view = fitted(points, inner, most=40.0 / largest_radius(robot.wheels))
    paper = Paper(area)
    wheels = [placed(w, shown.headings[w.name], view) for w in robot.wheels]
    icr = view.on(shown.icr) if near and shown.icr else None
    written = [paper.write((area[0], area[1] - 8), title, "title")]
    written += [paper.write((area[0], area[3] + 14 + 15 * k), text) for k, text in enumerate(words)]
    signs = frame(view, ("x", "y", "P"), paper, 24.0)
    paper.boxes += [p.box for p in wheels]
    mark = _icr(icr, paper) if icr else _pointed(shown, view, paper)
    few = len(wheels) <= _MANY
    axles = _axles(wheels, icr, area) if few else []
    spokes = [line(icr, p.centre, "spoke") for p in wheels if few and icr and not p.wheel.kind.sliding_row]
    velocities = _velocities(wheels, shown, view) if few else []
    return [
        (panel(view) + (f' data-icr="{pair(icr)}"' if icr else ""), chassis([p.pivot for p in wheels])),
        ("", [*(line(*axle, "axle") for axle in axles), *spokes]),
        *(("", body(p)) for p in wheels), ("", [*velocities, *signs, *mark, *written]),
    ]  # fmt: skip


def _velocities(wheels: list[Placed], shown: Example, view: View) -> list[str]:
    """Draw the velocity of each contact point, with a length proportional to it."""
    vx, vy, omega = shown.twist
    speeds = []
    for p in wheels:
        x, y = contact(p.wheel, shown.headings[p.wheel.name])
        speeds.append((vx - omega * y, vy + omega * x))
    fastest = max(hypot(*v) for v in speeds)
    elements: list[str] = []
    for p, (a, b) in zip(wheels, speeds, strict=True):
        length = _FASTEST * hypot(a, b) / fastest if fastest else 0.0
        if length > 5:
            tip = along(
                p.centre,
                unit((0.0, 0.0), (a * view.x[0] + b * view.x[1], a * view.x[1] - b * view.x[0])),
                length,
            )
            elements += arrow(p.centre, tip, "velocity", 4.0)
    return elements


def _axles(wheels: list[Placed], icr: Point | None, area: Box) -> list[Segment]:
    """Return the axle lines of wheels that cannot slide sideways: to the ICR and a little beyond.

    If there is no ICR, or if a wheel has to slide, its line crosses the panel. Wheels on one line share the longest
    segment.
    """
    longest: dict[tuple[float, float], Segment] = {}
    for p in wheels:
        if not p.wheel.kind.sliding_row or (icr is None and not p.wheel.kind.constrains):
            continue
        cut: Segment | None = None
        if icr is None or distance(p.centre, icr) < 1.0 or _slides(p, icr):
            cut = clip(p.centre, p.left, area)
        elif p.wheel.kind.constrains or abs(_off(p, icr)) < 1.0:
            way = unit(p.centre, icr)
            cut = along(p.centre, way, -p.half[1] - 10.0), along(icr, way, 14.0)
        if cut:
            longest[line_of(p)] = max(longest.get(line_of(p), cut), cut, key=lambda piece: distance(*piece))
    return list(longest.values())


def line_of(p: Placed) -> tuple[float, float]:
    """Return a key of the axle line of a wheel: direction [deg] and distance from the corner of the page [px]."""
    x, y = p.ahead if (p.ahead[1], p.ahead[0]) < (-1e-4, 0.0) else (-p.ahead[0], -p.ahead[1])
    return round(degrees(atan2(x, -y)) % 180, 1) % 180, round(abs(p.centre[0] * x + p.centre[1] * y), 0)


def _off(p: Placed, icr: Point) -> float:
    """Return the distance of the ICR from the axle line [px]."""
    return (icr[0] - p.centre[0]) * p.ahead[0] + (icr[1] - p.centre[1]) * p.ahead[1]


def _slides(p: Placed, icr: Point) -> bool:
    """Return whether a wheel that should not slide sideways does, because its axle misses the ICR."""
    return p.wheel.kind.constrains and abs(_off(p, icr)) > max(1.0, _SKEW * distance(p.centre, icr))


def _icr(p: Point, paper: Paper) -> list[str]:
    paper.boxes.append(bounds([p], 6))
    return [*icr_mark(p), *paper.put("ICR", bounds([p], 6), (p[0], p[1] + 20))]


def _pointed(shown: Example, view: View, paper: Paper) -> list[str]:
    """Draw an arrow to an ICR that is not on the page, with its distance from P."""
    area = paper.area
    if shown.icr is None:
        return [paper.write((area[2], area[1] + 4), "ICR at infinity", "words", "end")]
    way = unit(view.origin, view.on(shown.icr))
    cut = clip(view.origin, way, (area[0] + 2, area[1] + 8, area[2] - 2, area[3] - 4))
    end = cut[1] if cut else middle(area)
    start = along(end, way, -30.0)
    paper.boxes.append(bounds([start, end], 3))
    words = f"ICR {number(hypot(*shown.icr))} m from P"
    return [
        *arrow(start, end, "way"),
        *(paper.put(words, bounds([start, end], 3), end) or [_corner(words, paper)]),
    ]


def _corner(words: str, paper: Paper) -> str:
    """Write words in the corner where they overlap least."""
    left, top, right, bottom = paper.area
    wide = width(words)
    corners = [(x, y) for y in (bottom - 6, top + 6) for x in (right - wide, left)]
    boxes = [(x, y - 10, x + wide, y + 4) for x, y in corners]
    touched = []
    for box in boxes:
        touched.append(sum(overlap(box, other) for other in paper.boxes))
    return paper.write(corners[touched.index(min(touched))], words)


# ---- Singular configurations: one of each kind.

FILE = "singular.svg"
_WIDE, _DRAWN, _ROW = WIDTH / 2, 190.0, 15.0  # px: width and height of a panel, height of a line of words
_TITLES = {
    "icr_on_pivot": "ICR on a pivot", "shared_axle": "axles on one line", "drive": "driven wheels stand still",
    "rolling_rank": "a motion turns no wheel",
}  # fmt: skip


def singular(derivation: Derivation) -> Figure | None:
    """Return ``singular.svg``; None if no configuration is singular except at standstill."""
    robot, mobility = derivation.robot, derivation.mobility
    first: dict[str, tuple[Singularity, Twist]] = {}
    for s in mobility.singularities:
        twist = None if s.kind in first else _twist(s, robot, mobility)
        if twist is not None:
            first[s.kind] = s, twist
    if not first:
        return None
    panels = [(_TITLES.get(s.kind, s.kind), _words(s, mobility), moving(robot, t)) for s, t in first.values()]
    groups: list[Group] = []
    height = 0.0
    for k in range(0, len(panels), 2):
        pair = panels[k : k + 2]
        for j, (title, words, shown) in enumerate(pair):
            left = (j if len(pair) == 2 else 0.5) * _WIDE
            area = (left + 8, height + 22, left + _WIDE - 8, height + 22 + _DRAWN)
            groups += instant(robot, shown, area, title, words)
        height += 22 + _DRAWN + 8 + _ROW * max(len(words) for _, words, _ in pair)
    titles = listed([title for title, *_ in panels])
    return figure(FILE, f"{robot.name} in singular configurations: {titles}.", height + 6, groups)


def _words(s: Singularity, mobility: Mobility) -> list[str]:
    """Return the meaning of a singularity, in lines."""
    others = " (likewise the others)" if sum(o.kind == s.kind for o in mobility.singularities) > 1 else ""
    words = s.meaning.partition(". ")[0]
    return wrapped(plain(words[0].upper() + words[1:] + others), _WIDE - 24)


def _twist(s: Singularity, robot: Robot, mobility: Mobility) -> Twist | None:
    """Return an admissible motion in a singular configuration; None if only standstill is admissible.

    Args:
        s: the singularity.
        robot: the robot.
        mobility: its mobility.

    Returns:
        The twist of P [m/s, rad/s].
    """
    wheels = [robot.wheel(name) for name in s.wheels]
    if not mobility.admissible.linear:
        return None
    _, size = extent(robot.wheels)
    # Rows on (vx, vy, size omega).
    forbidden = null_basis(mobility.admissible.basis * np.array([1.0, 1.0, size]))
    if s.kind == "icr_on_pivot":
        return _turning(wheels[0].pivot, forbidden, size)
    if s.kind == "shared_axle":
        a, b = wheels[0].pivot, wheels[1].pivot
        return _turning(a + 0.6 * (a - b), forbidden, size)
    still = [
        admissible.along(w, w.zero_heading * complex(float(w.nominal.cg), float(w.nominal.sg)))
        for w in wheels
    ]
    free = null_basis(np.vstack([np.array(still) * np.array([1.0, 1.0, 1 / size]), forbidden]))
    if not len(free):
        return None
    vx, vy, turn = max(free.tolist(), key=lambda t: abs(t[2]))
    return (vx, vy, 0.0) if abs(turn) < 1e-9 else (size * vx / turn, size * vy / turn, 1.0)


def _turning(icr: complex, forbidden: Array, size: float) -> Twist | None:
    """Return a rotation of 1 rad/s about a point; None if it is not admissible.

    Args:
        icr: the point [m].
        forbidden: rows that are 0 for admissible (vx, vy, size omega).
        size: size of the robot [m].

    Returns:
        The twist of P [m/s, rad/s].
    """
    twist = (icr.imag, -icr.real, 1.0)
    rest = forbidden @ np.array([twist[0], twist[1], size])
    return twist if np.abs(rest).max(initial=0.0) < 1e-9 * max(size, abs(icr)) else None
