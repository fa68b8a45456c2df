"""`accelerations`: a twist and its derivative to joint speeds and accelerations, in closed form.

With vA the velocity of a steered wheel's pivot and ' its derivative in the robot frame,

    steer_rate = (vA x vA') / |vA|^2            (0 at standstill and where a limit holds the wheel)
    r spin = e . vA - o (omega + steer_rate)    r spin_rate = e . vA' + (n . vA) steer_rate - o (omega' + steer_rate')

e and n point along and across the wheel at the angle that `inverse` commands. A lateral offset o needs the
derivative of the steering rate, hence the second derivative of the twist: the inputs `vx_jerk`, `vy_jerk`,
`omega_jerk` exist for such robots only. `spin` of such a wheel contains -o steer_rate, which `inverse` cannot
know. A castor's rate obeys d steer_rate = -(n . vA + d omega) (Siegwart (3.18)); its derivative turns n with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.inverse import Joints, common_rate, inverse, spins
from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pivots import Velocity, pivot
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import function
from wmrgen.functions.space.wheel_motion import rolling_direction_at
from wmrgen.geometry.constraints import heading, rolling_row, working_view
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, dot, each, triple
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import TWIST, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, maximum, number, select, subtract, times

RATES, JERKS = (
    tuple(Port(f"{p.name}_{kind}", Role.COMMAND, f"{p.unit}^{power}", f"{text} of {p.name}") for p in TWIST)
    for kind, power, text in (("rate", 2, "derivative"), ("jerk", 3, "second derivative"))
)
AT_LIMIT = sympy.Rational(1, 10**6)  # rad: a command so near a limit is held by it
SLOWEST = sympy.Rational(1, 10**6)  # m/s: a pivot as slow as this or slower counts as that fast
Jet = tuple[Expr, Expr, Expr]  # a value with its first and second derivative


class Motion(NamedTuple):
    """The driven twist and its first and second derivative."""

    twist: Row
    rate: Row
    jerk: Row


class Turn(NamedTuple):
    """Steering rate [rad/s] and its derivative [rad/s^2]."""

    rate: Expr
    acceleration: Expr


@function("Kelly (4.31) in the plane; Siegwart (3.18)")
def accelerations(robot: Robot, mobility: Mobility) -> Formula:
    """The twist, its derivative and the present steering angles to every joint's speed and acceleration."""
    first = inverse(robot, mobility)
    names = Locals()
    commands = names.adopt(first, {})
    motion = motion_of(project(robot, mobility).twist)
    turns = steered_turns(robot, motion, commands, names) | castor_turns(robot, motion, names)
    speeds, rates = _spins(robot, motion, turns, commands, names)
    outputs: list[tuple[Port, Expr]] = []
    for w in robot.wheels:
        if not w.has_spin:
            continue
        outputs.append((joint_port(w, "spin", Role.COMMAND), speeds[w.index]))
        port = output(f"{w.name}.spin_rate", "rad/s^2", "angular acceleration about the axle")
        outputs.append((port, rates[w.index]))
        if w.kind.steers:
            outputs.append((joint_port(w, "steer", Role.COMMAND), commands[f"{w.name}.steer"]))
        if w.turns:
            outputs.append((joint_port(w, "steer_rate", Role.COMMAND), turns[w.index].rate))
        if w.kind.swivels or _offset(w):
            port = output(f"{w.name}.steer_acceleration", "rad/s^2", "derivative of the steering rate")
            outputs.append((port, turns[w.index].acceleration))
    twist, rest = first.inputs[:3], first.inputs[3:]
    jerks = JERKS if any(_offset(w) for w in robot.wheels) else ()
    return names.formula(
        "accelerations",
        (*twist, *RATES, *jerks, *rest),
        outputs,
        "twist and its derivative to joint speeds and accelerations",
    )


def _offset(w: Wheel) -> bool:
    """True for a steered wheel whose contact lies beside its steering axis."""
    return w.kind.steers and bool(working_view(w).steer_arm)


def motion_of(driven: Row) -> Motion:
    """The driven twist is linear in the commanded one with constant coefficients: so are its derivatives."""

    def renamed(suffix: str) -> Row:
        def value(gen: Gen) -> Poly | None:
            commanded = gen.kind == "input" and gen.name in TWIST_NAMES
            return Poly.gen("input", f"{gen.name}_{suffix}") if commanded else None

        return each(driven, lambda p: p.substitute(value))

    return Motion(driven, renamed("rate"), renamed("jerk"))


def _spins(
    robot: Robot, motion: Motion, turns: dict[int, Turn], commands: Mapping[str, Expr], names: Locals
) -> tuple[dict[int, Expr], dict[int, Expr]]:
    """Wheel speeds and accelerations; coupled wheels share them in the least-squares sense."""
    now: dict[int, Joints] = {}
    rates: dict[int, Joints] = {}
    for w in robot.wheels:
        if w.has_spin:
            radius = working_view(w).rolling_radius
            rim, change = _rims(w, motion, turns, commands, names)
            now[w.index], rates[w.index] = Joints(rim, radius), Joints(change, radius)
    speeds = spins(robot, now)
    offset = {robot.spin_group[w.index] for w in robot.wheels if _offset(w)}
    for w in robot.wheels:
        if w.has_spin and robot.spin_group[w.index] not in offset:
            speeds[w.index] = commands[f"{w.name}.spin"]
    return speeds, spins(robot, rates)


def _rims(
    w: Wheel, motion: Motion, turns: dict[int, Turn], commands: Mapping[str, Expr], names: Locals
) -> tuple[Expr, Expr]:
    """Rim speed [m/s] of a wheel and its derivative [m/s^2]."""
    g = working_view(w)
    if not w.turns:
        row = rolling_row(w, g).row
        return expression(dot(row, motion.twist)), expression(dot(row, motion.rate))
    if w.kind.swivels:
        e = heading(w, g)
    else:
        e = rolling_direction_at(w, names.define(f"{w.name}_commanded", commands[f"{w.name}.steer"]), names)
    (along, sideways), (change, _) = speeds_at(w, motion.twist, e), speeds_at(w, motion.rate, e)
    across = names.define(f"{w.name}_across", sideways)
    turn, o, arm = turns[w.index], expression(g.o), expression(g.steer_arm)
    omega, omega1 = expression(motion.twist[2]), expression(motion.rate[2])
    rim = subtract(expression(along), add(times(o, omega), times(arm, turn.rate)))
    swept = add(expression(change), times(across, turn.rate))
    faster = subtract(swept, add(times(o, omega1), times(arm, turn.acceleration)))
    return rim, names.define(f"{w.name}_rim_rate", faster)


def speeds_at(w: Wheel, twist: Row, e: tuple[Poly, Poly]) -> Velocity:
    """(e . vA, n . vA): the pivot's velocity along and across the rolling direction e."""
    (a, b), (c, s) = pivot(w, twist), e
    return a * c + b * s, b * c - a * s


def steered_turns(
    robot: Robot, motion: Motion, commands: Mapping[str, Expr], names: Locals
) -> dict[int, Turn]:
    """Rates of the angles that `inverse` commands: alone atan2 of vA, together half of a sum's double angle."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.steers)):
        lead = members[0]
        seen = [tuple(speeds_at(w, row, (w.working.ch, w.working.sh)) for row in motion) for w in members]
        pairs = [_jets(velocities, w.steer_sign) for w, velocities in zip(members, seen, strict=True)]
        alike = all(
            v == seen[0] and w.steer_sign == lead.steer_sign for w, v in zip(members, seen, strict=True)
        )
        x, y = pairs[0] if alike else _doubled(pairs)
        x, y = (_named(jet, f"{lead.name}_{axis}", names) for jet, axis in ((x, "along"), (y, "aside")))
        turn = _angle_rates(x, y, lead.name, names, sympy.S.One if alike else sympy.S.Half)
        limits = robot.limit(lead, "steer")
        if limits is not None:
            turn = _held(names, lead, commands[f"{lead.name}.steer"], limits, turn)
        result |= {w.index: Turn(*(times(w.steer_sign, rate) for rate in turn)) for w in members}
    return result


def _jets(velocities: tuple[Velocity, ...], sign: int) -> tuple[Jet, Jet]:
    """Of a wheel that turns against the first of its set (``sign`` -1) the mirror image."""
    along, across = zip(*velocities, strict=True)
    return triple(map(expression, along)), triple(expression(v.scale(Exact(sign))) for v in across)


def _named(jet: Jet, name: str, names: Locals) -> Jet:
    """A value and its first derivative as intermediate results."""
    value, rate, second = jet
    return names.define(name, value), names.define(f"{name}_rate", rate), second


def _doubled(pairs: list[tuple[Jet, Jet]]) -> tuple[Jet, Jet]:
    """(sum of u^2 - v^2, sum of 2 u v) with two derivatives: the double of the common angle (see `steer_group`)."""
    differences = [tuple(map(subtract, _product(u, u), _product(v, v))) for u, v in pairs]
    products = [_product(u, v) for u, v in pairs]
    x = triple(add(*terms) for terms in zip(*differences, strict=True))
    y = triple(times(2, add(*terms)) for terms in zip(*products, strict=True))
    return x, y


def _product(a: Jet, b: Jet) -> Jet:
    """Leibniz's rule."""
    return (
        times(a[0], b[0]),
        add(times(a[1], b[0]), times(a[0], b[1])),
        add(times(a[2], b[0]), times(2, a[1], b[1]), times(a[0], b[2])),
    )


def _angle_rates(x: Jet, y: Jet, name: str, names: Locals, share: Expr) -> Turn:
    """share times the first and second derivative of atan2(y, x); 0 where x and y are 0.

    The divisor is kept above a floor: a speed of `SLOWEST`, whose square x and y are where they are a double angle's.
    """
    floor = SLOWEST**2 if share is sympy.S.One else SLOWEST**4
    moves = names.define(f"{name}_moves", add(times(x[0], x[0]), times(y[0], y[0])))
    over = names.define(f"{name}_over", 1 / names.define(f"{name}_divisor", maximum(moves, floor)))
    turning = names.define(f"{name}_turning", subtract(times(x[0], y[1]), times(y[0], x[1])))
    growing = names.define(f"{name}_growing", add(times(x[0], x[1]), times(y[0], y[1])))
    rate = names.define(f"{name}_rate", times(share, turning, over))
    second = subtract(times(x[0], y[2]), times(y[0], x[2]))
    bent = times(share, over, subtract(second, times(2, turning, over, growing)))
    return Turn(rate, names.define(f"{name}_bent", bent))


def _held(names: Locals, lead: Wheel, command: Expr, limits: Interval, turn: Turn) -> Turn:
    """0 where the commanded angle is at a limit."""
    target = names.define(f"{lead.name}_aimed", command)
    low, high = number(limits.low) + AT_LIMIT, number(limits.high) - AT_LIMIT
    rate, acceleration = (
        names.define(
            f"{lead.name}_{name}",
            select(low, target, select(target, high, value, sympy.S.Zero), sympy.S.Zero),
        )
        for name, value in zip(("free", "freebent"), turn, strict=True)
    )
    return Turn(rate, acceleration)


def castor_turns(robot: Robot, motion: Motion, names: Locals) -> dict[int, Turn]:
    """Swivelling of castors; those turned by one motor share the least-squares rate."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.swivels)):
        offsets = [working_view(w).d for w in members]
        headings = [heading(w, working_view(w)) for w in members]
        now = [speeds_at(w, motion.twist, e) for w, e in zip(members, headings, strict=True)]
        then = [speeds_at(w, motion.rate, e) for w, e in zip(members, headings, strict=True)]
        # n . vA + d omega and its derivative, in which n turns with the rate
        slides = [v + d * motion.twist[2] for (_, v), d in zip(now, offsets, strict=True)]
        rate = names.poly(f"{members[0].name}_rate", common_rate(offsets, slides))
        changes = [
            v1 + d * motion.rate[2] - u * rate for (u, _), (_, v1), d in zip(now, then, offsets, strict=True)
        ]
        bent = names.define(f"{members[0].name}_bent", common_rate(offsets, changes))
        result |= {w.index: Turn(expression(rate), bent) for w in members}
    return result
