"""Steering angles at which no motion is possible, the X of a swerve drive: `lock`.

Every steered wheel points towards the centroid of all steered pivots, or away from it, and does not spin. Let r be the
vector from the centroid to a pivot and v the velocity of the centroid. The sliding row of the wheel is (z x r) . v +
|r|^2 omega = 0. The sum over all wheels gives omega = 0, because the vectors r sum to zero. Then v = 0, unless all
pivots are on one line.
"""

from __future__ import annotations

from cmath import phase
from math import pi

import mpmath
import numpy as np
import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.kinematics.steer import PER_HALF_TURN, present, turned_back, turned_by
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.evaluate import PRECISION, to_fraction, to_mpf
from wmrgen.geometry.exact.linalg import mean
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    angle_of,
    clamp_between,
    expression,
    nearest,
    number,
    subtract,
    times,
)

# Share of the largest distance from the centroid: a nearer wheel has no direction to point in. Also of singular values.
_CLEAR = 1e-3


@function("ours; setX of FRC swerve drives")
def lock(robot: Robot, _: Mobility) -> Formula:
    """Return the steering angles, nearest to the present ones, at which the robot can neither move nor turn."""
    steered = [w for w in robot.wheels if w.kind.steers]
    _check_lockable(robot, steered)
    names = Locals()
    views = [working_view(w) for w in steered]
    x, y = mean([g.x for g in views]), mean([g.y for g in views])
    outputs: list[tuple[Port, Expr]] = []
    for w in robot.wheels:
        if w.commands("spin"):
            outputs.append((joint_port(w, "spin", Role.COMMAND), sympy.S.Zero))
        if w not in steered:
            continue
        g, limits = working_view(w), robot.limit(w, "steer")
        along, across = turned_by(w, (g.x - x, g.y - y))
        heading = names.define(f"{w.name}_heading", _angle(across, along))
        turns = nearest(times(number(PER_HALF_TURN), subtract(heading, present(w, limits))))
        steer = names.define(f"{w.name}_nearest", subtract(heading, times(sympy.pi, turns)))
        if limits is not None:
            steer = clamp_between(number(limits.low), turned_back(steer, limits), number(limits.high))
        outputs.append((joint_port(w, "steer", Role.COMMAND), steer))
    return names.formula(
        "lock",
        (*(joint_port(w, "steer", Role.STATE) for w in steered), *tunable_ports(robot)),
        outputs,
        "present steering angles to the nearest ones at which no motion is possible; all spins are 0",
    )


def _angle(y: Poly, x: Poly) -> Expr:
    """Return the direction of (x, y) [rad]: a number if neither depends on a tunable parameter."""
    b, a = y.constant, x.constant
    if a is None or b is None:
        return angle_of(expression(y), expression(x))
    with mpmath.workdps(PRECISION):
        return number(Exact(to_fraction(mpmath.atan2(to_mpf(b.rational()), to_mpf(a.rational())))))


def _check_lockable(robot: Robot, steered: list[Wheel]) -> None:
    """Raise NotDerivableError if these angles do not lock the robot, or if a wheel cannot reach its angle."""
    if not steered:
        raise underivable(
            robot, "lock", "no wheel is steered, so no wheel can be turned across", Reason.NOT_STEERED
        )
    for members in robot.together("steer", steered):
        if len(members) > 1:
            why = f"{members[0].name} and {members[1].name} are steered by one motor"
            raise underivable(robot, "lock", why, Reason.SHARED_MOTOR)
    centre = sum(w.pivot for w in steered) / len(steered)
    arms = [w.pivot - centre for w in steered]
    far = max(map(abs, arms))
    for w, arm in zip(steered, arms, strict=True):
        if abs(arm) <= _CLEAR * far:
            why = f"{w.name} is at the centroid of the steered wheels, so it has no direction to point in"
            raise underivable(robot, "lock", why, Reason.AXLES)
        limits = robot.limit(w, "steer")
        if limits is not None:
            low, high = float(limits.low), float(limits.high)
            first = phase(arm / w.zero_heading)
            first += pi * np.ceil((low - first) / pi)
            if first > high:
                why = f"the steering stops of {w.name} prevent it from pointing to the centroid of the steered wheels"
                raise underivable(robot, "lock", why, Reason.STEERING_STOPS)
    rows = [[-arm.imag, arm.real, abs(arm) ** 2 / far] for arm in arms]
    fixed = [(w.heading, w.pivot - centre) for w in robot.wheels if w.kind.fixed_axle]
    for heading, arm in fixed:
        n = 1j * np.exp(1j * heading)
        rows.append([n.real * far, n.imag * far, (arm.real * n.imag - arm.imag * n.real)])
    if np.linalg.svd(np.array(rows))[1][2:].sum() <= _CLEAR * far:
        why = "all its wheels are on one line, along which they could still roll"
        raise underivable(robot, "lock", why, Reason.WHEELS_ON_ONE_LINE)
