"""Where a steered wheel should point, and how fast its rim then moves.

In the frame of the wheel as it stands, the pivot's velocity is (u, w). The swing to the nearer of the two
headings that roll is atan2(+-w, |u|), at most 90 degrees; the rim speed is +-sqrt(u**2 + w**2), negative when
the wheel drives backwards. atan2(0, 0) = 0 holds the angle at standstill.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.constraints import heading, working_view
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    local,
    maximum,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)

Velocity = tuple[Poly, Poly]


@dataclass(frozen=True, slots=True)
class Target:
    """Commanded angle [rad], rim speed of the pivot [m/s] and, where it may slide, its lateral speed [m/s]."""

    steer: Expr
    rim: Expr
    lateral: Expr | None = None


def steer_limits(robot: Robot, wheel: Wheel) -> Interval | None:
    """The wheel's own steering limits, or the robot's."""
    return wheel.limits.get("steer") or robot.limits.get("steer")


def seen_from(w: Wheel, velocity: Velocity, names: Locals, lead: Wheel | None = None) -> tuple[Expr, Expr]:
    """(u, w): the pivot's velocity along and across the wheel, at the present angle of ``lead``."""
    g = working_view(w)
    c, s = heading(w if lead is None else lead, g)
    a = _short(names, f"{w.name}_x", velocity[0])
    b = _short(names, f"{w.name}_y", velocity[1])
    along = names.define(f"{w.name}_along", a * c + b * s)
    across = names.define(f"{w.name}_across", b * c - a * s)
    return along, across


def _short(names: Locals, name: str, value: Poly) -> Poly:
    """A sum gets a name; a single term stays."""
    return names.poly(name, value) if len(value.terms) > 1 else value


def steer_one(robot: Robot, w: Wheel, velocity: Velocity, names: Locals) -> Target:
    """A wheel steered on its own."""
    u, v = seen_from(w, velocity, names)
    now = signal(f"{w.name}.steer")
    zero = sympy.S.Zero
    swing = angle_of(select(u, zero, times(-1, v), v), absolute(u))
    a, b = (
        local(f"{w.name}_{k}") if len(p.terms) > 1 else expression(p)
        for k, p in zip("xy", velocity, strict=True)
    )
    speed = names.define(f"{w.name}_speed", root(add(square(a), square(b))))
    limits = steer_limits(robot, w)
    if limits is None:
        return Target(add(now, swing), select(u, zero, times(-1, speed), speed))
    return _limited(w, limits, now, swing, (u, v), names)


def _limited(
    w: Wheel, limits: Interval, now: Expr, swing: Expr, seen: tuple[Expr, Expr], names: Locals
) -> Target:
    """The nearest heading inside the limits; outside both, the limit nearest to it."""
    low, high = number(limits.low), number(limits.high)
    nearest = names.define(f"{w.name}_nearest", add(now, swing))
    other = names.define(
        f"{w.name}_other", select(high, nearest, subtract(nearest, sympy.pi), add(nearest, sympy.pi))
    )
    inside = select(high, other, nearest, select(other, low, nearest, other))
    kept = select(high, nearest, inside, select(nearest, low, inside, nearest))
    steer = names.define(f"{w.name}_target", maximum(low, sympy.Min(high, kept, evaluate=False)))
    turn = names.define(f"{w.name}_turn", subtract(steer, now))
    return turned(steer, turn, *seen)


def steer_group(
    robot: Robot, members: list[Wheel], velocities: dict[int, Velocity], names: Locals
) -> dict[int, Target]:
    """Wheels turned by one motor: the common angle that leaves least sliding (sum of squares).

    The lateral speeds are w cos(t) - u sin(t); their squares sum to a minimum at half the angle of
    (sum of u**2 - w**2, sum of 2 u w), the nearest of the two branches.
    """
    lead = members[0]
    seen = {w.index: seen_from(w, velocities[w.index], names, lead) for w in members}
    double = add(*(2 * u * v for u, v in seen.values()))
    difference = add(*(subtract(u**2, v**2) for u, v in seen.values()))
    now = signal(f"{lead.name}.steer")
    swing = names.define(f"{lead.name}_swing", angle_of(double, difference) / 2)
    limits = steer_limits(robot, lead)
    target: Expr = add(now, swing)
    if limits is not None:
        target = maximum(number(limits.low), sympy.Min(number(limits.high), target, evaluate=False))
    steer = names.define(f"{lead.name}_target", target)
    turn = names.define(f"{lead.name}_turn", subtract(steer, now))
    return {i: turned(steer, turn, u, v) for i, (u, v) in seen.items()}


def turned(steer: Expr, turn: Expr, u: Expr, v: Expr) -> Target:
    """The pivot's velocity (u, v) seen from the wheel after it has turned."""
    c, s = sympy.cos(turn), sympy.sin(turn)
    return Target(steer, add(times(u, c), times(v, s)), subtract(times(v, c), times(u, s)))
