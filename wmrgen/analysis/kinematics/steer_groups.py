"""Steered wheels that turn together: on one motor the common angle, on one chain the same way round.

One motor turns its wheels to the angle at which they slide least. A chain makes wheels turn alike, and a wheel half a
turn about turns the other way round: of its two headings that roll each takes the one that turns the right way. Wheels
that do not steer decide which way the chain runs, else the first steered wheel does on its nearest heading.
"""

from __future__ import annotations

import sympy

from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.steer import Target, present, steer_one, turned_back, turning_points
from wmrgen.geometry.constraints import rolling_row, steer_gens, working_view
from wmrgen.geometry.exact.evaluate import add_angles
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    kept_between,
    number,
    rotated_back,
    select,
    subtract,
    times,
)

Targets = dict[int, Target]


def nearest_steering(robot: Robot, twist: Row, names: Locals) -> dict[int, Target]:
    """Targets of all steered wheels, coupled ones together, each on the branch nearest to its present angle."""
    result: dict[int, Target] = {}
    for members in steered_groups(robot):
        velocities = {w.index: pivot(w, twist) for w in members}
        lead = members[0]
        if moves_as_one(members, velocities):
            one = steer_one(robot, lead, velocities[lead.index], names)
            result.update({w.index: one if _spins_as(w, lead) else one._replace(spin=None) for w in members})
        else:
            result.update(steer_group(robot, members, velocities, names))
    return turning_alike(robot, twist, result, names)


def steered_groups(robot: Robot) -> list[list[Wheel]]:
    """The steered wheels, those that one motor turns together."""
    return robot.together("steer", (w for w in robot.wheels if w.kind.steers))


def moves_as_one(members: list[Wheel], velocities: dict[int, tuple[Poly, Poly]]) -> bool:
    """True when the wheels of a group see the same velocity of their pivots from the same heading."""
    return len({(velocities[w.index], w.working.ch, w.working.sh, w.steer_sign) for w in members}) == 1


def _spins_as(w: Wheel, lead: Wheel) -> bool:
    """A wheel whose pivot moves as another's turns as fast."""
    g, other = working_view(w), working_view(lead)
    return (g.r, g.o) == (other.r, other.o)


def steer_group(
    robot: Robot, members: list[Wheel], velocities: dict[int, Velocity], names: Locals
) -> dict[int, Target]:
    """Wheels turned by one motor: the common angle that leaves least sliding (sum of squares).

    The lateral speeds are w cos(t) - u sin(t); their squares sum to a minimum at half the angle of
    (sum of u**2 - w**2, sum of 2 u w), the nearest of the two branches. A wheel that turns against the first is seen
    in a mirror: its w has the other sign.
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
        best = turned_back(target, turning_points(limits))
        target = kept_between(number(limits.low), best, number(limits.high))
    steer = names.define(f"{lead.name}_target", target)
    turn = names.define(f"{lead.name}_turn", subtract(steer, now), f"Delta of {lead.name}")
    return {w.index: turned(steer, turn, *seen[w.index], w.steer_sign) for w in members}


def seen_from(
    w: Wheel,
    velocity: Velocity,
    names: Locals,
    lead: Wheel | None = None,
    at: tuple[Poly, Poly] | None = None,
) -> tuple[Expr, Expr]:
    """(u, w): the pivot's velocity along and across the wheel, at the present angle of ``lead``; w mirrored for a wheel
    that turns against it.

    ``at``: (cos, sin) of another angle.
    """
    g, sign = working_view(w), w.steer_sign
    c, s = steer_gens(w if lead is None else lead) if at is None else at
    c, s = add_angles((g.ch, g.sh), (c, s if lead is None else s.scale(Exact(sign))))
    a, b = (
        names.short(f"{w.name}_{k}", p, f"v_A{k} of {w.name}") for k, p in zip("xy", velocity, strict=True)
    )
    along = names.define(f"{w.name}_along", a * c + b * s, f"u of {w.name}")
    across = names.define(
        f"{w.name}_across", (b * c - a * s).scale(Exact(1 if lead is None else sign)), f"w of {w.name}"
    )
    return along, across


def turned(steer: Expr, turn: Expr, u: Expr, v: Expr, sign: int = 1) -> Target:
    """The pivot's velocity (u, v) seen from the wheel after it has turned; ``sign`` -1: against ``steer``, its v
    mirrored, and so its lateral velocity, of which only the square counts."""
    return Target(times(sign, steer), *rotated_back(sympy.cos(turn), sympy.sin(turn), u, v))


def turning_alike(robot: Robot, twist: Row, targets: Targets, names: Locals) -> Targets:
    """``targets`` with the wheels of every chain rolling the same way round, as far as their limits let them."""
    result = dict(targets)
    for members in robot.together("spin", robot.wheels):
        units = robot.together("steer", (w for w in members if w.kind.steers))
        unsteered = [w for w in members if not w.turns]
        if len(units) + bool(unsteered) < 2:
            continue
        chain = [_unsteered(robot, w, twist) for w in unsteered] or _rolling(robot, units.pop(0), result)
        way = names.define(f"{members[0].name}_way", add(*chain))
        for unit in units:
            whole = robot.partners(unit[0])
            result |= _reversed(robot, whole, times(way, add(*_rolling(robot, unit, result))), result, names)
    return result


def _unsteered(robot: Robot, w: Wheel, twist: Row) -> Expr:
    """r times the speed in the rolling row, of a wheel whose heading stands; r seen from the chain."""
    g = working_view(w)
    return expression(dot(rolling_row(w, g).row, twist) * robot.per_turn(w, g))


def _rolling(robot: Robot, unit: list[Wheel], targets: Targets) -> list[Expr]:
    """The same of steered wheels on their targets."""
    return [times(expression(robot.per_turn(w, working_view(w))), targets[w.index].rim) for w in unit]


def _reversed(robot: Robot, unit: list[Wheel], agrees: Expr, targets: Targets, names: Locals) -> Targets:
    """Half a turn about where ``agrees`` is negative and the limits leave room for it."""
    lead = unit[0]
    limits = robot.limit(lead, "steer")
    if limits is not None and limits.high - limits.low < 3:
        return {}
    steer = names.define(f"{lead.name}_rolls", times(lead.steer_sign, targets[lead.index].steer))
    against = names.define(f"{lead.name}_agrees", agrees)
    if limits is not None:
        toward: Expr = number((limits.low + limits.high) / 2)
    else:
        toward = present(lead, None)
    about = names.define(
        f"{lead.name}_about", select(toward, steer, subtract(steer, sympy.pi), add(steer, sympy.pi))
    )

    def chosen(stay: Expr, turn: Expr) -> Expr:
        if limits is not None:
            turn = select(number(limits.high), about, stay, select(about, number(limits.low), stay, turn))
        return select(against, sympy.S.Zero, turn, stay)

    def mirrored(t: Target, sign: int) -> Target:
        return Target(times(sign, chosen(steer, about)), chosen(t.rim, times(-1, t.rim)), t.lateral)

    return {w.index: mirrored(targets[w.index], w.steer_sign) for w in unit}
