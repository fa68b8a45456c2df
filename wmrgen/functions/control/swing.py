"""What is commanded while wheels swing to their angles: `steer_toward` and `compensate_steering`.

`steer_toward` commands angles step by step, as fast as the limits of ``steer_rate`` let them.
`inverse` commands the angle that a twist needs, however far the wheel stands from it. In a step of dt the wheel comes
no further than dt times its limit of ``steer_rate``:

    steer' = max(steer + low dt, min(steer + high dt, wanted))

so that it stands at ``wanted``, to the bit, as soon as that can be reached. No turn is taken off: the way from -170 to
170 degrees leads through zero, as steering stops have it; `inverse` gives the angle that is nearest. An angle outside
the limits of ``steer`` counts as at the limit.

A wheel beside its steering axis (offset o, Siegwart (3.12)) rolls while it swings. Its rate and its spin are

    steer_rate = max(low, min(high, (wanted - steer) / dt))    spin' = spin - o steer_rate / r

so that `forward` finds in the commands the twist that `inverse` was given. This rate is (steer' - steer) / dt, written
without the rounding error of steer', which a short dt would enlarge. If dt is 0, the rate is 0.

`compensate_steering` rolls a wheel, until it points where it should, as fast as its pivot moves along the way that it
points now: of the velocity that `inverse` commands, r spin along the angle ``steer``, that is

    spin' = spin cos(steer - steer_now)

(the rolling row, Siegwart (3.12), at the present angle; cosineScale of WPILib). Any other speed would slip along the
wheel. The sign is kept: a wheel more than a quarter turn off, as one that comes back from a steering stop, rolls
backwards, which carries the robot where it should go. `inverse` asks for no more than a quarter turn where there are
no stops. A wheel beside its steering axis has -o omega / r in its spin, which is no velocity of its pivot and stays:
with the yaw rate omega of the twist that `inverse` was given, spin' = spin cos - (o / r) omega (1 - cos).
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.pose import rate_per_change
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.kinematics.steer import present
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.axle_speeds import axle_speeds, car_axle
from wmrgen.functions.registry import function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import DT, TWIST, Limits, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    expression,
    kept_between,
    maximum,
    minimum,
    number,
    signal,
    subtract,
    times,
)

_STEP = replace(DT, text="duration of the step; what is below 0 counts as 0")
_WANTED = "steering angle that is to be reached, as inverse commands it"
_DRIVING = "wheel speed without its share of the steering, as inverse commands it"


@function("ours; the texts have none", limits=Limits.COMMANDED)
def steer_toward(robot: Robot, _: Mobility) -> Formula:
    """Present and wanted steering angles to those commanded next; a wheel without limit goes there at once."""
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
            rate = kept_between(number(limit.low), rate, number(limit.high))
        rate = names.define(f"{w.name}_rate", rate)
        g = working_view(w)
        share = times(expression(g.steer_arm * g.rolling_radius.inverse()), rate)
        values = {
            "spin": subtract(signal(f"{w.name}.spin_wanted"), share),
            "steer": steer,
            "steer_rate": rate,
        }
        outputs += [(joint_port(w, joint, Role.COMMAND), value) for joint, value in values.items()]
    text = "present and wanted steering angles to those commanded next, inside the limits of steer_rate"
    if per_time is not None:
        text += "; rates, and wheel speeds with what steering turns wheels beside their axes"
    return names.formula("steer_toward", (*inputs, _STEP, *tunable_ports(robot)), outputs, text)


@function("Siegwart (3.12) at the present angle; cosineScale of WPILib", limits=Limits.ASKED, in_place=True)
def compensate_steering(robot: Robot, mobility: Mobility) -> Formula:
    """Every ``<wheel>.spin`` of a wheel that steers and drives, times the cosine of what it has yet to swing.

    Of a car with other driven wheels, all roll about the centre that the present angles have, see `axle_speeds`.
    """
    steered = [w for w in robot.wheels if w.kind.steers]
    driven = [w for w in robot.wheels if "spin" in w.actuated and (w.kind.steers or w.kind.fixed_axle)]
    if not steered or not driven:
        raise underivable(robot, "compensate_steering", "no wheel is steered, or none is driven")
    names = Locals()
    axle = car_axle(robot, mobility)
    text = "wheel speeds while wheels swing: those of their pivots along the present steering angles"
    if axle is not None and (len(driven) > 1 or not driven[0].kind.steers):
        spins = [joint_port(w, "spin", Role.COMMAND) for w in driven]
        angles = [port for w in steered for port in (joint_port(w, "steer", Role.COMMAND), _present(w))]
        speeds = axle_speeds(robot, axle, driven, names)
        text = "wheel speeds while wheels swing, about the centre of rotation that the present steering angles have"
        return names.formula(
            "compensate_steering",
            (*spins, *angles, *tunable_ports(robot)),
            zip(spins, speeds, strict=True),
            text,
        )
    unsteered = [w.name for w in driven if not w.kind.steers]
    if unsteered:
        why = f"{unsteered[0]} is driven and does not steer, and the robot is not steered as a car"
        raise underivable(robot, "compensate_steering", why)
    inputs, outputs = dict[Port, None](), list[tuple[Port, Expr]]()
    for w in driven:
        lead = _lead(robot, w)
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
    return Port(f"{w.name}.steer_now", Role.STATE, "rad", "steering angle as it is")


def _lead(robot: Robot, w: Wheel) -> Wheel:
    """The first wheel that steers with ``w``. NotDerivableError where no factor of its own makes its speed right."""
    groups = robot.steer_group
    for other in robot.wheels:
        if (
            robot.spin_group[other.index] == robot.spin_group[w.index]
            and groups[other.index] != groups[w.index]
        ):
            why = f"{w.name} and {other.name} turn as one and steer each by itself"
            raise underivable(robot, "compensate_steering", why)
    return robot.wheels[groups[w.index]]


def _wanted(w: Wheel, angles: Interval | None) -> Expr:
    """The angle that is to be reached, inside the limits of the angle."""
    wanted = signal(f"{w.name}.steer_wanted")
    return wanted if angles is None else kept_between(number(angles.low), wanted, number(angles.high))


def _next(w: Wheel, limit: Interval | None, angles: Interval | None, step: Expr) -> Expr:
    """``limit``: of the rate, ``angles``: of the angle."""
    now, wanted = present(w, angles), _wanted(w, angles)
    if limit is None:
        return wanted
    low, high = (add(now, times(number(end), step)) for end in (limit.low, limit.high))
    return maximum(low, minimum(high, wanted))


def _rates(robot: Robot) -> list[tuple[Wheel, Interval | None]]:
    """The wheels whose angle is chosen, with their limits of ``steer_rate``."""
    rates = [(w, robot.limit(w, "steer_rate")) for w in robot.wheels if w.kind.steers]
    if not rates:
        raise underivable(robot, "steer_toward", "no wheel is steered")
    limited = [(w, limit) for w, limit in rates if limit is not None]
    if not limited and not any(w.rolls_when_steered for w, _ in rates):
        raise underivable(
            robot, "steer_toward", "its steering has no limit of rate; write limits: {steer_rate: 2} [rad/s]"
        )
    for w, limit in limited:
        if limit.low.sign > 0 or limit.high.sign < 0:
            raise underivable(
                robot,
                "steer_toward",
                f"the limits of {w.name}.steer_rate do not let the wheel hold its angle",
            )
    return rates
