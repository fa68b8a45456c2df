"""Where a function is tested: inputs that together take every branch and come close to singularities.

Standstill; each command alone with both signs, and next to -0; generic commands with their mirror images; declared
limits; very slow and very fast motions; the centre of rotation near and on each pivot; and a pool of points for the
remaining branches. Every number is a float32.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from wmrgen.geometry.ports import NO_SITE, TWIST_NAMES, Limits, Site
from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Op, Port, Role, pruned
from wmrgen.ir.rounding import nearest_float32, to_float64

Array = Any
Point = tuple[str, Array]  # what the point is, one value per port

BRANCH = "branch"  # a point of the pool, kept if it takes branches that no other point takes
_SIZE = {"m/s": 1.5, "rad/s": 2.0, "rad": 3.0, "m": 2.0, "s": 0.25}  # typical sizes by unit
_GENERIC, _POOL, _ROWS = 6, 320, 64  # generic points, points of the pool, rows of a grid
_ANGLES = (
    1.515625,
    -1.453125,
    4.59375,
    -1.625,
    3.0625,
    -64.40625,
    98.9375,
    1.40625,
)  # near quarter turns [rad]
_MANY, _ALONE = (
    10,
    8,
)  # functions of more than _MANY inputs have long rows; at most _ALONE inputs are tried alone
_LARGE = 600  # operations: larger functions take long and have a smaller pool
_BEYOND = 1 + 2.0**-11  # times a limit: just outside [1]
_STEPS = (2.0**-11, 4.0)  # a very short and a long time step [s]
_FAINT = 2.0**-13  # times a limit: a small command next to a large one [1]
_ANGLED = (".steer", ".steer_wanted")  # not scaled up: tolerances hold for sines of up to 100 rad


class Grid:
    """Generic values of some ports: rows with one value per port, in multiples of 1/128 of a typical size."""

    def __init__(self, ports: Sequence[Port], site: Site) -> None:
        sizes = np.array([_size(port, site) for port in ports])
        row, column = np.ogrid[0:_ROWS, 0 : len(ports)]
        spread = (row * 37 + column * 23 + row * column * 5 + 11) % 62 - 31
        self.rows = np.rint(sizes * (spread + (spread >= 0)) * 4) / 128  # never zero
        self.single = np.maximum(np.rint(sizes * 96) / 128, 1 / 128)


def _size(port: Port, site: Site) -> float:
    """Return a typical size of a port: that of its unit, or its limit if that is smaller."""
    size = 20.0 if port.name.endswith(".spin") else _SIZE.get(port.unit, 1.0)
    low, high = site.limits.get(port.name, (-size, size))
    return min(size, max(abs(low), abs(high)))


def points(function: Function, ports: Sequence[Port], site: Site) -> Iterator[Point]:
    """Yield the points at which a function is tested.

    Args:
        function: the function.
        ports: its inputs that vary; a point has a value for each.
        site: limits and pivots of the robot.
    """
    grid = Grid(ports, site)
    moving = np.array([p.role is Role.COMMAND for p in ports])
    scaled = moving & np.array([p.unit != "s" and not p.name.endswith(_ANGLED) for p in ports])
    yield "all zero", np.zeros(len(ports))
    yield "standstill", np.where(moving, 0.0, grid.rows[3])
    for column in np.flatnonzero(moving)[:_ALONE].tolist():
        alone = np.zeros(len(ports))
        alone[column] = grid.single[column]
        yield f"{ports[column].name} alone", alone
        if moving.sum() <= 4:
            backwards = np.where(moving, 0.0 - alone, grid.rows[3])
            yield f"{ports[column].name} alone, backwards", backwards
            if ports[column].name in TWIST_NAMES and len(ports) <= _MANY:
                yield f"{ports[column].name} alone, beside -0", np.where(backwards == 0, -0.0, backwards)
    generic = _GENERIC if len(ports) <= _MANY else _GENERIC - 1
    for row in range(generic):
        yield "generic", grid.rows[row]
        if row < generic // 2:
            yield "the same backwards", np.where(moving, -grid.rows[row], grid.rows[row])
    for power, text in ((-14, "very slow"), (7, "fast"), (12, "very fast")):
        factor = np.where(scaled, 2.0**power, 1.0)
        yield text, grid.rows[17 + power] * factor
    free = Grid(ports, NO_SITE)  # without limits, because code must be correct beyond them
    stretch = np.array([{"m/s": 8.0, "rad/s": 0.25}.get(p.unit, 1.0) for p in ports])
    for row in (41, 42, 43):
        yield "a long arc", free.rows[row] * np.where(moving, stretch, 1.0)
    yield from _all_round(ports, free, moving)
    yield from _extremes(ports, site, grid)
    yield from _centres(ports, site, grid)
    yield from _limiting(function, ports, site, grid)
    if any(p.name == "slip" for p in ports):
        yield "a little slip", np.array([2.0**-6 if p.name == "slip" else 0.0 for p in ports])
    if any(_chooses(node.op) for node in function.nodes):
        timed = np.array([p.unit == "s" for p in ports])
        if timed.any():
            yield "a short step", np.where(timed, _STEPS[0], grid.rows[5])
        pool = _POOL if len(function.nodes) <= _LARGE else _POOL // 10
        for row, values in enumerate(_scattered(ports, pool)):
            yield BRANCH, values * (1.0, 0.125, 4.0)[row % 3]


def _all_round(ports: Sequence[Port], free: Grid, moving: Array) -> Iterator[Point]:
    """Yield angles near quarter turns, where sines are extreme, at the origin, where no position hides an error."""
    angle = np.array([port.unit == "rad" for port in ports])
    if not angle.any():
        return
    place = np.array([port.unit == "m" and port.role is not Role.COMMAND for port in ports])
    turning = np.array([port.unit == "rad/s" for port in ports])
    for k in range(len(_ANGLES)):
        angles = np.array([_ANGLES[(k + 5 * column) % len(_ANGLES)] for column in range(len(ports))])
        values = np.where(moving & turning, free.rows[44 + k] * 2.0 ** (k % 4), free.rows[44 + k])
        yield "all round", np.where(angle, angles, np.where(place, 0.0, values))


def _scattered(ports: Sequence[Port], count: int) -> Array:
    """Return a pool of pseudo-random rows, which exceed declared limits, because code must be correct beyond them."""
    sizes = np.array([_size(port, NO_SITE) for port in ports])
    row, column = np.ogrid[0:count, 0 : len(ports)]
    mixed = (row * 0x9E3779B1 + column * 0x85EBCA6B + 0x27D4EB2F) & 0xFFFFFFFF
    for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39)):
        mixed = ((mixed ^ mixed >> shift) * factor) & 0xFFFFFFFF
    return np.rint(sizes * ((mixed >> 7) % 255 - 127)) / 128 + 0.0


def _extremes(ports: Sequence[Port], site: Site, grid: Grid) -> Iterator[Point]:
    """Yield a point with every limited input at its limit; and joints just beyond their limits, at standstill."""
    limits = [site.limits.get(p.name) for p in ports]
    if not any(limits):
        return
    limited = np.array([limit is not None for limit in limits])
    state = np.array([p.role is not Role.COMMAND for p in ports])
    for side, text in ((1, "upper limits"), (0, "lower limits")):
        at = np.array([limit[side] if limit else 0.0 for limit in limits])
        yield text, np.where(limited, _single(at), grid.rows[9 + side])
        if (limited & state).any():
            yield f"just beyond {text}", np.where(limited & state, _single(at * _BEYOND), 0.0)


def _single(values: Array) -> Array:
    return np.array([nearest_float32(x) for x in values.tolist()])


def _centres(ports: Sequence[Port], site: Site, grid: Grid) -> Iterator[Point]:
    names = [p.name for p in ports]
    if not set(TWIST_NAMES) <= set(names):
        return
    where = [names.index(n) for n in TWIST_NAMES]
    for row, (name, x, y) in enumerate(site.pivots):
        for off, text in ((1 / 64, "near"), (0.0, "on")):
            point = grid.rows[(row + 5) % _ROWS].copy()
            point[where] = nearest_float32(y - off / 2), -nearest_float32(x + off), 1.0
            yield f"centre of rotation {text} {name}", point


def _limiting(function: Function, ports: Sequence[Port], site: Site, grid: Grid) -> Iterator[Point]:
    """Yield large commands for functions that enforce limits: one command alone, and all with each once the largest.

    They exceed the limits if the function accepts that. Functions that go from one value towards another get very short
    and long time steps.
    """
    steps = any(p.name.endswith(("_last", "_wanted")) for p in ports)
    asked = function.limits is Limits.ASKED
    if not (steps or asked):
        return
    timed = np.array([p.unit == "s" for p in ports])
    driven = np.array([p.role is Role.COMMAND for p in ports]) & ~timed
    ends = np.array(
        [site.limits.get(p.name, (-size, size)) for p, size in zip(ports, grid.single, strict=True)]
    )
    columns = np.cumsum(driven) - 1
    count = min(int(driven.sum()), _ALONE)
    for step, k, side in product(_STEPS if steps else (0.0,), range(count), (0, 1)):
        large = (
            np.where(columns == k, 2.0 if asked else 0.75, _FAINT if asked or side else 0.0) * ends[:, side]
        )
        yield "one large command", np.where(timed, step, np.where(driven, _single(large), 0.0))
    for k, way in product(range(min(count, 4)), (1, -1)):
        order = (way * columns + k) % count
        large = (
            np.where((order + k) % 2, -1.0, 1.0)
            * (1.25 + order / count)
            * (1.0 if asked else 0.5)
            * ends[:, 1]
        )
        yield "large commands", np.where(timed, grid.rows[k], np.where(driven, _single(large), 0.0))


# ---- near thresholds

Threshold = tuple[int, float]  # node, and its value at the threshold
Segment = tuple[Threshold, int, int]  # the rows of points below and above a threshold
Values = Callable[[Array, Function], list[Array]]  # of every node at points, one column per port
NEAR_THRESHOLD = "near a threshold"
_STEP, _NEAR = 5e-4, 2e-4  # distance from a threshold and tolerance of that [share of the threshold]
_LEAST = 1e-2  # smaller constants are no thresholds: they guard divisors and switch to series
_HALVINGS, _MOST, _PAIRS = 40, 11, 4  # bisections, thresholds of a function, segments for each


def near_thresholds(
    function: Function, ports: Sequence[Port], rows: Array, prepared: Mapping[str, Array]
) -> Iterator[Point]:
    """Yield points on both sides of each threshold that segments between given points cross.

    Args:
        function: the function.
        ports: its inputs that vary.
        rows: points, one column per port.
        prepared: values of the other inputs by name.
    """
    if not len(rows) or not any(_chooses(n.op) or n.op is Op.RINT for n in function.nodes):
        return

    @np.errstate(all="ignore")
    def at(points: Array, run: Function) -> list[Array]:
        columns = {port.name: points[:, k] for k, port in enumerate(ports)}
        return values_of(run, {**prepared, **columns}, np.float64)

    segments = _segments(function, at(rows, function), len(rows))
    if segments:
        yield from _near_goals(function, rows, segments, at)


def _chooses(op: Op) -> bool:
    return op.cost == "comparisons"


def _segments(function: Function, values: Sequence[Array], count: int) -> list[Segment]:
    """Return several segments across each threshold, because on some of them the value jumps over it."""
    segments: list[Segment] = []
    for node, goal in _goals(function, values):
        column = np.broadcast_to(values[node], count)
        below, above = np.flatnonzero(column < goal), np.flatnonzero(column > goal)
        if len(below) and len(above) and len(segments) < _MOST * _PAIRS:
            for k in range(_PAIRS):
                segments.append(((node, goal), int(below[k % len(below)]), int(above[-1 - k % len(above)])))
    return segments


def _near_goals(function: Function, rows: Array, segments: Sequence[Segment], at: Values) -> Iterator[Point]:
    """Yield the first point found just below each threshold, by bisection of the segments across it."""
    thresholds = [threshold for threshold, _, _ in segments]
    needed = tuple(dict.fromkeys(node for node, _ in thresholds))
    short = pruned(replace(function, results=needed))
    place = dict(zip(needed, short.results, strict=True))
    goals = np.array([goal for _, goal in thresholds])

    def reached(points: Array) -> Array:
        values = at(points, short)
        return np.array([values[place[node]][k] for k, (node, _) in enumerate(thresholds)])

    low, high = rows[[below for _, below, _ in segments]], rows[[above for _, _, above in segments]]
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        under = reached(middle) < goals
        low, high = np.where(under[:, None], middle, low), np.where(under[:, None], high, middle)
    points = low.astype(np.float32).astype(np.float64)
    met: set[Threshold] = set()
    for k, near in enumerate(np.abs(reached(points) - goals) <= _NEAR * np.abs(goals)):
        if near and thresholds[k] not in met:
            met.add(thresholds[k])
            yield NEAR_THRESHOLD, points[k]


def _goals(function: Function, values: Sequence[Array]) -> list[Threshold]:
    """Return both sides of every threshold; first beyond limits and short of roundings, where larger constants show."""
    thresholds = _thresholds(function, values)
    first = [(node, value * (1 - _STEP if half else 1 + _STEP)) for node, value, half in thresholds]
    return first + [(node, value * (1 + _STEP if half else 1 - _STEP)) for node, value, half in thresholds]


def _thresholds(function: Function, values: Sequence[Array]) -> list[tuple[int, float, bool]]:
    """Return (node, threshold, whether it is half a whole number) of every choice and rounding."""
    thresholds: dict[tuple[int, float, bool], None] = {}
    for node in function.nodes:
        if _chooses(node.op):
            signs = (1, -1) if node.op in (Op.CLAMP, Op.AT_LEAST) else (1,)
            for c, other in (node.args[:2], node.args[1::-1]):
                value = function.nodes[c].value
                threshold = 0.0 if value is None else to_float64(value)
                if abs(threshold) >= _LEAST:
                    thresholds |= {(other, sign * threshold, False): None for sign in signs}
        elif node.op is Op.RINT:
            inner = node.args[0]
            far = np.sort(np.atleast_1d(values[inner]))
            for end in (far[1], far[-2]) if len(far) > 3 else ():
                thresholds[inner, float(np.trunc(end) + np.copysign(0.5, -end)), True] = None
    return [threshold for threshold in thresholds if threshold[1]]
