"""`wheel_motion`: what the wheels' contacts do in space, through world, body, suspension and steering.

The recursion through moving frames, Kelly (4.23)-(4.29), taken twice is the articulated wheel, Kelly (4.30), (4.31).
The body frame stands at P on the ground. The frame of a wheel has its origin on the steering axis at the height of the
axle, travels along z with the suspension and turns about z with the steering. In it the contact is at
d e + o n - r z, e along and n across the wheel. All vectors are triples of expressions in body axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.constraints import working_view
from wmrgen.exact.poly import Poly
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import JOINT_TEXT, Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

AXES = ("x", "y", "z")
_ZERO = sympy.S.Zero
NOTHING: Vector = (_ZERO, _ZERO, _ZERO)


def vector_ports(name: str, suffix: str, unit: str, text: str) -> tuple[Port, ...]:
    """``<name>x<suffix>``, ``<name>y<suffix>``, ``<name>z<suffix>``."""
    return tuple(Port(f"{name}{axis}{suffix}", Role.COMMAND, unit, text) for axis in AXES)


BODY = (
    *vector_ports("v", "", "m/s", "velocity of P over the ground"),
    *vector_ports("w", "", "rad/s", "angular velocity of the body"),
    *vector_ports("a", "", "m/s^2", "acceleration of P over the ground"),
    *vector_ports("w", "_rate", "rad/s^2", "angular acceleration of the body"),
)
_STEER = (("steer", "rad", Role.STATE), ("steer_rate", "rad/s", Role.COMMAND))
_SECOND = (("steer_acceleration", "rad/s^2", "derivative of the steering rate"),)
_TRAVEL = (
    ("travel", "m", "of the suspension, positive when the wheel is up in the body"),
    ("travel_rate", "m/s", "rate of the suspension's travel"),
    ("travel_acceleration", "m/s^2", "second derivative of the suspension's travel"),
)


@function("Kelly (4.23)-(4.31), (4.25) corrected")
def wheel_motion(robot: Robot, _: Mobility) -> Formula:
    """Motion of the body, steering and suspension to velocity and acceleration of every contact."""
    names = Locals()
    inputs: list[Port] = [*BODY]
    outputs: list[tuple[Port, Expr]] = []
    body = Frame(given_vector("v"), given_vector("w"), given_vector("a"), given_vector("w", "_rate"))
    for w in robot.wheels:
        inputs += _inputs(w)
        contact = seen_from_before(body, NOTHING, in_body(w, names))
        for name, unit, value in (("v", "m/s", contact.v), ("a", "m/s^2", contact.a)):
            text = (
                f"{'velocity' if name == 'v' else 'acceleration'} of the contact over the ground, body axes"
            )
            outputs += [
                (Port(f"{w.name}.{name}{axis}", Role.COMMAND, unit, text), entry)
                for axis, entry in zip(AXES, value, strict=True)
            ]
    return Formula(
        "wheel_motion", (*inputs, *tunable_ports(robot)), tuple(names.items), tuple(outputs),
        "motion in space of body, steering and suspension to that of the contacts (Kelly (4.30), (4.31))",
    )  # fmt: skip


def given_vector(name: str, suffix: str = "") -> Vector:
    """The vector of the inputs ``<name>x<suffix>`` and so on."""
    x, y, z = (signal(f"{name}{axis}{suffix}") for axis in AXES)
    return x, y, z


def _inputs(w: Wheel) -> list[Port]:
    found: list[Port] = []
    if w.turns:
        found += [Port(f"{w.name}.{n}", role, unit, JOINT_TEXT[n]) for n, unit, role in _STEER]
        found += [Port(f"{w.name}.{n}", Role.COMMAND, unit, text) for n, unit, text in _SECOND]
    return found + [Port(f"{w.name}.{n}", Role.COMMAND, unit, text) for n, unit, text in _TRAVEL]


def in_body(w: Wheel, names: Locals) -> Point:
    """The contact as the body sees it: fixed in the wheel's frame, which travels and steers."""
    g = working_view(w)
    travel, rate, acceleration = (signal(f"{w.name}.{n}") for n, _, _ in _TRAVEL)
    origin = (expression(g.x), expression(g.y), expression(g.r) + travel)
    turn = [signal(f"{w.name}.{n}") if w.turns else _ZERO for n, _, _ in (*_STEER, *_SECOND)]
    frame = Frame(
        (_ZERO, _ZERO, rate), (_ZERO, _ZERO, turn[1]), (_ZERO, _ZERO, acceleration), (_ZERO, _ZERO, turn[2])
    )
    seen = seen_from_before(frame, origin, Point(arm(w, names), NOTHING, NOTHING))
    parts = [
        tuple(names.define(f"{w.name}_{n}{axis}", entry) for axis, entry in zip(AXES, value, strict=True))
        for n, value in (("r", seen.r), ("v", seen.v), ("a", seen.a))
    ]
    (rx, ry, rz), (vx, vy, vz), (ax, ay, az) = parts
    return Point((rx, ry, rz), (vx, vy, vz), (ax, ay, az))


def arm(w: Wheel, names: Locals) -> Vector:
    """d e + o n - r z, from the origin of the wheel's frame to the contact."""
    g = working_view(w)
    if not (g.d or g.o):
        return _ZERO, _ZERO, expression(-g.r)
    c, s = g.ch, g.sh
    if w.turns:
        angle = signal(f"{w.name}.steer")
        cos = names.poly(f"{w.name}_cosine", sympy.cos(angle))
        sin = names.poly(f"{w.name}_sine", sympy.sin(angle))
        c, s = g.ch * cos - g.sh * sin, g.sh * cos + g.ch * sin
    x, y, z = (expression(p) for p in (g.d * c - g.o * s, g.d * s + g.o * c, Poly.of(0) - g.r))
    return x, y, z


Vector = tuple[Expr, Expr, Expr]


def plus(*vectors: Vector) -> Vector:
    """The sum of vectors."""
    x, y, z = (add(*entries) for entries in zip(*vectors, strict=True))
    return x, y, z


def scaled(factor: Expr, v: Vector) -> Vector:
    """factor v."""
    return times(factor, v[0]), times(factor, v[1]), times(factor, v[2])


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    x, y, z = (subtract(times(a[i], b[j]), times(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1)))
    return x, y, z


def dot(a: Vector, b: Vector) -> Expr:
    """a . b."""
    return add(*(times(p, q) for p, q in zip(a, b, strict=True)))


@dataclass(frozen=True, slots=True)
class Frame:
    """What a frame does as the frame before it sees it: velocity, angular velocity and their rates."""

    v: Vector
    omega: Vector
    a: Vector
    alpha: Vector


@dataclass(frozen=True, slots=True)
class Point:
    """A point as a frame sees it: position, velocity, acceleration."""

    r: Vector
    v: Vector
    a: Vector


def seen_from_before(frame: Frame, origin: Vector, point: Point) -> Point:
    """One step of the recursion (Kelly (4.23)-(4.25), corrected): the point as the frame before sees it.

    v = v_f + omega x r + v_o,  a = a_f + alpha x r + omega x (omega x r) + 2 omega x v_o + a_o. ``origin``: of the
    frame, from the frame before.
    """
    turning = cross(frame.omega, point.r)
    v = plus(frame.v, turning, point.v)
    euler, inward = cross(frame.alpha, point.r), cross(frame.omega, turning)
    coriolis = scaled(2, cross(frame.omega, point.v))
    return Point(plus(origin, point.r), v, plus(frame.a, euler, inward, coriolis, point.a))
