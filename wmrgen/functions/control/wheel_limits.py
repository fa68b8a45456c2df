"""Speed limits of the joints: `desaturate`, and what other functions need to know about these limits.

`desaturate` uses one factor for all joint rates, so that every wheel keeps its speed limit and the path does not
change. Steering angles depend only on the direction of the twist, and joint rates are proportional to its size: rates
times k drive the twist times k, along the same path, in 1/k times the time.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import sympy

from wmrgen.analysis.kinematics.inverse import Joints, spins
from wmrgen.analysis.kinematics.ranges import steering_spin
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import rolling_row, working_view
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Row, dot
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import Limits, Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    clamp_between,
    expression,
    maximum,
    number,
    signal,
    times,
)


@function("ours; the texts have none", limits=Limits.ASKED, in_place=True)
def desaturate(robot: Robot, _: Mobility) -> Formula:
    """Return the rates of the joints that `inverse` commands, all times one ``scale`` <= 1.

    scale = 1 / max(1, rate / limit over all limited joints). Wheels without a motor are included if their own
    ``limits`` say so. A wheel that rolls while it is steered reserves a part of its limit of spin for `steer_toward`,
    which comes after: the spin that its limit of steer_rate causes.
    """
    rates = _rates(robot)
    names = Locals()
    load = largest_ratio(sympy.S.One, ((signal(port.name), limit) for port, limit in rates))
    scale = names.define("scale", 1 / names.define("load", load))
    outputs = [(port, scaled_within(signal(port.name), limit, scale)) for port, limit in rates]
    outputs.append((output("scale", "", "factor of all rates: 1 if every limit holds"), scale))
    return names.formula(
        "desaturate",
        (port for port, _ in rates),
        outputs,
        "joint rates to joint rates inside the speed limits, all times one factor",
    )


def largest_ratio(least: Expr, quantities: Iterable[tuple[Expr, Interval | None]]) -> Expr:
    """Return the largest ratio of a quantity to its limit on the same side, but no less than ``least`` >= 0."""
    shares: list[Expr] = [] if least.is_zero else [least]
    for value, limit in quantities:
        if limit is not None and limit.low == -limit.high:
            shares.append(times(number(ONE / limit.high), absolute(value)))
        elif limit is not None:
            shares += [times(number(ONE / end), value) for end in (limit.high, limit.low)]
    return reduce(maximum, shares)


def scaled_within(value: Expr, limit: Interval | None, scale: Expr) -> Expr:
    """Return ``value`` times ``scale``, clamped to the limit: rounding may exceed it by one unit in the last place.

    Args:
        value: The quantity.
        limit: Its limit; None if it has none.
        scale: The factor.
    """
    product = times(scale, value)
    return product if limit is None else clamp_between(number(limit.low), product, number(limit.high))


def refuse_one_sided(robot: Robot, what: str, limits: Iterable[tuple[str, Interval | None]]) -> None:
    """Raise an error if one of the limits excludes one direction, so that no factor can satisfy it.

    Args:
        robot: The robot.
        what: The function that needs the limits, for the message.
        limits: Names of joints or components of the twist, with their limits.

    Raises:
        NotDerivableError: If a limit does not contain numbers on both sides of 0.
    """
    for name, limit in limits:
        if limit is not None and not (limit.low.sign < 0 < limit.high.sign):
            raise underivable(
                robot,
                what,
                f"the limits of {name} exclude one side of 0, and scaling cannot bring a value "
                "of that side inside",
                Reason.ONE_SIDED_LIMIT,
            )


def _rates(robot: Robot) -> list[tuple[Port, Interval | None]]:
    """Return the joint rates that `inverse` commands, each with its limit (None: unlimited)."""
    driven = [w for w in robot.wheels if "spin" in w.actuated]
    if not driven:
        raise underivable(robot, "desaturate", "no wheel is driven", Reason.NOT_DRIVEN)
    missing = [w.name for w in driven if robot.limit(w, "spin") is None]
    if missing:
        raise underivable(
            robot,
            "desaturate",
            f"{', '.join(missing)} {'has' if len(missing) == 1 else 'have'} no limit of spin; "
            "write limits: {spin: 40} [rad/s] for the robot or for each wheel",
            Reason.NO_LIMIT,
        )
    joints = [(w, "spin") for w in robot.wheels if w.has_spin]
    joints += [(w, "steer_rate") for w in robot.wheels if w.kind.swivels]
    rates = [
        (joint_port(w, joint, Role.COMMAND), limit_beside_steering(robot, w, joint, "desaturate"))
        for w, joint in joints
    ]
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


def limit_beside_steering(robot: Robot, w: Wheel, joint: str, what: str) -> Interval | None:
    """Return the limit of a joint rate; for a spin, without the part that `steer_toward` may add.

    Args:
        robot: The robot of ``w``.
        w: A wheel.
        joint: ``spin`` or ``steer_rate``.
        what: The function that needs the limit, for the message of an error.

    Returns:
        The limit [rad/s]; None if the joint has none.

    Raises:
        NotDerivableError: If steering uses all of the limit.
    """
    limit = robot.limit(w, joint)
    if limit is None or joint != "spin" or not w.rolls_when_steered:
        return limit
    share = steering_spin(robot, w)
    if share is None or not (limit.low + share).sign < 0 < (limit.high - share).sign:
        taken = (
            "without a limit of steer_rate"
            if share is None
            else f"needs {float(share):.4g} rad/s of its spin, which"
        )
        why = (
            f"steering {w.name} {taken} leaves no room inside its limit of spin; "
            "write a smaller limits: {steer_rate: …}"
        )
        raise underivable(robot, what, why, Reason.LIMIT_TOO_NARROW)
    return Interval(limit.low + share, limit.high - share)
