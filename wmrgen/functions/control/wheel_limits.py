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

import sympy

from wmrgen.exact.number import ONE, Exact
from wmrgen.functions.registry import function, underivable
from wmrgen.kinematics.ranges import steering_spin
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Limits, Port, Role, output
from wmrgen.symbolic import (
    Expr,
    absolute,
    kept_between,
    maximum,
    number,
    signal,
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
