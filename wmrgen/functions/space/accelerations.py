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

import sympy

from wmrgen.constraints import rolling_row, working_view
from wmrgen.exact.poly import dot
from wmrgen.functions.registry import function
from wmrgen.functions.space.turning import Motion, Turn, castor_turns, motion_of, speeds_at, steered_turns
from wmrgen.kinematics.inverse import Joints, inverse, spins
from wmrgen.kinematics.line import pivot
from wmrgen.kinematics.project import project
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, subtract, times

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
