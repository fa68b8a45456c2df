"""What is kept between kinematics and motors: `desaturate` and `inverse_together`.

`desaturate` has one factor for all joint rates, so that every wheel keeps its speed limit and the path stays. Steering
angles depend on the direction of the twist alone, joint rates are proportional to its size: rates times k drive the
twist times k, along the same path, 1/k times as long.

With `inverse_together` all steered wheels drive backwards or none, so that swinging modules do not turn the robot.
`inverse` takes the nearer branch for each wheel on its own; near 90 degrees of swing neighbours then swing to
opposite sides, and the robot yaws until they arrive. Here the wheels decide together: backwards where, as they
stand, they would on the whole roll backwards (sum of u < 0, u the speed of the pivot along the wheel). Steering
limits come first: the choice that leaves less of any angle outside them, by more than `_TIE`, wins. A wheel
whose pivot stands still holds its angle.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Row
from wmrgen.functions.registry import function
from wmrgen.kinematics.inverse import joint_commands, moves_as_one, steered_groups
from wmrgen.kinematics.line import Velocity, pivot
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.kinematics.steer import Target, seen_from, turned
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Limits, Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    kept_between,
    local,
    maximum,
    minimum,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)


@dataclass(frozen=True, slots=True)
class _Rate:
    """A joint rate: what is asked of it, and what it may do (None: anything)."""

    wheel: Wheel
    joint: str
    limit: Interval | None

    @property
    def name(self) -> str:
        return f"{self.wheel.name}.{self.joint}"


@function("ours; the texts have none")
def desaturate(robot: Robot, _: Mobility) -> Formula:
    """Every ``<wheel>.spin`` (and ``<castor>.steer_rate``) that `inverse` commands, times one ``scale`` <= 1.

    scale = 1 / max(1, rate / limit over all limited joints). Castors that nothing drives turn along.
    """
    rates = _rates(robot)
    names = Locals()
    load: Expr = sympy.S.One
    for rate in rates:
        if rate.limit is not None:
            asked = signal(rate.name)
            for bound in (rate.limit.high, rate.limit.low):
                load = maximum(load, times(number(ONE / bound), asked))
    scale = names.define("scale", 1 / names.define("load", load))
    outputs = [(joint_port(r.wheel, r.joint, Role.COMMAND), _kept(r, scale)) for r in rates]
    outputs.append(
        (Port("scale", Role.COMMAND, "", "factor of all rates: 1 where every limit is kept"), scale)
    )
    inputs = tuple(joint_port(r.wheel, r.joint, Role.COMMAND) for r in rates)
    text = "joint rates to joint rates inside the speed limits, all times one factor"
    return Formula("desaturate", inputs, tuple(names.items), tuple(outputs), text)


def _kept(rate: _Rate, scale: Expr) -> Expr:
    """The scaled rate; cut at the limit, which rounding may pass by one unit in the last place."""
    scaled = times(scale, signal(rate.name))
    if rate.limit is None:
        return scaled
    below = minimum(number(rate.limit.high), scaled)
    return maximum(number(rate.limit.low), below)


def _rates(robot: Robot) -> list[_Rate]:
    rates = [_Rate(w, "spin", robot.limit(w, "spin")) for w in robot.wheels if w.has_spin]
    rates += [_Rate(w, "steer_rate", robot.limit(w, "steer_rate")) for w in robot.wheels if w.kind.swivels]
    missing = [
        r.wheel.name for r in rates if r.joint == "spin" and "spin" in r.wheel.actuated and not r.limit
    ]
    driven = [r for r in rates if r.joint == "spin" and "spin" in r.wheel.actuated]
    if not driven:
        raise NotDerivableError(f"{robot.name} has no desaturate: no wheel is driven")
    if missing:
        raise NotDerivableError(
            f"{robot.name} has no desaturate: {', '.join(missing)} {'has' if len(missing) == 1 else 'have'} no "
            "limit of spin; write limits: {spin: 40} [rad/s] for the robot or for each wheel"
        )
    for rate in rates:
        if rate.limit is not None and not (rate.limit.low.sign < 0 < rate.limit.high.sign):
            raise NotDerivableError(
                f"{robot.name} has no desaturate: the limits of {rate.name} leave no speed in one direction, "
                "and no factor brings a rate of the other sign inside"
            )
    return rates


_ZERO = sympy.S.Zero
_TIE = Exact(Fraction(1, 10**4))  # rad: both ways lie as far outside the limits, whatever the rounding


@dataclass(frozen=True, slots=True)
class _Unit:
    """Wheels that one motor steers. ``swing``: to the nearer branch; ``rim``: the way that branch rolls.

    ``seen``: (u, v) per wheel; ``forwards``, ``backwards``: joint angle that rolls that way, limits aside.
    """

    lead: Wheel
    members: tuple[Wheel, ...]
    seen: dict[int, tuple[Expr, Expr]]
    along: Expr
    speed: Expr
    forwards: Expr
    backwards: Expr
    limits: Interval | None


@function("ours; the texts have none", limits=Limits.COMMANDED)
def inverse_together(robot: Robot, mobility: Mobility) -> Formula:
    """As ``inverse``, with one decision for all modules. NotDerivableError where fewer than two steer."""
    count = len(steered_groups(robot))
    if count < 2:
        found = (
            "no wheel is steered" if not count else "all steered wheels turn by one motor, so inverse does it"
        )
        raise NotDerivableError(f"{robot.name} has no inverse_together: {found}")
    text = "twist of P in the robot frame to joint commands, all modules on the same branch"
    return joint_commands(robot, mobility, _steering, "inverse_together", text)


def _steering(robot: Robot, twist: Row, names: Locals) -> dict[int, Target]:
    units = [_unit(robot, members, twist, names) for members in steered_groups(robot)]
    direction = names.define("direction", _direction(units, names))
    result: dict[int, Target] = {}
    for unit in units:
        result.update(_targets(unit, direction, names))
    return result


def _unit(robot: Robot, members: list[Wheel], twist: Row, names: Locals) -> _Unit:
    lead = members[0]
    velocities = {w.index: pivot(w, twist) for w in members}
    if moves_as_one(members, velocities):
        seen = dict.fromkeys(velocities, seen_from(lead, velocities[lead.index], names))
        u, v = seen[lead.index]
        own, speed = u, names.define(f"{lead.name}_speed", _length([velocities[lead.index]]))
        swing = angle_of(select(u, _ZERO, times(-1, v), v), absolute(u))
    else:
        seen = {w.index: seen_from(w, velocities[w.index], names, lead) for w in members}
        own, speed, swing = _common(lead, seen, velocities, names)
    swing = names.define(f"{lead.name}_near", swing)
    half = select(_ZERO, swing, subtract(swing, sympy.pi), add(swing, sympy.pi))
    far = names.define(f"{lead.name}_far", select(_ZERO, speed, half, swing))
    now = signal(f"{lead.name}.steer")

    def define(way: str, low: Expr, high: Expr) -> Expr:
        return names.define(f"{lead.name}_{way}", add(now, select(own, _ZERO, low, high)))

    return _Unit(
        lead, tuple(members), seen, add(*(u for u, _ in seen.values())), speed,
        define("forwards", far, swing), define("backwards", swing, far), robot.limit(lead, "steer"),
    )  # fmt: skip


def _common(
    lead: Wheel, seen: dict[int, tuple[Expr, Expr]], velocities: dict[int, Velocity], names: Locals
) -> tuple[Expr, Expr, Expr]:
    """Rim speed on the nearer branch, speed and swing of wheels on one motor (see `steer_group`)."""
    double = add(*(times(2, u, v) for u, v in seen.values()))
    difference = add(*(subtract(square(u), square(v)) for u, v in seen.values()))
    swing = names.define(f"{lead.name}_swing", angle_of(double, difference) / 2)
    c, s = sympy.cos(swing), sympy.sin(swing)
    rim = add(*(add(times(u, c), times(v, s)) for u, v in seen.values()))
    speed = _length(list(velocities.values()))
    return names.define(f"{lead.name}_rim", rim), names.define(f"{lead.name}_speed", speed), swing


def _length(velocities: list[Velocity]) -> Expr:
    """Root of the sum of squares of all pivots' velocities."""
    return root(add(*(square(expression(p)) for velocity in velocities for p in velocity)))


def _direction(units: list[_Unit], names: Locals) -> Expr:
    """Negative: backwards. Steering limits first, then how the wheels stand."""
    along = add(*(u.along for u in units))
    limited = [u for u in units if u.limits is not None]
    if not limited:
        return along
    over = {
        way: names.define(f"over_{way}", _largest([_excess(u, getattr(u, way), names, way) for u in limited]))
        for way in ("forwards", "backwards")
    }
    one = sympy.S.One
    forwards, backwards = (add(over[way], number(_TIE)) for way in ("forwards", "backwards"))
    backwards_better = select(backwards, over["forwards"], times(-1, one), along)
    return select(forwards, over["backwards"], one, backwards_better)


def _largest(values: list[Expr]) -> Expr:
    found = values[0]
    for value in values[1:]:
        found = maximum(found, value)
    return found


def _excess(unit: _Unit, angle: Expr, names: Locals, way: str) -> Expr:
    """How far the best full turn of ``angle`` lies outside the limits."""
    return _outside(unit, _wrapped(unit, angle, names, way))


def _outside(unit: _Unit, angle: Expr) -> Expr:
    assert unit.limits is not None
    low, high = number(unit.limits.low), number(unit.limits.high)
    return maximum(_ZERO, maximum(subtract(low, angle), subtract(angle, high)))


def _wrapped(unit: _Unit, angle: Expr, names: Locals, way: str) -> Expr:
    """``angle`` or, where that leaves less outside the limits, the same heading a full turn away."""
    assert unit.limits is not None
    low, high, turn = number(unit.limits.low), number(unit.limits.high), 2 * sympy.pi
    key = f"{unit.lead.name}_{way}"
    other = names.define(
        f"{key}_turned",
        select(high, angle, subtract(angle, turn), select(angle, low, add(angle, turn), angle)),
    )
    best = select(_outside(unit, other), _outside(unit, angle), other, angle)
    return names.define(f"{key}_best", best)


def _targets(unit: _Unit, direction: Expr, names: Locals) -> dict[int, Target]:
    alone = len(unit.seen) == 1 or len(set(unit.seen.values())) == 1
    if unit.limits is None and alone:
        steer = select(direction, _ZERO, unit.backwards, unit.forwards)
        rim = select(direction, _ZERO, times(-1, unit.speed), unit.speed)
        return dict.fromkeys(unit.seen, Target(steer, rim))
    key = unit.lead.name
    if unit.limits is None:
        wanted = select(direction, _ZERO, unit.backwards, unit.forwards)
    else:
        chosen = select(direction, _ZERO, local(f"{key}_backwards_best"), local(f"{key}_forwards_best"))
        low, high = number(unit.limits.low), number(unit.limits.high)
        wanted = kept_between(low, chosen, high)
    steer = names.define(f"{key}_target", wanted)
    turn = names.define(f"{key}_turn", subtract(steer, signal(f"{key}.steer")))
    return {i: turned(steer, turn, u, v) for i, (u, v) in unit.seen.items()}
