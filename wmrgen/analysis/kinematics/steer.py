"""Where a steered wheel should point, and how fast its rim then moves.

Two headings roll, half a turn apart: the angle theta of the line along which the pivot moves, and those
k half turns away. k = rint((theta - present) / pi) gives the nearest, at most 90 degrees away; the wheel drives
along it with the speed of the pivot, reversed where k is odd. At standstill the present angle is held.

A steered wheel rolls along its pivot's velocity (a, b) forwards or backwards, so only the line matters. With the
size s = sqrt(a**2 + b**2), half the angle of the line has the tangent +-b / (s + |a|), its sign that of a: it lies in
[-1, 1], from one quotient and one arctangent, and nothing cancels. The divisor is kept above `STILL`, so that whoever
reads the C, an analyser too, sees that it is not zero.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import mpmath
import sympy

from wmrgen.analysis.kinematics.pivots import Velocity, components
from wmrgen.analysis.kinematics.records import Call, Formula, Locals
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.evaluate import PRECISION, add_angles, circle_point, to_fraction, to_mpf, twelfths
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    alternating,
    arctangent,
    at_least,
    expression,
    kept_between,
    maximum,
    nearest,
    norm,
    number,
    select,
    signal,
    square,
    subtract,
    times,
    with_sign_of,
)

STILL = Exact(Fraction(1, 10**20))  # m/s
# 1/pi, rounded down by 3e-11 of it: a swing of 90 degrees keeps its branch in every arithmetic.
PER_HALF_TURN = Exact(Fraction(31830988617, 10**11))
QUARTER = Exact(Fraction(1570796326794896619, 10**18))  # rad
HYSTERESIS = QUARTER / 18  # 5 degrees
NARROW = Exact(Fraction(157, 100))  # rad between limits, just under a quarter turn


class Target(NamedTuple):
    """Commanded angle [rad], rim speed of the pivot [m/s] and, where it may slide, its lateral speed
    [m/s] of either sign."""

    steer: Expr
    rim: Expr
    lateral: Expr | None = None
    spin: Expr | None = None  # [rad/s], where it is known already


class Line(NamedTuple):
    """``heading``: joint angle [rad] of one direction of the line, that in which the pivot moves where a >= 0.

    ``size``: of the velocity [m/s]. Up to `STILL` the pivot counts as standing, and there is no heading.
    """

    heading: Expr
    size: Expr


def line(a: Expr, b: Expr, zero: Expr, names: Locals, name: str) -> Line:
    """The line of the velocity (a, b) [m/s] in a frame at the angle ``zero`` [rad] short of the joint's zero."""
    size = names.define(f"{name}size", norm(a, b))
    safe = names.define(f"{name}size_safe", maximum(number(STILL), size))
    slope = names.define(f"{name}slope", b / add(safe, absolute(a)))
    heading = times(with_sign_of(sympy.Integer(2), a), arctangent(slope))
    return Line(subtract(heading, zero), size)


def turned_by(w: Wheel, velocity: Velocity, angle: Exact = ZERO) -> Velocity:
    """The velocity along and across the wheel at joint angle ``angle``."""
    g = working_view(w)
    c, s = g.ch, g.sh
    if angle:
        cosine, sine = circle_point(angle.rational())
        c, s = add_angles((c, s), (Poly.of(cosine), Poly.of(sine)))
    return velocity[0] * c + velocity[1] * s, velocity[1] * c - velocity[0] * s


def near_zero(w: Wheel, velocity: Velocity) -> tuple[Velocity, Expr]:
    """The velocity in a frame at a fixed angle [rad] short of the wheel's zero, and that angle.

    Turning by a quarter is free and by a tunable angle there is no other way. By any other the velocity is left in
    the robot frame, where its cancelling terms have the plain coordinates of the pivot for factors.
    """
    g = working_view(w)
    c, s = g.ch.constant, g.sh.constant
    if c is None or s is None or not (c and s):
        return turned_by(w, velocity), sympy.S.Zero
    for k in range(24):
        if twelfths(k) == (c, s):
            return velocity, times(sympy.Rational(k if k <= 12 else k - 24, 12), sympy.pi)
    with mpmath.workdps(PRECISION):
        angle = mpmath.atan2(to_mpf(s.rational()), to_mpf(c.rational()))
    return velocity, number(Exact(to_fraction(angle)))


def steer_one(robot: Robot, w: Wheel, velocity: Velocity, names: Locals) -> Target:
    """A wheel steered on its own."""
    limits, g = robot.limit(w, "steer"), working_view(w)
    if limits is not None and limits.high - limits.low <= NARROW:
        return _narrow(robot, w, limits, velocity, names)
    (x, y), zero = near_zero(w, velocity)
    a, b = components(
        (x, y), names, *((f"{w.name}_{k}", f"v_A{k} of {w.name}") for k in "xy"), precise=robot.precise
    )
    alone = limits is None and not g.o and [w] in robot.together("spin", robot.wheels)
    per_rim = expression(g.r.inverse()) if alone else sympy.S.One
    now = present(w, limits)
    heading_, spin = _along(a, b, now, per_rim, zero, names, f"{w.name}_")
    steer = names.define(f"{w.name}_nearest", heading_)
    rim = names.define(f"{w.name}_spin" if alone else f"{w.name}_rim", spin)
    if not (a.is_number or b.is_number):
        kernel, frame = (_KERNELS[0], ()) if zero.is_zero else (_KERNELS[1], (zero,))
        names.calls.append(Call(kernel, (a, b, now, per_rim, *frame), (rim, steer)))
    if limits is not None:
        return _limited(w, limits, steer, rim, names)
    return Target(steer, times(expression(g.r), rim), spin=rim) if alone else Target(steer, rim)


def _along(
    a: Expr, b: Expr, now: Expr, per_rim: Expr, zero: Expr, names: Locals, name: str
) -> tuple[Expr, Expr]:
    """Angle and spin along the velocity (a, b) of a pivot, in a frame ``zero`` [rad] short of the joint's zero."""
    way = line(a, b, zero, names, name)
    heading_ = names.define(f"{name}heading", select(way.size, number(STILL), now, way.heading))
    turns = nearest(times(number(PER_HALF_TURN), subtract(heading_, now)))
    forwards = with_sign_of(times(per_rim, way.size), a)
    return subtract(heading_, times(sympy.pi, turns)), times(alternating(turns), forwards)


def _kernel(name: str, text: str, *ports: tuple[str, str]) -> Formula:
    """`_along` as a function of its own; a frame at the joint's zero where no port is called zero."""
    names, signals = Locals(), {port: signal(port) for port, _ in ports}
    zero = signals.get("zero", sympy.S.Zero)
    steer, spin = _along(signals["x"], signals["y"], signals["now"], signals["per_rim"], zero, names, "")
    inputs = tuple(Port(port, Role.STATE, unit, "") for port, unit in ports)
    outputs = (
        (Port("spin", Role.COMMAND, "rad/s", ""), spin),
        (Port("steer", Role.COMMAND, "rad", ""), steer),
    )
    return names.formula(name, inputs, outputs, text)


_PORTS = (("x", "m/s"), ("y", "m/s"), ("now", "rad"), ("per_rim", "1/m"))
_TEXT = (
    "Steers along the velocity (x, y) [m/s] of a pivot, to the heading [rad] nearest to the present one, at most a "
    "quarter turn away, and rolls backwards where that is shorter. At standstill the present angle is held. per_rim: "
    "spin [rad/s] per speed of the rim [m/s]"
)
_FROM = f"{_TEXT}. zero [rad]: of the joint, in the frame of x and y."
_KERNELS = (
    _kernel("steer_along", f"{_TEXT}.", *_PORTS),
    _kernel("steer_along_from", _FROM, *_PORTS, ("zero", "rad")),
)


def present(w: Wheel, limits: Interval | None) -> Expr:
    """The wheel's angle; what stands outside the limits counts as at the limit."""
    now = signal(f"{w.name}.steer")
    if limits is None:
        return now
    return kept_between(number(limits.low), now, number(limits.high))


def _limited(w: Wheel, limits: Interval, steer: Expr, rim: Expr, names: Locals) -> Target:
    """The nearest heading, or its opposite where that one fits the limits better; no further than the limit."""
    speed, ends = names.define(f"{w.name}_rim", rim), turning_points(limits)
    target = turned_back(steer, ends)
    if ends == limits:
        back = select(steer, number(ends.low), times(-1, speed), speed)
        return Target(target, select(number(ends.high), steer, times(-1, speed), back))
    target = names.define(f"{w.name}_target", kept_between(number(limits.low), target, number(limits.high)))
    excess = names.define(f"{w.name}_excess", subtract(target, steer))
    return Target(target, times(speed, sympy.cos(excess)), times(-1, speed, sympy.sin(excess)))


def hysteresis(limits: Interval, apart: Exact = QUARTER) -> Exact:
    """How much further outside its limits [rad] a wheel keeps its heading than the one of the other branch would be.

    The nearest heading is kept, cut at the stop, while that leaves it at most so much further outside. A stop slides
    by the sine of its distance from the line, so that keeping costs at most sin(5 degrees) = 0.087 of the pivot's
    speed; in return noise at a stop does not swing the wheel to the other one and back. It is 5 degrees for limits up
    to half a turn apart. Inside wider ones both branches lie for a while, and it is what lets the wheel turn back 5
    degrees beyond a quarter turn from the middle: nothing from 190 degrees on. Limits less than a quarter turn apart
    have none: where both stops are equally near, either is dear. ``apart``: half of what lies between branches [rad].
    """
    width = limits.high - limits.low
    return ZERO if width <= NARROW else min(HYSTERESIS, max(ZERO, apart + HYSTERESIS - width / 2))


def turning_points(limits: Interval, apart: Exact = QUARTER) -> Interval:
    """The angles beyond which a heading is given up for that of the other branch; the limits if it never is cut.

    Without `hysteresis` they are the limits or, of narrower ones, where both branches are as far outside: the middle
    decides which stop is nearer.
    """
    middle, half, stay = (
        (limits.low + limits.high) / 2,
        (limits.high - limits.low) / 2,
        hysteresis(limits, apart),
    )
    reach = max(half + stay, apart + stay / 2)
    return Interval(middle - reach, middle + reach)


def turned_back(steer: Expr, ends: Interval, turn: Expr = sympy.pi) -> Expr:
    """``steer`` or, beyond the turning points ``ends``, the angle one ``turn`` back."""
    target = select(number(ends.high), steer, subtract(steer, turn), steer)
    return select(steer, number(ends.low), add(steer, turn), target)


def _narrow(robot: Robot, w: Wheel, limits: Interval, velocity: Velocity, names: Locals) -> Target:
    """Limits less than a quarter turn apart: at most one of the headings that roll is inside.

    Seen from the middle of the limits the velocity is (u, v), and the wheel's slope v/u is cut at the tangent of
    half their distance: the angle inside the limits at which the wheel slides least. A wheel that hardly moves
    (|u| + |v| < 2 STILL) holds its angle.
    """
    middle, half = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    cosine, sine = circle_point(half.rational())
    most = number(sine / cosine)
    x, y = turned_by(w, velocity, middle)
    u, v = components(
        (x, y), names, *((f"{w.name}_{k}", f"{k} of {w.name}") for k in "pq"), precise=robot.precise
    )
    tangent = kept_between(-most, v / at_least(u, number(STILL)), most)
    slope = names.define(f"{w.name}_t", tangent, f"t of {w.name}")
    now = present(w, limits)
    moving = add(absolute(u), absolute(v))
    steer = select(moving, number(STILL * 2), now, add(number(middle), arctangent(slope)))
    scale = names.define(
        f"{w.name}_scale", sympy.Pow(add(sympy.S.One, square(slope)), -sympy.S.Half, evaluate=False)
    )
    return Target(steer, times(add(u, times(v, slope)), scale), times(subtract(v, times(u, slope)), scale))
