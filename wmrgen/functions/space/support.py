"""The support polygon: which pairs of contacts are its edges, counter-clockwise.

Contacts of castors and of offset wheels move on circles about their steering axes. Whether three contacts turn
left is decided now where no motion changes it, exactly for contacts that stand still; what is left becomes a
condition on the steering angles. Tunable lengths count at their nominal values here; margins follow the tuned ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from wmrgen.constraints import working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import ZERO, Exact
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Robot, Wheel
from wmrgen.symbolic import Expr, expression, signal

_TOLERANCE = 1e-9  # relative: such a triangle is a line


@dataclass(frozen=True, slots=True)
class Spot:
    """A contact: where it is (symbols), the centre of its circle and the radius of it [m]."""

    wheel: Wheel
    x: Expr
    y: Expr
    centre: tuple[Exact, Exact]
    reach: float


@dataclass(frozen=True, slots=True)
class Edge:
    """From contact ``start`` to contact ``end``, wherever every contact of ``unless_right`` lies to its left."""

    start: int
    end: int
    unless_right: tuple[int, ...]


def spots(robot: Robot, names: Locals) -> list[Spot]:
    """The contacts of all wheels."""
    return [_spot(w, names) for w in robot.wheels]


def _spot(w: Wheel, names: Locals) -> Spot:
    g, n = working_view(w), w.nominal
    moves = w.turns and bool(g.d or g.o)
    if not moves:
        x, y = g.x + g.d * g.ch - g.o * g.sh, g.y + g.d * g.sh + g.o * g.ch
        at = (n.x + n.d * n.ch - n.o * n.sh, n.y + n.d * n.sh + n.o * n.ch)
        return Spot(w, expression(x), expression(y), at, 0.0)
    angle = signal(f"{w.name}.steer")
    cos, sin = names.poly(f"{w.name}_c", sympy.cos(angle)), names.poly(f"{w.name}_s", sympy.sin(angle))
    c, s = g.ch * cos - g.sh * sin, g.sh * cos + g.ch * sin
    x = names.poly(f"{w.name}_bx", g.x + g.d * c - g.o * s)
    y = names.poly(f"{w.name}_by", g.y + g.d * s + g.o * c)
    reach = math.hypot(float(n.d), float(n.o))
    return Spot(w, expression(x), expression(y), (n.x, n.y), reach)


def edges(robot: Robot, places: list[Spot]) -> list[Edge]:
    """Every pair that is an edge of the polygon, at least for some steering. NotDerivableError without a polygon."""
    count = range(len(places))
    found = []
    for i in count:
        for j in count:
            conditions = _conditions(places, i, j) if i != j else None
            if conditions is not None:
                found.append(Edge(i, j, conditions))
    if len({e.start for e in found}) < 3:
        raise NotDerivableError(
            f"{robot.name} has no stability: its {len(places)} contacts do not span a support polygon; "
            "a robot stands on at least three contacts that are not in one line"
        )
    return found


def _conditions(places: list[Spot], i: int, j: int) -> tuple[int, ...] | None:
    """The contacts that must lie left of i -> j at run time; None where one lies right of it now."""
    if _same(places[i], places[j]):
        return None
    open_ones = []
    for k in range(len(places)):
        if k in (i, j):
            continue
        side = _side(places[i], places[j], places[k])
        if side is None:
            open_ones.append(k)
        elif side < 0 or (side == 0 and not _between(places, i, j, k)):
            return None
    return tuple(open_ones)


def _same(a: Spot, b: Spot) -> bool:
    """True for contacts that stand in one place."""
    d = math.hypot(*(float(p - q) for p, q in zip(a.centre, b.centre, strict=True)))
    return not (a.reach or b.reach) and d < _TOLERANCE


def _side(a: Spot, b: Spot, c: Spot) -> int | None:
    """1 where c is left of a -> b, -1 right, 0 in line with it; None where that depends on the steering."""
    (ux, uy), (wx, wy) = _arrow(a, b), _arrow(a, c)
    area = float(ux * wy - uy * wx)
    u, w = math.hypot(float(ux), float(uy)), math.hypot(float(wx), float(wy))
    du, dw = a.reach + b.reach, a.reach + c.reach
    doubt = u * dw + w * du + du * dw + _TOLERANCE * u * w
    if abs(area) > doubt:
        return 1 if area > 0 else -1
    return None if du or dw else 0


def _arrow(a: Spot, b: Spot) -> tuple[Exact, Exact]:
    return b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]


def _between(places: list[Spot], i: int, j: int, k: int) -> bool:
    """True where k, in line with i -> j, needs no edge of its own: inside, or a later wheel at an end."""
    a, b, c = places[i], places[j], places[k]
    if _same(a, c) or _same(b, c):
        return k > (i if _same(a, c) else j)
    (ux, uy), (wx, wy) = _arrow(a, b), _arrow(a, c)
    reached = ux * wx + uy * wy
    return reached > ZERO and reached < ux * ux + uy * uy


def polygon(robot: Robot, steer: Mapping[str, float]) -> tuple[str, ...]:
    """The wheels at the corners of the support polygon at given steering angles [rad], counter-clockwise."""
    points: dict[str, tuple[float, float]] = {}
    for w in robot.wheels:
        n, angle = w.nominal, steer.get(w.name, 0.0) if w.turns else 0.0
        ch, sh, d, o = (float(v) for v in (n.ch, n.sh, n.d, n.o))
        c, s = ch * math.cos(angle) - sh * math.sin(angle), sh * math.cos(angle) + ch * math.sin(angle)
        points.setdefault(w.name, (float(n.x) + d * c - o * s, float(n.y) + d * s + o * c))
    return tuple(_hull(points))


def _hull(points: dict[str, tuple[float, float]]) -> list[str]:
    """Andrew's monotone chain."""
    order = sorted(points, key=lambda name: points[name])

    def half(names: list[str]) -> list[str]:
        chain: list[str] = []
        for name in names:
            while len(chain) > 1 and not _left(*(points[n] for n in (*chain[-2:], name))):
                chain.pop()
            chain.append(name)
        return chain[:-1]

    return half(order) + half(order[::-1])


def _left(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    u, w = (b[0] - a[0], b[1] - a[1]), (c[0] - a[0], c[1] - a[1])
    return u[0] * w[1] - u[1] * w[0] > _TOLERANCE * math.hypot(*u) * math.hypot(*w)
