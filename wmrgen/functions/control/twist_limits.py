"""Limits between a wanted twist and `inverse`: `limit_twist` and `limit_acceleration`.

Both use one factor for vx, vy and omega. `limit_twist` slows a twist down and keeps its path: the centre of rotation
does not change. `limit_acceleration` changes the last twist straight towards the wanted one: each component makes the
same share of its change. If vy has no limit of its own, it has the limit of vx. Components that the robot cannot
drive, for example sideways motion, are 0 in the result and slow nothing down.

A twist that is smaller than `deadband` times its limits, in all components at once, is treated as standstill:
`inverse` then stops every wheel and keeps every steering angle, so noise of a joystick swings no wheel. The deadband
comes before the limits of acceleration, so the robot stops along its path.
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
from wmrgen.functions.control.steering_stops import CurvatureRange, Stops, curvature_range, steering_stops
from wmrgen.functions.control.wheel_limits import largest_ratio, refuse_one_sided, scaled_within
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.layout.records import Interval, Robot
from wmrgen.geometry.ports import DT, TWIST, TWIST_NAMES, Limits, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    maximum,
    minimum,
    number,
    select,
    signal,
    subtract,
    times,
)

# Share of a change that a step makes at most: rounding does not carry it past the wanted twist.
LARGEST_SHARE = Exact(1 - Fraction(1, 2**21))
LEAST_TIME = Exact(Fraction(1, 10**20))  # s: the least divisor, far below any step
WANTED = tuple(Port(f"{p.name}_wanted", Role.COMMAND, p.unit, f"wanted {p.name}") for p in TWIST)
LAST = tuple(replace(port, role=Role.STATE) for port in TWIST)
STEP = replace(DT, text="time since the last command; below 0 is treated as 0")


@function("ours; the texts have none", limits=Limits.ASKED, in_place=True)
def limit_twist(robot: Robot, mobility: Mobility) -> Formula:
    """Return a twist inside the limits of vx, vy and omega, along the same path; zero below the ``deadband``.

    scale = 1 / max(1, component / limit over all three), or 0 if the largest of these is below the deadband. Before
    that, the steering stops limit the twist. For a car they limit its yaw rate. For a robot without a fixed axle they
    limit everything but its speed along a direction in which all wheels can roll.
    """
    names = Locals()
    bends: CurvatureRange | Stops | None = curvature_range(robot, mobility, names) or steering_stops(
        robot, mobility
    )
    limits = twist_limits(robot, mobility, "limit_twist", needed=bends is None)
    missing = [name for name, limit in limits.items() if limit is None]
    if robot.deadband and missing:
        why = f"its deadband is a share of the limits, and {missing[0]} has no limit"
        raise underivable(robot, "limit_twist", why, Reason.NO_LIMIT)
    asked: dict[str, Expr] = {name: signal(name) for name in limits}
    if bends is not None:
        parts = zip(TWIST_NAMES, bends.cut(names), strict=True)
        asked = {name: names.define(f"{name}_bent", part) for name, part in parts if name in limits}
    components = ((asked[name], limit) for name, limit in limits.items())
    load = names.define("load", largest_ratio(sympy.S.Zero if robot.deadband else sympy.S.One, components))
    scale: Expr = 1 / load
    text = "a twist to the fastest one along the same path inside the limits of vx, vy and omega"
    if bends is not None:
        text += ", the path changed only as far as the steering stops require"
    if robot.deadband:
        scale = select(load, number(robot.deadband), sympy.S.Zero, 1 / maximum(sympy.S.One, load))
        text += f"; standstill if all components are below {float(robot.deadband):g} of their limits"
    scale = names.define("scale", scale)
    twist = {name: scaled_within(asked[name], limit, scale) for name, limit in limits.items()}
    return names.formula(
        "limit_twist", (*TWIST, *(tunable_ports(robot) if bends else ())), full_twist(twist), text
    )


@function("ours; the texts have none", limits=Limits.COMMANDED, in_place=True)
def limit_acceleration(robot: Robot, mobility: Mobility) -> Formula:
    """Return the next twist from the last one towards the wanted one, inside the limits of its rates.

    The change takes the time t = max(change / limit over all components, `LEAST_TIME`). If t <= dt, the result is the
    wanted twist, to the bit. Otherwise the change is multiplied by dt / t, and by `LARGEST_SHARE` so that the result is
    between both twists. The limit is that of speeding up or of braking, see `rate_limit`.
    """
    limits = acceleration_limits(robot, mobility, "limit_acceleration")
    names = Locals()
    changes = {
        name: names.define(f"{name}_change", subtract(signal(f"{name}_wanted"), signal(name)))
        for name in limits
    }
    step = names.define("step", maximum(signal(DT.name), sympy.S.Zero))
    per_step = inverse_of_step(limits.values(), step, names)
    shares = [
        time_of_change(limit, signal(name), changes[name], per_step, names, name)
        for name, limit in limits.items()
        if limit is not None
    ]
    time = names.define("time", reduce(maximum, shares, number(LEAST_TIME)))
    share = names.define("share", times(number(LARGEST_SHARE), step) / time)
    twist = {
        name: select(step, time, add(signal(name), times(share, change)), signal(f"{name}_wanted"))
        for name, change in changes.items()
    }
    text = (
        "the last commanded twist to the next one towards the wanted twist, inside the limits of acceleration"
    )
    return names.formula("limit_acceleration", (*LAST, *WANTED, STEP), full_twist(twist), text)


def twist_limits(robot: Robot, mobility: Mobility, what: str, needed: bool) -> dict[str, Interval | None]:
    """Return the limits of vx, vy and omega, for each component that the robot can drive.

    Args:
        robot: The robot.
        mobility: Its mobility.
        what: The function that needs the limits, for the message of an error.
        needed: Whether at least one limit is required.

    Returns:
        The limits [m/s, rad/s] by component; None if a component has no limit.

    Raises:
        NotDerivableError: If a limit is needed and there is none, or if a limit excludes one direction.
    """
    return _limits(robot, mobility, what, "", "{vx: 1, omega: 2}", needed)


def acceleration_limits(
    robot: Robot, mobility: Mobility, what: str, needed: bool = True
) -> dict[str, Interval | None]:
    """Return the limits of the rates of vx, vy and omega, for each component that the robot can drive.

    Args:
        robot: The robot.
        mobility: Its mobility.
        what: The function that needs the limits, for the message of an error.
        needed: Whether at least one limit is required.

    Returns:
        The limits [m/s^2, rad/s^2] by component; None if a component has no limit.

    Raises:
        NotDerivableError: If a limit is needed and there is none, or if a limit excludes one direction.
    """
    return _limits(robot, mobility, what, "_rate", "{vx_rate: 1, omega_rate: 2}", needed)


def inverse_of_step(limits: Iterable[Interval | None], step: Expr, names: Locals) -> Expr | None:
    """Return 1 / ``step`` if a limit differs for speeding up and for braking.

    Args:
        limits: Limits of rates.
        step: The duration of the step [s].
        names: Takes the intermediate result.

    Returns:
        1 / step [1/s]; None if all limits are symmetric, which do not need it.
    """
    if all(limit is None or limit.high == -limit.low for limit in limits):
        return None
    return names.define("per_step", 1 / maximum(number(LEAST_TIME), step))


def rate_limit(
    limit: Interval, now: Expr, change: Expr, per_step: Expr | None, names: Locals, name: str
) -> Expr:
    """Return how fast a quantity may change in this step, in either direction, per second.

    A limit [low, high] of a rate lets the size of the quantity grow by ``high`` and shrink by -``low`` per second. A
    step of dt that passes through zero brakes first and speeds up after it. Let x be the present size if the step goes
    towards zero, else 0. In one step the quantity may change by

        D = -low dt                       if that does not reach zero
        D = x + high (dt - x / -low)      beyond zero

    Hence D / dt = max(-low, high + (1 + high / low) x / dt), or min instead of max if braking is faster.

    Args:
        limit: The limit of the rate. -``low`` limits braking and ``high`` limits speeding up; both are above 0.
        now: The quantity.
        change: The wanted change, or a quantity with the same sign.
        per_step: 1 / dt [1/s]; may be None if the limit is symmetric.
        names: Takes the intermediate results.
        name: The prefix of their names.

    Returns:
        The largest size of the rate, above 0.
    """
    faster, slower = limit.high, -limit.low
    if faster == slower:
        return number(faster)
    assert per_step is not None
    ahead = names.define(
        f"{name}_ahead", select(times(now, change), sympy.S.Zero, absolute(now), sympy.S.Zero)
    )
    mixed = add(number(faster), times(number(ONE - faster / slower), per_step, ahead))
    better = minimum if slower > faster else maximum
    return names.define(f"{name}_limit", better(number(slower), mixed))


def time_of_change(
    limit: Interval, now: Expr, change: Expr, per_step: Expr | None, names: Locals, name: str
) -> Expr:
    """Return the time [s] that a change takes: its size over the limit of its rate, see `rate_limit`.

    Args:
        limit: The limit of the rate.
        now: The quantity.
        change: The wanted change of the quantity.
        per_step: 1 / dt [1/s]; may be None if the limit is symmetric.
        names: Takes the intermediate results.
        name: The prefix of their names.

    Returns:
        The time, 0 or more.
    """
    return times(absolute(change), 1 / rate_limit(limit, now, change, per_step, names, name))


def full_twist(twist: dict[str, Expr]) -> list[tuple[Port, Expr]]:
    """Return all three components of a twist: 0 for a component that the robot cannot drive."""
    return [(port, twist.get(port.name, sympy.S.Zero)) for port in TWIST]


def _limits(
    robot: Robot, mobility: Mobility, what: str, ending: str, example: str, needed: bool = True
) -> dict[str, Interval | None]:
    """Return the limits of the twist, or of its rates if ``ending`` is ``_rate``, for each driven component."""
    limits = {name: robot.limits.get(f"{name}{ending}") for name in TWIST_NAMES}
    limits["vy"] = limits["vy"] or limits["vx"]
    driven = zip(limits, project(robot, mobility).twist, strict=True)
    limits = {name: limits[name] for name, component in driven if component}
    if needed and not any(limits.values()):
        of = "the rates of vx, vy and omega" if ending else "vx, vy and omega"
        raise underivable(robot, what, f"it has no limits of {of}; write limits: {example}", Reason.NO_LIMIT)
    refuse_one_sided(robot, what, ((f"{name}{ending}", limit) for name, limit in limits.items()))
    return limits
