"""Two choices for a twist that is too fast for the robot: `turn_first` and `drive_first`.

`limit_twist` keeps the path: it scales vx, vy and omega by one factor. Here the twist has two parts, translation (vx,
vy) and rotation (omega). The first part is slowed down only if it is too fast by itself. The second part gets what the
limits of the twist and of wheel speed (``spin``) leave. Let a be the speed of a wheel for the first part and b for the
second part; both are linear. The second part is scaled by the largest k in [0, 1] for which

    low <= a + k b <= high            for a wheel that does not steer
    |a + k b| <= limit                for the pivot of a steered wheel, where a and b are vectors

The second inequality gives k = (q - a . b) / b^2 with q = sqrt((a . b)^2 + b^2 (limit^2 - a^2)).

A car turns only while it drives, so it has no such choice.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import reduce

import sympy

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.twist_limits import full_twist, twist_limits
from wmrgen.functions.control.wheel_limits import (
    largest_ratio,
    limit_beside_steering,
    linear_spins,
    refuse_one_sided,
)
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, triple
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import TWIST, TWIST_NAMES, Limits
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    clamp_between,
    expression,
    maximum,
    minimum,
    number,
    root,
    select,
    square,
    subtract,
    times,
)

_ONE, _ZERO = sympy.S.One, sympy.S.Zero
_TRANSLATION, _ROTATION = ("vx", "vy"), ("omega",)
# rad/s or (rad/s)^2: the least divisor. A wheel whose speed for the second part is smaller does not limit it.
_LEAST = Exact(Fraction(1, 10**12))


@function("ours; the choice of FRC drives at saturation", limits=Limits.ASKED, in_place=True)
def turn_first(robot: Robot, mobility: Mobility) -> Formula:
    """Return a twist inside the limits of twist and wheel speed: omega as wanted if possible, then vx and vy."""
    return _prioritised(robot, mobility, "turn_first", (_ROTATION, _TRANSLATION))


@function("ours; the choice of FRC drives at saturation", limits=Limits.ASKED, in_place=True)
def drive_first(robot: Robot, mobility: Mobility) -> Formula:
    """Return a twist inside the limits of twist and wheel speed: vx, vy as wanted if possible, then omega."""
    return _prioritised(robot, mobility, "drive_first", (_TRANSLATION, _ROTATION))


def _prioritised(
    robot: Robot, mobility: Mobility, what: str, order: tuple[tuple[str, ...], tuple[str, ...]]
) -> Formula:
    """Return the function ``what``, which slows down the components of ``order[0]`` last."""
    limits = twist_limits(robot, mobility, what, needed=False)
    steered = [w for w in robot.wheels if w.kind.steers]
    if steered and any(w.kind.fixed_axle for w in robot.wheels):
        raise underivable(
            robot, what, "it turns only while it drives; use limit_twist, which keeps the path", Reason.CAR
        )
    driven = [w for w in robot.wheels if w.commands("spin") and not w.kind.swivels]
    beside = next((w.name for w in steered if w.nominal.o), None)
    if beside is not None:
        why = f"{beside} rolls beside its steering axis (offset_y), so steering changes its spin"
        raise underivable(robot, what, why, Reason.BESIDE_STEERING_AXIS)
    caps = {w.index: limit_beside_steering(robot, w, "spin", what) for w in driven}
    refuse_one_sided(robot, what, ((f"{w.name}.spin", caps[w.index]) for w in driven))
    if not any((*limits.values(), *caps.values())):
        raise underivable(
            robot, what, "it has no limits; write limits: {vx: 1, omega: 2, spin: 40}", Reason.NO_LIMIT
        )
    names, plan = Locals(), project(robot, mobility).twist
    first, second = (_twist_of_components(plan, part) for part in order)
    a, b = (_speeds(robot, driven, part) for part in (first, second))
    loads = [largest_ratio(_ONE, _components(limits, order[0]))]
    for w in driven:
        if (limit := caps[w.index]) is not None:
            value = a[w.index]
            if len(value) == 1:
                loads.append(largest_ratio(_ONE, [(value[0], limit)]))
            else:
                loads.append(times(root(add(*map(square, value))), number(ONE / _symmetric_limit(limit))))
    slower = names.define("slower", 1 / names.define("load", reduce(maximum, loads)))
    share = names.define(
        "fastest", 1 / names.define("own", largest_ratio(_ONE, _components(limits, order[1])))
    )
    for w in driven:
        if (limit := caps[w.index]) is not None:
            now = [names.define(f"{w.name}_first", times(slower, v)) for v in a[w.index]]
            rest = [names.define(f"{w.name}_second", v) for v in b[w.index]]
            share = minimum(
                share,
                _share_in_interval(now[0], rest[0], limit)
                if len(now) == 1
                else _share_in_disk(w, now, rest, limit, names),
            )
    share = names.define("share", maximum(share, _ZERO))
    twist: dict[str, Expr] = {}
    for n, p, q, limit in zip(TWIST_NAMES, first, second, map(limits.get, TWIST_NAMES), strict=True):
        value = add(times(slower, expression(p)), times(share, expression(q)))
        if limit is not None and p + q == Poly.gen("input", n):  # rounding may exceed the limit by one unit
            value = clamp_between(number(limit.low), value, number(limit.high))
        if p or q:
            twist[n] = value
    text = "a twist to one inside the limits of twist and wheel speed: "
    text += "the yaw rate" if order[0] == _ROTATION else "the velocity"
    text += " as wanted if possible, the rest as fast as the limits then allow"
    return names.formula(what, (*TWIST, *tunable_ports(robot)), full_twist(twist), text)


def _components(
    limits: Mapping[str, Interval | None], part: tuple[str, ...]
) -> list[tuple[Expr, Interval | None]]:
    """Return the inputs of one part of the twist, each with its limit."""
    return [(expression(Poly.gen("input", name)), limits[name]) for name in part if name in limits]


def _twist_of_components(plan: Row, kept: tuple[str, ...]) -> Row:
    """Return the admissible twist of the components ``kept`` alone."""

    def only(g: Gen) -> Poly | None:
        return Poly({}) if g.kind == "input" and g.name in TWIST_NAMES and g.name not in kept else None

    return triple(p.substitute(only) for p in plan)


def _speeds(robot: Robot, driven: list[Wheel], twist: Row) -> dict[int, list[Expr]]:
    """Return spins [rad/s] by wheel index: one number, or for a steered wheel two, along x and y of the robot."""
    speeds = {i: [spin] for i, spin in linear_spins(robot, twist).items()}
    for w in (w for w in driven if w.kind.steers):
        over = working_view(w).r.inverse()
        speeds[w.index] = [expression(p * over) for p in pivot(w, twist)]
    return speeds


def _symmetric_limit(limit: Interval) -> Exact:
    """Return the speed that a steered wheel may have in both directions."""
    return min(limit.high, -limit.low)


def _share_in_interval(a: Expr, b: Expr, limit: Interval) -> Expr:
    """Return the largest share of b that the limit of a linear speed leaves; above 1 is treated as 1."""
    left = select(b, _ZERO, subtract(a, number(limit.low)), subtract(number(limit.high), a))
    left = maximum(left, _ZERO)
    return left / maximum(maximum(absolute(b), number(_LEAST)), left)


def _share_in_disk(w: Wheel, a: list[Expr], b: list[Expr], limit: Interval, names: Locals) -> Expr:
    """Return the largest share of b that the limit of a steered wheel leaves."""
    top = number(_symmetric_limit(limit))
    left = maximum(subtract(square(top), add(*map(square, a))), _ZERO)
    left = names.define(f"{w.name}_left", left)
    both = names.define(f"{w.name}_both", add(*(times(x, y) for x, y in zip(a, b, strict=True))))
    size = names.define(f"{w.name}_size", add(*map(square, b)))
    reach = names.define(f"{w.name}_reach", root(maximum(add(square(both), times(size, left)), _ZERO)))
    back = subtract(reach, both) / maximum(number(_LEAST), size)
    on = left / maximum(number(_LEAST), add(reach, both))
    return select(both, _ZERO, back, on)
