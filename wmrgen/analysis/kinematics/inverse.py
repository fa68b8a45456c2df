"""Inverse kinematics: from a twist to joint rates and steering angles, in closed form.

A steered wheel steers along the velocity of its pivot, by at most 90 degrees from its present angle: it drives
backwards if that is shorter. If its pivot does not move it keeps its angle.

For a castor let (a, b) be the velocity of the pivot in the frame of the wheel at joint angle zero. It is linear in the
twist, and castors in a row share parts of it. In the frame of the turned wheel it is (u, w) = (a c + b s, b c - a s).
With the offset d and the lateral offset o

    rolling row . xi = u - o omega        sliding row . xi = w + d omega        (Siegwart (3.17), (3.18))

A twist does not determine how fast the steering changes, so `inverse` commands a ``steer_rate`` of 0 for a steered
wheel whose rolling row depends on it. `steer_toward` commands the rate and the spin that it causes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import Projection, norm, project
from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, slip_port, tunable_ports
from wmrgen.analysis.kinematics.steer import Target, hysteresis, turned_by
from wmrgen.analysis.kinematics.steer_groups import nearest_steering
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.constraints import rolling_row, steer_gens, working_view
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.exact.readable import with_tangents
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST, Port, Role
from wmrgen.geometry.symbolic import Expr, add, expression, number, root, square, subtract, times

_MANY = 3  # castors with the same offset: from this number on, dividing all velocities by it takes fewer operations


class Joints(NamedTuple):
    """The commands for one wheel, before spins are coupled."""

    rim: Expr  # rim speed [m/s]
    radius: Poly  # rim speed per spin [m]
    steer: Expr | None = None  # [rad]
    steer_rate: Expr | None = None  # [rad/s]
    spin: Expr | None = None  # [rad/s], if it is known from the steering


Steering = Callable[[Robot, Row, Locals], dict[int, Target]]  # driven twist -> target per wheel index


def inverse(robot: Robot, mobility: Mobility) -> Formula:
    """Return the function from vx, vy, omega and the present steering angles to the command of every joint."""
    text = "twist of P in the robot frame to joint commands"
    steered = [w for w in robot.wheels if w.kind.steers]
    if steered:
        text += (
            "; a wheel steers from its present angle to the nearest heading inside its limits, and keeps its angle at "
            "standstill"
        )
    limits = [robot.limit(w, "steer") for w in steered]
    if any(limit is not None and hysteresis(limit) for limit in limits):
        text += (
            ". At a stop it keeps that heading, clamped to the limit, until the opposite heading is closer to the "
            "limits by 5 degrees: noise does not make it swing between both"
        )
    return joint_commands(robot, mobility, nearest_steering, "inverse", text)


def joint_commands(robot: Robot, mobility: Mobility, steering: Steering, name: str, text: str) -> Formula:
    """Return an inverse in which a given function determines the targets of steered wheels.

    Args:
        robot: The robot.
        mobility: Its mobility, which determines the nearest admissible twist.
        steering: Returns the targets of steered wheels for the driven twist.
        name: The name of the function.
        text: The description of the function.

    Returns:
        The function from the twist and steering angles to joint commands and ``slip``.
    """
    names = Locals()
    projection = project(robot, mobility)
    twist = projection.named(names.poly)
    targets = steering(robot, twist, names)
    seen = castor_motion(robot, twist, names)
    swivels, residuals = _swivels(robot, seen)
    joints = {w.index: _joints(w, twist, targets, swivels, seen) for w in robot.wheels if w.has_spin}
    speeds = spins(robot, joints)
    outputs: list[tuple[Port, Expr]] = []
    for i, j in joints.items():
        commands = (("spin", speeds[i]), ("steer", j.steer), ("steer_rate", j.steer_rate))
        outputs += [(joint_port(robot.wheels[i], n, Role.COMMAND), v) for n, v in commands if v is not None]
    slip = _slip(projection, targets, [*residuals, *turned_unlike(robot, joints, speeds)])
    outputs.append((slip_port("norm of the speeds at which wheels slide when this twist is driven"), slip))
    steers = tuple(joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.turns)
    inputs = (*TWIST, *steers, *tunable_ports(robot))
    return names.formula(name, inputs, outputs, text)


def readable_spins(robot: Robot, mobility: Mobility) -> dict[str, Expr]:
    """Return the commanded spins of wheels with rollers for reports, with tan gamma for sin gamma / cos gamma."""
    twist, spins = project(robot, mobility).twist, dict[str, Expr]()
    for members in robot.together("spin", (w for w in robot.wheels if w.has_spin)):
        w, g = members[0], working_view(members[0])
        if len(members) == 1 and w.kind.rollers and g.cg.constant is None:
            rim = dot(rolling_row(w, g).row, twist)
            speed = expression(with_tangents(rim * g.cg.inverse()))
            spins[f"{w.name}.spin"] = times(speed, expression(g.r.inverse()))
    return spins


def _slip(projection: Projection, targets: dict[int, Target], coupled: list[list[Expr]]) -> Expr:
    """Return the norm of all sliding speeds [m/s].

    They are the inadmissible part of the twist, the lateral speeds of steered wheels at their limits, and ``coupled``:
    for each set of coupled wheels the speeds that remain at their common rate.
    """
    forbidden = norm(projection.residuals, projection.weight)
    speeds = [t.lateral for t in targets.values() if t.lateral is not None]
    for of_set in coupled:
        speeds += of_set
    if not speeds:
        return forbidden
    squares = [square(v) for v in speeds]
    return root(add(*squares) if forbidden.is_zero else add(square(forbidden), *squares))


def _swivels(robot: Robot, seen: dict[int, CastorMotion]) -> tuple[dict[int, Poly], list[list[Expr]]]:
    """Return the steering rates of castors by wheel index: d rate = -(sliding row . xi), Siegwart (3.18).

    Castors that one motor turns have a common rate, by least squares. The second part of the result are the speeds at
    which their contacts then slide.
    """
    rates: dict[int, Poly] = {}
    residuals: list[list[Expr]] = []
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.swivels)):
        if len(members) == 1:
            rates[members[0].index] = seen[members[0].index].free_rate
            continue
        slides = [seen[w.index].sliding for w in members]
        offsets = [working_view(w).d for w in members]
        shared = common_rate(offsets, slides)
        rates.update({w.index: shared for w in members})
        residuals.append([expression(s + d * shared) for d, s in zip(offsets, slides, strict=True)])
    return rates, residuals


def common_rate(offsets: Sequence[Poly], slides: Sequence[Poly]) -> Poly:
    """Return the common steering rate of castors that minimises the sum of squares of d rate + slide.

    ``offsets`` are their offsets d [m], and ``slides`` their sliding rows times the twist [m/s] (Siegwart (3.18)).
    """
    total = Poly.sum(d * d for d in offsets).inverse()
    return -(Poly.sum(d * s for d, s in zip(offsets, slides, strict=True)) * total)


def _joints(
    w: Wheel,
    twist: Row,
    targets: dict[int, Target],
    swivels: dict[int, Poly],
    seen: dict[int, CastorMotion],
) -> Joints:
    """Return the commands for one wheel."""
    g = working_view(w)
    if w.kind.steers:
        target = targets[w.index]
        rim = subtract(target.rim, expression(g.o * twist[2])) if g.o else target.rim
        return Joints(rim, g.r, target.steer, sympy.S.Zero if w.rolls_when_steered else None, target.spin)
    if w.kind.swivels:
        rate, rolling = swivels[w.index], seen[w.index].rolling
        rim_speed = rolling - g.steer_arm * rate if g.steer_arm else rolling
        return Joints(expression(rim_speed), g.r, None, expression(rate))
    rolling = dot(rolling_row(w, g).row, twist)
    return Joints(expression(rolling), g.rolling_radius)


def spins(robot: Robot, joints: dict[int, Joints]) -> dict[int, Expr]:
    """Return the spins of wheels by index; wheels with coupled spins have the least-squares speed in their ratios."""
    result = {}
    for members in robot.together("spin", (robot.wheels[i] for i in joints)):
        coupled = {w.index: joints[w.index] for w in members}
        if len(coupled) == 1:
            ((i, j),) = coupled.items()
            result[i] = _scaled(j.rim, j.radius.inverse()) if j.spin is None else j.spin
            continue
        rolled = {i: j.radius * robot.spin_ratios[i] for i, j in coupled.items()}
        total = Poly.sum(r * r for r in rolled.values()).inverse()
        shared = add(*(_scaled(j.rim, rolled[i] * total) for i, j in coupled.items()))
        result |= {i: times(number(robot.spin_ratios[i]), shared) for i in coupled}
    return result


def turned_unlike(robot: Robot, joints: dict[int, Joints], speeds: dict[int, Expr]) -> list[list[Expr]]:
    """Return the rim speeds [m/s] at which wheels with coupled spins slide, for sets with steered wheels or castors.

    `project` accounts for sets without such wheels.

    Args:
        robot: The robot.
        joints: The commands of wheels by index.
        speeds: The spins of wheels by index, as from `spins`.

    Returns:
        For each set the differences between wanted and coupled rim speeds.
    """
    unlike: list[list[Expr]] = []
    for members in robot.together("spin", (robot.wheels[i] for i in joints)):
        coupled = {w.index: joints[w.index] for w in members}
        alike = {(j.rim, (j.radius * robot.spin_ratios[i]).key) for i, j in coupled.items()}
        if len(alike) > 1 and any(w.turns for w in members):
            unlike.append([subtract(j.rim, _scaled(speeds[i], j.radius)) for i, j in coupled.items()])
    return unlike


def _scaled(rim: Expr, factor: Poly) -> Expr:
    return times(expression(factor), rim)


class CastorMotion(NamedTuple):
    """The motion of a castor for a twist."""

    rolling: Poly  # rolling row times the twist [m/s]
    sliding: Poly  # sliding row times the twist [m/s]
    free_rate: Poly  # steering rate [rad/s] at which the castor does not slide


def castor_motion(robot: Robot, twist: Row, names: Locals) -> dict[int, CastorMotion]:
    """Return the motion of every castor.

    Args:
        robot: The robot.
        twist: vx, vy [m/s] and omega [rad/s] as polynomials.
        names: Collects intermediate results.

    Returns:
        The motion by wheel index.
    """
    castors = [w for w in robot.wheels if w.kind.swivels]
    alike = Counter(working_view(w).d.key for w in castors)
    return {w.index: _motion(w, twist, names, alike[working_view(w).d.key] >= _MANY) for w in castors}


def _motion(w: Wheel, twist: Row, names: Locals, divided: bool) -> CastorMotion:
    """Return the motion of a castor. If ``divided``, the velocity of its pivot is in offsets per second."""
    g, (c, s) = working_view(w), steer_gens(w)
    over = g.d.inverse()
    before, after = (over, Poly.of(1)) if divided else (Poly.of(1), over)
    x, y = turned_by(w, pivot(w, twist))
    a = names.short(f"{w.name}_a", x * before)
    b = names.short(f"{w.name}_b", y * before)
    along, across = a * c + b * s, b * c - a * s
    unit = g.d if divided else Poly.of(1)
    rolling = unit * along - g.o * twist[2]
    sliding = unit * across + g.d * twist[2]
    return CastorMotion(rolling, sliding, -(across * after) - twist[2])
