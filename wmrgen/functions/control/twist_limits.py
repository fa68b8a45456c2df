"""What is kept between a wanted twist and `inverse`: `limit_twist` and `limit_acceleration`.

Both have one factor for vx, vy and omega. `limit_twist` makes a twist slower and not another one: it is driven about
the same centre of rotation, along the same path. `limit_acceleration` goes from the last twist straight towards the
wanted one, each component in the same share of its way. Where vy has no limit of its own it has that of vx. What the
robot cannot drive, sideways say, is 0 in the twist that `inverse` drives: it is 0 here, and slows nothing down.

A twist that is smaller than `deadband` times its limits, in all components at once, counts as standstill: `inverse`
then stops every wheel and holds every steering angle, and noise of a joystick swings none. The deadband comes before
the limits of acceleration, so that the robot stops along the path that it drives.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import reduce

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.braking import rate_limit
from wmrgen.functions.control.curvature import Reach, reach
from wmrgen.functions.control.steering_stops import Stops, steering_stops
from wmrgen.functions.control.wheel_limits import most, refuse_one_sided, scaled
from wmrgen.functions.registry import function, underivable
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Interval, Robot
from wmrgen.geometry.ports import DT, TWIST, TWIST_NAMES, Limits, Port, Role
from wmrgen.geometry.symbolic import Expr, absolute, add, maximum, number, select, signal, subtract, times

# Of the way that a step may go: no rounding carries it past the wanted twist.
SHORT = Exact(1 - Fraction(1, 2**21))
INSTANT = Exact(Fraction(1, 10**20))  # s
WANTED = tuple(
    Port(f"{p.name}_wanted", Role.COMMAND, p.unit, f"{p.name} that is to be reached") for p in TWIST
)
LAST = tuple(replace(port, role=Role.STATE) for port in TWIST)
STEP = replace(DT, text="time since the last command; what is below 0 counts as 0")


@function("ours; the texts have none", limits=Limits.ASKED, in_place=True)
def limit_twist(robot: Robot, mobility: Mobility) -> Formula:
    """A twist inside the limits of vx, vy and omega, along the same path; nothing below the ``deadband``.

    scale = 1 / max(1, component / limit over all three), or 0 where the largest of these is below the deadband. Before
    that the twist is cut to what the steering stops allow: for a car its yaw rate, see `curvature`; for a robot without
    a fixed axle all but its speed along a direction that all wheels can roll in, see `steering_stops`.
    """
    names = Locals()
    bends: Reach | Stops | None = reach(robot, mobility, names) or steering_stops(robot, mobility)
    limits = twist_limits(robot, mobility, "limit_twist", needed=bends is None)
    missing = [name for name, limit in limits.items() if limit is None]
    if robot.deadband and missing:
        why = f"its deadband is a share of limits, and {missing[0]} has none"
        raise underivable(robot, "limit_twist", why)
    asked: dict[str, Expr] = {name: signal(name) for name in limits}
    if bends is not None:
        parts = zip(TWIST_NAMES, bends.cut(names), strict=True)
        asked = {name: names.define(f"{name}_bent", part) for name, part in parts if name in limits}
    components = ((asked[name], limit) for name, limit in limits.items())
    load = names.define("load", most(sympy.S.Zero if robot.deadband else sympy.S.One, components))
    scale: Expr = 1 / load
    text = "a twist to the fastest one along the same path that keeps the limits of vx, vy and omega"
    if bends is not None:
        text += ", the path bent no more than the steering stops allow"
    if robot.deadband:
        scale = select(load, number(robot.deadband), sympy.S.Zero, 1 / maximum(sympy.S.One, load))
        text += f"; below {float(robot.deadband):g} of them in all components it is standstill"
    scale = names.define("scale", scale)
    twist = {name: scaled(asked[name], limit, scale) for name, limit in limits.items()}
    return names.formula(
        "limit_twist", (*TWIST, *(tunable_ports(robot) if bends else ())), whole(twist), text
    )


@function("ours; the texts have none", limits=Limits.COMMANDED, in_place=True)
def limit_acceleration(robot: Robot, mobility: Mobility) -> Formula:
    """From the last twist towards the wanted one, as far as dt and the limits of the rates of vx, vy and omega let it.

    The step takes the time t = max(change / limit over all components, `INSTANT`). The wanted twist is reached, to
    the bit, where t <= dt; else the change is that times dt / t (and times `SHORT`, so that the result lies between
    both twists). The limit is that of speeding up or of braking, see `braking`.
    """
    limits = acceleration_limits(robot, mobility, "limit_acceleration")
    names = Locals()
    changes = {
        name: names.define(f"{name}_change", subtract(signal(f"{name}_wanted"), signal(name)))
        for name in limits
    }
    step = names.define("step", maximum(signal(DT.name), sympy.S.Zero))
    per_step = per_duration(limits.values(), step, names)
    shares = [
        share_of_limit(limit, signal(name), changes[name], per_step, names, name)
        for name, limit in limits.items()
        if limit is not None
    ]
    time = names.define("time", reduce(maximum, shares, number(INSTANT)))
    share = names.define("share", times(number(SHORT), step) / time)
    twist = {
        name: select(step, time, add(signal(name), times(share, change)), signal(f"{name}_wanted"))
        for name, change in changes.items()
    }
    text = "the last commanded twist to the next, straight towards the wanted one, inside the limits of acceleration"
    return names.formula("limit_acceleration", (*LAST, *WANTED, STEP), whole(twist), text)


def twist_limits(robot: Robot, mobility: Mobility, what: str, needed: bool) -> dict[str, Interval | None]:
    """Limits of vx, vy and omega, for each that the robot can drive."""
    return _limits(robot, mobility, what, "", "{vx: 1, omega: 2}", needed)


def acceleration_limits(
    robot: Robot, mobility: Mobility, what: str, needed: bool = True
) -> dict[str, Interval | None]:
    """Limits of the rates of vx, vy and omega, for each that the robot can drive."""
    return _limits(robot, mobility, what, "_rate", "{vx_rate: 1, omega_rate: 2}", needed)


def per_duration(limits: Iterable[Interval | None], step: Expr, names: Locals) -> Expr | None:
    """1 / ``step`` where a limit differs for speeding up and for braking, which alone needs it."""
    if all(limit is None or limit.high == -limit.low for limit in limits):
        return None
    return names.define("per_step", 1 / maximum(number(INSTANT), step))


def share_of_limit(
    limit: Interval, now: Expr, change: Expr, per_step: Expr | None, names: Locals, name: str
) -> Expr:
    """Return the time [s] that a change takes: its size over the limit of its rate, see `rate_limit`."""
    return times(absolute(change), 1 / rate_limit(limit, now, change, per_step, names, name))


def whole(twist: dict[str, Expr]) -> list[tuple[Port, Expr]]:
    """All three components: 0 for one that the robot cannot drive."""
    return [(port, twist.get(port.name, sympy.S.Zero)) for port in TWIST]


def _limits(
    robot: Robot, mobility: Mobility, what: str, ending: str, example: str, needed: bool = True
) -> dict[str, Interval | None]:
    """Limits of vx, vy and omega, or of their rates, for each that the robot can drive.

    NotDerivableError where there is none and one is ``needed``, or for a one-sided one.
    """
    limits = {name: robot.limits.get(f"{name}{ending}") for name in TWIST_NAMES}
    limits["vy"] = limits["vy"] or limits["vx"]
    driven = zip(limits, project(robot, mobility).twist, strict=True)
    limits = {name: limits[name] for name, component in driven if component}
    if needed and not any(limits.values()):
        of = "the rates of vx, vy and omega" if ending else "vx, vy and omega"
        raise underivable(robot, what, f"it has no limits of {of}; write limits: {example}")
    refuse_one_sided(robot, what, ((f"{name}{ending}", limit) for name, limit in limits.items()))
    return limits
