"""`accelerations`: a twist and its derivative to joint speeds and accelerations, in closed form.

With vA the velocity of a steered wheel's pivot and ' its derivative in the robot frame,

    steer_rate = (vA x vA') / |vA|^2            (0 at standstill and where a limit holds the wheel)
    r spin = e . vA - o (omega + steer_rate)    r spin_rate = e . vA' + (n . vA) steer_rate - o (omega' + steer_rate')

e and n point along and across the wheel at the angle that `inverse` commands. A lateral offset o needs the
derivative of the steering rate, hence the second derivative of the twist: the inputs `vx_jerk`, `vy_jerk`,
`omega_jerk` exist for such robots only. `spin` of such a wheel contains -o steer_rate, which `inverse` cannot
know. A castor's rate obeys d steer_rate = -(n . vA + d omega) (Siegwart (3.18)); its derivative turns n with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.constraints import heading, rolling_row, working_view
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, Row, dot
from wmrgen.functions.registry import function
from wmrgen.kinematics.inverse import Joints, inverse, spins
from wmrgen.kinematics.line import pivot
from wmrgen.kinematics.project import project
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.kinematics.smallest import FLOOR
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, maximum, number, select, subtract, times

RATES = (
    Port("vx_rate", Role.COMMAND, "m/s^2", "derivative of vx"),
    Port("vy_rate", Role.COMMAND, "m/s^2", "derivative of vy"),
    Port("omega_rate", Role.COMMAND, "rad/s^2", "derivative of omega"),
)
JERKS = (
    Port("vx_jerk", Role.COMMAND, "m/s^3", "second derivative of vx"),
    Port("vy_jerk", Role.COMMAND, "m/s^3", "second derivative of vy"),
    Port("omega_jerk", Role.COMMAND, "rad/s^3", "second derivative of omega"),
)


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
        outputs.append(
            (_port(w, "spin_rate", "rad/s^2", "angular acceleration about the axle"), rates[w.index])
        )
        if w.kind.steers:
            outputs.append((joint_port(w, "steer", Role.COMMAND), commands[f"{w.name}.steer"]))
        if w.turns:
            turn = turns[w.index]
            outputs.append((joint_port(w, "steer_rate", Role.COMMAND), turn.rate))
        if w.kind.swivels or _offset(w):
            text = "derivative of the steering rate"
            outputs.append((_port(w, "steer_acceleration", "rad/s^2", text), turn.acceleration))
    twist, rest = first.inputs[:3], first.inputs[3:]
    jerks = JERKS if any(_offset(w) for w in robot.wheels) else ()
    return Formula(
        "accelerations", (*twist, *RATES, *jerks, *rest), tuple(names.items), tuple(outputs),
        "twist and its derivative to joint speeds and accelerations",
    )  # fmt: skip


def _port(w: Wheel, joint: str, unit: str, text: str) -> Port:
    return Port(f"{w.name}.{joint}", Role.COMMAND, unit, text)


def _offset(w: Wheel) -> bool:
    """True for a steered wheel whose contact lies beside its steering axis."""
    return w.kind.steers and bool(working_view(w).o)


def _spins(
    robot: Robot, motion: Motion, turns: dict[int, Turn], commands: Mapping[str, Expr], names: Locals
) -> tuple[dict[int, Expr], dict[int, Expr]]:
    """Wheel speeds and accelerations; coupled wheels share them in the least-squares sense."""
    now: dict[int, Joints] = {}
    rates: dict[int, Joints] = {}
    for w in robot.wheels:
        if not w.has_spin:
            continue
        g = working_view(w)
        radius = g.rolling_radius
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
    turn, o = turns[w.index], expression(g.o)
    if w.kind.swivels:
        (ahead, aside), (ahead1, _) = speeds_at(w, motion.twist), speeds_at(w, motion.rate)
        along, across, change = expression(ahead), expression(aside), expression(ahead1)
    else:
        along, across, change = _at_target(w, motion, commands[f"{w.name}.steer"], names)
    omega, omega1 = expression(motion.twist[2]), expression(motion.rate[2])
    rim = subtract(along, times(o, add(omega, turn.rate)))
    swept = add(change, times(across, turn.rate))
    return rim, subtract(swept, times(o, add(omega1, turn.acceleration)))


def _at_target(w: Wheel, motion: Motion, target: Expr, names: Locals) -> tuple[Expr, Expr, Expr]:
    """(e . vA, n . vA, e . vA') at the commanded angle."""
    g = working_view(w)
    angle = names.define(f"{w.name}_commanded", target)
    c = names.poly(f"{w.name}_cosine", sympy.cos(angle))
    s = names.poly(f"{w.name}_sine", sympy.sin(angle))
    ex, ey = g.ch * c - g.sh * s, g.sh * c + g.ch * s
    (a, b), (a1, b1) = pivot(w, motion.twist), pivot(w, motion.rate)
    return expression(a * ex + b * ey), expression(b * ex - a * ey), expression(a1 * ex + b1 * ey)


AT_LIMIT = Exact(Fraction(1, 10**6))  # rad: a command so near a limit is held by it
_TWIST = ("vx", "vy", "omega")
Jet = tuple[Expr, Expr, Expr]


@dataclass(frozen=True, slots=True)
class Motion:
    """The driven twist and its first and second derivative."""

    twist: Row
    rate: Row
    jerk: Row


@dataclass(frozen=True, slots=True)
class Turn:
    """Steering rate [rad/s] and its derivative [rad/s^2]."""

    rate: Expr
    acceleration: Expr


def motion_of(driven: Row) -> Motion:
    """The driven twist is linear in the commanded one with constant coefficients: so are its derivatives."""

    def renamed(row: Row, suffix: str) -> Row:
        def value(gen: Gen) -> Poly | None:
            known = gen.kind == "input" and gen.name in _TWIST
            return Poly.gen("input", f"{gen.name}_{suffix}") if known else None

        a, b, c = (p.substitute(value) for p in row)
        return a, b, c

    return Motion(driven, renamed(driven, "rate"), renamed(driven, "jerk"))


def steered_turns(
    robot: Robot, motion: Motion, commands: Mapping[str, Expr], names: Locals
) -> dict[int, Turn]:
    """Rates of the angles that `inverse` commands: alone atan2 of vA, together half of a sum's double angle."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.steers)):
        lead = members[0]
        seen = [_along_across(w, motion) for w in members]
        alike = all(s == seen[0] for s in seen)
        x, y = _jets(seen[0]) if alike else _doubled(seen)
        turn = _angle_rates(x, y, lead.name, names, sympy.S.One if alike else sympy.S.Half)
        limits = robot.limit(lead, "steer")
        if limits is not None:
            turn = _held(names, lead, commands[f"{lead.name}.steer"], limits, turn)
        result.update({w.index: turn for w in members})
    return result


def _along_across(w: Wheel, motion: Motion) -> tuple[tuple[Poly, Poly], ...]:
    """The pivot's velocity and its derivatives along and across the wheel's zero heading."""
    g = working_view(w)
    found = []
    for row in (motion.twist, motion.rate, motion.jerk):
        a, b = pivot(w, row)
        found.append((a * g.ch + b * g.sh, b * g.ch - a * g.sh))
    return tuple(found)


def _jets(seen: tuple[tuple[Poly, Poly], ...]) -> tuple[Jet, Jet]:
    u, u1, u2 = (expression(p) for p, _ in seen)
    v, v1, v2 = (expression(p) for _, p in seen)
    return (u, u1, u2), (v, v1, v2)


def _doubled(seen: list[tuple[tuple[Poly, Poly], ...]]) -> tuple[Jet, Jet]:
    """(sum of u^2 - v^2, sum of 2 u v) with two derivatives: the double of the common angle (see `steer_group`)."""
    x: list[list[Expr]] = [[], [], []]
    y: list[list[Expr]] = [[], [], []]
    for one in seen:
        (u, u1, u2), (v, v1, v2) = _jets(one)
        x[0].append(subtract(times(u, u), times(v, v)))
        x[1].append(times(2, subtract(times(u, u1), times(v, v1))))
        x[2].append(times(2, add(times(u1, u1), times(u, u2), times(-1, v1, v1), times(-1, v, v2))))
        y[0].append(times(2, u, v))
        y[1].append(times(2, add(times(u1, v), times(u, v1))))
        y[2].append(times(2, add(times(u2, v), times(2, u1, v1), times(u, v2))))
    return (add(*x[0]), add(*x[1]), add(*x[2])), (add(*y[0]), add(*y[1]), add(*y[2]))


def _angle_rates(x: Jet, y: Jet, name: str, names: Locals, share: Expr) -> Turn:
    """share times the first and second derivative of atan2(y, x); 0 where x and y are 0.

    The divisor is kept above a floor: a speed of 1e-6 m/s.
    """
    floor = number(FLOOR if share is sympy.S.One else FLOOR * FLOOR)
    over = names.define(f"{name}_over", 1 / maximum(add(times(x[0], x[0]), times(y[0], y[0])), floor))
    turning = names.define(f"{name}_turning", subtract(times(x[0], y[1]), times(y[0], x[1])))
    growing = names.define(f"{name}_growing", add(times(x[0], x[1]), times(y[0], y[1])))
    rate = names.define(f"{name}_rate", times(share, turning, over))
    second = subtract(times(x[0], y[2]), times(y[0], x[2]))
    bent = times(share, over, subtract(second, times(2, turning, over, growing)))
    return Turn(rate, names.define(f"{name}_bent", bent))


def _held(names: Locals, lead: Wheel, command: Expr, limits: Interval, turn: Turn) -> Turn:
    """0 where the commanded angle is at a limit."""
    target = names.define(f"{lead.name}_aimed", command)
    low, high = number(limits.low + AT_LIMIT), number(limits.high - AT_LIMIT)
    rate, bent = (
        names.define(
            f"{lead.name}_{k}", select(low, target, select(target, high, value, sympy.S.Zero), sympy.S.Zero)
        )
        for k, value in (("free", turn.rate), ("freebent", turn.acceleration))
    )
    return Turn(rate, bent)


def castor_turns(robot: Robot, motion: Motion, names: Locals) -> dict[int, Turn]:
    """Swivelling of castors; those turned by one motor share the least-squares rate."""
    result: dict[int, Turn] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.swivels)):
        lead = members[0].name
        offsets = [working_view(w).d for w in members]
        total = Poly.sum(d * d for d in offsets).inverse()
        slides = [_slide(w, motion.twist) for w in members]
        rate = names.poly(
            f"{lead}_rate", -(Poly.sum(d * s for d, s in zip(offsets, slides, strict=True)) * total)
        )
        changes = [_slide(w, motion.rate) - speeds_at(w, motion.twist)[0] * rate for w in members]
        bent = -(Poly.sum(d * s for d, s in zip(offsets, changes, strict=True)) * total)
        turn = Turn(expression(rate), names.define(f"{lead}_bent", bent))
        result.update({w.index: turn for w in members})
    return result


def _slide(w: Wheel, twist: Row) -> Poly:
    """n . vA + d omega."""
    return speeds_at(w, twist)[1] + working_view(w).d * twist[2]


def speeds_at(w: Wheel, twist: Row) -> tuple[Poly, Poly]:
    """(e . vA, n . vA) at the present angle."""
    c, s = heading(w, working_view(w))
    a, b = pivot(w, twist)
    return a * c + b * s, b * c - a * s
