"""Chained form: z1' = u1, z2' = u2, z3' = z2 u1, ..., zn' = z_(n-1) u1 (Tzafestas (2.58)).

Type (2, 0) without trailers takes (2.62), (2.63): z1 = theta, everywhere. A car takes (2.66)-(2.69), and N trailers
coupled on the axle the construction of Sordalen (1993): z1 and zn are the position of the last axle, and
z_(k-1) = dz_k/dz_1 along its path (module `series`), where cos theta_N and the cosines of all hitch angles
are not 0. u1, u2 to the robot's own inputs is `chained_input`, the way back `chained_rates`.
"""

from __future__ import annotations

import sympy

from wmrgen.functions.registry import function
from wmrgen.functions.trailers.train import OMEGA, V, Written, train, write
from wmrgen.kinematics.records import Formula, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

SOURCE = "Tzafestas (2.58); Tzafestas (2.61)-(2.63); Tzafestas (2.66)-(2.69)"
U = (
    Port("u1", Role.COMMAND, "", "first input of the chain"),
    Port("u2", Role.COMMAND, "", "second input of the chain"),
)


def _z(k: int) -> Port:
    return Port(f"z{k}", Role.COMMAND, "", f"state {k} of the chain")


@function(SOURCE)
def chained(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta, steering, trailers to z1 ... zn."""
    w = write(train(robot, mobility))
    n = w.train.size
    inputs = (*w.train.state, *tunable_ports(robot))
    outputs = tuple((_z(k + 1), z) for k, z in enumerate(coordinates(w)))
    cite = "Tzafestas (2.62)" if w.train.by_heading else "Tzafestas (2.66), Sordalen (1993)"
    return Formula("chained", inputs, tuple(w.names.items), outputs, f"state of the (2,{n}) chain; {cite}")


def coordinates(w: Written) -> tuple[Expr, ...]:
    """z1 ... zn in the state."""
    if w.path is None:
        along = add(times(w.x, w.cosine), times(w.y, w.sine))
        across = subtract(times(w.x, w.sine), times(w.y, w.cosine))
        return signal("theta"), along, across
    slopes = w.path.slopes[1:-1]
    return (w.x, *reversed(slopes), w.y)


@function(SOURCE)
def chained_input(robot: Robot, mobility: Mobility) -> Formula:
    """State and u1, u2 to v, the steering rate, and the twist of P that `inverse` turns into wheel commands."""
    w = write(train(robot, mobility))
    u1, u2 = (signal(p.name) for p in U)
    v, turning = own_inputs(w, u1, u2)
    v = w.names.define("axle_speed", v)
    outputs = list(commands(w, v, turning))
    inputs = (*w.train.state, *U, *tunable_ports(robot))
    text = "inputs of the chain to those of the robot; " + ("(2.63)" if w.path is None else "(2.68)")
    return Formula("chained_input", inputs, tuple(w.names.items), tuple(outputs), text)


def own_inputs(w: Written, u1: Expr, u2: Expr) -> tuple[Expr, Expr]:
    """v, and the yaw rate or the steering rate."""
    p = w.path
    if p is None:
        return add(u2, times(u1, coordinates(w)[2])), u1
    rest = subtract(u2, times(p.slopes[-1], u1))
    answer = times(p.along, w.answer) if w.curvature is not None else sympy.S.One
    return times(u1, p.speed), times(p.inverse_gain, answer, rest)


def commands(w: Written, v: Expr, turning: Expr) -> tuple[tuple[Port, Expr], ...]:
    """v, vx, vy, omega of P and the steering rate, where there is one."""
    axle, t = w.train.axle, w.train
    omega = turning if w.curvature is None else times(w.curvature, v)
    omega = w.names.define("yaw_rate", omega)
    ex, ey = expression(axle.ex), expression(axle.ey)
    vx = add(times(ex, v), times(expression(axle.y), omega))
    vy = subtract(times(ey, v), times(expression(axle.x), omega))
    found = [(V, v), (Port("vx", Role.COMMAND, "m/s", "velocity of P forward"), vx)]
    found += [(Port("vy", Role.COMMAND, "m/s", "velocity of P to the left"), vy), (OMEGA, omega)]
    if w.curvature is not None:
        found.append((t.turning, turning))
    return tuple(found)


@function(SOURCE)
def chained_rates(robot: Robot, mobility: Mobility) -> Formula:
    """State and the robot's own inputs (v and the yaw or steering rate) to z1' ... zn'; u1, u2 are the first two."""
    w = write(train(robot, mobility))
    inputs = (*w.train.state, V, w.train.turning, *tunable_ports(robot))
    u1, u2 = chain_inputs(w, signal("v"), signal(w.train.turning.name))
    z = coordinates(w)
    u1 = w.names.define("chain_u1", u1)
    rates = [u1, u2, *(times(z[k], u1) for k in range(1, len(z) - 1))]
    outputs = tuple(
        (Port(f"z{k + 1}_rate", Role.COMMAND, "1/s", f"rate of z{k + 1}"), rate)
        for k, rate in enumerate(rates)
    )
    text = "rates of the chained state; z1_rate and z2_rate are the chain's inputs u1 and u2"
    return Formula("chained_rates", inputs, tuple(w.names.items), outputs, text)


def chain_inputs(w: Written, v: Expr, turning: Expr) -> tuple[Expr, Expr]:
    """u1, u2 of the robot's own inputs."""
    p = w.path
    if p is None:
        return turning, subtract(v, times(coordinates(w)[2], turning))
    leverage = times(p.speed, w.leverage) if w.curvature is not None else sympy.S.One
    u1 = w.names.define("path_rate", times(v, p.along))
    return u1, add(times(p.slopes[-1], u1), times(p.gain, leverage, turning))
