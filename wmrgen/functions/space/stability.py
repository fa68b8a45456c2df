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

from collections.abc import Callable
from fractions import Fraction

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.functions.registry import function
from wmrgen.functions.space.support import Edge, Spot, edges, spots
from wmrgen.functions.space.wheel_motion import (
    AXES,
    BODY,
    NOTHING,
    Frame,
    Point,
    Vector,
    cross,
    dot,
    given_vector,
    seen_from_before,
    vector_ports,
)
from wmrgen.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    maximum,
    minimum,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)  # fmt: skip

FORCE = vector_ports("f", "", "m/s^2", "specific force a - g at the centre of gravity, robot frame")
NONE = sympy.Integer(10**9)  # a limit [m/s^2] that does not exist
_TINY = number(Exact(Fraction(1, 10**12)))
_ZERO = sympy.S.Zero


@function("criterion of Kelly 4.1.3; the margin is ours")
def stability(robot: Robot, _: Mobility) -> Formula:
    """Specific force and present steering angles to the margin of every edge of the support polygon."""
    c = centre_of_gravity(robot, "stability")
    names = Locals()
    places = spots(robot, names)
    found = edges(robot, places)
    f = (signal("fx"), signal("fy"), signal("fz"))
    normals = {e: _normal(places, e, c, names) for e in found}
    valid = {e: _condition(places, e, names) for e in found}
    margins = {e: _where(valid[e], _margin(f, normals[e]), sympy.pi, names, _name(e, "angle")) for e in found}
    outputs: list[tuple[Port, Expr]] = []
    for i, place in enumerate(places):
        own = [e for e in found if e.start == i]
        if own:
            least = names.define(f"{place.wheel.name}_least", _fold([margins[e] for e in own], minimum))
            outputs.append((_edge_port(places, own), least))
    every = _fold([value for _, value in outputs], minimum)
    outputs.append((Port("margin", Role.COMMAND, "rad", "least of all edges, negative: tips over"), every))
    outputs += _ranges(f, normals, valid, names, places)
    steers = tuple(joint_port(p.wheel, "steer", Role.STATE) for p in places if p.reach)
    return Formula(
        "stability", (*FORCE, *steers, *tunable_ports(robot)), tuple(names.items), tuple(outputs),
        "specific force to the angle that is left before the robot tips over, per edge of its support polygon",
    )  # fmt: skip


def centre_of_gravity(robot: Robot, function: str) -> Vector:
    """``cg`` of the robot file. NotDerivableError without one, or with one on the ground."""
    if robot.cg is None:
        raise NotDerivableError(
            f"{robot.name} has no {function}: it needs the centre of gravity; write cg: {{x: 0, y: 0, z: 0.3}}, "
            "z above the ground"
        )
    if robot.cg.z.nominal.sign <= 0:
        raise NotDerivableError(f"{robot.name} has no {function}: cg is not above the ground (z > 0)")
    x, y, z = (expression(p.working) for p in (robot.cg.x, robot.cg.y, robot.cg.z))
    return x, y, z


def _name(e: Edge, suffix: str) -> str:
    return f"edge{e.start}to{e.end}_{suffix}"


def _edge_port(places: list[Spot], own: list[Edge]) -> Port:
    ends = " or ".join(places[e.end].wheel.name for e in own)
    some = "; pi while this wheel is inside" if all(e.unless_right for e in own) else ""
    return Port(f"{places[own[0].start].wheel.name}.margin", Role.COMMAND, "rad", f"edge to {ends}{some}")


def _normal(places: list[Spot], e: Edge, c: Vector, names: Locals) -> Vector:
    """M: normal to the plane through the centre of gravity and the edge, pointing inwards along the ground."""
    p, q = places[e.start], places[e.end]
    arm = (subtract(c[0], p.x), subtract(c[1], p.y), c[2])
    m = cross(arm, (subtract(q.x, p.x), subtract(q.y, p.y), _ZERO))
    x, y, z = (names.define(_name(e, f"m{k}"), entry) for k, entry in zip("xyz", m, strict=True))
    return x, y, z


def _margin(f: Vector, m: Vector) -> Expr:
    return angle_of(times(-1, dot(f, m)), root(add(*(square(entry) for entry in cross(f, m)))))


def _condition(places: list[Spot], e: Edge, names: Locals) -> Expr | None:
    """Not negative where the pair is an edge; None where it always is."""
    if not e.unless_right:
        return None
    p, q = places[e.start], places[e.end]
    sides = []
    for k in e.unless_right:
        w = places[k]
        left = times(subtract(q.x, p.x), subtract(w.y, p.y))
        sides.append(subtract(left, times(subtract(q.y, p.y), subtract(w.x, p.x))))
    return names.define(_name(e, "inside"), _fold(sides, minimum))


def _where(condition: Expr | None, value: Expr, otherwise: Expr, names: Locals, name: str) -> Expr:
    """``value`` where the pair is an edge; contacts in line with it, to rounding, do not matter."""
    chosen = value if condition is None else select(condition, times(-1, _TINY), otherwise, value)
    return names.define(name, chosen)


def _fold(values: list[Expr], choose: Callable[[Expr, Expr], Expr]) -> Expr:
    total = values[0]
    for value in values[1:]:
        total = choose(total, value)
    return total


def _ranges(
    f: Vector, normals: dict[Edge, Vector], valid: dict[Edge, Expr | None], names: Locals, places: list[Spot]
) -> list[tuple[Port, Expr]]:
    """The range of each horizontal component in which the robot stands, the other two as given.

    Each edge asks t . M <= 0, which is linear in the component.
    """
    outputs: list[tuple[Port, Expr]] = []
    for axis, letter in enumerate("xy"):
        lows, highs = [], []
        for e, m in normals.items():
            rest = times(-1, add(*(times(f[k], m[k]) for k in range(3) if k != axis)))
            slope = m[axis]
            high = select(_TINY, slope, times(rest, 1 / maximum(slope, _TINY)), NONE)
            down = times(-1, slope)
            low = select(_TINY, down, times(-1, rest, 1 / maximum(down, _TINY)), times(-1, NONE))
            highs.append(_where(valid[e], high, NONE, names, _name(e, f"high{letter}")))
            lows.append(_where(valid[e], low, times(-1, NONE), names, _name(e, f"low{letter}")))
        text = f"f{letter} at which the robot tips over, the rest as given; 1e9: never"
        outputs += [
            (Port(f"f{letter}_min", Role.COMMAND, "m/s^2", text), _fold(lows, maximum)),
            (Port(f"f{letter}_max", Role.COMMAND, "m/s^2", text), _fold(highs, minimum)),
        ]
    return outputs


SENSOR = tuple(Port(f"sensor.{k}", Role.STATE, "m", "place of the sensor, z above the ground") for k in AXES)
_MEASURED = tuple(
    Port(p.name, p.role, p.unit, "specific force a - g at the sensor, robot frame") for p in FORCE
)


@function("Kelly 4.1.3")
def cg_force(robot: Robot, _: Mobility) -> Formula:
    """What an accelerometer and a gyroscope measure to the specific force at the centre of gravity."""
    c = centre_of_gravity(robot, "cg_force")
    x, y, z = (subtract(c[k], signal(port.name)) for k, port in enumerate(SENSOR))
    body = Frame(NOTHING, given_vector("w"), given_vector("f"), given_vector("w", "_rate"))
    found = seen_from_before(body, NOTHING, Point((x, y, z), NOTHING, NOTHING)).a
    turning = tuple(p for p in BODY if p.name.startswith("w"))
    return Formula(
        "cg_force", (*_MEASURED, *SENSOR, *turning, *tunable_ports(robot)), (),
        tuple(zip(FORCE, found, strict=True)),
        "specific force at a sensor to that at the centre of gravity (Kelly 4.1.3)",
    )  # fmt: skip
