"""Where a steered wheel should point, and how fast its rim then moves.

Two headings roll, half a turn apart: the angle theta of the line along which the pivot moves (`line`), and those
k half turns away. k = rint((theta - present) / pi) gives the nearest, at most 90 degrees away; the wheel drives
along it with the speed of the pivot, reversed where k is odd. At standstill the present angle is held.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.constraints import heading, working_view
from wmrgen.exact.evaluate import add_angles, circle_point
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.line import STILL, Velocity, line, near_zero, short, turned_by
from wmrgen.kinematics.records import Call, Formula, Locals
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    alternating,
    angle_of,
    arctangent,
    at_least,
    expression,
    inverse_root,
    kept_between,
    nearest,
    number,
    select,
    signal,
    square,
    subtract,
    times,
    with_sign_of,
)

# 1/pi, rounded down by 3e-11 of it: a swing of 90 degrees keeps its branch in every arithmetic.
PER_HALF_TURN = Exact(Fraction(31830988617, 10**11))
WIDE = Exact(Fraction(315, 100))  # rad between limits, just over half a turn
QUARTER = Exact(Fraction(1570796326794896619, 10**18))  # rad
NARROW = Exact(Fraction(157, 100))  # rad between limits, just under a quarter turn


@dataclass(frozen=True, slots=True)
class Target:
    """Commanded angle [rad], rim speed of the pivot [m/s] and, where it may slide, its lateral speed [m/s]."""

    steer: Expr
    rim: Expr
    lateral: Expr | None = None
    spin: Expr | None = None  # [rad/s], where it is known already


def seen_from(
    w: Wheel,
    velocity: Velocity,
    names: Locals,
    lead: Wheel | None = None,
    at: tuple[Poly, Poly] | None = None,
) -> tuple[Expr, Expr]:
    """(u, w): the pivot's velocity along and across the wheel, at the present angle of ``lead``.

    ``at``: (cos, sin) of another angle.
    """
    g = working_view(w)
    c, s = heading(w if lead is None else lead, g) if at is None else add_angles((g.ch, g.sh), at)
    a, b = (
        names.poly(f"{w.name}_{k}", p) if len(p.terms) > 1 else p for k, p in zip("ab", velocity, strict=True)
    )
    along = names.define(f"{w.name}_along", a * c + b * s)
    across = names.define(f"{w.name}_across", b * c - a * s)
    return along, across


def steer_one(robot: Robot, w: Wheel, velocity: Velocity, names: Locals) -> Target:
    """A wheel steered on its own."""
    limits, g = robot.limit(w, "steer"), working_view(w)
    if limits is not None and limits.high - limits.low <= NARROW:
        return _narrow(w, limits, velocity, names)
    (x, y), zero = near_zero(w, velocity)
    a, b = short(names, f"{w.name}_x", x), short(names, f"{w.name}_y", y)
    alone = limits is None and not g.o and [w] in robot.together("spin", robot.wheels)
    per_rim = expression(g.r.inverse()) if alone else sympy.S.One
    now = present(w, limits)
    heading_, spin = _along(a, b, now, per_rim, zero, names, f"{w.name}_")
    steer = names.define(f"{w.name}_nearest", heading_)
    rim = names.define(f"{w.name}_spin" if alone else f"{w.name}_rim", spin)
    if not (a.is_number or b.is_number):
        kernel, given = (_KERNELS[0], ()) if zero.is_zero else (_KERNELS[1], (zero,))
        names.calls.append(Call(kernel, (a, b, now, per_rim, *given), (rim, steer)))
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
    names, given = Locals(), {port: signal(port) for port, _ in ports}
    zero = given.get("zero", sympy.S.Zero)
    steer, spin = _along(given["x"], given["y"], given["now"], given["per_rim"], zero, names, "")
    inputs = tuple(Port(port, Role.STATE, unit, "") for port, unit in ports)
    outputs = (
        (Port("spin", Role.COMMAND, "rad/s", ""), spin),
        (Port("steer", Role.COMMAND, "rad", ""), steer),
    )
    return Formula(name, inputs, tuple(names.items), outputs, text)


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
    """The nearest heading, or its opposite where that one fits the limits better, and no further than the limit."""
    low, high = _turning_points(limits)
    speed = names.define(f"{w.name}_rim", rim)
    target = _turned_back(steer, low, high)
    if limits.high - limits.low >= WIDE:
        back = times(-1, speed)
        return Target(target, select(high, steer, back, select(steer, low, back, speed)))
    target = names.define(f"{w.name}_target", kept_between(number(limits.low), target, number(limits.high)))
    excess = names.define(f"{w.name}_excess", subtract(target, steer))
    return Target(target, times(speed, sympy.cos(excess)), times(-1, speed, sympy.sin(excess)))


def _turning_points(limits: Interval) -> tuple[Expr, Expr]:
    """The angles beyond which the opposite heading fits the limits better.

    Both headings fit limits more than half a turn apart, and the wheel turns back where the nearer one ends. Of
    narrower limits the middle decides: a stop slides by the sine of its distance from the line, so that the heading
    less than a quarter turn from the middle is the one that fits, or that has the nearer stop.
    """
    middle = (limits.low + limits.high) / 2
    reach = max((limits.high - limits.low) / 2, QUARTER)
    return number(middle - reach), number(middle + reach)


def _turned_back(steer: Expr, low: Expr, high: Expr) -> Expr:
    """``steer``, or half a turn from it where that lies between ``low`` and ``high`` and it does not."""
    target = select(high, steer, subtract(steer, sympy.pi), steer)
    return select(steer, low, add(steer, sympy.pi), target)


def _narrow(w: Wheel, limits: Interval, velocity: Velocity, names: Locals) -> Target:
    """Limits less than a quarter turn apart: at most one of the headings that roll is inside.

    Seen from the middle of the limits the velocity is (u, v), and the wheel's slope v/u is cut at the tangent of
    half their distance: the angle inside the limits at which the wheel slides least. A wheel that hardly moves
    (|u| + |v| < 2 STILL) holds its angle.
    """
    middle, half = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    cosine, sine = circle_point(half.rational())
    most = number(sine / cosine)
    x, y = turned_by(w, velocity, middle)
    u, v = short(names, f"{w.name}_p", x), short(names, f"{w.name}_q", y)
    slope = names.define(f"{w.name}_tangent", kept_between(-most, v / at_least(u, number(STILL)), most))
    now = present(w, limits)
    moving = add(absolute(u), absolute(v))
    steer = select(moving, number(STILL * 2), now, add(number(middle), arctangent(slope)))
    scale = names.define(f"{w.name}_scale", inverse_root(add(sympy.S.One, square(slope))))
    return Target(steer, times(add(u, times(v, slope)), scale), times(subtract(v, times(u, slope)), scale))


def steer_group(
    robot: Robot, members: list[Wheel], velocities: dict[int, Velocity], names: Locals
) -> dict[int, Target]:
    """Wheels turned by one motor: the common angle that leaves least sliding (sum of squares).

    The lateral speeds are w cos(t) - u sin(t); their squares sum to a minimum at half the angle of
    (sum of u**2 - w**2, sum of 2 u w), the nearest of the two branches.
    """
    lead = members[0]
    limits = robot.limit(lead, "steer")
    now = present(lead, limits)
    at = None
    if limits is not None:
        now = names.define(f"{lead.name}_now", now)
        at = names.poly(f"{lead.name}_c", sympy.cos(now)), names.poly(f"{lead.name}_s", sympy.sin(now))
    seen = {w.index: seen_from(w, velocities[w.index], names, lead, at) for w in members}
    double = add(*(2 * u * v for u, v in seen.values()))
    difference = add(*(subtract(u**2, v**2) for u, v in seen.values()))
    swing = names.define(f"{lead.name}_swing", angle_of(double, difference) / 2)
    target: Expr = add(now, swing)
    if limits is not None:
        target = names.define(f"{lead.name}_nearest", target)
        best = _turned_back(target, *_turning_points(limits))
        target = kept_between(number(limits.low), best, number(limits.high))
    steer = names.define(f"{lead.name}_target", target)
    turn = names.define(f"{lead.name}_turn", subtract(steer, now))
    return {i: turned(steer, turn, u, v) for i, (u, v) in seen.items()}


def turned(steer: Expr, turn: Expr, u: Expr, v: Expr) -> Target:
    """The pivot's velocity (u, v) seen from the wheel after it has turned."""
    c, s = sympy.cos(turn), sympy.sin(turn)
    return Target(steer, add(times(u, c), times(v, s)), subtract(times(v, c), times(u, s)))
