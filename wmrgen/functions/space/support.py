"""The support polygon: which pairs of contacts are its edges, counter-clockwise.

Contacts of castors and of offset wheels move on circles about their steering axes. Whether three contacts turn
left is decided now where no motion changes it, exactly for contacts that stand still; what is left becomes a
condition on the steering angles. Tunable lengths count at their nominal values here; margins follow the tuned ones.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

from wmrgen.constraints import arm, working_view
from wmrgen.exact.number import ZERO, Exact
from wmrgen.functions.registry import underivable
from wmrgen.functions.space.wheel_motion import rolling_direction
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

    start: Spot
    end: Spot
    unless_right: tuple[Spot, ...]


def spots(robot: Robot, names: Locals) -> list[Spot]:
    """The contacts of all wheels."""
    return [_spot(w, names) for w in robot.wheels]


def _spot(w: Wheel, names: Locals) -> Spot:
    g, n = working_view(w), w.nominal
    if not (w.turns and (g.d or g.o)):
        (ax, ay), (bx, by) = arm(g, g.ch, g.sh), arm(n, n.ch, n.sh)
        return Spot(w, expression(g.x + ax), expression(g.y + ay), (n.x + bx, n.y + by), 0.0)
    ax, ay = arm(g, *rolling_direction(w, signal(f"{w.name}.steer"), names))
    x, y = names.define(f"{w.name}_bx", g.x + ax), names.define(f"{w.name}_by", g.y + ay)
    return Spot(w, x, y, (n.x, n.y), math.hypot(float(n.d), float(n.o)))


def edges(robot: Robot, places: list[Spot]) -> list[Edge]:
    """Every pair that is an edge of the polygon, at least for some steering. NotDerivableError without a polygon."""
    pairs = ((a, b) for a in places for b in places if a is not b)
    result = [edge for a, b in pairs if (edge := _edge(a, b, places)) is not None]
    if len({e.start.wheel.index for e in result}) < 3:
        raise underivable(
            robot, "stability", f"its {len(places)} contacts do not span a support polygon; "
            "a robot stands on at least three contacts that are not in one line",
        )  # fmt: skip
    return result


def _edge(a: Spot, b: Spot, places: list[Spot]) -> Edge | None:
    """a -> b, with the contacts that must lie left of it at run time; None where one lies right of it now."""
    if _same(a, b):
        return None
    undecided = []
    for c in places:
        if c is a or c is b:
            continue
        side = _side(a, b, c)
        if side is None:
            undecided.append(c)
        elif side < 0 or (side == 0 and not _between(a, b, c)):
            return None
    return Edge(a, b, tuple(undecided))


def _same(a: Spot, b: Spot) -> bool:
    """True for contacts that stand in one place."""
    return not (a.reach or b.reach) and math.hypot(*map(float, _arrow(a, b))) < _TOLERANCE


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


def _between(a: Spot, b: Spot, c: Spot) -> bool:
    """True where c, in line with a -> b, needs no edge of its own: inside, or a later wheel at an end."""
    for end in (a, b):
        if _same(end, c):
            return c.wheel.index > end.wheel.index
    (ux, uy), (wx, wy) = _arrow(a, b), _arrow(a, c)
    reached = ux * wx + uy * wy
    return reached > ZERO and reached < ux * ux + uy * uy


def polygon(robot: Robot, steer: Mapping[str, float]) -> tuple[str, ...]:
    """The wheels at the corners of the support polygon at given steering angles [rad], counter-clockwise."""
    points: dict[str, complex] = {}
    for w in robot.wheels:
        g, angle = w.nominal, steer.get(w.name, 0.0) if w.turns else 0.0
        e = complex(g.ch, g.sh) * cmath.rect(1, angle)
        points[w.name] = complex(g.x, g.y) + complex(g.d, g.o) * e
    return tuple(_hull(points))


def _hull(points: dict[str, complex]) -> list[str]:
    """Andrew's monotone chain."""
    order = sorted(points, key=lambda name: (points[name].real, points[name].imag))

    def half(names: list[str]) -> list[str]:
        chain: list[str] = []
        for name in names:
            while len(chain) > 1 and not _left(points[chain[-2]], points[chain[-1]], points[name]):
                chain.pop()
            chain.append(name)
        return chain[:-1]

    return half(order) + half(order[::-1])


def _left(a: complex, b: complex, c: complex) -> bool:
    """True where c lies left of a -> b."""
    u, w = b - a, c - a
    return (u.conjugate() * w).imag > _TOLERANCE * abs(u) * abs(w)
