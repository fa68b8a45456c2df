"""What is kept between kinematics and motors: `desaturate` and `inverse_together`.

`desaturate` has one factor for all joint rates, so that every wheel keeps its speed limit and the path stays. Steering
angles depend on the direction of the twist alone, joint rates are proportional to its size: rates times k drive the
twist times k, along the same path, 1/k times as long.

With `inverse_together` all steered wheels drive backwards or none, so that swinging modules do not turn the robot.
`inverse` takes the nearer branch for each wheel on its own; near 90 degrees of swing neighbours then swing to
opposite sides, and the robot yaws until they arrive. Here the wheels decide together: backwards where, as they
stand, they would on the whole roll backwards (sum of u < 0, u the speed of the pivot along the wheel). Steering
limits come first: the choice that leaves less of any angle outside them wins, by more than the largest of the wheels'
`hysteresis` and by more than `_TIE`. A wheel whose pivot stands still holds its angle.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.inverse import Joints, joint_commands, spins
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.ranges import steering_spin
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port
from wmrgen.analysis.kinematics.steer import QUARTER, Target, hysteresis, turned_back, turning_points
from wmrgen.analysis.kinematics.steer_groups import moves_as_one, seen_from, steered_groups, turned
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import function, underivable
from wmrgen.geometry.constraints import rolling_row, working_view
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Row, dot
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import Limits, Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    kept_between,
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
_TIE = Exact(Fraction(1, 10**4))  # rad: both ways lie as far outside the limits, whatever the rounding
WAYS = ("forwards", "backwards")


@function("ours; the texts have none", limits=Limits.ASKED, in_place=True)
def desaturate(robot: Robot, _: Mobility) -> Formula:
    """Every ``<wheel>.spin`` (and ``<castor>.steer_rate``) that `inverse` commands, times one ``scale`` <= 1.

    scale = 1 / max(1, rate / limit over all limited joints). Wheels that nothing drives turn along; what they would
    exceed counts where their own ``limits`` name it. A wheel that rolls while it is steered keeps what its limit of
    steer_rate takes of its spin for `steer_toward`, which comes after.
    """
    rates = _rates(robot)
    names = Locals()
    load = most(sympy.S.One, ((signal(port.name), limit) for port, limit in rates))
    scale = names.define("scale", 1 / names.define("load", load))
    outputs = [(port, scaled(signal(port.name), limit, scale)) for port, limit in rates]
    outputs.append((output("scale", "", "factor of all rates: 1 where every limit is kept"), scale))
    return names.formula(
        "desaturate",
        (port for port, _ in rates),
        outputs,
        "joint rates to joint rates inside the speed limits, all times one factor",
    )


def most(least: Expr, quantities: Iterable[tuple[Expr, Interval | None]]) -> Expr:
    """The largest quantity in proportion to its limit, on the side where it lies, but no less than ``least`` >= 0."""
    shares: list[Expr] = [] if least.is_zero else [least]
    for value, limit in quantities:
        if limit is not None and limit.low == -limit.high:
            shares.append(times(number(ONE / limit.high), absolute(value)))
        elif limit is not None:
            shares += [times(number(ONE / end), value) for end in (limit.high, limit.low)]
    return reduce(maximum, shares)


def scaled(value: Expr, limit: Interval | None, scale: Expr) -> Expr:
    """``value`` times ``scale``; cut at the limit, which rounding may pass by one unit in the last place."""
    product = times(scale, value)
    return product if limit is None else kept_between(number(limit.low), product, number(limit.high))


def refuse_one_sided(robot: Robot, what: str, limits: Iterable[tuple[str, Interval | None]]) -> None:
    """NotDerivableError of the function ``what`` where one of the named limits leaves no room on a side of 0."""
    for name, limit in limits:
        if limit is not None and not (limit.low.sign < 0 < limit.high.sign):
            raise underivable(
                robot, what, f"the limits of {name} leave nothing on one side of 0, "
                "and no factor brings what lies there inside",
            )  # fmt: skip


def _rates(robot: Robot) -> list[tuple[Port, Interval | None]]:
    """The joint rates that `inverse` commands, each with what it may do (None: anything)."""
    driven = [w for w in robot.wheels if "spin" in w.actuated]
    if not driven:
        raise underivable(robot, "desaturate", "no wheel is driven")
    missing = [w.name for w in driven if robot.limit(w, "spin") is None]
    if missing:
        raise underivable(
            robot, "desaturate", f"{', '.join(missing)} {'has' if len(missing) == 1 else 'have'} no limit of spin; "
            "write limits: {spin: 40} [rad/s] for the robot or for each wheel",
        )  # fmt: skip
    joints = [(w, "spin") for w in robot.wheels if w.has_spin]
    joints += [(w, "steer_rate") for w in robot.wheels if w.kind.swivels]
    rates = [(joint_port(w, joint, Role.COMMAND), room(robot, w, joint, "desaturate")) for w, joint in joints]
    refuse_one_sided(robot, "desaturate", ((port.name, limit) for port, limit in rates))
    return rates


def linear_spins(robot: Robot, twist: Row) -> dict[int, Expr]:
    """Return the spin [rad/s] at a twist of each wheel without an upright axis, by wheel index (Siegwart 3.12)."""
    rims = {}
    for w in robot.wheels:
        if w.has_spin and not w.turns:
            g = working_view(w)
            rims[w.index] = Joints(expression(dot(rolling_row(w, g).row, twist)), g.rolling_radius)
    return spins(robot, rims)


def room(robot: Robot, w: Wheel, joint: str, what: str) -> Interval | None:
    """Return the limit of a joint rate, of a spin without what `steer_toward` may add.

    Args:
        robot: the robot of ``w``.
        w: a wheel.
        joint: ``spin`` or ``steer_rate``.
        what: the function that asks, for the NotDerivableError if steering takes all of the limit.
    """
    limit = robot.limit(w, joint)
    if limit is None or joint != "spin" or not w.rolls_when_steered:
        return limit
    share = steering_spin(robot, w)
    if share is None or not (limit.low + share).sign < 0 < (limit.high - share).sign:
        taken = (
            "with no limit of steer_rate"
            if share is None
            else f"takes {float(share):.4g} rad/s of its spin and"
        )
        why = (
            f"steering {w.name} {taken} leaves no room inside its limit of spin; "
            "write a smaller limits: {steer_rate: …}"
        )
        raise underivable(robot, what, why)
    return Interval(limit.low + share, limit.high - share)


class _Unit(NamedTuple):
    """Wheels that one motor steers.

    ``seen``: per wheel the velocity (u, v) of its pivot along and across it, v mirrored where ``signs`` has -1, for a
    wheel that turns against the first. ``moves``: the sum of
    the squared speeds of the pivots. ``angles``: the joint angle that rolls each of `WAYS`, on the full turn that
    leaves less of it outside ``limits``.
    """

    lead: Wheel
    seen: dict[int, tuple[Expr, Expr]]
    signs: dict[int, int]
    moves: Expr
    angles: dict[str, Expr]
    limits: Interval | None


@function("ours; the texts have none", limits=Limits.COMMANDED)
def inverse_together(robot: Robot, mobility: Mobility) -> Formula:
    """As ``inverse``, with one decision for all modules. NotDerivableError where fewer than two steer."""
    count = len(steered_groups(robot))
    if not count:
        raise underivable(robot, "inverse_together", "no wheel is steered")
    if count == 1:
        why = "all steered wheels turn by one motor, so inverse does it"
        raise underivable(robot, "inverse_together", why)
    text = "twist of P in the robot frame to joint commands, all modules on the same branch"
    return joint_commands(robot, mobility, _steering, "inverse_together", text)


def _steering(robot: Robot, twist: Row, names: Locals) -> dict[int, Target]:
    units = [_unit(robot, members, twist, names) for members in steered_groups(robot)]
    direction = names.define("direction", _direction(units, names))
    targets: dict[int, Target] = {}
    for unit in units:
        targets |= _targets(unit, direction, names)
    return targets


def _unit(robot: Robot, members: list[Wheel], twist: Row, names: Locals) -> _Unit:
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
    """Rim speed on the nearer branch, squared speeds and swing of wheels on one motor (see `steer_group`)."""
    double = add(*(times(2, u, v) for u, v in seen.values()))
    difference = add(*(subtract(square(u), square(v)) for u, v in seen.values()))
    swing = names.define(f"{lead.name}_swing", angle_of(double, difference) / 2)
    c, s = sympy.cos(swing), sympy.sin(swing)
    rim = add(*(add(times(u, c), times(v, s)) for u, v in seen.values()))
    moves = names.define(f"{lead.name}_moves", _squares(list(velocities.values())))
    return names.define(f"{lead.name}_rim", rim), moves, swing


def _squares(velocities: list[Velocity]) -> Expr:
    """The sum of the squares of all pivots' velocities."""
    return add(*(square(expression(p)) for velocity in velocities for p in velocity))


def _beyond(angle: Expr, limits: Interval) -> Expr:
    """How far an angle lies outside its limits [rad]; negative inside."""
    middle, reach = (limits.low + limits.high) / 2, (limits.high - limits.low) / 2
    return subtract(absolute(subtract(angle, number(middle))), number(reach))


def _wrapped(angle: Expr, limits: Interval, names: Locals, name: str) -> Expr:
    """``angle`` or, where that leaves less outside the limits, the same heading a full turn away.

    It does where the angle lies outside, and more than half a turn from the middle, by `hysteresis`.
    """
    best = turned_back(angle, turning_points(limits, QUARTER * 2), 2 * sympy.pi)
    return names.define(f"{name}_best", best)


def _direction(units: list[_Unit], names: Locals) -> Expr:
    """Negative: backwards. Steering limits first, then how the wheels stand."""
    along = add(*(u for unit in units for u, _ in unit.seen.values()))
    limited = [(u.angles, u.limits) for u in units if u.limits is not None]
    if not limited:
        return along
    forwards, backwards = (
        names.define(
            f"over_{way}",
            reduce(maximum, [_beyond(angles[way], limits) for angles, limits in limited], _ZERO),
        )
        for way in WAYS
    )
    stay = number(max(_TIE, *(hysteresis(limits) for _, limits in limited)))
    backwards_better = select(add(backwards, stay), forwards, sympy.S.NegativeOne, along)
    return select(add(forwards, stay), backwards, sympy.S.One, backwards_better)


def _targets(unit: _Unit, direction: Expr, names: Locals) -> dict[int, Target]:
    wanted = select(direction, _ZERO, unit.angles["backwards"], unit.angles["forwards"])
    if unit.limits is None and len(set(unit.seen.values())) == 1:
        speed = names.define(f"{unit.lead.name}_speed", root(unit.moves))
        rim = names.define(f"{unit.lead.name}_rim", select(direction, _ZERO, times(-1, speed), speed))
        return {i: Target(times(unit.signs[i], wanted), rim) for i in unit.seen}
    if unit.limits is not None:
        wanted = kept_between(number(unit.limits.low), wanted, number(unit.limits.high))
    key = unit.lead.name
    steer = names.define(f"{key}_target", wanted)
    turn = names.define(f"{key}_turn", subtract(steer, signal(f"{key}.steer")))
    return {i: turned(steer, turn, u, v, unit.signs[i]) for i, (u, v) in unit.seen.items()}
