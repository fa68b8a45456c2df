"""Commands while wheels swing to their angles: `steer_toward` and `compensate_steering`.

`steer_toward` commands steering angles step by step, as fast as the limits of ``steer_rate`` allow. `inverse` commands
the angle that a twist needs, however far the wheel is from it. In a step of dt the wheel can turn by at most dt times
its limit of ``steer_rate``:

    steer' = max(steer + low dt, min(steer + high dt, wanted))

The result equals ``wanted``, to the bit, as soon as that can be reached. Full turns are not removed: the wheel turns
from -170 to 170 degrees through zero, because steering stops may be there. `inverse` commands the nearest angle. An
angle outside the limits of ``steer`` is treated as an angle at the limit.

A wheel beside its steering axis (offset o, Siegwart (3.12)) rolls while it swings. Its rate and its spin are

    steer_rate = max(low, min(high, (wanted - steer) / dt))    spin' = spin - o steer_rate / r

From these commands `forward` returns the twist that `inverse` was given. The rate is (steer' - steer) / dt, written
without the rounding error of steer', which a short dt would enlarge. If dt is 0, the rate is 0.

`compensate_steering` makes a wheel that is still swinging roll only as fast as its pivot moves along the present
direction of the wheel. `inverse` commands the velocity r spin along the angle ``steer``, so that

    spin' = spin cos(steer - steer_now)

(the rolling row, Siegwart (3.12), at the present angle; cosineScale of WPILib). Any other speed would slip along the
wheel. The sign is not changed: a wheel more than a quarter turn off, for example one that returns from a steering
stop, rolls backwards, which moves the robot in the wanted direction. Without stops `inverse` commands swings of at
most a quarter turn. The spin of a wheel beside its steering axis contains -o omega / r, which is not part of the
velocity of its pivot and does not change: with the yaw rate omega of the twist,

    spin' = spin cos(steer - steer_now) - (o / r) omega (1 - cos(steer - steer_now))

**A car.** All driven wheels roll at the present steering angles, see `axle_speeds`. Q is the centre of the fixed axle.
The pivot of a steered wheel is a ahead of Q and b to the left of it. The wheel points along (c, s), seen from the
axle. If its pivot moves at q along this direction, then Q moves at v and the body turns at omega:

    v = q (c + s b / a)    omega = q s / a

Every driven wheel rolls at row . xi = q g, where g depends on the steering angles alone. Least squares determine q
from the commanded spins and angles. Along the present direction the pivot moves at q cos(steer - steer_now), so that

    q = sum of g r spin / sum of g**2    r spin' = q cos(steer - steer_now) g_now

For several steered wheels the mean is taken. It is exact if all present angles belong to one centre of rotation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.pose import rate_per_change
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.kinematics.steer import present
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.unicycle import drives
from wmrgen.functions.models.axle import Axle, fixed_axle
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import along, rolling_row, working_view
from wmrgen.geometry.exact.evaluate import add_angles
from wmrgen.geometry.exact.poly import Poly, dot
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import DT, TWIST, Limits, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    clamp_between,
    expression,
    maximum,
    minimum,
    number,
    over,
    signal,
    subtract,
    times,
)

_STEP = replace(DT, text="duration of the step; below 0 is treated as 0")
_WANTED = "wanted steering angle, as inverse commands it"
_DRIVING = "wheel speed without the effect of steering, as inverse commands it"


@function("ours; the texts have none", limits=Limits.COMMANDED)
def steer_toward(robot: Robot, _: Mobility) -> Formula:
    """Return the next steering commands from the present and wanted angles, inside the limits of steer_rate."""
    rates = _rates(robot)
    names = Locals()
    step = names.define("step", maximum(signal(DT.name), sympy.S.Zero))
    per_time: Expr | None = None
    inputs, outputs = list[Port](), list[tuple[Port, Expr]]()
    for w, limit in rates:
        if limit is not None or w.rolls_when_steered:
            inputs.append(joint_port(w, "steer", Role.STATE))
    for w, limit in rates:
        angles = robot.limit(w, "steer")
        steer = _next(w, limit, angles, step)
        inputs.append(Port(f"{w.name}.steer_wanted", Role.COMMAND, "rad", _WANTED))
        if not w.rolls_when_steered:
            outputs.append((joint_port(w, "steer", Role.COMMAND), steer))
            continue
        inputs.append(Port(f"{w.name}.spin_wanted", Role.COMMAND, "rad/s", _DRIVING))
        per_time = names.define("per_time", rate_per_change(step)) if per_time is None else per_time
        rate = times(per_time, subtract(_wanted(w, angles), present(w, angles)))
        if limit is not None:
            rate = clamp_between(number(limit.low), rate, number(limit.high))
        rate = names.define(f"{w.name}_rate", rate)
        g = working_view(w)
        share = times(expression(g.steer_arm * g.rolling_radius.inverse()), rate)
        values = {
            "spin": subtract(signal(f"{w.name}.spin_wanted"), share),
            "steer": steer,
            "steer_rate": rate,
        }
        outputs += [(joint_port(w, joint, Role.COMMAND), value) for joint, value in values.items()]
    text = "present and wanted steering angles to the next commands, inside the limits of steer_rate"
    if per_time is not None:
        text += "; also steering rates, and wheel speeds that include the effect of steering"
    return names.formula("steer_toward", (*inputs, _STEP, *tunable_ports(robot)), outputs, text)


@function("Siegwart (3.12) at the present angle; cosineScale of WPILib", limits=Limits.ASKED, in_place=True)
def compensate_steering(robot: Robot, mobility: Mobility) -> Formula:
    """Return the spin of each steered and driven wheel, times the cosine of the swing that is left.

    If a car has other driven wheels, all wheels roll about the present centre of rotation, see `axle_speeds`.
    """
    steered = [w for w in robot.wheels if w.kind.steers]
    driven = [w for w in robot.wheels if "spin" in w.actuated and (w.kind.steers or w.kind.fixed_axle)]
    if not steered or not driven:
        raise underivable(
            robot, "compensate_steering", "no wheel is steered, or none is driven", Reason.NOT_STEERED
        )
    names = Locals()
    axle = car_axle(robot, mobility)
    text = "wheel speeds while wheels swing: the speeds of their pivots along the present steering angles"
    if axle is not None and (len(driven) > 1 or not driven[0].kind.steers):
        spins = [joint_port(w, "spin", Role.COMMAND) for w in driven]
        angles = [port for w in steered for port in (joint_port(w, "steer", Role.COMMAND), _present(w))]
        speeds = axle_speeds(robot, axle, driven, names)
        text = "wheel speeds while wheels swing, about the centre of rotation of the present steering angles"
        return names.formula(
            "compensate_steering",
            (*spins, *angles, *tunable_ports(robot)),
            zip(spins, speeds, strict=True),
            text,
        )
    unsteered = [w.name for w in driven if not w.kind.steers]
    if unsteered:
        why = f"{unsteered[0]} is driven and does not steer, which needs a robot that is steered as a car"
        raise underivable(robot, "compensate_steering", why, Reason.NOT_A_CAR)
    inputs, outputs = dict[Port, None](), list[tuple[Port, Expr]]()
    for w in driven:
        lead = _steering_lead(robot, w)
        spin, steer = joint_port(w, "spin", Role.COMMAND), joint_port(lead, "steer", Role.COMMAND)
        now = _present(lead)
        inputs |= dict.fromkeys((spin, steer, now))
        along = sympy.cos(subtract(signal(steer.name), signal(now.name)), evaluate=False)
        moved = times(signal(spin.name), along)
        g = working_view(w)
        if g.o:
            inputs[TWIST[2]] = None
            aside = times(expression(g.o * g.r.inverse()), signal(TWIST[2].name))
            moved = subtract(moved, times(aside, subtract(sympy.S.One, along)))
        outputs.append((spin, moved))
    ports = (*inputs, *tunable_ports(robot)) if any(w.working.o for w in driven) else inputs
    return names.formula("compensate_steering", ports, outputs, text)


def _present(w: Wheel) -> Port:
    """Return the input for the measured steering angle of a wheel."""
    return Port(f"{w.name}.steer_now", Role.STATE, "rad", "present steering angle")


def _steering_lead(robot: Robot, w: Wheel) -> Wheel:
    """Return the first wheel that steers with ``w``. Raise NotDerivableError if other angles change its spin."""
    groups = robot.steer_group
    for other in robot.wheels:
        if (
            robot.spin_group[other.index] == robot.spin_group[w.index]
            and groups[other.index] != groups[w.index]
        ):
            why = f"{w.name} and {other.name} share the motor of their spin, but not of their steering"
            raise underivable(robot, "compensate_steering", why, Reason.SHARED_MOTOR)
    return robot.wheels[groups[w.index]]


def _wanted(w: Wheel, angles: Interval | None) -> Expr:
    """Return the wanted angle, inside the limits of the angle."""
    wanted = signal(f"{w.name}.steer_wanted")
    return wanted if angles is None else clamp_between(number(angles.low), wanted, number(angles.high))


def _next(w: Wheel, limit: Interval | None, angles: Interval | None, step: Expr) -> Expr:
    """Return the next angle. ``limit`` limits the rate, ``angles`` limits the angle."""
    now, wanted = present(w, angles), _wanted(w, angles)
    if limit is None:
        return wanted
    low, high = (add(now, times(number(end), step)) for end in (limit.low, limit.high))
    return maximum(low, minimum(high, wanted))


def _rates(robot: Robot) -> list[tuple[Wheel, Interval | None]]:
    """Return the steered wheels with their limits of ``steer_rate``."""
    rates = [(w, robot.limit(w, "steer_rate")) for w in robot.wheels if w.kind.steers]
    if not rates:
        raise underivable(robot, "steer_toward", "no wheel is steered", Reason.NOT_STEERED)
    limited = [(w, limit) for w, limit in rates if limit is not None]
    if not limited and not any(w.rolls_when_steered for w, _ in rates):
        raise underivable(
            robot,
            "steer_toward",
            "its wheels have no limit of steering rate; write limits: {steer_rate: 2} [rad/s]",
            Reason.NO_LIMIT,
        )
    for w, limit in limited:
        if limit.low.sign > 0 or limit.high.sign < 0:
            raise underivable(
                robot,
                "steer_toward",
                f"the limits of {w.name}.steer_rate exclude 0, so the wheel cannot keep its angle",
                Reason.ONE_SIDED_LIMIT,
            )
    return rates


# No unit: the least sum of g**2. It is near 0 only if the centre of rotation is under the only driven wheel.
_LEAST = sympy.Rational(1, 10**6)


def car_axle(robot: Robot, mobility: Mobility) -> Axle | None:
    """Return the fixed axle of a robot that is steered as a car; None for any other robot."""
    axle = fixed_axle(robot, mobility, working_view)
    if axle is None or not drives(robot, mobility, axle) or not _steered_off_axle(robot, axle):
        return None
    return axle


def _steered_off_axle(robot: Robot, axle: Axle) -> list[Wheel]:
    """Return the steered wheels that are not on the axle line: their angles determine where the robot turns."""
    return [w for w in robot.wheels if w.kind.steers and axle.seen(working_view(w))[0]]


def axle_speeds(robot: Robot, axle: Axle, driven: Sequence[Wheel], names: Locals) -> list[Expr]:
    """Return the spins [rad/s] of ``driven`` wheels at the present angles ``<wheel>.steer_now``.

    Args:
        robot: A car. Its inputs are commanded spins and angles, and the present angles.
        axle: The fixed axle, see `car_axle`.
        driven: Fixed and steered wheels that have motors.
        names: Takes the intermediate results.

    Returns:
        One spin for each wheel of ``driven``, in the same order.
    """
    leads = _steered_off_axle(robot, axle)
    turning = [w for w in robot.wheels if w.kind.steers and (w in leads or w in driven)]
    wanted = {w.index: _rolling_direction(w, "steer", names) for w in turning}
    present = {w.index: _rolling_direction(w, "steer_now", names) for w in turning}
    parts: list[list[Expr]] = [[] for _ in driven]
    for lead in leads:
        g, now = [], []
        for w in driven:
            ratio = _rim_speed_ratio(w, lead, axle, wanted)
            g.append(names.short(f"{lead.name}_wanted_{w.name}", ratio))
        for w in driven:
            ratio = _rim_speed_ratio(w, lead, axle, present)
            now.append(names.short(f"{lead.name}_present_{w.name}", ratio))
        radii = [working_view(w).rolling_radius for w in driven]
        rims = []
        for w, k, r in zip(driven, g, radii, strict=True):
            rims.append(times(expression(k * r), signal(f"{w.name}.spin")))
        squares = maximum(expression(Poly.sum(k * k for k in g)), _LEAST)
        speed = over(add(*rims), squares)
        swing = subtract(signal(f"{lead.name}.steer"), signal(f"{lead.name}.steer_now"))
        moved = names.define(f"{lead.name}_speed", times(speed, sympy.cos(swing, evaluate=False)))
        for part, k, r in zip(parts, now, radii, strict=True):
            part.append(times(expression(k * r.inverse()), moved))
    return [times(sympy.Rational(1, len(leads)), add(*part)) for part in parts]


def _rolling_direction(w: Wheel, joint: str, names: Locals) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the rolling direction at the angle ``joint``, robot frame."""
    g, angle = working_view(w), signal(f"{w.name}.{joint}")
    c = names.poly(f"{w.name}_{joint}_cos", sympy.cos(angle))
    return add_angles((g.ch, g.sh), (c, names.poly(f"{w.name}_{joint}_sin", sympy.sin(angle))))


def _rim_speed_ratio(w: Wheel, lead: Wheel, axle: Axle, angles: dict[int, tuple[Poly, Poly]]) -> Poly:
    """Return g of a wheel: its rim speed per speed of the pivot of ``lead`` along its direction."""
    dx, dy = angles[lead.index]
    c, s = axle.ex * dx + axle.ey * dy, axle.ex * dy - axle.ey * dx
    a, b = axle.seen(working_view(lead))
    turn = s * a.inverse()
    v = c + b * turn
    g = working_view(w)
    if w.kind.steers:
        x, y, third = along(angles[w.index], g)
        row = x, y, third - g.o
    else:
        row = rolling_row(w, g).row
    return dot(row, (axle.ex * v + axle.y * turn, axle.ey * v - axle.x * turn, turn))
