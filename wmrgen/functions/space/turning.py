"""How fast wheels turn about their steering axes, and how fast that changes, for a twist and its derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.constraints import heading, working_view
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, Row
from wmrgen.kinematics.line import pivot
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.smallest import FLOOR
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.symbolic import Expr, add, expression, maximum, number, select, subtract, times

AT_LIMIT = Exact(Fraction(1, 10**6))  # rad: a command so near a limit is held by it
_TWIST = ("vx", "vy", "omega")
Jet = tuple[Expr, Expr, Expr]


@dataclass(frozen=True, slots=True)
class Motion:
    """The driven twist and its first and second derivative."""

    twist: Row
    rate: Row
    jerk: Row


@dataclass(frozen=True, slots=True)
class Turn:
    """Steering rate [rad/s] and its derivative [rad/s^2]."""

    rate: Expr
    acceleration: Expr


def motion_of(driven: Row) -> Motion:
    """The driven twist is linear in the commanded one with constant coefficients: so are its derivatives."""

    def renamed(row: Row, suffix: str) -> Row:
        def value(gen: Gen) -> Poly | None:
            known = gen.kind == "input" and gen.name in _TWIST
            return Poly.gen("input", f"{gen.name}_{suffix}") if known else None

        a, b, c = (p.substitute(value) for p in row)
        return a, b, c

    return Motion(driven, renamed(driven, "rate"), renamed(driven, "jerk"))


def steered_turns(
    robot: Robot, motion: Motion, commands: Mapping[str, Expr], names: Locals
) -> dict[int, Turn]:
    """Rates of the angles that `inverse` commands: alone atan2 of vA, together half of a sum's double angle."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.steers)):
        lead = members[0]
        seen = [_along_across(w, motion) for w in members]
        alike = all(s == seen[0] for s in seen)
        x, y = _jets(seen[0]) if alike else _doubled(seen)
        turn = _angle_rates(x, y, lead.name, names, sympy.S.One if alike else sympy.S.Half)
        limits = robot.limit(lead, "steer")
        if limits is not None:
            turn = _held(names, lead, commands[f"{lead.name}.steer"], limits, turn)
        result.update({w.index: turn for w in members})
    return result


def _along_across(w: Wheel, motion: Motion) -> tuple[tuple[Poly, Poly], ...]:
    """The pivot's velocity and its derivatives along and across the wheel's zero heading."""
    g = working_view(w)
    found = []
    for row in (motion.twist, motion.rate, motion.jerk):
        a, b = pivot(w, row)
        found.append((a * g.ch + b * g.sh, b * g.ch - a * g.sh))
    return tuple(found)


def _jets(seen: tuple[tuple[Poly, Poly], ...]) -> tuple[Jet, Jet]:
    u, u1, u2 = (expression(p) for p, _ in seen)
    v, v1, v2 = (expression(p) for _, p in seen)
    return (u, u1, u2), (v, v1, v2)


def _doubled(seen: list[tuple[tuple[Poly, Poly], ...]]) -> tuple[Jet, Jet]:
    """(sum of u^2 - v^2, sum of 2 u v) with two derivatives: the double of the common angle (see `steer_group`)."""
    x: list[list[Expr]] = [[], [], []]
    y: list[list[Expr]] = [[], [], []]
    for one in seen:
        (u, u1, u2), (v, v1, v2) = _jets(one)
        x[0].append(subtract(times(u, u), times(v, v)))
        x[1].append(times(2, subtract(times(u, u1), times(v, v1))))
        x[2].append(times(2, add(times(u1, u1), times(u, u2), times(-1, v1, v1), times(-1, v, v2))))
        y[0].append(times(2, u, v))
        y[1].append(times(2, add(times(u1, v), times(u, v1))))
        y[2].append(times(2, add(times(u2, v), times(2, u1, v1), times(u, v2))))
    return (add(*x[0]), add(*x[1]), add(*x[2])), (add(*y[0]), add(*y[1]), add(*y[2]))


def _angle_rates(x: Jet, y: Jet, name: str, names: Locals, share: Expr) -> Turn:
    """share times the first and second derivative of atan2(y, x); 0 where x and y are 0.

    The divisor is kept above a floor: a speed of 1e-6 m/s.
    """
    floor = number(FLOOR if share is sympy.S.One else FLOOR * FLOOR)
    over = names.define(f"{name}_over", 1 / maximum(add(times(x[0], x[0]), times(y[0], y[0])), floor))
    turning = names.define(f"{name}_turning", subtract(times(x[0], y[1]), times(y[0], x[1])))
    growing = names.define(f"{name}_growing", add(times(x[0], x[1]), times(y[0], y[1])))
    rate = names.define(f"{name}_rate", times(share, turning, over))
    second = subtract(times(x[0], y[2]), times(y[0], x[2]))
    bent = times(share, over, subtract(second, times(2, turning, over, growing)))
    return Turn(rate, names.define(f"{name}_bent", bent))


def _held(names: Locals, lead: Wheel, command: Expr, limits: Interval, turn: Turn) -> Turn:
    """0 where the commanded angle is at a limit."""
    target = names.define(f"{lead.name}_aimed", command)
    low, high = number(limits.low + AT_LIMIT), number(limits.high - AT_LIMIT)
    rate, bent = (
        names.define(
            f"{lead.name}_{k}", select(low, target, select(target, high, value, sympy.S.Zero), sympy.S.Zero)
        )
        for k, value in (("free", turn.rate), ("freebent", turn.acceleration))
    )
    return Turn(rate, bent)


def castor_turns(robot: Robot, motion: Motion, names: Locals) -> dict[int, Turn]:
    """Swivelling of castors; those turned by one motor share the least-squares rate."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.swivels)):
        lead = members[0].name
        offsets = [working_view(w).d for w in members]
        total = Poly.sum(d * d for d in offsets).inverse()
        slides = [_slide(w, motion.twist) for w in members]
        rate = names.poly(
            f"{lead}_rate", -(Poly.sum(d * s for d, s in zip(offsets, slides, strict=True)) * total)
        )
        changes = [_slide(w, motion.rate) - speeds_at(w, motion.twist)[0] * rate for w in members]
        bent = -(Poly.sum(d * s for d, s in zip(offsets, changes, strict=True)) * total)
        turn = Turn(expression(rate), names.define(f"{lead}_bent", bent))
        result.update({w.index: turn for w in members})
    return result


def _slide(w: Wheel, twist: Row) -> Poly:
    """n . vA + d omega."""
    return speeds_at(w, twist)[1] + working_view(w).d * twist[2]


def speeds_at(w: Wheel, twist: Row) -> tuple[Poly, Poly]:
    """(e . vA, n . vA) at the present angle."""
    c, s = heading(w, working_view(w))
    a, b = pivot(w, twist)
    return a * c + b * s, b * c - a * s
