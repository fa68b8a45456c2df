"""The (v, omega) that a car can drive, and the nearest one to a command: `input_limits` (AA274; Tzafestas 2.3.4).

A wheel on the centre line, L before the fixed axle, runs at u1 under the steering angle zeta: v = u1 cos zeta and L
omega = u1 sin zeta. With |u1| <= u1_max and |zeta| <= zeta_max the exact set is

    v^2 + (L omega)^2 <= u1_max^2,  |L omega| <= |v| tan zeta_max

The inner set |v| <= u1_max cos zeta_max, |L omega| <= |v| tan zeta_max is inside it. There the bound of v does not
depend on omega. Reeds-Shepp cars drive |v| = v_max, Dubins cars v = v_max. The texts print L = 1. Distances and
margins are in m/s, and turning is measured as L omega.
"""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.errors import NotDerivableError
from wmrgen.functions.control.unicycle import reference, wheelbase
from wmrgen.functions.models.axle import Axle
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.evaluate import circle_point
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import Port, Role, output
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

INPUTS = (
    Port("v", Role.COMMAND, "m/s", "wanted speed forward of the axle centre"),
    Port("omega", Role.COMMAND, "rad/s", "wanted yaw rate"),
)
_OUTPUTS = (
    output("v_max", "m/s", "inner bound of |v|; Reeds-Shepp: |v| = v_max, Dubins: v = v_max"),
    output("omega_max", "rad/s", "inner bound of |omega| at v"),
    output("omega_max_exact", "rad/s", "exact bound of |omega| at v; 0 if v is too fast"),
    output("exact.v", "m/s", "speed of the nearest command in the exact set"),
    output("exact.omega", "rad/s", "yaw rate of the nearest command in the exact set"),
    output("inner.v", "m/s", "speed of the nearest command in the inner set"),
    output("inner.omega", "rad/s", "yaw rate of the nearest command in the inner set"),
    output("exact.margin", "m/s", "slack of the tightest bound, negative outside"),
    output("inner.margin", "m/s", "slack of the tightest bound, negative outside"),
)


class _CarLimits(NamedTuple):
    """The car's geometry and limits."""

    base: Expr  # L [m]
    tan: Expr  # tan zeta_max
    cos: Expr  # cos zeta_max
    sin: Expr  # sin zeta_max
    top: Expr  # u1_max [m/s]


@function("AA274, bounds of the simplified car; Tzafestas 2.3.4")
def input_limits(robot: Robot, mobility: Mobility) -> Formula:
    """Return bounds, margins and the nearest commands in the exact and the inner set, for v and omega."""
    ref = reference(robot, mobility, "input_limits")
    names = Locals()
    car = _car_limits(robot, ref, names)
    v, turn = signal("v"), names.define("turn", times(car.base, signal("omega")))
    a, b = names.define("v_size", absolute(v)), names.define("turn_size", absolute(turn))
    v_max = names.define("v_inner", times(car.top, car.cos))
    slope = names.define("slope", times(a, car.tan))
    rest = names.define("rest", root(maximum(subtract(square(car.top), square(v)), sympy.S.Zero)))
    over_base = names.define("over_base", 1 / car.base)
    bounds = (v_max, times(over_base, slope), times(over_base, minimum(slope, rest)))
    nearest = _nearest(car, (a, b), slope, v_max, over_base, names)
    exact = minimum(subtract(car.top, norm(v, turn)), subtract(slope, b))
    inner = minimum(subtract(v_max, a), subtract(slope, b))
    return names.formula(
        "input_limits",
        (*INPUTS, *tunable_ports(robot)),
        zip(_OUTPUTS, (*bounds, *nearest, exact, inner), strict=True),
        "speed and yaw rate to the nearest ones that a car can drive (AA274 bounds)",
    )


def _nearest(
    car: _CarLimits, sizes: tuple[Expr, Expr], slope: Expr, v_max: Expr, over_base: Expr, names: Locals
) -> tuple[Expr, Expr, Expr, Expr]:
    """Return (v, omega) of the nearest points of the exact and of the inner set, in (v, L omega).

    Each set consists of four mirror images of its part with v, omega >= 0. This part is convex. Outside the wedge the
    nearest point is on the wedge's ray. The disk then scales it, and the inner bound clips it.
    """
    a, b = sizes
    ray = names.define("ray", add(times(a, car.cos), times(b, car.sin)))
    wedge_v = names.define("wedge_v", select(slope, b, times(ray, car.cos), a))
    wedge_turn = names.define("wedge_turn", select(slope, b, times(ray, car.sin), b))
    speed = names.define("wedge_speed", norm(wedge_v, wedge_turn))
    divisor = names.define("speed_divisor", maximum(speed, car.top))
    shrink = names.define("shrink", times(car.top, 1 / divisor))
    clipped_v = names.define("clipped_v", minimum(wedge_v, v_max))
    clipped_turn = names.define("clipped_turn", minimum(wedge_turn, times(v_max, car.tan)))

    def signed(port: str, size: Expr) -> Expr:
        return with_sign_of(size, signal(port))

    return (
        signed("v", times(shrink, wedge_v)),
        signed("omega", times(over_base, shrink, wedge_turn)),
        signed("v", clipped_v),
        signed("omega", times(over_base, clipped_turn)),
    )


def _car_limits(robot: Robot, ref: Axle, names: Locals) -> _CarLimits:
    """Return the geometry and the limits of a wheel on the centre line."""
    base = wheelbase(robot, ref)
    steered = [w for w in robot.wheels if w.kind.steers]
    if base is None:
        raise _refusal(
            robot,
            "its bounds are defined for a car: a fixed axle, and steered wheels on one line across it",
            Reason.NOT_A_CAR,
        )
    bend = names.define("sharpest", _smallest([_largest_curvature(robot, w, ref) for w in steered]))
    length = names.define("wheelbase_size", absolute(expression(base)))
    tan = names.define("tan_zeta", times(length, bend))
    cos = names.define("cos_zeta", 1 / root(add(sympy.S.One, square(tan))))
    top = _smallest(_speed_bounds(robot, steered, ref, bend))
    return _CarLimits(
        length, tan, cos, names.define("sin_zeta", times(tan, cos)), names.define("u1_max", top)
    )


def _smallest(values: list[Expr]) -> Expr:
    """Return the smallest value; equal values are written once."""
    return reduce(lambda least, value: least if value == least else minimum(least, value), values)


def _refusal(robot: Robot, why: str, reason: Reason) -> NotDerivableError:
    """Return the error for a robot without `input_limits`."""
    return underivable(robot, "input_limits", why, reason)


def _largest_curvature(robot: Robot, w: Wheel, ref: Axle) -> Expr:
    """Return the largest curvature [1/m] that the steering limit of one wheel allows to both sides.

    A wheel at (x, y) from the axle centre points along (1 - k y, k x) on the circle of curvature k.
    """
    limit = robot.limit(w, "steer")
    if limit is None:
        raise _refusal(
            robot,
            f"{w.name} has no limits: {{steer: ...}}; write its largest steering angle",
            Reason.NO_LIMIT,
        )
    if ref.ey.scale(w.nominal.ch) - ref.ex.scale(w.nominal.sh):
        raise _refusal(
            robot,
            f"{w.name} does not point straight ahead at steering angle 0, so its limits are not symmetric",
            Reason.SKEWED_WHEEL,
        )
    zeta = min(limit.high, -limit.low)
    if zeta.sign <= 0 or float(zeta) >= 1.57:
        reason = Reason.ONE_SIDED_LIMIT if zeta.sign <= 0 else Reason.LIMIT_TOO_WIDE
        raise _refusal(
            robot,
            f"{w.name} may steer by {float(zeta):.4g} rad; a bound needs more than 0 and less than 90 deg",
            reason,
        )
    cosine, sine = circle_point(zeta.rational())
    tan = number(sine / cosine)
    x, y = map(expression, ref.seen(working_view(w)))
    return times(tan, 1 / add(absolute(x), times(tan, absolute(y))))


def _speed_bounds(robot: Robot, steered: list[Wheel], ref: Axle, bend: Expr) -> list[Expr]:
    """Return bounds of u1 [m/s]: `vx` of the robot, and r spin of each steered wheel.

    A wheel beside the centre line runs up to 1 + |y| bend times as fast as a wheel on the line.
    """
    tops: list[Expr] = []
    if "vx" in robot.limits:
        tops.append(number(_symmetric(robot, "vx", robot.limits["vx"])))
    for w in steered:
        spin = robot.limit(w, "spin")
        if spin is None:
            continue
        rim = working_view(w).r * Poly.of(_symmetric(robot, "spin", spin))
        _, aside = ref.seen(working_view(w))
        faster = add(sympy.S.One, times(absolute(expression(aside)), bend))
        tops.append(times(expression(rim), 1 / faster))
    if not tops:
        raise _refusal(
            robot,
            "no limit of speed is given; write limits: {vx: ...} or spin of the steered wheel",
            Reason.NO_LIMIT,
        )
    return tops


def _symmetric(robot: Robot, name: str, limit: Interval) -> Exact:
    """Return the speed that a limit allows in both directions."""
    top = min(limit.high, -limit.low)
    if top.sign <= 0:
        raise _refusal(
            robot,
            f"the limits of {name} allow motion in one direction only, and a Reeds-Shepp car also reverses",
            Reason.ONE_SIDED_LIMIT,
        )
    return top
