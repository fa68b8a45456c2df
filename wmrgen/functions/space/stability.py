"""How far a robot is from tipping over: `stability`, the margins of its support polygon (after Kelly 4.1.3).

The specific force t = a - g at the centre of gravity c (x forward, y left, z up; at rest (0, 0, 9.81)) is the force of
the ground per mass. The robot stands while the ray from c along -t meets the support polygon. The texts give this
criterion and no formula; the margin is ours. For the edge from contact p to contact q, counter-clockwise,

    M = (c - p) x (q - p),    margin = atan2(-t . M, |t x M|)

which is the angle from the plane through c and the edge to -t. It is positive inside, 0 if the wheels of the other
edges lift off about this edge, and at most pi/2. The robot's margin is the smallest margin of its edges.

The support polygon's edges are pairs of contacts, counter-clockwise. Contacts of castors and of offset wheels move on
circles about their steering axes. Whether three contacts turn left is decided here if no steering changes it, exactly
for contacts that do not move. Otherwise it becomes a condition on the steering angles. This decision uses nominal
values of tunable lengths; the margins use the tuned values.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.functions.space.pendulum import axle, hanging_stability
from wmrgen.functions.space.wheel_motion import (
    AXES,
    FORCE,
    Vector,
    centre_of_gravity,
    cross,
    dot,
    input_vector,
    named_vector,
    rolling_direction_at,
)
from wmrgen.geometry.constraints import arm, working_view
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    maximum,
    minimum,
    norm,
    select,
    signal,
    subtract,
    times,
)

NONE = sympy.Integer(10**9)  # [m/s^2]: no limit
_TINY = sympy.Rational(1, 10**12)  # a smaller slope or distance from a line is treated as 0
_TOLERANCE = 1e-9  # relative: a triangle with a smaller area is a line


class Spot(NamedTuple):
    """A contact with the circle on which it moves."""

    wheel: Wheel
    x: Expr  # an expression [m]
    y: Expr  # an expression [m]
    centre: tuple[Exact, Exact]  # centre of its circle, nominal [m]
    reach: float  # radius of its circle [m]


class Edge(NamedTuple):
    """A possible edge of the polygon: it is one if every contact of ``unless_right`` is to its left."""

    start: Spot
    end: Spot
    unless_right: tuple[Spot, ...]  # contacts that the steering may move to the right of it


def _spot(w: Wheel, names: Locals) -> Spot:
    """Return the contact of a wheel."""
    g, n = working_view(w), w.nominal
    if not (w.turns and (g.d or g.o)):
        (ax, ay), (bx, by) = arm(g, g.ch, g.sh), arm(n, n.ch, n.sh)
        return Spot(w, expression(g.x + ax), expression(g.y + ay), (n.x + bx, n.y + by), 0.0)
    ax, ay = arm(g, *rolling_direction_at(w, signal(f"{w.name}.steer"), names))
    x, y = names.define(f"{w.name}_bx", g.x + ax), names.define(f"{w.name}_by", g.y + ay)
    return Spot(w, x, y, (n.x, n.y), math.hypot(float(n.d), float(n.o)))


def edges(robot: Robot, places: list[Spot]) -> list[Edge]:
    """Return every pair that is an edge of the polygon for some steering. Raise NotDerivableError without a polygon."""
    pairs = ((a, b) for a in places for b in places if a is not b)
    result = [edge for a, b in pairs if (edge := _edge(a, b, places)) is not None]
    if len({e.start.wheel.index for e in result}) < 3:
        raise underivable(
            robot,
            "stability",
            f"its {len(places)} contacts do not span a support polygon; "
            "a robot stands on at least three contacts that are not in one line",
            Reason.NO_POLYGON,
        )
    return result


def _edge(a: Spot, b: Spot, places: list[Spot]) -> Edge | None:
    """Return a -> b with the contacts that must be to its left at run time; None if one is always to its right."""
    if _coincide(a, b):
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


def _coincide(a: Spot, b: Spot) -> bool:
    """Return whether two contacts are at one place."""
    return not (a.reach or b.reach) and math.hypot(*map(float, _between_centres(a, b))) < _TOLERANCE


def _side(a: Spot, b: Spot, c: Spot) -> int | None:
    """Return 1 if c is left of a -> b, -1 right, 0 in line with it; None if that depends on the steering."""
    (ux, uy), (wx, wy) = _between_centres(a, b), _between_centres(a, c)
    area = float(ux * wy - uy * wx)
    u, w = math.hypot(float(ux), float(uy)), math.hypot(float(wx), float(wy))
    du, dw = a.reach + b.reach, a.reach + c.reach
    doubt = u * dw + w * du + du * dw + _TOLERANCE * u * w
    if abs(area) > doubt:
        return 1 if area > 0 else -1
    return None if du or dw else 0


def _between_centres(a: Spot, b: Spot) -> tuple[Exact, Exact]:
    """Return the vector from the centre of a to the centre of b."""
    return b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]


def _between(a: Spot, b: Spot, c: Spot) -> bool:
    """Return whether c, in line with a -> b, needs no edge of its own: inside, or a later wheel at an end."""
    for end in (a, b):
        if _coincide(end, c):
            return c.wheel.index > end.wheel.index
    (ux, uy), (wx, wy) = _between_centres(a, b), _between_centres(a, c)
    reached = ux * wx + uy * wy
    return reached > ZERO and reached < ux * ux + uy * uy


class _Plane(NamedTuple):
    """The plane through the centre of gravity and an edge of the support polygon."""

    edge: Edge
    name: str  # prefix of the names of results
    normal: Vector  # M, pointing inwards along the ground
    inside: Expr | None  # not negative if the two contacts make an edge; None if they always do

    def where_edge(self, value: Expr, otherwise: Expr, suffix: str, names: Locals) -> Expr:
        """Return a value that is valid only if the pair is an edge.

        Args:
            value: The value for an edge. Contacts in line with it, up to rounding, make no difference.
            otherwise: The value if the pair is no edge.
            suffix: The end of the name of the result.
            names: Takes the intermediate result.
        """
        if self.inside is not None:
            value = select(self.inside, times(-1, _TINY), otherwise, value)
        return names.define(f"{self.name}_{suffix}", value)


@function("criterion of Kelly 4.1.3; the margin is ours", contacts=True, reads=("cg",))
def stability(robot: Robot, _: Mobility) -> Formula:
    """Return the margin of every edge of the support polygon for a specific force and steering angles.

    For a robot on one axle whose body hangs below it, see `pendulum`.
    """
    c = centre_of_gravity(robot, "stability")
    two = axle(robot)
    if two is not None and robot.cg is not None:
        return hanging_stability(robot, robot.cg, two)
    names = Locals()
    places = [_spot(w, names) for w in robot.bodies]
    planes = [_plane(e, c, names) for e in edges(robot, places)]
    force = input_vector("f")
    outputs: list[tuple[Port, Expr]] = []
    for place in places:
        own = [plane for plane in planes if plane.edge.start is place]
        if own:
            margins = [p.where_edge(_margin(force, p.normal), sympy.pi, "angle", names) for p in own]
            least = names.define(f"{place.wheel.name}_least", reduce(minimum, margins))
            outputs.append((_edge_port([plane.edge for plane in own]), least))
    margin = reduce(minimum, [value for _, value in outputs])
    outputs.append((output("margin", "rad", "smallest margin of all edges; negative: tips over"), margin))
    outputs += [entry for axis in (0, 1) for entry in _range(axis, force, planes, names)]
    steers = tuple(joint_port(p.wheel, "steer", Role.STATE) for p in places if p.reach)
    return names.formula(
        "stability",
        (*FORCE, *steers, *tunable_ports(robot)),
        outputs,
        "specific force to the remaining angle before the robot tips over, per edge of its support polygon",
    )


def _edge_port(own: list[Edge]) -> Port:
    """Return the output for the margin of the edges that start at one contact."""
    ends = " or ".join(e.end.wheel.name for e in own)
    some = "; pi while this wheel is inside" if all(e.unless_right for e in own) else ""
    return output(f"{own[0].start.wheel.name}.margin", "rad", f"edge to {ends}{some}")


def _plane(e: Edge, c: Vector, names: Locals) -> _Plane:
    """Return the plane of an edge."""
    p, q = e.start, e.end
    name = f"edge{p.wheel.index}to{q.wheel.index}"
    along: Vector = (subtract(q.x, p.x), subtract(q.y, p.y), sympy.S.Zero)
    normal = cross((subtract(c[0], p.x), subtract(c[1], p.y), c[2]), along)
    normal = named_vector(f"{name}_m", normal, names)
    sides = [
        subtract(times(along[0], subtract(w.y, p.y)), times(along[1], subtract(w.x, p.x)))
        for w in e.unless_right
    ]
    inside = names.define(f"{name}_inside", reduce(minimum, sides)) if sides else None
    return _Plane(e, name, normal, inside)


def _margin(f: Vector, m: Vector) -> Expr:
    """Return the angle from the plane to the force."""
    return angle_of(times(-1, dot(f, m)), norm(*cross(f, m)))


def _range(axis: int, f: Vector, planes: list[_Plane], names: Locals) -> list[tuple[Port, Expr]]:
    """Return the range of one horizontal component of the force in which the robot stands, the others as given.

    Each edge requires t . M <= 0, which is linear in the component.
    """
    letter = AXES[axis]
    lows, highs = [], []
    for plane in planes:
        m = plane.normal
        rest = times(-1, add(*(times(f[k], m[k]) for k in range(3) if k != axis)))
        up, down = m[axis], times(-1, m[axis])
        high = select(_TINY, up, times(rest, 1 / maximum(up, _TINY)), NONE)
        low = select(_TINY, down, times(-1, rest, 1 / maximum(down, _TINY)), times(-1, NONE))
        highs.append(plane.where_edge(high, NONE, f"high{letter}", names))
        lows.append(plane.where_edge(low, times(-1, NONE), f"low{letter}", names))
    text = f"f{letter} at which the robot tips over, other components as given; 1e9: never"
    return [
        (output(f"f{letter}_min", "m/s^2", text), reduce(maximum, lows)),
        (output(f"f{letter}_max", "m/s^2", text), reduce(minimum, highs)),
    ]


def polygon(robot: Robot, steer: Mapping[str, float]) -> tuple[str, ...]:
    """Return the wheels at the corners of the support polygon at steering angles [rad], counter-clockwise."""
    angles = {w.name: steer.get(w.name, 0.0) if w.turns else 0.0 for w in robot.wheels}
    return tuple(
        _hull({w.name: w.contact(w.zero_heading * cmath.rect(1, angles[w.name])) for w in robot.wheels})
    )


def _hull(points: dict[str, complex]) -> list[str]:
    """Return the convex hull by Andrew's monotone chain."""
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
    """Return whether c is left of a -> b."""
    u, w = b - a, c - a
    return (u.conjugate() * w).imag > _TOLERANCE * abs(u) * abs(w)
