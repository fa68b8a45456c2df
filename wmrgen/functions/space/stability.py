"""`stability`: how far a robot is from tipping over. `cg_force`: the force that decides it (after Kelly 4.1.3).

The specific force t = a - g at the centre of gravity c (x forward, y left, z up; at rest (0, 0, 9.81)) is what the
ground gives. The robot stands while the ray from c along -t meets the support polygon. The texts give this
criterion and no formula; the margin is ours: for the edge from contact p to contact q, counter-clockwise,

    M = (c - p) x (q - p),    margin = atan2(-t . M, |t x M|)

which is the angle from the plane through c and the edge to -t: positive inside, 0 where the wheels of the other
edges lift off about this one, at most pi/2. The robot's margin is the least of its edges.

A sensor elsewhere in the body measures t_s, and t = t_s + alpha x r + omega x (omega x r), r from the sensor to c.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import sympy

from wmrgen.functions.registry import function, underivable
from wmrgen.functions.space.support import Edge, edges, spots
from wmrgen.functions.space.wheel_motion import (
    AXES,
    BODY,
    NOTHING,
    Frame,
    Point,
    Vector,
    cross,
    dot,
    input_vector,
    named_vector,
    seen_from_before,
    vector_ports,
)
from wmrgen.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role, output
from wmrgen.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    maximum,
    minimum,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)  # fmt: skip

FORCE = vector_ports("f", "", "m/s^2", "specific force a - g at the centre of gravity, robot frame")
NONE = sympy.Integer(10**9)  # a limit [m/s^2] that does not exist
_TINY = sympy.Rational(1, 10**12)


@dataclass(frozen=True, slots=True)
class _Plane:
    """The plane through the centre of gravity and an edge of the support polygon.

    ``normal``: M, pointing inwards along the ground. ``inside``: not negative where the two contacts make an edge;
    None where they always do.
    """

    edge: Edge
    name: str
    normal: Vector
    inside: Expr | None

    def where_edge(self, value: Expr, otherwise: Expr, suffix: str, names: Locals) -> Expr:
        """``value`` where the pair is an edge; contacts in line with it, to rounding, do not matter."""
        if self.inside is not None:
            value = select(self.inside, times(-1, _TINY), otherwise, value)
        return names.define(f"{self.name}_{suffix}", value)


@function("criterion of Kelly 4.1.3; the margin is ours")
def stability(robot: Robot, _: Mobility) -> Formula:
    """Specific force and present steering angles to the margin of every edge of the support polygon."""
    c = centre_of_gravity(robot, "stability")
    names = Locals()
    places = spots(robot, names)
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
    outputs.append((output("margin", "rad", "least of all edges, negative: tips over"), margin))
    outputs += [entry for axis in (0, 1) for entry in _range(axis, force, planes, names)]
    steers = tuple(joint_port(p.wheel, "steer", Role.STATE) for p in places if p.reach)
    return Formula(
        "stability", (*FORCE, *steers, *tunable_ports(robot)), tuple(names.items), tuple(outputs),
        "specific force to the angle that is left before the robot tips over, per edge of its support polygon",
    )  # fmt: skip


def centre_of_gravity(robot: Robot, name: str) -> Vector:
    """``cg`` of the robot file for the function ``name``. NotDerivableError without one, or with one on the ground."""
    if robot.cg is None:
        why = "it needs the centre of gravity; write cg: {x: 0, y: 0, z: 0.3}, z above the ground"
        raise underivable(robot, name, why)
    if robot.cg.z.nominal.sign <= 0:
        raise underivable(robot, name, "cg is not above the ground (z > 0)")
    x, y, z = (expression(p.working) for p in (robot.cg.x, robot.cg.y, robot.cg.z))
    return x, y, z


def _edge_port(own: list[Edge]) -> Port:
    ends = " or ".join(e.end.wheel.name for e in own)
    some = "; pi while this wheel is inside" if all(e.unless_right for e in own) else ""
    return output(f"{own[0].start.wheel.name}.margin", "rad", f"edge to {ends}{some}")


def _plane(e: Edge, c: Vector, names: Locals) -> _Plane:
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
    return angle_of(times(-1, dot(f, m)), root(add(*(square(entry) for entry in cross(f, m)))))


def _range(axis: int, f: Vector, planes: list[_Plane], names: Locals) -> list[tuple[Port, Expr]]:
    """The range of one horizontal component of the force in which the robot stands, the other two as given.

    Each edge asks t . M <= 0, which is linear in the component.
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
    text = f"f{letter} at which the robot tips over, the rest as given; 1e9: never"
    return [
        (output(f"f{letter}_min", "m/s^2", text), reduce(maximum, lows)),
        (output(f"f{letter}_max", "m/s^2", text), reduce(minimum, highs)),
    ]


_MEASURED = vector_ports("f", "", "m/s^2", "specific force a - g at the sensor, robot frame")
SENSOR = tuple(Port(f"sensor.{k}", Role.STATE, "m", "place of the sensor, z above the ground") for k in AXES)


@function("Kelly 4.1.3")
def cg_force(robot: Robot, _: Mobility) -> Formula:
    """What an accelerometer and a gyroscope measure to the specific force at the centre of gravity."""
    c = centre_of_gravity(robot, "cg_force")
    x, y, z = (subtract(entry, signal(port.name)) for entry, port in zip(c, SENSOR, strict=True))
    body = Frame(NOTHING, input_vector("w"), input_vector("f"), input_vector("w", "_rate"))
    force = seen_from_before(body, NOTHING, Point((x, y, z), NOTHING, NOTHING)).a
    turning = tuple(p for p in BODY if p.name.startswith("w"))
    return Formula(
        "cg_force", (*_MEASURED, *SENSOR, *turning, *tunable_ports(robot)), (),
        tuple(zip(FORCE, force, strict=True)),
        "specific force at a sensor to that at the centre of gravity (Kelly 4.1.3)",
    )  # fmt: skip
