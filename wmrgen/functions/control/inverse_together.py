"""Joint commands with one decision for all steered wheels, forwards or backwards: `inverse_together`.

`inverse` chooses the nearer direction for each wheel by itself. Near 90 degrees of swing neighbouring wheels then swing
to opposite sides, and the robot yaws until they arrive. Here the wheels decide together. They drive backwards if on the
whole they would roll backwards at their present angles (sum of u < 0, where u is the speed of the pivot along the
wheel). Steering limits come first: the direction is chosen for which the angles exceed their limits less. The
difference must be more than the largest `hysteresis` of the wheels and more than `_TIE`. A wheel whose pivot stands
still keeps its angle.
"""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.inverse import joint_commands
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.analysis.kinematics.steer import QUARTER, Target, hysteresis, turned_back, turning_points
from wmrgen.analysis.kinematics.steer_groups import moves_as_one, seen_from, steered_groups, turned
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Row
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import Limits
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    clamp_between,
    expression,
    maximum,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)

_ZERO = sympy.S.Zero
_TIE = Exact(Fraction(1, 10**4))  # rad: angles that exceed the limits by the same amount up to rounding
WAYS = ("forwards", "backwards")


class _Unit(NamedTuple):
    """Wheels that one motor steers."""

    lead: Wheel
    # by wheel index: velocity (u, v) of the pivot along and across the wheel; v is mirrored if the sign
    # is -1
    seen: dict[int, tuple[Expr, Expr]]
    signs: dict[int, int]  # by wheel index: -1 for a wheel that turns against the first
    moves: Expr  # sum of the squared speeds of the pivots
    angles: dict[str, Expr]  # joint angle for each of `WAYS`, on the full turn that is nearer to ``limits``
    limits: Interval | None


@function("ours; the texts have none", limits=Limits.COMMANDED)
def inverse_together(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands as `inverse` does, with one decision for all modules: forwards or backwards."""
    count = len(steered_groups(robot))
    if not count:
        raise underivable(robot, "inverse_together", "no wheel is steered", Reason.NOT_STEERED)
    if count == 1:
        why = "one motor steers all wheels, so use inverse"
        raise underivable(robot, "inverse_together", why, Reason.SHARED_MOTOR)
    text = "twist of P in the robot frame to joint commands, all modules forwards or all backwards"
    return joint_commands(robot, mobility, _steering, "inverse_together", text)


def _steering(robot: Robot, twist: Row, names: Locals) -> dict[int, Target]:
    """Return the angle and the rim speed of each steered wheel, by wheel index."""
    units = [_unit(robot, members, twist, names) for members in steered_groups(robot)]
    direction = names.define("direction", _direction(units, names))
    targets: dict[int, Target] = {}
    for unit in units:
        targets |= _targets(unit, direction, names)
    return targets


def _unit(robot: Robot, members: list[Wheel], twist: Row, names: Locals) -> _Unit:
    """Return the wheels of one motor with their angles for both directions of rolling."""
    lead = members[0]
    velocities = {w.index: pivot(w, twist) for w in members}
    if moves_as_one(members, velocities):
        seen = dict.fromkeys(velocities, seen_from(lead, velocities[lead.index], names))
        rim, v = seen[lead.index]
        moves = names.define(f"{lead.name}_moves", _squares([velocities[lead.index]]))
        aside = names.define(f"{lead.name}_aside", select(rim, _ZERO, times(-1, v), v))
        swing = angle_of(aside, absolute(rim))
    else:
        seen = {w.index: seen_from(w, velocities[w.index], names, lead) for w in members}
        rim, moves, swing = _common(lead, seen, velocities, names)
    near = names.define(f"{lead.name}_near", swing)
    opposite = names.define(
        f"{lead.name}_opposite", select(_ZERO, near, subtract(near, sympy.pi), add(near, sympy.pi))
    )
    far = names.define(f"{lead.name}_far", select(_ZERO, moves, opposite, near))
    now, limits = signal(f"{lead.name}.steer"), robot.limit(lead, "steer")
    angles = {}
    for way, low, high in zip(WAYS, (far, near), (near, far), strict=True):
        swung = names.define(f"{lead.name}_swing_{way}", select(rim, _ZERO, low, high))
        angles[way] = names.define(f"{lead.name}_{way}", add(now, swung))
        if limits is not None:
            angles[way] = _wrapped(angles[way], limits, names, f"{lead.name}_{way}")
    return _Unit(lead, seen, {w.index: w.steer_sign for w in members}, moves, angles, limits)


def _common(
    lead: Wheel, seen: dict[int, tuple[Expr, Expr]], velocities: dict[int, Velocity], names: Locals
) -> tuple[Expr, Expr, Expr]:
    """Return rim speed on the nearer branch, squared speeds and swing of wheels on one motor (see `steer_group`)."""
    double = add(*(times(2, u, v) for u, v in seen.values()))
    difference = add(*(subtract(square(u), square(v)) for u, v in seen.values()))
    swing = names.define(f"{lead.name}_swing", angle_of(double, difference) / 2)
    c, s = sympy.cos(swing), sympy.sin(swing)
    rim = add(*(add(times(u, c), times(v, s)) for u, v in seen.values()))
    moves = names.define(f"{lead.name}_moves", _squares(list(velocities.values())))
    return names.define(f"{lead.name}_rim", rim), moves, swing


def _squares(velocities: list[Velocity]) -> Expr:
    """Return the sum of the squares of all pivots' velocities."""
    return add(*(square(expression(p)) for velocity in velocities for p in velocity))


def _beyond(angle: Expr, limits: Interval) -> Expr:
    """Return how far an angle is outside its limits [rad]; negative inside."""
    middle, reach = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    return subtract(absolute(subtract(angle, number(middle))), number(reach))


def _wrapped(angle: Expr, limits: Interval, names: Locals, name: str) -> Expr:
    """Return ``angle``, or the same heading a full turn away if that is nearer to the limits.

    The other turn is taken if the angle is outside the limits, and more than half a turn plus `hysteresis` from the
    middle.
    """
    best = turned_back(angle, turning_points(limits, QUARTER * 2), 2 * sympy.pi)
    return names.define(f"{name}_best", best)


def _direction(units: list[_Unit], names: Locals) -> Expr:
    """Return a number that is negative for backwards. Steering limits decide first, then the present angles."""
    along = add(*(u for unit in units for u, _ in unit.seen.values()))
    limited = [(u.angles, u.limits) for u in units if u.limits is not None]
    if not limited:
        return along
    excess = {}
    for way in WAYS:
        beyond = [_beyond(angles[way], limits) for angles, limits in limited]
        excess[way] = names.define(f"over_{way}", reduce(maximum, beyond, _ZERO))
    forwards, backwards = excess["forwards"], excess["backwards"]
    stay = number(max(_TIE, *(hysteresis(limits) for _, limits in limited)))
    backwards_better = select(add(backwards, stay), forwards, sympy.S.NegativeOne, along)
    return select(add(forwards, stay), backwards, sympy.S.One, backwards_better)


def _targets(unit: _Unit, direction: Expr, names: Locals) -> dict[int, Target]:
    """Return the angle and the rim speed of each wheel of a unit in the chosen direction."""
    wanted = select(direction, _ZERO, unit.angles["backwards"], unit.angles["forwards"])
    if unit.limits is None and len(set(unit.seen.values())) == 1:
        speed = names.define(f"{unit.lead.name}_speed", root(unit.moves))
        rim = names.define(f"{unit.lead.name}_rim", select(direction, _ZERO, times(-1, speed), speed))
        return {i: Target(times(unit.signs[i], wanted), rim) for i in unit.seen}
    if unit.limits is not None:
        wanted = clamp_between(number(unit.limits.low), wanted, number(unit.limits.high))
    key = unit.lead.name
    steer = names.define(f"{key}_target", wanted)
    turn = names.define(f"{key}_turn", subtract(steer, signal(f"{key}.steer")))
    return {i: turned(steer, turn, u, v, unit.signs[i]) for i, (u, v) in unit.seen.items()}
