"""The next twist towards the wanted one that the wheels can follow in one step: `setpoint`.

From the last commanded twist it goes straight towards the wanted one, last + s (wanted - last) with the largest share
0 <= s <= 1 that the limits of wheel acceleration (``spin_rate``), of ``steer_rate`` and of the rates of vx, vy and
omega allow in dt. Every velocity is linear in s, so that s has a closed form:

* A wheel that does not steer spins at a linear function of the twist: s |change of its spin| <= limit dt.
* The rim of a steered wheel runs as fast as its pivot moves, v(s) = v + s dv, and changes by at most s |dv|.
* Let e be the direction of a steered wheel and delta = limit of its steer_rate times dt, the swing that a step allows
  (delta <= tan delta). The pivot stays in the double cone of this half angle about e where
  |e x v(s)| <= delta |e . v(s)|. With A = e . v, B = e . dv, C = e x v, D = e x dv and the sign of A this holds for

      s (|D| - delta B sign A) <= CREEP + delta |A| - |C|.

`CREEP` [m/s] is so slow that a wheel may point anywhere: it slides by that at most. It is what swings a wheel whose
pivot stands. Its direction is defined by the way that the twist has begun to go, and `inverse` steers along it, until
the cone contains the wanted direction. So a robot at rest turns its wheels before it moves, and no twist is a dead end.

The wanted twist is first slowed down to the limits of ``spin``, along its path. They hold between two twists that
keep them, since the speed of a pivot is a convex function of s. A wheel whose steering stop is in the way from the
present to the wanted direction cannot follow: the robot brakes until it stands, and the wheel turns the other way.
"""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.kinematics.steer import NARROW, hysteresis
from wmrgen.analysis.kinematics.steer_groups import moves_as_one, steered_groups
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.braking import rate_limit
from wmrgen.functions.control.curvature import reach
from wmrgen.functions.control.steering_cone import Unit, blocked_by_stops, named_pivot, share_in_cone
from wmrgen.functions.control.twist_limits import (
    INSTANT,
    LAST,
    SHORT,
    STEP,
    WANTED,
    acceleration_limits,
    per_duration,
    share_of_limit,
    whole,
)
from wmrgen.functions.control.wheel_limits import linear_spins, most, refuse_one_sided, room
from wmrgen.functions.registry import function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.poly import Gen, Poly, Row, triple
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import DT, TWIST_NAMES, Limits, Role
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    expression,
    maximum,
    minimum,
    norm,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)

_ZERO, _ONE = sympy.S.Zero, sympy.S.One


class _Rims(NamedTuple):
    """Shares of limits that speeds of steered wheels take: ``squares`` of speeds by the share that a speed of 1 takes,
    and ``others``."""

    squares: dict[Expr, list[Expr]]
    others: list[Expr]

    @property
    def all(self) -> list[Expr]:
        """Every share, the largest of ``squares`` as one; no rounding is below 0 there, which bounds do not see."""
        return [
            *self.others,
            *(times(per, root(reduce(maximum, own, _ZERO))) for per, own in self.squares.items()),
        ]


@function("ours; Team 254's swerve setpoint generator has the idea", limits=Limits.COMMANDED, in_place=True)
def setpoint(robot: Robot, mobility: Mobility) -> Formula:
    """From the last commanded twist and steering angles to the next twist, see above.

    share = min(dt / max(change / limit), (CREEP + delta |A| - |C|) / (|D| - delta B sign A) of each steered wheel, 1),
    the first maximum over all wheels and components of the twist. Without time the twist is held.
    """
    units = _units(robot, mobility)
    _check(robot, mobility, units)
    names = Locals()
    plan = project(robot, mobility).twist
    last, asked = (_row(plan, when, names) for when in ("", "_wanted"))
    goal = _slowed(robot, units, asked, names)
    blocked = {u.lead.index: blocked_by_stops(u, last, asked, names) for u in units if u.rate and u.stops}
    if blocked:
        stops = names.define("stops", reduce(maximum, (b.brakes for b in blocked.values())))
        goal = triple(
            names.poly(f"{n}_goal", select(_ZERO, stops, _ZERO, expression(p))) if p else p
            for n, p in zip(TWIST_NAMES, goal, strict=True)
        )
    change = triple(
        names.poly(f"{n}_change", subtract(expression(g), expression(p))) if p else p
        for n, g, p in zip(TWIST_NAMES, goal, last, strict=True)
    )
    step = names.define("step", maximum(signal(DT.name), _ZERO))
    times_needed = _times(robot, mobility, units, (last, change), step, names)
    share: Expr = _ONE
    if times_needed:
        time = names.define("time", reduce(maximum, times_needed))
        share = step / names.define("longest", maximum(number(INSTANT), maximum(step, time)))
    for unit in units:
        if unit.rate is not None:
            share = minimum(
                share, share_in_cone(unit, (last, change), step, blocked.get(unit.lead.index), names)
            )
    share = names.define("share", select(_ZERO, step, share, _ZERO))
    part = names.define("part", times(number(SHORT), share))
    twist = {
        n: select(share, _ONE, add(expression(p), times(part, expression(c))), expression(g))
        for n, p, c, g in zip(TWIST_NAMES, last, change, goal, strict=True)
        if p
    }
    steers = [joint_port(u.lead, "steer", Role.STATE) for u in units if u.rate is not None]
    text = (
        "the last commanded twist and steering angles to the next twist, straight towards the wanted one, inside the "
        "limits of wheel speed and acceleration, of steering rates and of the rates of the twist"
    )
    return names.formula(
        "setpoint", (*LAST, *WANTED, *steers, STEP, *tunable_ports(robot)), whole(twist), text
    )


def _units(robot: Robot, mobility: Mobility) -> list[Unit]:
    """The steered wheels, by motor. NotDerivableError where no cone says how a wheel swings."""
    units = []
    for members in steered_groups(robot):
        lead, plan = members[0], project(robot, mobility).twist
        rate, stops = robot.limit(lead, "steer_rate"), robot.limit(lead, "steer")
        if not moves_as_one(members, {w.index: pivot(w, plan) for w in members}):
            why = f"{lead.name} and {members[1].name} are steered by one motor and move apart, so one of them slides"
            raise underivable(robot, "setpoint", why)
        units.append(Unit(lead, members, rate, stops))
    for together in robot.together("spin", robot.wheels):
        turning = {robot.steer_group[w.index] for w in together if w.turns}
        if len(turning) + any(not w.turns for w in together) > 1 and turning:
            why = f"{together[0].name} and {together[1].name} turn as one and do not steer as one"
            raise underivable(robot, "setpoint", why)
    return units


def _driven(robot: Robot) -> list[Wheel]:
    """The wheels with a motor on their axle."""
    return [w for w in robot.wheels if w.commands("spin")]


def _spin_rate(robot: Robot, w: Wheel) -> Interval | None:
    return robot.limit(w, "spin_rate")


def _check(robot: Robot, mobility: Mobility, units: list[Unit]) -> None:
    """NotDerivableError where there is nothing to keep, or what cannot be kept."""
    driven = _driven(robot)
    limits = [(f"{w.name}.spin_rate", _spin_rate(robot, w)) for w in driven]
    limits += [(f"{u.lead.name}.steer_rate", u.rate) for u in units]
    if not any(limit for _, limit in limits):
        why = "its wheels have no limits of acceleration; write limits: {spin_rate: 60} [rad/s^2], and steer_rate"
        raise underivable(robot, "setpoint", why)
    refuse_one_sided(robot, "setpoint", limits)
    for w in driven:
        if w.kind.swivels and (_spin_rate(robot, w) or robot.limit(w, "steer_acceleration")):
            why = f"the castor {w.name} swings as the robot moves, which changes its spin whatever the twist does"
            raise underivable(robot, "setpoint", why)
    for unit in units:
        if unit.rate is None or unit.stops is None:
            continue
        apart = unit.stops.high - unit.stops.low
        narrow = apart <= NARROW * 2
        if (narrow and reach(robot, mobility, Locals()) is None) or (not narrow and hysteresis(unit.stops)):
            why = (
                f"between its steering stops {unit.lead.name} cannot reach every direction that inverse commands; "
                "stops at least 190 deg apart can, and so can those of a car"
            )
            raise underivable(robot, "setpoint", why)


def _row(plan: Row, when: str, names: Locals) -> Row:
    """The admissible part of a twist, with the inputs of a name that ends in ``when``."""

    def at(g: Gen) -> Poly | None:
        return Poly.gen("input", f"{g.name}{when}") if g.kind == "input" and g.name in TWIST_NAMES else None

    polys = (p.substitute(at) for p in plan)
    return triple(
        p if not p or (len(p.terms) == 1 and p.constant is None) else names.poly(f"{n}{when}_driven", p)
        for n, p in zip(TWIST_NAMES, polys, strict=True)
    )


def _linear(robot: Robot, twist: Row) -> dict[str, tuple[Wheel, Expr]]:
    """Spin [rad/s] of each driven wheel without an upright axis."""
    found = linear_spins(robot, twist)
    return {w.name: (w, found[w.index]) for w in robot.wheels if w.index in found and w.commands("spin")}


def _slowed(robot: Robot, units: list[Unit], asked: Row, names: Locals) -> Row:
    """The wanted twist, or the fastest along its path at which wheels keep their limits of ``spin``."""
    limited = []
    for name, (w, spin) in _linear(robot, asked).items():
        if (limit := robot.limit(w, "spin")) is not None:
            refuse_one_sided(robot, "setpoint", [(f"{name}.spin", limit)])
            limited.append((names.define(f"{name}_asked", spin), limit))
    load = most(_ONE, limited)
    rims = _Rims({}, [])
    for unit in units:
        velocity: Velocity | None = None
        for w in unit.members:
            limit = room(robot, w, "spin", "setpoint") if w.commands("spin") else None
            if limit is None:
                continue
            refuse_one_sided(robot, "setpoint", [(f"{w.name}.spin", limit)])
            velocity = velocity or named_pivot(unit.lead, asked, "asked", names)
            g = working_view(w)
            per = expression(g.r.inverse() * (1 / min(limit.high, -limit.low)))
            _sort(velocity, g.o * asked[2], per, rims)
    if not limited and not rims.all:
        return asked
    load = reduce(maximum, [load, *rims.all])
    scale = names.define("slower", 1 / names.define("load", load))
    return triple(
        names.poly(f"{n}_target", times(scale, expression(p))) if p else p
        for n, p in zip(TWIST_NAMES, asked, strict=True)
    )


def _sort(velocity: Velocity, turn: Poly, per: Expr, rims: _Rims) -> None:
    """Add (|velocity| + |turn|) per; the largest of sums of squares, where nothing else is in it, has one root."""
    size = add(*(square(expression(p)) for p in velocity if p))
    if turn:
        rims.others.append(times(per, add(root(size), absolute(expression(turn)))))
    elif size not in (squares := rims.squares.setdefault(per, [])):
        squares.append(size)


def _times(
    robot: Robot, mobility: Mobility, units: list[Unit], motion: tuple[Row, Row], step: Expr, names: Locals
) -> list[Expr]:
    """The times [s] that limits of change need, of the components of the twist and of wheel speeds.

    ``motion``: the last twist and its change.
    """
    last, change = motion
    rates = acceleration_limits(robot, mobility, "setpoint", needed=False)
    per_step = per_duration([*rates.values(), *(_spin_rate(robot, w) for w in _driven(robot))], step, names)
    of = dict(zip(TWIST_NAMES, zip(*motion, strict=True), strict=True))
    found = [
        share_of_limit(limit, expression(of[name][0]), expression(of[name][1]), per_step, names, name)
        for name, limit in rates.items()
        if limit is not None
    ]
    before = _linear(robot, last)
    for name, (w, spin) in _linear(robot, change).items():
        if (limit := _spin_rate(robot, w)) is not None:
            spin = names.define(f"{name}_change", spin)
            found.append(share_of_limit(limit, before[name][1], spin, per_step, names, name))
    rims = _Rims({}, [])
    for unit in units:
        driven = [(w, limit) for w in unit.members if w.commands("spin") and (limit := _spin_rate(robot, w))]
        for w, limit in driven:
            velocity = named_pivot(unit.lead, change, "change", names)
            now = named_pivot(unit.lead, last, "last", names)
            toward = add(*(expression(p * q) for p, q in zip(now, velocity, strict=True)))
            most_of = rate_limit(limit, norm(*map(expression, now)), toward, per_step, names, w.name)
            g = working_view(w)
            per = times(expression(g.r.inverse()), 1 / most_of)
            _sort(velocity, g.o * change[2], per, rims)
    return [*found, *rims.all]
