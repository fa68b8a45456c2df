"""Inverse kinematics: a twist to joint rates and steering angles, in closed form.

Steering comes from atan2 of the pivot's velocity seen from the present wheel, so the swing is at most
90 degrees with the drive reversed where that is shorter, and a pivot that stands still holds its angle.

What castors see of a twist is the velocity of the pivot in the frame of the wheel's zero, then turned. It is linear in
the twist and castors that stand in a row share its parts (a, b); turned by the joint angle it is
(u, w) = (a c + b s, b c - a s), and with the offset d and the lateral offset o

    rolling row . xi = u - o omega        sliding row . xi = w + d omega        (Siegwart (3.17), (3.18))

A twist does not say how fast it changes, so steering stands: a steered wheel whose rolling row has a ``steer_rate``
gets 0. `steer_toward` commands the rate, and the spin that it takes.
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

_MANY = 3  # castors of one offset from which dividing all velocities by it takes fewer operations


class Joints(NamedTuple):
    """What the inverse commands for one wheel; ``rim``: speed of its rim [m/s] before coupling, ``radius`` [m]."""

    rim: Expr
    radius: Poly
    steer: Expr | None = None
    steer_rate: Expr | None = None
    spin: Expr | None = None  # [rad/s], where steering gives it


Steering = Callable[[Robot, Row, Locals], dict[int, Target]]  # driven twist -> target per wheel index


def inverse(robot: Robot, mobility: Mobility) -> Formula:
    """vx vy omega and the present steering angles to every joint's command."""
    text = "twist of P in the robot frame to joint commands"
    steered = [w for w in robot.wheels if w.kind.steers]
    if steered:
        text += "; a wheel steers from the angle given to the nearest heading in its limits, and holds it at standstill"
    if any(limits and hysteresis(limits) for limits in (robot.limit(w, "steer") for w in steered)):
        text += (
            ". At a stop it keeps that heading, cut there, while the opposite one lies less than 5 degrees less "
            "outside: noise does not swing it to and fro"
        )
    return joint_commands(robot, mobility, nearest_steering, "inverse", text)


def joint_commands(robot: Robot, mobility: Mobility, steering: Steering, name: str, text: str) -> Formula:
    """An inverse whose steered wheels take the targets of ``steering``."""
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
    outputs.append(
        (
            slip_port("norm of the speeds at which wheels slide when this twist is driven"),
            _slip(projection, targets, [*residuals, *turned_unlike(robot, joints, speeds)]),
        )
    )
    steers = tuple(joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.turns)
    inputs = (*TWIST, *steers, *tunable_ports(robot))
    return names.formula(name, inputs, outputs, text)


def readable_spins(robot: Robot, mobility: Mobility) -> dict[str, Expr]:
    """Return the spins that `inverse` commands of wheels with rollers, with tan gamma for sin gamma / cos gamma."""
    twist, spins = project(robot, mobility).twist, dict[str, Expr]()
    for members in robot.together("spin", (w for w in robot.wheels if w.has_spin)):
        w, g = members[0], working_view(members[0])
        if len(members) == 1 and w.kind.rollers and g.cg.constant is None:
            rim = dot(rolling_row(w, g).row, twist)
            speed = expression(with_tangents(rim * g.cg.inverse()))
            spins[f"{w.name}.spin"] = times(speed, expression(g.r.inverse()))
    return spins


def _slip(projection: Projection, targets: dict[int, Target], coupled: list[list[Expr]]) -> Expr:
    """Norm of what slides: the forbidden part of the twist, steered wheels held back, and groups of coupled wheels.

    ``coupled``: per group what its common rate leaves over [m/s].
    """
    forbidden = norm(projection.residuals, projection.weight)
    held = [t.lateral for t in targets.values() if t.lateral is not None]
    sliding = [square(v) for speeds in (held, *coupled) for v in speeds]
    if not sliding:
        return forbidden
    return root(add(*([] if forbidden.is_zero else [square(forbidden)]), *sliding))


def _swivels(robot: Robot, seen: dict[int, CastorMotion]) -> tuple[dict[int, Poly], list[list[Expr]]]:
    """Steering rates of castors: d rate = -(sliding row . xi) (Siegwart (3.18)).

    Castors turned by one motor share the least-squares rate; what their contacts still slide comes second.
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
    """The steering rate that leaves least of d rate + slide over castors of these offsets d (Siegwart (3.18))."""
    total = Poly.sum(d * d for d in offsets).inverse()
    return -(Poly.sum(d * s for d, s in zip(offsets, slides, strict=True)) * total)


def _joints(
    w: Wheel,
    twist: Row,
    targets: dict[int, Target],
    swivels: dict[int, Poly],
    seen: dict[int, CastorMotion],
) -> Joints:
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
    """Rim speeds to wheel speeds; wheels that must turn alike share the least-squares speed, each in its ratio."""
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
    """Rim speeds [m/s] that a common spin leaves to sliding, per group in which a wheel turns (see `project`)."""
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
    """``rolling`` and ``sliding``: rows times the twist [m/s]. ``free_rate``: steering rate [rad/s] without sliding."""

    rolling: Poly
    sliding: Poly
    free_rate: Poly


def castor_motion(robot: Robot, twist: Row, names: Locals) -> dict[int, CastorMotion]:
    """The motion of every castor, by wheel index."""
    castors = [w for w in robot.wheels if w.kind.swivels]
    alike = Counter(working_view(w).d.key for w in castors)
    return {w.index: _motion(w, twist, names, alike[working_view(w).d.key] >= _MANY) for w in castors}


def _motion(w: Wheel, twist: Row, names: Locals, divided: bool) -> CastorMotion:
    """``divided``: the pivot's velocity is written in offsets per second."""
    g, (c, s) = working_view(w), steer_gens(w)
    over = g.d.inverse()
    before, after = (over, Poly.of(1)) if divided else (Poly.of(1), over)
    a, b = (
        names.short(f"{w.name}_{k}", p * before)
        for k, p in zip("ab", turned_by(w, pivot(w, twist)), strict=True)
    )
    along, across = a * c + b * s, b * c - a * s
    unit = g.d if divided else Poly.of(1)
    return CastorMotion(
        unit * along - g.o * twist[2], unit * across + g.d * twist[2], -(across * after) - twist[2]
    )
