"""The next twist towards the wanted one that the wheels can follow in one step: `setpoint`.

The next twist is last + s (wanted - last). The share 0 <= s <= 1 is the largest one that the limits allow in dt: the
limits of wheel acceleration (``spin_rate``), of ``steer_rate`` and of the rates of vx, vy and omega. Every velocity is
linear in s, so s has a closed form:

* A wheel that does not steer spins at a linear function of the twist: s |change of its spin| <= limit dt.
* The rim of a steered wheel runs as fast as its pivot moves, v(s) = v + s dv, and changes by at most s |dv|.
* Let e be the direction of a steered wheel and delta = limit of its steer_rate times dt, the swing that a step allows
  (delta <= tan delta). The pivot stays in the double cone of this half angle about e if
  |e x v(s)| <= delta |e . v(s)|. With A = e . v, B = e . dv, C = e x v, D = e x dv and the sign of A this holds for

      s (|D| - delta B sign A) <= CREEP + delta |A| - |C|.

`CREEP` [m/s] is a speed at which a wheel may point anywhere, because it slides by no more than that. It lets the wheel
of a resting pivot swing: the twist starts to change by at most `CREEP`, this defines a direction of motion, `inverse`
steers along it, and soon the cone contains the wanted direction. So a robot at rest turns its wheels before it moves,
and every twist can be left.

The wanted twist is first slowed down to the limits of ``spin``, along its path. The limits then hold between the last
and the wanted twist, since the speed of a pivot is a convex function of s. If a steering stop is between the present
and the wanted direction of a wheel, the wheel cannot follow: the robot brakes until it stands, and the wheel turns in
the other direction.
"""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.kinematics.steer import NARROW, QUARTER, hysteresis, turned_by
from wmrgen.analysis.kinematics.steer_groups import moves_as_one, seen_from, steered_groups
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.steering_stops import curvature_range
from wmrgen.functions.control.twist_limits import (
    LARGEST_SHARE,
    LAST,
    LEAST_TIME,
    STEP,
    WANTED,
    acceleration_limits,
    full_twist,
    inverse_of_step,
    rate_limit,
    time_of_change,
)
from wmrgen.functions.control.wheel_limits import (
    largest_ratio,
    limit_beside_steering,
    linear_spins,
    refuse_one_sided,
)
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.number import Exact
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
    with_sign_of,
)

HALF_TURN = QUARTER * 2
CREEP = Exact(Fraction(1, 10**5))  # m/s: thirty times the resolution of a float at 3 m/s
# m/s: the least numerator, above 0, so that a wheel outside its cone leaves a share of nearly 0
_LEAST = Exact(Fraction(1, 10**20))
_ZERO, _ONE = sympy.S.Zero, sympy.S.One


class Unit(NamedTuple):
    """Wheels that one motor steers and whose pivots move alike."""

    lead: Wheel  # the first of the wheels
    members: list[Wheel]
    rate: Interval | None  # limit of the steering rate [rad/s]
    stops: Interval | None  # limits of the steering angle [rad]


class _SpeedShares(NamedTuple):
    """Shares of their limits that the speeds of steered wheels use."""

    # squares of speeds, by the share that a speed of 1 uses: one root serves them all
    squares: dict[Expr, list[Expr]]
    others: list[Expr]  # shares of wheels beside their steering axis

    @property
    def all(self) -> list[Expr]:
        """Return every share; the shares of ``squares`` as one root of the largest square."""
        shares = list(self.others)
        for per, own in self.squares.items():
            # The 0 is for the analysis of ranges, which does not know that squares are not negative.
            largest = reduce(maximum, own, _ZERO)
            shares.append(times(per, root(largest)))
        return shares


@function("ours; Team 254's swerve setpoint generator has the idea", limits=Limits.COMMANDED, in_place=True)
def setpoint(robot: Robot, mobility: Mobility) -> Formula:
    """Return the next twist from the last commanded twist and steering angles, see above.

    share = min(dt / max(change / limit), (CREEP + delta |A| - |C|) / (|D| - delta B sign A) of each steered wheel, 1),
    with the first maximum over all wheels and components of the twist. If dt is 0, the twist does not change.
    """
    units = _units(robot, mobility)
    _check_limits(robot, mobility, units)
    names = Locals()
    plan = project(robot, mobility).twist
    last, asked = (_row(plan, when, names) for when in ("", "_wanted"))
    goal = _within_spin_limits(robot, units, asked, names)
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
    times_needed = _times_needed(robot, mobility, units, (last, change), step, names)
    share: Expr = _ONE
    if times_needed:
        time = names.define("time", reduce(maximum, times_needed))
        share = step / names.define("longest", maximum(number(LEAST_TIME), maximum(step, time)))
    for unit in units:
        if unit.rate is not None:
            share = minimum(
                share, share_in_cone(unit, (last, change), step, blocked.get(unit.lead.index), names)
            )
    share = names.define("share", select(_ZERO, step, share, _ZERO))
    part = names.define("part", times(number(LARGEST_SHARE), share))
    twist = {
        n: select(share, _ONE, add(expression(p), times(part, expression(c))), expression(g))
        for n, p, c, g in zip(TWIST_NAMES, last, change, goal, strict=True)
        if p
    }
    steers = [joint_port(u.lead, "steer", Role.STATE) for u in units if u.rate is not None]
    text = (
        "the last commanded twist and steering angles to the next twist towards the wanted one, inside the limits of "
        "wheel speed and acceleration, of steering rates and of the rates of the twist"
    )
    return names.formula(
        "setpoint", (*LAST, *WANTED, *steers, STEP, *tunable_ports(robot)), full_twist(twist), text
    )


def _units(robot: Robot, mobility: Mobility) -> list[Unit]:
    """Return the steered wheels by motor. Raise NotDerivableError if no cone describes how a wheel swings."""
    units = []
    for members in steered_groups(robot):
        lead, plan = members[0], project(robot, mobility).twist
        rate, stops = robot.limit(lead, "steer_rate"), robot.limit(lead, "steer")
        if not moves_as_one(members, {w.index: pivot(w, plan) for w in members}):
            why = f"{lead.name} and {members[1].name} share a steering motor but move in different directions"
            raise underivable(robot, "setpoint", why, Reason.SHARED_MOTOR)
        units.append(Unit(lead, members, rate, stops))
    for together in robot.together("spin", robot.wheels):
        turning = {robot.steer_group[w.index] for w in together if w.turns}
        if len(turning) + any(not w.turns for w in together) > 1 and turning:
            why = f"{together[0].name} and {together[1].name} share the motor of their spin, but not of their steering"
            raise underivable(robot, "setpoint", why, Reason.SHARED_MOTOR)
    return units


def _driven(robot: Robot) -> list[Wheel]:
    """Return the wheels with a motor on their axle."""
    return [w for w in robot.wheels if w.commands("spin")]


def _spin_rate(robot: Robot, w: Wheel) -> Interval | None:
    """Return the limit of the acceleration of a wheel [rad/s^2]."""
    return robot.limit(w, "spin_rate")


def _check_limits(robot: Robot, mobility: Mobility, units: list[Unit]) -> None:
    """Raise NotDerivableError if the robot has no limit that matters, or one that cannot be satisfied."""
    driven = _driven(robot)
    limits = [(f"{w.name}.spin_rate", _spin_rate(robot, w)) for w in driven]
    limits += [(f"{u.lead.name}.steer_rate", u.rate) for u in units]
    if not any(limit for _, limit in limits):
        why = "its wheels have no limits of acceleration; write limits: {spin_rate: 60} [rad/s^2], and steer_rate"
        raise underivable(robot, "setpoint", why, Reason.NO_LIMIT)
    refuse_one_sided(robot, "setpoint", limits)
    for w in driven:
        if w.kind.swivels and (_spin_rate(robot, w) or robot.limit(w, "steer_acceleration")):
            why = f"the castor {w.name} swings as the robot moves, which changes its spin even at constant twist"
            raise underivable(robot, "setpoint", why, Reason.CASTOR)
    for unit in units:
        if unit.rate is None or unit.stops is None:
            continue
        apart = unit.stops.high - unit.stops.low
        narrow = apart <= NARROW * 2
        if (narrow and curvature_range(robot, mobility, Locals()) is None) or (
            not narrow and hysteresis(unit.stops)
        ):
            why = (
                f"{unit.lead.name} cannot reach every direction that inverse commands between its steering stops; "
                "write stops at least 190 deg apart, or steer the robot as a car"
            )
            raise underivable(robot, "setpoint", why, Reason.STEERING_STOPS)


def _row(plan: Row, when: str, names: Locals) -> Row:
    """Return the admissible part of a twist, written in the inputs whose names end in ``when``."""

    def at(g: Gen) -> Poly | None:
        return Poly.gen("input", f"{g.name}{when}") if g.kind == "input" and g.name in TWIST_NAMES else None

    polys = (p.substitute(at) for p in plan)
    return triple(
        p if not p or (len(p.terms) == 1 and p.constant is None) else names.poly(f"{n}{when}_driven", p)
        for n, p in zip(TWIST_NAMES, polys, strict=True)
    )


def _unsteered_spins(robot: Robot, twist: Row) -> dict[str, tuple[Wheel, Expr]]:
    """Return the spin [rad/s] of each driven wheel without an upright axis."""
    found = linear_spins(robot, twist)
    return {w.name: (w, found[w.index]) for w in robot.wheels if w.index in found and w.commands("spin")}


def _within_spin_limits(robot: Robot, units: list[Unit], asked: Row, names: Locals) -> Row:
    """Return the wanted twist, or the fastest twist along its path that satisfies the limits of ``spin``."""
    limited = []
    for name, (w, spin) in _unsteered_spins(robot, asked).items():
        if (limit := robot.limit(w, "spin")) is not None:
            refuse_one_sided(robot, "setpoint", [(f"{name}.spin", limit)])
            limited.append((names.define(f"{name}_asked", spin), limit))
    load = largest_ratio(_ONE, limited)
    rims = _SpeedShares({}, [])
    for unit in units:
        velocity: Velocity | None = None
        for w in unit.members:
            limit = limit_beside_steering(robot, w, "spin", "setpoint") if w.commands("spin") else None
            if limit is None:
                continue
            refuse_one_sided(robot, "setpoint", [(f"{w.name}.spin", limit)])
            velocity = velocity or named_pivot(unit.lead, asked, "asked", names)
            g = working_view(w)
            per = expression(g.r.inverse() * (1 / min(limit.high, -limit.low)))
            _add_share(velocity, g.o * asked[2], per, rims)
    if not limited and not rims.all:
        return asked
    load = reduce(maximum, [load, *rims.all])
    scale = names.define("slower", 1 / names.define("load", load))
    return triple(
        names.poly(f"{n}_target", times(scale, expression(p))) if p else p
        for n, p in zip(TWIST_NAMES, asked, strict=True)
    )


def _add_share(velocity: Velocity, turn: Poly, per: Expr, rims: _SpeedShares) -> None:
    """Add the share (|velocity| + |turn|) per to ``rims``, as a square if ``turn`` is 0."""
    size = add(*(square(expression(p)) for p in velocity if p))
    if turn:
        rims.others.append(times(per, add(root(size), absolute(expression(turn)))))
    elif size not in (squares := rims.squares.setdefault(per, [])):
        squares.append(size)


def _times_needed(
    robot: Robot, mobility: Mobility, units: list[Unit], motion: tuple[Row, Row], step: Expr, names: Locals
) -> list[Expr]:
    """Return the times [s] that the components of the twist and the wheel speeds need for their changes.

    ``motion`` is the last twist and its change.
    """
    last, change = motion
    rates = acceleration_limits(robot, mobility, "setpoint", needed=False)
    per_step = inverse_of_step(
        [*rates.values(), *(_spin_rate(robot, w) for w in _driven(robot))], step, names
    )
    of = dict(zip(TWIST_NAMES, zip(*motion, strict=True), strict=True))
    found = [
        time_of_change(limit, expression(of[name][0]), expression(of[name][1]), per_step, names, name)
        for name, limit in rates.items()
        if limit is not None
    ]
    before = _unsteered_spins(robot, last)
    for name, (w, spin) in _unsteered_spins(robot, change).items():
        if (limit := _spin_rate(robot, w)) is not None:
            spin = names.define(f"{name}_change", spin)
            found.append(time_of_change(limit, before[name][1], spin, per_step, names, name))
    rims = _SpeedShares({}, [])
    for unit in units:
        driven = [(w, limit) for w in unit.members if w.commands("spin") and (limit := _spin_rate(robot, w))]
        for w, limit in driven:
            velocity = named_pivot(unit.lead, change, "change", names)
            now = named_pivot(unit.lead, last, "last", names)
            toward = add(*(expression(p * q) for p, q in zip(now, velocity, strict=True)))
            most_of = rate_limit(limit, norm(*map(expression, now)), toward, per_step, names, w.name)
            g = working_view(w)
            per = times(expression(g.r.inverse()), 1 / most_of)
            _add_share(velocity, g.o * change[2], per, rims)
    return [*found, *rims.all]


def named_pivot(w: Wheel, twist: Row, when: str, names: Locals) -> Velocity:
    """Return the velocity [m/s] of a wheel's pivot at a twist, as intermediate results.

    Args:
        w: The wheel.
        twist: The twist of P in the robot frame.
        when: The end of the names of the results: ``last``, ``change`` or ``asked``.
        names: Takes the intermediate results.

    Returns:
        The components along x and y of the robot frame.
    """
    x, y = pivot(w, twist)
    return names.short(f"{w.name}_x_{when}", x), names.short(f"{w.name}_y_{when}", y)


class Blocked(NamedTuple):
    """A steering stop between the present and the wanted direction of a wheel."""

    brakes: Expr  # above 0 if the wheel moves, so that the robot has to brake
    waits: Expr  # above 0 if the wheel stands, and may turn in the other direction


def blocked_by_stops(unit: Unit, last: Row, asked: Row, names: Locals) -> Blocked:
    """Return whether a wheel meets a stop when it turns from the direction of its motion to the wanted one.

    Let e be the direction in which it rolls and w the wanted velocity of its pivot. It turns to the left if e x w > 0.
    It passes the left stop, whose direction is d, if d x w > 0 and if the stop is less than half a turn away.

    Args:
        unit: The wheel, with stops.
        last: The last twist.
        asked: The wanted twist.
        names: Takes the intermediate results.

    Returns:
        Two expressions [m/s], see `Blocked`.
    """
    w, stops = unit.lead, unit.stops
    assert stops is not None
    velocity = named_pivot(w, asked, "asked", names)
    a, _ = seen_from(w, named_pivot(w, last, "last", names), names)
    b, d = seen_from(w, velocity, names)
    moves = subtract(absolute(a), number(CREEP * 2))
    sense = names.define(f"{w.name}_onward", select(moves, _ZERO, b, a))
    now, sides = signal(f"{w.name}.steer"), list[Expr]()
    for way, stop in ((1, stops.high), (-1, stops.low)):
        passed = times(way, with_sign_of(expression(turned_by(w, velocity, stop)[1]), sense))
        side = minimum(times(way, with_sign_of(d, sense)), subtract(passed, number(CREEP)))
        if stops.high - stops.low > HALF_TURN:
            side = minimum(side, subtract(times(way, now), number(way * stop - HALF_TURN)))
        sides.append(side)
    met = names.define(f"{w.name}_blocked", maximum(*sides))
    return Blocked(minimum(met, moves), minimum(met, times(-1, moves)))


def share_in_cone(
    unit: Unit, motion: tuple[Row, Row], step: Expr, blocked: Blocked | None, names: Locals
) -> Expr:
    """Return the largest share of the motion for which a steered wheel stays in the cone that a step can reach.

    Args:
        unit: The wheel, with a limit of its steering rate.
        motion: The last twist and its wanted change.
        step: The duration of the step [s].
        blocked: Whether a stop is in the way of the wheel; None if it has no stops.
        names: Takes the intermediate results.

    Returns:
        The share s, above 0; shares above 1 do not occur.
    """
    w, rate = unit.lead, unit.rate
    assert rate is not None
    delta = names.define(f"{w.name}_delta", times(number(min(rate.high, -rate.low)), step))
    (a, c), (b, d) = (
        seen_from(w, named_pivot(w, twist, when, names), names)
        for twist, when in zip(motion, ("last", "change"), strict=True)
    )
    rolls = names.define(f"{w.name}_rolls", absolute(a))
    gains = select(rolls, number(CREEP), absolute(b), with_sign_of(b, a))
    within = add(number(CREEP), subtract(times(delta, rolls), absolute(c)))
    within = names.define(f"{w.name}_within", maximum(within, number(_LEAST)))
    out = subtract(absolute(d), times(delta, gains))
    if blocked is not None:
        out = select(_ZERO, blocked.waits, add(absolute(b), absolute(d)), out)
    return within / names.define(f"{w.name}_below", maximum(within, out))
