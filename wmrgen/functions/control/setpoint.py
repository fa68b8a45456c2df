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

from fractions import Fraction
from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.constraints import rolling_row, working_view
from wmrgen.exact.evaluate import add_angles, circle_point
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, Row, dot, triple
from wmrgen.functions.control.braking import rate_limit
from wmrgen.functions.control.curvature import reach
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
from wmrgen.functions.control.wheel_limits import most, refuse_one_sided, room
from wmrgen.functions.registry import function, underivable
from wmrgen.kinematics.inverse import Joints, spins
from wmrgen.kinematics.least_squares import project
from wmrgen.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.kinematics.steer import NARROW, QUARTER, Velocity, hysteresis, pivot
from wmrgen.kinematics.steer_groups import moves_as_one, seen_from, steered_groups
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import DT, TWIST_NAMES, Limits, Role
from wmrgen.symbolic import (
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
    with_sign_of,
)

HALF_TURN = QUARTER * 2
CREEP = Exact(Fraction(1, 10**5))  # m/s: thirty times what a float resolves of a pivot that stands at 3 m/s
_LEAST = Exact(Fraction(1, 10**20))  # of a divisor
_ZERO, _ONE = sympy.S.Zero, sympy.S.One


class _Unit(NamedTuple):
    """Wheels that one motor steers, whose pivots move alike. ``rate`` and ``stops``: limits of steering."""

    lead: Wheel
    members: list[Wheel]
    rate: Interval | None
    stops: Interval | None


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
    blocked = {u.lead.index: _blocked(u, last, asked, names) for u in units if u.rate and u.stops}
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
            share = minimum(share, _swing(unit, (last, change), step, blocked.get(unit.lead.index), names))
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


def _units(robot: Robot, mobility: Mobility) -> list[_Unit]:
    """The steered wheels, by motor. NotDerivableError where no cone says how a wheel swings."""
    units = []
    for members in steered_groups(robot):
        lead, plan = members[0], project(robot, mobility).twist
        rate, stops = robot.limit(lead, "steer_rate"), robot.limit(lead, "steer")
        if not moves_as_one(members, {w.index: pivot(w, plan) for w in members}):
            why = f"{lead.name} and {members[1].name} are steered by one motor and move apart, so one of them slides"
            raise underivable(robot, "setpoint", why)
        units.append(_Unit(lead, members, rate, stops))
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


def _check(robot: Robot, mobility: Mobility, units: list[_Unit]) -> None:
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


def _still(robot: Robot) -> list[Wheel]:
    """The wheels whose spin is linear in the twist."""
    return [w for w in robot.wheels if w.has_spin and not w.turns]


def _linear(robot: Robot, twist: Row) -> dict[str, tuple[Wheel, Expr]]:
    """Spin [rad/s] of each driven wheel that does not turn about an upright axis."""
    joints = {
        w.index: Joints(
            expression(dot(rolling_row(w, working_view(w)).row, twist)), working_view(w).rolling_radius
        )
        for w in _still(robot)
    }
    found = spins(robot, joints)
    return {w.name: (w, found[w.index]) for w in _still(robot) if w.commands("spin")}


def _slowed(robot: Robot, units: list[_Unit], asked: Row, names: Locals) -> Row:
    """The wanted twist, or the fastest along its path at which wheels keep their limits of ``spin``."""
    limited = []
    for name, (w, spin) in _linear(robot, asked).items():
        if (limit := robot.limit(w, "spin")) is not None:
            refuse_one_sided(robot, "setpoint", [(f"{name}.spin", limit)])
            limited.append((names.define(f"{name}_asked", spin), limit))
    load = most(_ONE, limited)
    squares, others = list[Expr](), list[Expr]()
    for unit in units:
        velocity: Velocity | None = None
        for w in unit.members:
            limit = room(robot, w, "spin", "setpoint") if w.commands("spin") else None
            if limit is None:
                continue
            refuse_one_sided(robot, "setpoint", [(f"{w.name}.spin", limit)])
            velocity = velocity or _named(unit.lead, asked, "asked", names)
            g = working_view(w)
            per = expression(g.r.inverse() * (1 / min(limit.high, -limit.low)))
            _sort(velocity, g.o * asked[2], per, squares, others)
    if not limited and not squares and not others:
        return asked
    load = reduce(maximum, _with_root([load, *others], squares))
    scale = names.define("slower", 1 / names.define("load", load))
    return triple(
        names.poly(f"{n}_target", times(scale, expression(p))) if p else p
        for n, p in zip(TWIST_NAMES, asked, strict=True)
    )


def _named(w: Wheel, twist: Row, when: str, names: Locals) -> Velocity:
    x, y = pivot(w, twist)
    return names.short(f"{w.name}_x_{when}", x), names.short(f"{w.name}_y_{when}", y)


def _sort(velocity: Velocity, turn: Poly, per: Expr, squares: list[Expr] | None, others: list[Expr]) -> None:
    """Add (|velocity| + |turn|) per to ``others``, or its square to ``squares`` where that is the simpler one."""
    size = add(*(square(expression(p)) for p in velocity if p))
    if turn or squares is None:
        others.append(times(per, add(root(size), absolute(expression(turn)))))
    elif (new := times(square(per), size)) not in squares:
        squares.append(new)


def _with_root(values: list[Expr], squares: list[Expr]) -> list[Expr]:
    """``values`` and the root of the largest square."""
    return [*values, root(reduce(maximum, squares))] if squares else values


class _Blocked(NamedTuple):
    """``way`` > 0: a steering stop is between the present and the wanted direction. ``brakes`` > 0: and it moves."""

    way: Expr
    brakes: Expr


def _blocked(unit: _Unit, last: Row, asked: Row, names: Locals) -> _Blocked:
    """Whether a wheel that turns from where it rolls to where it shall roll meets a stop.

    It turns to the left where e x w > 0, w the wanted velocity of the pivot seen from the way that it rolls. It comes
    past the stop there if the direction d of the stop has d x w > 0, and is less than half a turn away.
    """
    w, stops = unit.lead, unit.stops
    assert stops is not None
    velocity = _named(w, asked, "asked", names)
    a, _ = seen_from(w, _named(w, last, "last", names), names)
    b, d = seen_from(w, velocity, names)
    moves = subtract(absolute(a), number(CREEP * 2))
    sense = names.define(f"{w.name}_onward", select(moves, _ZERO, b, a))
    now, sides = signal(f"{w.name}.steer"), list[Expr]()
    for way, stop in ((1, stops.high), (-1, stops.low)):
        passed = times(way, with_sign_of(_across(w, stop, velocity), sense))
        side = minimum(times(way, with_sign_of(d, sense)), subtract(passed, number(CREEP)))
        if stops.high - stops.low > HALF_TURN:
            side = minimum(side, subtract(times(way, now), number(way * stop - HALF_TURN)))
        sides.append(side)
    met = names.define(f"{w.name}_blocked", maximum(*sides))
    return _Blocked(met, minimum(met, moves))


def _across(w: Wheel, angle: Exact, velocity: Velocity) -> Expr:
    """The velocity across the wheel at a joint angle."""
    g, (c, s) = working_view(w), circle_point(angle.rational())
    x, y = add_angles((g.ch, g.sh), (Poly.of(c), Poly.of(s)))
    return expression(x * velocity[1] - y * velocity[0])


def _times(
    robot: Robot, mobility: Mobility, units: list[_Unit], motion: tuple[Row, Row], step: Expr, names: Locals
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
    squares: list[Expr] = []
    for unit in units:
        driven = [(w, limit) for w in unit.members if w.commands("spin") and (limit := _spin_rate(robot, w))]
        for w, limit in driven:
            velocity = _named(unit.lead, change, "change", names)
            now = _named(unit.lead, last, "last", names)
            toward = add(*(expression(p * q) for p, q in zip(now, velocity, strict=True)))
            most_of = rate_limit(limit, norm(*map(expression, now)), toward, per_step, names, w.name)
            g = working_view(w)
            per = times(expression(g.r.inverse()), 1 / most_of)
            _sort(velocity, g.o * change[2], per, squares if most_of.is_number else None, found)
    return _with_root(found, squares)


def _swing(unit: _Unit, motion: tuple[Row, Row], step: Expr, blocked: _Blocked | None, names: Locals) -> Expr:
    """The share that keeps the pivot of a steered wheel in the cone that it reaches in a step."""
    w, rate = unit.lead, unit.rate
    assert rate is not None
    delta = names.define(f"{w.name}_delta", times(number(min(rate.high, -rate.low)), step))
    (a, c), (b, d) = (
        seen_from(w, _named(w, twist, when, names), names)
        for twist, when in zip(motion, ("last", "change"), strict=True)
    )
    sense = names.define(f"{w.name}_sense", select(absolute(a), number(CREEP), b, a))
    within = add(number(CREEP), subtract(times(delta, with_sign_of(a, sense)), absolute(c)))
    within = names.define(f"{w.name}_within", maximum(within, _ZERO))
    out = subtract(absolute(d), times(delta, with_sign_of(b, sense)))
    if blocked is not None:
        out = select(_ZERO, blocked.way, add(absolute(b), absolute(d)), out)
    below = maximum(number(_LEAST), maximum(within, names.define(f"{w.name}_out", out)))
    return within / names.define(f"{w.name}_below", below)
