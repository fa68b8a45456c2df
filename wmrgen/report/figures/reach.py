"""Draw the set of twists that the limits allow, in the planes of a joystick."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import cos, hypot, inf, isfinite, pi, sin

from wmrgen.analysis.mobility.records import Array
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.poly import triple
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.report.figures.example import Twist, inside, swung
from wmrgen.report.figures.figure import UP, WIDTH, Figure, Group, figure
from wmrgen.report.figures.instant import number
from wmrgen.report.figures.paper import Paper, Point, along, arrow, num, pair, polygon, wrapped

FILE = "reach.svg"
NAMES, UNITS, SHOWN = ("vx", "vy", "omega"), ("m/s", "m/s", "rad/s"), ("vx", "vy", "ω")
_DIRECTIONS = 144  # directions in which the boundary is computed, every 2.5°
_HALVINGS = 20  # bisections that find a corner to a millionth of a direction step
_SIZE, _ROW = 140.0, 15.0  # px: size of a panel, height of a line of words
Plane = tuple[int, int]  # components of the twist that point up and to the left
# Returns the factor by which a twist may be multiplied until it reaches a limit.
Measure = Callable[[Twist], float]
End = tuple[int, Point]  # number of the limit that is reached in a direction, and the point of the boundary


def reach(derivation: Derivation) -> Figure | None:
    """Return ``reach.svg``.

    It is None if the set is unbounded, if the robot has only one admissible motion, or if no limit of a wheel is
    reached, because the set is a box then.
    """
    robot, free = derivation.driven.robot, derivation.driven.mobility.admissible
    if not free.linear or free.dimension < 2 or _one_sided(robot) or not _limited(robot):
        return None
    planes: list[Plane] = [(0, 1), (0, 2)] if free.dimension == 3 else [_plane(free.basis)]
    drawn = [outline(robot, lift(free.basis, plane)) for plane in planes]
    outlines = [points for points, _ in drawn]
    if any(not isfinite(x) for points in outlines for p in points for x in p):
        return None
    if not any(limit >= len(NAMES) for _, limits in drawn for limit in limits):
        return None
    groups: list[Group] = []
    words = wrapped(f"limits: {_limits(robot)}", WIDTH - 20)
    for k, (plane, points) in enumerate(zip(planes, outlines, strict=True)):
        centre = WIDTH * ((2 * k + 1) / (2 * len(planes)))
        groups.append(_panel(plane, points, (centre, 32 + _SIZE / 2), free.dimension == 3))
    paper = Paper((0.0, 0.0, WIDTH, 400.0))
    below = [paper.write((10.0, 72 + _SIZE + _ROW * k), text) for k, text in enumerate(words)]
    what = " and ".join(f"({SHOWN[a]}, {SHOWN[b]})" for a, b in planes)
    alt = f"The twists of {robot.name} that its limits allow, in {what}."
    return figure(FILE, alt, 66 + _SIZE + _ROW * len(words), [*groups, ("", below)])


def largest_factor(robot: Robot, twist: Twist) -> float:
    """Return the factor by which a twist may be multiplied until it reaches a limit; infinity without limits."""
    return _most(_measures(robot), twist)[0]


def _one_sided(robot: Robot) -> bool:
    """Return whether a limit does not allow standstill."""
    limits = [limit for name in NAMES if (limit := robot.limits.get(name))]
    limits += [limit for w in robot.wheels if (limit := robot.limit(w, "spin"))]
    return any(float(limit.low) > 0 or float(limit.high) < 0 for limit in limits)


def _plane(basis: Array) -> Plane:
    """Return two components that determine an admissible twist; vx and omega are preferred."""
    minors = {
        (a, b): abs(float(basis[0, a] * basis[1, b] - basis[0, b] * basis[1, a]))
        for a, b in ((0, 2), (1, 2), (0, 1))
    }
    return next(plane for plane, minor in minors.items() if minor > 0.05 * max(minors.values()))


def lift(basis: Array, plane: Plane) -> Callable[[float, float], Twist]:
    """Return the function from two components to the admissible twist; a third free component is 0."""
    a, b = plane
    if len(basis) == 3:
        return lambda p, q: (p, q if b == 1 else 0.0, q if b == 2 else 0.0)
    (first, second), minor = basis.tolist(), float(basis[0, a] * basis[1, b] - basis[0, b] * basis[1, a])

    def lifted(p: float, q: float) -> Twist:
        u, v = (p * second[b] - q * second[a]) / minor, (q * first[a] - p * first[b]) / minor
        return triple(u * s + v * t for s, t in zip(first, second, strict=True))

    return lifted


# ---- The set.


def outline(robot: Robot, twist: Callable[[float, float], Twist]) -> tuple[list[Point], set[int]]:
    """Return the boundary of the set in its plane, counter-clockwise, and the numbers of the limits that are reached.

    The set is star-shaped, because an allowed motion is also allowed at lower speed. The boundary is computed in many
    directions. If different limits are reached in two neighbouring directions, the corner between is found by
    bisection. Limits from number 3 on are limits of wheels.
    """
    measures = _measures(robot)
    ends = [_most(measures, twist(*way)) for way in ((1.0, 0.0), (0.0, 1.0))]
    scales = [k if isfinite(k) and k > 0 else 1.0 for k, _ in ends]

    def at(angle: float) -> End:
        p, q = scales[0] * cos(angle), scales[1] * sin(angle)
        k, limit = _most(measures, twist(p, q))
        return limit, (k * p if k else 0.0, k * q if k else 0.0)

    angles = [2 * pi * (k + 0.5) / _DIRECTIONS for k in range(_DIRECTIONS + 1)]
    points: list[Point] = []
    limits: set[int] = set()
    for first, last in pairwise((angle, at(angle)) for angle in angles):
        _, (limit, point) = first
        limits.add(limit)
        points += [point, *_corner(at, first, last)]
    return points, limits


def _corner(at: Callable[[float], End], first: tuple[float, End], last: tuple[float, End]) -> Iterator[Point]:
    (low, start), (high, end) = first, last
    if start[0] == end[0]:
        return
    for _ in range(_HALVINGS):
        centre = (low + high) / 2
        between = at(centre)
        if between[0] == start[0]:
            low, start = centre, between
        else:
            high, end = centre, between
    yield start[1]
    yield end[1]


def _most(measures: Sequence[Measure], twist: Twist) -> tuple[float, int]:
    """Return the factor by which a twist may be multiplied, and the number of the limit that is reached then."""
    factors = ((measure(twist), number) for number, measure in enumerate(measures))
    return min(factors, default=(inf, -1))


def _measures(robot: Robot) -> list[Measure]:
    """Return a measure for each limit: three limits of the twist, then the limits of wheels."""
    limits = [robot.limits.get(name) for name in NAMES]
    limits[1] = limits[1] or limits[0]  # as in limit_twist
    measures = []
    for k, limit in enumerate(limits):
        row = [float(k == i) for i in range(3)]
        measures.append(_linear(row, limit))
    for w in _limited(robot):
        spin, rate = robot.limit(w, "spin"), robot.limit(w, "steer_rate")
        if w.kind.swivels:
            measures += _castor(w, spin, rate)
        elif w.kind.steers:
            measures.append(_steered(robot, w, spin))
        elif w.has_spin:
            c, s, r = cos(w.heading + w.gamma), sin(w.heading + w.gamma), float(w.nominal.rolling_radius)
            measures.append(_linear([c / r, s / r, (w.pivot.real * s - w.pivot.imag * c) / r], spin))
    return measures


def _limited(robot: Robot) -> list[Wheel]:
    """Return the wheels that have limits."""
    return [w for w in robot.wheels if _is_limited(robot, w)]


def _is_limited(robot: Robot, w: Wheel) -> bool:
    return any(robot.limit(w, quantity) for quantity in ("spin", "steer", "steer_rate"))


def _linear(row: list[float], limit: Interval | None) -> Measure:
    a, b, k = row
    low, high = (float(limit.low), float(limit.high)) if limit else (-inf, inf)
    return lambda t: _factor(a * t[0] + b * t[1] + k * t[2], low, high)


def _factor(value: float, low: float, high: float) -> float:
    return inf if abs(value) < 1e-12 else (high if value > 0 else low) / value


def _steered(robot: Robot, w: Wheel, limit: Interval | None) -> Measure:
    """Return the measure of the limits of a steered wheel."""
    low, high = (float(limit.low), float(limit.high)) if limit else (-inf, inf)
    x, y, r, o = w.pivot.real, w.pivot.imag, float(w.nominal.r), float(w.nominal.o)

    def measure(t: Twist) -> float:
        swing = swung(robot, w, t)
        if not inside(robot, w, swing):
            return 0.0
        h = w.heading + swing
        return _factor((cos(h) * (t[0] - y * t[2]) + sin(h) * (t[1] + x * t[2]) - o * t[2]) / r, low, high)

    return measure


def _castor(w: Wheel, spin: Interval | None, rate: Interval | None) -> list[Measure]:
    """Return measures of the limits of a castor, from its largest rates at any angle.

    The rates are r spin = e.v + (o/d) n.v and -d steer_rate = n.v + d omega.

    Args:
        w: the castor.
        spin: limits of its spin [rad/s].
        rate: limits of its steering rate [rad/s].

    Returns:
        A measure for each limit.
    """
    x, y, r = w.pivot.real, w.pivot.imag, float(w.nominal.r)
    d, o = abs(float(w.nominal.d)), float(w.nominal.steer_arm)

    def largest(t: Twist, joint: str) -> float:
        v = hypot(t[0] - y * t[2], t[1] + x * t[2])
        return v * hypot(1.0, o / d) / r if joint == "spin" else v / d + abs(t[2])

    def measure(limit: Interval, joint: str) -> Measure:
        most = min(float(limit.high), -float(limit.low))
        return lambda t: _factor(largest(t, joint), -most, most)

    return [measure(limit, joint) for limit, joint in ((spin, "spin"), (rate, "steer_rate")) if limit]


# ---- The picture.


def _panel(plane: Plane, points: list[Point], centre: Point, section: bool) -> Group:
    most = max(abs(p[0]) for p in points) or 1.0, max(abs(p[1]) for p in points) or 1.0
    half = _SIZE / 2

    def on(p: Point) -> Point:
        return centre[0] - half * p[1] / most[1], centre[1] - half * p[0] / most[0]

    paper = Paper((centre[0] - 118, 2.0, centre[0] + 118, centre[1] + half + 20))
    a, b = plane
    third = 3 - a - b
    tips = along(centre, UP, half + 12), along(centre, (-1.0, 0.0), half + 12)
    axes = [
        *arrow(along(centre, UP, -half - 6), tips[0], "frame", 4.0),
        *arrow(along(centre, (1.0, 0.0), half + 6), tips[1], "frame", 4.0),
    ]
    paper.segments += [(centre, tip) for tip in tips]
    top, side = max(p[0] for p in points), max(p[1] for p in points)
    words = [
        paper.write((centre[0] + 8, centre[1] - half - 6), f"{SHOWN[a]} {number(top)} {UNITS[a]}"),
        paper.write((centre[0] - half - 12, centre[1] - half - 6), f"{SHOWN[third]} = 0") if section else "",
        paper.write(
            (centre[0] - half - 14, centre[1] + half + 18),
            f"{SHOWN[b]} {number(side)} {UNITS[b]} to the left",
        ),
    ]
    shape = polygon(simplified([on(p) for p in points]), "reach")
    at = f' data-plane="{NAMES[a]},{NAMES[b]}" data-most="{most[0]:.6g},{most[1]:.6g}"'
    at += f' data-origin="{pair(centre)}" data-half="{num(half)}"'
    return at, [shape, *axes, *(w for w in words if w)]


def simplified(points: list[Point]) -> list[Point]:
    """Remove points that are on a straight line between their neighbours."""
    kept: list[Point] = []
    for p in points:
        p = (round(p[0], 2) + 0.0, round(p[1], 2) + 0.0)
        if kept and hypot(p[0] - kept[-1][0], p[1] - kept[-1][1]) < 0.02:
            continue
        while len(kept) > 1 and _bend(kept[-2], kept[-1], p) < 0.02:
            kept.pop()
        kept.append(p)
    while len(kept) > 3 and _bend(kept[-1], kept[0], kept[1]) < 0.02:
        kept = kept[1:]
    while len(kept) > 3 and _bend(kept[-2], kept[-1], kept[0]) < 0.02:
        kept = kept[:-1]
    return kept


def _bend(a: Point, b: Point, c: Point) -> float:
    """Return the distance [px] of b from the segment from a to c; infinity if it is beyond its ends."""
    x, y = c[0] - a[0], c[1] - a[1]
    size = hypot(x, y)
    if (b[0] - a[0]) * x + (b[1] - a[1]) * y < 0 or (b[0] - c[0]) * x + (b[1] - c[1]) * y > 0 or not size:
        return inf
    return abs(x * (b[1] - a[1]) - y * (b[0] - a[0])) / size


def _limits(robot: Robot) -> str:
    """Return the limits of twists and wheels in words."""
    words = [
        f"{SHOWN[k]} {_interval(robot.limits[name])} {UNITS[k]}"
        for k, name in enumerate(NAMES)
        if name in robot.limits
    ]
    for quantity, unit in (("spin", "rad/s"), ("steer", "rad")):
        ranges = {_interval(limit) for w in robot.wheels if (limit := robot.limit(w, quantity))}
        words += [f"{quantity} {' or '.join(sorted(ranges))} {unit}"] if ranges else []
    return ", ".join(words)


def _interval(limit: Interval) -> str:
    low, high = float(limit.low), float(limit.high)
    return f"±{number(high)}" if low == -high else f"{number(low)} to {number(high)}"
