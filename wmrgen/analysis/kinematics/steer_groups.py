"""Steering of coupled wheels: a common angle for coupled steering, a common direction of rolling for coupled spins.

Wheels with coupled steering take the angle at which they slide least. Wheels with coupled spins must roll in the same
direction. A steered wheel has two possible headings half a turn apart, at which it rolls in opposite directions, and
takes the one that fits. The direction of a set of coupled spins is determined by its wheels that do not steer. If there
are none, the first steered wheel determines it with its nearest heading.
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
    clamp_between,
    expression,
    number,
    rotated_back,
    select,
    subtract,
    times,
)

Targets = dict[int, Target]


def nearest_steering(robot: Robot, twist: Row, names: Locals) -> dict[int, Target]:
    """Return the targets of all steered wheels, with headings nearest to the present angles.

    Args:
        robot: The robot.
        twist: vx, vy [m/s] and omega [rad/s] as polynomials.
        names: Collects intermediate results.

    Returns:
        The targets by wheel index.
    """
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
    """Return the steered wheels in sets with coupled steering."""
    return robot.together("steer", (w for w in robot.wheels if w.kind.steers))


def moves_as_one(members: list[Wheel], velocities: dict[int, tuple[Poly, Poly]]) -> bool:
    """Return whether the pivots of all wheels have the same velocity relative to their zero headings."""
    return len({(velocities[w.index], w.working.ch, w.working.sh, w.steer_sign) for w in members}) == 1


def _spins_as(w: Wheel, lead: Wheel) -> bool:
    """Return whether two wheels have the same spin when their pivots have the same velocity along them."""
    g, other = working_view(w), working_view(lead)
    return (g.r, g.o) == (other.r, other.o)


def steer_group(
    robot: Robot, members: list[Wheel], velocities: dict[int, Velocity], names: Locals
) -> dict[int, Target]:
    """Return targets with a common angle, at which the sum of squares of the lateral speeds is least.

    If the wheels turn by t, the lateral speeds are w cos(t) - u sin(t). Their sum of squares has a minimum at half the
    angle of the vector (sum of u**2 - w**2, sum of 2 u w), and the nearer of the two minima is taken. For a wheel that
    steers opposite to the first wheel, w has the opposite sign.

    Args:
        robot: The robot.
        members: The wheels with coupled steering.
        velocities: The velocities of their pivots in the robot frame [m/s], by wheel index.
        names: Collects intermediate results.

    Returns:
        The targets by wheel index.
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
        target = clamp_between(number(limits.low), best, number(limits.high))
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
    """Return the velocity (u, w) of a pivot along and across its wheel.

    Args:
        w: The wheel.
        velocity: The velocity of its pivot in the robot frame [m/s].
        names: Collects intermediate results.
        lead: The wheel whose steering it is coupled to, or None. The sign of w is reversed if the wheel steers opposite
            to it.
        at: Cosine and sine of the steering angle of ``lead`` (or of the wheel); by default of the present angle.

    Returns:
        u and w [m/s].
    """
    g, sign = working_view(w), Exact(1 if lead is None else w.steer_sign)
    c, s = steer_gens(w if lead is None else lead) if at is None else at
    c, s = add_angles((g.ch, g.sh), (c, s.scale(sign)))
    a = names.short(f"{w.name}_x", velocity[0], f"v_Ax of {w.name}")
    b = names.short(f"{w.name}_y", velocity[1], f"v_Ay of {w.name}")
    along = names.define(f"{w.name}_along", a * c + b * s, f"u of {w.name}")
    across = names.define(f"{w.name}_across", (b * c - a * s).scale(sign), f"w of {w.name}")
    return along, across


def turned(steer: Expr, turn: Expr, u: Expr, v: Expr, sign: int = 1) -> Target:
    """Return the target of a wheel that turns from its present angle.

    Args:
        steer: The target angle of the leading wheel [rad].
        turn: The change of that angle [rad].
        u: The velocity of the pivot along the wheel at the present angle [m/s].
        v: The velocity across the wheel [m/s], as from `seen_from`.
        sign: -1 if the wheel steers opposite to the leading wheel. Then the sign of the lateral speed is reversed too,
            which does not matter because only its square is used.

    Returns:
        The target.
    """
    return Target(times(sign, steer), *rotated_back(sympy.cos(turn), sympy.sin(turn), u, v))


def turning_alike(robot: Robot, twist: Row, targets: Targets, names: Locals) -> Targets:
    """Return ``targets`` in which wheels with coupled spins roll in the same direction, if steering limits allow it.

    Args:
        robot: The robot.
        twist: vx, vy [m/s] and omega [rad/s] as polynomials.
        targets: The targets of steered wheels by index.
        names: Collects intermediate results.

    Returns:
        The targets, some with the opposite heading.
    """
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
    """Return r times the rolling speed for a wheel that does not steer, with r per radian of the common shaft."""
    g = working_view(w)
    return expression(dot(rolling_row(w, g).row, twist) * robot.per_turn(w, g))


def _rolling(robot: Robot, unit: list[Wheel], targets: Targets) -> list[Expr]:
    """Return r times the rolling speed for steered wheels at their targets, with r per radian of the common shaft."""
    return [times(expression(robot.per_turn(w, working_view(w))), targets[w.index].rim) for w in unit]


def _reversed(robot: Robot, unit: list[Wheel], agrees: Expr, targets: Targets, names: Locals) -> Targets:
    """Return targets of ``unit`` half a turn away if ``agrees`` is negative and the limits allow it."""
    lead = unit[0]
    limits = robot.limit(lead, "steer")
    if (
        limits is not None and limits.high - limits.low < 3
    ):  # rad: the other heading is half a turn away, outside
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
