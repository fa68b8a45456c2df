"""Joint speeds and accelerations for a twist and its derivative, in closed form: `accelerations`.

With vA the velocity of a steered wheel's pivot and ' its derivative in the robot frame,

    steer_rate = (vA x vA') / |vA|^2            (0 at standstill and at a limit of the angle)
    r spin = e . vA - o (omega + steer_rate)    r spin_rate = e . vA' + (n . vA) steer_rate - o (omega' + steer_rate')

e and n point along and across the wheel at the angle that `inverse` commands. A lateral offset o needs the derivative
of the steering rate, hence the second derivative of the twist: only robots with such a wheel have the inputs
`vx_jerk`, `vy_jerk`, `omega_jerk`. The `spin` of such a wheel contains -o steer_rate, which `inverse` does not know. A
castor's rate satisfies d steer_rate = -(n . vA + d omega) (Siegwart (3.18)); in its derivative n rotates with the
castor.
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

RATES = tuple(Port(f"{p.name}_rate", Role.COMMAND, f"{p.unit}^2", f"derivative of {p.name}") for p in TWIST)
JERKS = tuple(
    Port(f"{p.name}_jerk", Role.COMMAND, f"{p.unit}^3", f"second derivative of {p.name}") for p in TWIST
)
AT_LIMIT = sympy.Rational(1, 10**6)  # rad: a command nearer to a limit is treated as at the limit
SLOWEST = sympy.Rational(1, 10**6)  # m/s: a slower pivot is treated as this fast in divisors
Jet = tuple[Expr, Expr, Expr]  # a value with its first and second derivative


class Motion(NamedTuple):
    """The driven twist and its first and second derivative."""

    twist: Row
    rate: Row
    jerk: Row


class Turn(NamedTuple):
    """The motion of a steering angle."""

    rate: Expr  # rad/s
    acceleration: Expr  # rad/s^2


@function("Kelly (4.31) in the plane; Siegwart (3.18)")
def accelerations(robot: Robot, mobility: Mobility) -> Formula:
    """Return every joint's speed and acceleration for the twist, its derivative and the present steering angles."""
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
        if w.kind.swivels or _beside_axis(w):
            port = output(f"{w.name}.steer_acceleration", "rad/s^2", "derivative of the steering rate")
            outputs.append((port, turns[w.index].acceleration))
    twist, rest = first.inputs[:3], first.inputs[3:]
    jerks = JERKS if any(_beside_axis(w) for w in robot.wheels) else ()
    return names.formula(
        "accelerations",
        (*twist, *RATES, *jerks, *rest),
        outputs,
        "twist and its derivative to joint speeds and accelerations",
    )


def _beside_axis(w: Wheel) -> bool:
    """Return whether a wheel is steered and its contact is beside its steering axis."""
    return w.kind.steers and bool(working_view(w).steer_arm)


def motion_of(driven: Row) -> Motion:
    """Return the driven twist with its derivatives: it is linear in the commanded twist."""

    def renamed(suffix: str) -> Row:
        def value(gen: Gen) -> Poly | None:
            commanded = gen.kind == "input" and gen.name in TWIST_NAMES
            return Poly.gen("input", f"{gen.name}_{suffix}") if commanded else None

        return each(driven, lambda p: p.substitute(value))

    return Motion(driven, renamed("rate"), renamed("jerk"))


def _spins(
    robot: Robot, motion: Motion, turns: dict[int, Turn], commands: Mapping[str, Expr], names: Locals
) -> tuple[dict[int, Expr], dict[int, Expr]]:
    """Return wheel speeds and accelerations; coupled wheels share them in the least-squares sense."""
    now: dict[int, Joints] = {}
    rates: dict[int, Joints] = {}
    for w in robot.wheels:
        if w.has_spin:
            radius = working_view(w).rolling_radius
            rim, change = _rims(w, motion, turns, commands, names)
            now[w.index], rates[w.index] = Joints(rim, radius), Joints(change, radius)
    speeds = spins(robot, now)
    offset = {robot.spin_group[w.index] for w in robot.wheels if _beside_axis(w)}
    for w in robot.wheels:
        if w.has_spin and robot.spin_group[w.index] not in offset:
            speeds[w.index] = commands[f"{w.name}.spin"]
    return speeds, spins(robot, rates)


def _rims(
    w: Wheel, motion: Motion, turns: dict[int, Turn], commands: Mapping[str, Expr], names: Locals
) -> tuple[Expr, Expr]:
    """Return the rim speed [m/s] of a wheel and its derivative [m/s^2]."""
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
    """Return (e . vA, n . vA): the pivot's velocity along and across the rolling direction e [m/s].

    Args:
        w: The wheel.
        twist: The twist of P in the robot frame.
        e: Cosine and sine of the rolling direction, robot frame.
    """
    (a, b), (c, s) = pivot(w, twist), e
    return a * c + b * s, b * c - a * s


def steered_turns(
    robot: Robot, motion: Motion, commands: Mapping[str, Expr], names: Locals
) -> dict[int, Turn]:
    """Return the rates of the angles that `inverse` commands.

    For one wheel the angle is atan2 of vA; for wheels on one motor it is half the double angle of a sum.

    Args:
        robot: The robot.
        motion: The twist and its derivatives.
        commands: The outputs of `inverse` by name.
        names: Takes the intermediate results.

    Returns:
        Steering rate and its derivative by wheel index.
    """
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.steers)):
        lead = members[0]
        seen = []  # for each wheel, velocity of its pivot along and across its zero heading, with two derivatives
        for w in members:
            zero_heading = w.working.ch, w.working.sh
            seen.append(tuple(speeds_at(w, row, zero_heading) for row in motion))
        pairs = [_jets(velocities, w.steer_sign) for w, velocities in zip(members, seen, strict=True)]
        alike = all(
            v == seen[0] and w.steer_sign == lead.steer_sign for w, v in zip(members, seen, strict=True)
        )
        x, y = pairs[0] if alike else _double_angle(pairs)
        x, y = (_named(jet, f"{lead.name}_{axis}", names) for jet, axis in ((x, "along"), (y, "aside")))
        turn = _angle_rates(x, y, lead.name, names, sympy.S.One if alike else sympy.S.Half)
        limits = robot.limit(lead, "steer")
        if limits is not None:
            turn = _zero_at_limits(names, lead, commands[f"{lead.name}.steer"], limits, turn)
        for w in members:
            result[w.index] = Turn(*(times(w.steer_sign, rate) for rate in turn))
    return result


def _jets(velocities: tuple[Velocity, ...], sign: int) -> tuple[Jet, Jet]:
    """Return velocities along and across as jets; mirrored if the wheel turns against the first (``sign`` -1)."""
    along, across = zip(*velocities, strict=True)
    return triple(map(expression, along)), triple(expression(v.scale(Exact(sign))) for v in across)


def _named(jet: Jet, name: str, names: Locals) -> Jet:
    """Return a jet whose value and first derivative are intermediate results."""
    value, rate, second = jet
    return names.define(name, value), names.define(f"{name}_rate", rate), second


def _double_angle(pairs: list[tuple[Jet, Jet]]) -> tuple[Jet, Jet]:
    """Return (sum of u^2 - v^2, sum of 2 u v) with two derivatives: the double of the common angle (see
    `steer_group`)."""
    differences = [tuple(map(subtract, _product(u, u), _product(v, v))) for u, v in pairs]
    products = [_product(u, v) for u, v in pairs]
    x = triple(add(*terms) for terms in zip(*differences, strict=True))
    y = triple(times(2, add(*terms)) for terms in zip(*products, strict=True))
    return x, y


def _product(a: Jet, b: Jet) -> Jet:
    """Return the product of two jets by Leibniz's rule."""
    return (
        times(a[0], b[0]),
        add(times(a[1], b[0]), times(a[0], b[1])),
        add(times(a[2], b[0]), times(2, a[1], b[1]), times(a[0], b[2])),
    )


def _angle_rates(x: Jet, y: Jet, name: str, names: Locals, share: Expr) -> Turn:
    """Return share times the first and second derivative of atan2(y, x); 0 if x and y are 0.

    The divisor has a lower bound: the square of the speed `SLOWEST`, or its fourth power for a double angle.
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


def _zero_at_limits(names: Locals, lead: Wheel, command: Expr, limits: Interval, turn: Turn) -> Turn:
    """Return 0 if the commanded angle is at a limit, else the given motion."""
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
    """Return the rates of castors; castors on one motor share the least-squares rate.

    Args:
        robot: The robot.
        motion: The twist and its derivatives.
        names: Takes the intermediate results.

    Returns:
        Steering rate and its derivative by wheel index.
    """
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.swivels)):
        offsets = [working_view(w).d for w in members]
        headings = [heading(w, working_view(w)) for w in members]
        now = [speeds_at(w, motion.twist, e) for w, e in zip(members, headings, strict=True)]
        then = [speeds_at(w, motion.rate, e) for w, e in zip(members, headings, strict=True)]
        # n . vA + d omega and its derivative, in which n rotates with the castor
        slides = [v + d * motion.twist[2] for (_, v), d in zip(now, offsets, strict=True)]
        rate = names.poly(f"{members[0].name}_rate", common_rate(offsets, slides))
        changes = [
            v1 + d * motion.rate[2] - u * rate for (u, _), (_, v1), d in zip(now, then, offsets, strict=True)
        ]
        bent = names.define(f"{members[0].name}_bent", common_rate(offsets, changes))
        result |= {w.index: Turn(expression(rate), bent) for w in members}
    return result
