"""The steering angle of a steered wheel for a velocity of its pivot, and its rim speed.

A wheel can roll forwards or backwards, so all angles theta - k pi along the velocity are possible. The nearest angle to
the present one has k = rint((theta - present) / pi), and is at most 90 degrees away. The wheel drives along it with
the speed of the pivot, backwards if k is odd. If the pivot does not move, the wheel keeps its present angle.

The angle is computed from the line of the velocity (a, b), without its direction. With s = sqrt(a**2 + b**2), half the
angle of the line has the tangent b / (s + |a|), with the sign of a. This tangent is in [-1, 1], takes one quotient and
one arctangent, and involves no cancellation. The divisor is limited to at least `STILL`, so that a reader or a static
analyser of the C sees that it is not zero.
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
    clamp_between,
    expression,
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

# [m/s] a slower pivot stands still: a float still represents it, no motor does.
STILL = Exact(Fraction(1, 10**20))
# [1/rad] 1/pi, rounded down by 3e-11 relative, so that a change of 90 degrees keeps its branch in every arithmetic.
PER_HALF_TURN = Exact(Fraction(31830988617, 10**11))
QUARTER = Exact(Fraction(1570796326794896619, 10**18))  # [rad] a quarter turn
HYSTERESIS = QUARTER / 18  # [rad] 5 degrees, see `hysteresis`
NARROW = Exact(Fraction(157, 100))  # [rad] distance of limits, just under a quarter turn, see `_narrow`


class Target(NamedTuple):
    """The target of a steered wheel."""

    steer: Expr  # commanded angle [rad]
    rim: Expr  # speed of the pivot along the wheel [m/s]
    lateral: Expr | None = None  # speed of the pivot across the wheel [m/s], of any sign; None if it is 0
    spin: Expr | None = None  # [rad/s], if it is already known


class Line(NamedTuple):
    """The line along which a pivot moves."""

    heading: (
        Expr  # joint angle [rad] along the line; the direction of motion if a >= 0. Undefined up to `STILL`
    )
    size: Expr  # speed [m/s]


def line(a: Expr, b: Expr, zero: Expr, names: Locals, name: str) -> Line:
    """Return the line of a velocity.

    Args:
        a: The x component of the velocity [m/s].
        b: The y component of the velocity [m/s].
        zero: The zero angle of the joint [rad] in the frame of a and b.
        names: Collects intermediate results.
        name: A prefix for their names.

    Returns:
        The line, as a joint angle and a speed.
    """
    size = names.define(f"{name}size", norm(a, b))
    safe = names.define(f"{name}size_safe", maximum(number(STILL), size))
    slope = names.define(f"{name}slope", b / add(safe, absolute(a)))
    heading = times(with_sign_of(sympy.Integer(2), a), arctangent(slope))
    return Line(subtract(heading, zero), size)


def turned_by(w: Wheel, velocity: Velocity, angle: Exact = ZERO) -> Velocity:
    """Return a velocity along and across a wheel.

    Args:
        w: The wheel.
        velocity: The velocity in the robot frame [m/s].
        angle: The joint angle of the wheel [rad].

    Returns:
        The components along and across the wheel [m/s].
    """
    g = working_view(w)
    c, s = g.ch, g.sh
    if angle:
        cosine, sine = circle_point(angle.rational())
        c, s = add_angles((c, s), (Poly.of(cosine), Poly.of(sine)))
    return velocity[0] * c + velocity[1] * s, velocity[1] * c - velocity[0] * s


def near_zero(w: Wheel, velocity: Velocity) -> tuple[Velocity, Expr]:
    """Return the velocity in a frame with few operations, and the zero angle of the joint in that frame [rad].

    The frame is that of the wheel at joint angle zero if its heading is a multiple of 90 degrees, which takes no
    operation, or tunable. For any other heading it is the robot frame, in which the terms that may cancel have the
    plain coordinates of the pivot as factors.
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
    """Return the target of a wheel whose steering is not coupled to different motions.

    Args:
        robot: The robot.
        w: The steered wheel.
        velocity: The velocity of its pivot in the robot frame [m/s].
        names: Collects intermediate results.

    Returns:
        The target, inside the steering limits.
    """
    limits, g = robot.limit(w, "steer"), working_view(w)
    if limits is not None and limits.high - limits.low <= NARROW:
        return _narrow(robot, w, limits, velocity, names)
    in_frame, zero = near_zero(w, velocity)
    called = (f"{w.name}_x", f"v_Ax of {w.name}"), (f"{w.name}_y", f"v_Ay of {w.name}")
    a, b = components(in_frame, names, *called, precise=robot.precise)
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
    """Return the nearest angle and the spin for a pivot with the velocity (a, b), see `line` for the arguments."""
    motion = line(a, b, zero, names, name)
    heading_ = names.define(f"{name}heading", select(motion.size, number(STILL), now, motion.heading))
    half_turns = nearest(times(number(PER_HALF_TURN), subtract(heading_, now)))
    forwards = with_sign_of(times(per_rim, motion.size), a)
    return subtract(heading_, times(sympy.pi, half_turns)), times(alternating(half_turns), forwards)


def _kernel(name: str, text: str, *ports: tuple[str, str]) -> Formula:
    """Return `_along` as a kernel. The zero angle of the joint is 0 if no port is called zero."""
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
    "quarter turn away, and rolls backwards if that is shorter. At standstill it keeps the present angle. per_rim: "
    "spin [rad/s] per speed of the rim [m/s]"
)
_FROM = f"{_TEXT}. zero: the zero angle of the joint [rad] in the frame of x and y."
_KERNELS = (
    _kernel("steer_along", f"{_TEXT}.", *_PORTS),
    _kernel("steer_along_from", _FROM, *_PORTS, ("zero", "rad")),
)


def present(w: Wheel, limits: Interval | None) -> Expr:
    """Return the present steering angle [rad], clamped to the limits."""
    now = signal(f"{w.name}.steer")
    if limits is None:
        return now
    return clamp_between(number(limits.low), now, number(limits.high))


def _limited(w: Wheel, limits: Interval, steer: Expr, rim: Expr, names: Locals) -> Target:
    """Return the target for the nearest heading, or its opposite if that fits the limits better, clamped to them."""
    speed, ends = names.define(f"{w.name}_rim", rim), turning_points(limits)
    target = turned_back(steer, ends)
    if ends == limits:
        back = select(steer, number(ends.low), times(-1, speed), speed)
        return Target(target, select(number(ends.high), steer, times(-1, speed), back))
    target = names.define(f"{w.name}_target", clamp_between(number(limits.low), target, number(limits.high)))
    excess = names.define(f"{w.name}_excess", subtract(target, steer))
    return Target(target, times(speed, sympy.cos(excess)), times(-1, speed, sympy.sin(excess)))


def hysteresis(limits: Interval, apart: Exact = QUARTER) -> Exact:
    """Return the hysteresis between the two headings of a wheel at its steering limits.

    A heading that is outside the limits is clamped to the limit. The wheel changes to the opposite heading only if that
    is closer to the limits by more than the hysteresis. Otherwise noise at a limit would make the wheel swing from one
    limit to the other. The wheel then slides with the sine of the angle by which it is clamped, so the hysteresis costs
    at most sin(5 degrees) = 0.087 of the pivot's speed.

    The hysteresis is 5 degrees for limits up to 180 degrees apart. Between wider limits both headings are allowed over
    part of the range; the wheel then turns back 95 degrees from the middle of the limits, and from 190 degrees on no
    heading is clamped and the hysteresis is 0. It is also 0 for limits less than 90 degrees apart, because there the
    clamped angle is already far off if both limits are equally near.

    Args:
        limits: The steering limits [rad].
        apart: Half the angle between two possible headings [rad].

    Returns:
        The hysteresis [rad].
    """
    width = limits.high - limits.low
    return ZERO if width <= NARROW else min(HYSTERESIS, max(ZERO, apart + HYSTERESIS - width / 2))


def turning_points(limits: Interval, apart: Exact = QUARTER) -> Interval:
    """Return the angles [rad] beyond which a wheel changes to the other heading.

    They are the limits if no heading is ever clamped. For limits without `hysteresis` that are less than 90 degrees
    apart, they are the angles at which both headings are equally far outside.

    Args:
        limits: The steering limits [rad].
        apart: Half the angle between two possible headings [rad].

    Returns:
        The interval of angles that are kept.
    """
    middle, half = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    stay = hysteresis(limits, apart)
    reach = max(half + stay, apart + stay / 2)
    return Interval(middle - reach, middle + reach)


def turned_back(steer: Expr, ends: Interval, turn: Expr = sympy.pi) -> Expr:
    """Return ``steer``, or the angle one ``turn`` back if it is beyond the turning points.

    Args:
        steer: The nearest angle [rad].
        ends: The turning points, see `turning_points`.
        turn: The angle between two possible headings [rad].

    Returns:
        The chosen angle [rad], not clamped.
    """
    target = select(number(ends.high), steer, subtract(steer, turn), steer)
    return select(steer, number(ends.low), add(steer, turn), target)


def _narrow(robot: Robot, w: Wheel, limits: Interval, velocity: Velocity, names: Locals) -> Target:
    """Return the target for limits less than a quarter turn apart, inside which at most one heading rolls.

    With (u, v) as the velocity in the frame of the middle of the limits, the slope v/u is clamped to the tangent of
    half their distance. The result is the angle inside the limits at which the wheel slides least. A wheel whose pivot
    does not move (|u| + |v| < 2 STILL) keeps its angle.
    """
    middle, half = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    cosine, sine = circle_point(half.rational())
    most = number(sine / cosine)
    called = (f"{w.name}_p", f"p of {w.name}"), (f"{w.name}_q", f"q of {w.name}")
    u, v = components(turned_by(w, velocity, middle), names, *called, precise=robot.precise)
    tangent = clamp_between(-most, v / at_least(u, number(STILL)), most)
    slope = names.define(f"{w.name}_t", tangent, f"t of {w.name}")
    now = present(w, limits)
    moving = add(absolute(u), absolute(v))
    steer = select(moving, number(STILL * 2), now, add(number(middle), arctangent(slope)))
    scale = names.define(
        f"{w.name}_scale", sympy.Pow(add(sympy.S.One, square(slope)), -sympy.S.Half, evaluate=False)
    )
    return Target(steer, times(add(u, times(v, slope)), scale), times(subtract(v, times(u, slope)), scale))
