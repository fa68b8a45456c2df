"""Motion in space through moving frames: of the contacts, `wheel_motion`, and of a sensor, `cg_force`.

The recursion through moving frames, Kelly (4.23)-(4.29), applied twice is the articulated wheel, Kelly (4.30), (4.31).
The body frame is at P on the ground. The frame of a wheel has its origin on the steering axis at the height of the
axle. It moves along z with the suspension and rotates about z with the steering. In this frame the contact is at d e +
o n - r z, with e along and n across the wheel. All vectors are triples of expressions in body axes.

A sensor that is not at the centre of gravity c measures a specific force t_s that differs from the specific force t at
c: t = t_s + alpha x r + omega x (omega x r), with r from the sensor to c (Kelly 4.1.3).
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import arm, working_view
from wmrgen.geometry.exact.evaluate import add_angles
from wmrgen.geometry.exact.poly import Poly, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, signal, subtract, times

Vector = tuple[Expr, Expr, Expr]
AXES = ("x", "y", "z")
_ZERO = sympy.S.Zero
NOTHING: Vector = (_ZERO, _ZERO, _ZERO)


def vector_ports(name: str, suffix: str, unit: str, text: str) -> tuple[Port, ...]:
    """Return the ports ``<name>x<suffix>``, ``<name>y<suffix>``, ``<name>z<suffix>``.

    Args:
        name: The start of the names.
        suffix: The end of the names.
        unit: The unit of all three.
        text: The description of all three.
    """
    return tuple(Port(f"{name}{axis}{suffix}", Role.COMMAND, unit, text) for axis in AXES)


BODY = (
    *vector_ports("v", "", "m/s", "velocity of P over the ground"),
    *vector_ports("w", "", "rad/s", "angular velocity of the body"),
    *vector_ports("a", "", "m/s^2", "acceleration of P over the ground"),
    *vector_ports("w", "_rate", "rad/s^2", "angular acceleration of the body"),
)


def input_vector(name: str, suffix: str = "") -> Vector:
    """Return the vector of the inputs ``<name>x<suffix>`` and so on."""
    return triple(signal(f"{name}{axis}{suffix}") for axis in AXES)


def named_vector(name: str, v: Vector, names: Locals) -> Vector:
    """Return the vector as the intermediate results ``<name>x`` and so on.

    Args:
        name: The start of the names.
        v: The vector.
        names: Takes the intermediate results.
    """
    return triple(names.define(f"{name}{axis}", entry) for axis, entry in zip(AXES, v, strict=True))


def plus(*vectors: Vector) -> Vector:
    """Return the sum of vectors."""
    return triple(add(*entries) for entries in zip(*vectors, strict=True))


def scaled(factor: Expr, v: Vector) -> Vector:
    """Return factor v."""
    return times(factor, v[0]), times(factor, v[1]), times(factor, v[2])


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return triple(subtract(times(a[i], b[j]), times(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1)))


def dot(a: Vector, b: Vector) -> Expr:
    """Return a . b."""
    return add(*(times(p, q) for p, q in zip(a, b, strict=True)))


class Frame(NamedTuple):
    """The motion of a frame in the frame before it."""

    v: Vector  # velocity
    omega: Vector  # angular velocity
    a: Vector  # acceleration
    alpha: Vector  # angular acceleration


class Point(NamedTuple):
    """The motion of a point in a frame."""

    r: Vector  # position
    v: Vector  # velocity
    a: Vector  # acceleration


def seen_from_before(frame: Frame, origin: Vector, point: Point) -> Point:
    """Return a point in the frame before, one step of the recursion (Kelly (4.23)-(4.25), corrected).

    v = v_f + omega x r + v_o,  a = a_f + alpha x r + omega x (omega x r) + 2 omega x v_o + a_o.

    Args:
        frame: The motion of the frame in the frame before.
        origin: The origin of the frame in the frame before.
        point: The point in the frame.
    """
    turning = cross(frame.omega, point.r)
    v = plus(frame.v, turning, point.v)
    euler, inward = cross(frame.alpha, point.r), cross(frame.omega, turning)
    coriolis = scaled(2, cross(frame.omega, point.v))
    return Point(plus(origin, point.r), v, plus(frame.a, euler, inward, coriolis, point.a))


@function("Kelly (4.23)-(4.31), (4.25) corrected", contacts=True)
def wheel_motion(robot: Robot, _: Mobility) -> Formula:
    """Return velocity and acceleration of every contact for the motion of body, steering and suspension."""
    names = Locals()
    inputs: list[Port] = [*BODY]
    outputs: list[tuple[Port, Expr]] = []
    body = Frame(input_vector("v"), input_vector("w"), input_vector("a"), input_vector("w", "_rate"))
    for w in robot.wheels:
        joints = _joints(w)
        inputs += joints
        contact = seen_from_before(body, NOTHING, in_body(w, joints, names))
        for name, kind, unit, value in (
            ("v", "velocity", "m/s", contact.v),
            ("a", "acceleration", "m/s^2", contact.a),
        ):
            ports = vector_ports(
                f"{w.name}.{name}", "", unit, f"{kind} of the contact over the ground, body axes"
            )
            outputs += zip(ports, value, strict=True)
    return names.formula(
        "wheel_motion",
        (*inputs, *tunable_ports(robot)),
        outputs,
        "motion in space of body, steering and suspension to the motion of the contacts (Kelly (4.30), (4.31))",
    )


def _joints(w: Wheel) -> list[Port]:
    """Return angle, rate and acceleration of the steering, if the wheel turns, then of the suspension."""
    steering = [
        joint_port(w, "steer", Role.STATE),
        joint_port(w, "steer_rate", Role.COMMAND),
        output(f"{w.name}.steer_acceleration", "rad/s^2", "derivative of the steering rate"),
    ]
    return (steering if w.turns else []) + [
        output(
            f"{w.name}.travel", "m", "travel of the suspension, positive when the wheel is up in the body"
        ),
        output(f"{w.name}.travel_rate", "m/s", "rate of the suspension's travel"),
        output(f"{w.name}.travel_acceleration", "m/s^2", "second derivative of the suspension's travel"),
    ]


def in_body(w: Wheel, joints: list[Port], names: Locals) -> Point:
    """Return the contact in the body frame: it is fixed in the wheel's frame, which moves and steers.

    Args:
        w: The wheel.
        joints: Its inputs.
        names: Takes the intermediate results.
    """
    g = working_view(w)
    *steering, travel, rate, acceleration = (signal(port.name) for port in joints)
    _, turning, bending = steering or NOTHING
    along_z = ((_ZERO, _ZERO, value) for value in (rate, turning, acceleration, bending))
    origin = (expression(g.x), expression(g.y), expression(g.r) + travel)
    seen = seen_from_before(Frame(*along_z), origin, Point(_to_contact(w, names), NOTHING, NOTHING))
    parts = zip("rva", (seen.r, seen.v, seen.a), strict=True)
    return Point(*(named_vector(f"{w.name}_{name}", part, names) for name, part in parts))


def _to_contact(w: Wheel, names: Locals) -> Vector:
    """Return d e + o n - r z, from the origin of the wheel's frame to the contact."""
    g = working_view(w)
    if not (g.d or g.o):
        return _ZERO, _ZERO, expression(-g.r)
    e = rolling_direction_at(w, signal(f"{w.name}.steer"), names) if w.turns else (g.ch, g.sh)
    x, y = arm(g, *e)
    return expression(x), expression(y), expression(-g.r)


def rolling_direction_at(w: Wheel, angle: Expr, names: Locals) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the rolling direction of a wheel that turns.

    Args:
        w: The wheel.
        angle: Its joint angle [rad].
        names: Takes the intermediate results.
    """
    g = working_view(w)
    c = names.poly(f"{w.name}_cosine", sympy.cos(angle))
    return add_angles((g.ch, g.sh), (c, names.poly(f"{w.name}_sine", sympy.sin(angle))))


FORCE = vector_ports("f", "", "m/s^2", "specific force a - g at the centre of gravity, robot frame")
_MEASURED = vector_ports("f", "", "m/s^2", "specific force a - g at the sensor, robot frame")
SENSOR = tuple(
    Port(f"sensor.{k}", Role.STATE, "m", "position of the sensor, z above the ground") for k in AXES
)


def centre_of_gravity(robot: Robot, name: str) -> Vector:
    """Return ``cg`` of the robot file. Raise NotDerivableError without one, or with one on the ground."""
    if robot.cg is None:
        why = "it needs the centre of gravity; write cg: {x: 0, y: 0, z: 0.3}, z above the ground"
        raise underivable(robot, name, why, Reason.NO_CENTRE_OF_GRAVITY)
    if robot.cg.z.nominal.sign <= 0:
        raise underivable(robot, name, "cg is not above the ground (z > 0)", Reason.CENTRE_OF_GRAVITY)
    return triple(expression(p.working) for p in robot.cg)


@function("Kelly 4.1.3", contacts=True, reads=("cg",))
def cg_force(robot: Robot, _: Mobility) -> Formula:
    """Return the specific force at the centre of gravity from an accelerometer and a gyroscope."""
    c = centre_of_gravity(robot, "cg_force")
    lever = triple(subtract(entry, signal(port.name)) for entry, port in zip(c, SENSOR, strict=True))
    body = Frame(NOTHING, input_vector("w"), input_vector("f"), input_vector("w", "_rate"))
    force = seen_from_before(body, NOTHING, Point(lever, NOTHING, NOTHING)).a
    turning = tuple(p for p in BODY if p.name.startswith("w"))
    return Formula(
        "cg_force", (*_MEASURED, *SENSOR, *turning, *tunable_ports(robot)), (),
        tuple(zip(FORCE, force, strict=True)),
        "specific force at a sensor to the specific force at the centre of gravity (Kelly 4.1.3)",
    )  # fmt: skip
