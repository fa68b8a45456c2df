"""Steered wheels whose spins are coupled: of the two headings that roll they take the one that turns the right way.

A chain makes wheels turn alike, and a wheel half a turn about turns the other way round. Wheels that do not steer
decide which way the chain runs, else the first steered wheel does on its nearest heading.
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.constraints import rolling_row, working_view
from wmrgen.exact.poly import Row, dot
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.steer import Target, present
from wmrgen.layout.records import Robot, Wheel
from wmrgen.symbolic import Expr, add, expression, number, select, subtract, times

Targets = dict[int, Target]


def turning_alike(robot: Robot, twist: Row, targets: Targets, names: Locals) -> Targets:
    """``targets`` with the wheels of every chain rolling the same way round, as far as their limits let them."""
    result = dict(targets)
    for members in robot.together("spin", robot.wheels):
        units = robot.together("steer", (w for w in members if w.kind.steers))
        unsteered = [w for w in members if not w.turns]
        if len(units) + bool(unsteered) < 2:
            continue
        chain = [_unsteered(w, twist) for w in unsteered] or _rolling(units.pop(0), result)
        way = names.define(f"{members[0].name}_way", add(*chain))
        for unit in units:
            whole = [
                w for w in robot.wheels if robot.steer_group[w.index] == robot.steer_group[unit[0].index]
            ]
            result |= _reversed(robot, whole, times(way, add(*_rolling(unit, result))), result, names)
    return result


def _unsteered(w: Wheel, twist: Row) -> Expr:
    """r times the speed in the rolling row, of a wheel whose heading stands."""
    g = working_view(w)
    return expression(dot(rolling_row(w, g).row, twist) * g.rolling_radius)


def _rolling(unit: list[Wheel], targets: Targets) -> list[Expr]:
    """The same of steered wheels on their targets."""
    return [times(expression(working_view(w).r), targets[w.index].rim) for w in unit]


def _reversed(robot: Robot, unit: list[Wheel], agrees: Expr, targets: Targets, names: Locals) -> Targets:
    """Half a turn about where ``agrees`` is negative and the limits leave room for it."""
    lead = unit[0]
    limits = robot.limit(lead, "steer")
    if limits is not None and limits.high - limits.low < 3:
        return {}
    steer = names.define(f"{lead.name}_rolls", targets[lead.index].steer)
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

    def mirrored(t: Target) -> Target:
        rim = chosen(t.rim, times(-1, t.rim))
        lateral = None if t.lateral is None else chosen(t.lateral, times(-1, t.lateral))
        return replace(t, steer=chosen(steer, about), rim=rim, lateral=lateral)

    return {w.index: mirrored(targets[w.index]) for w in unit}
