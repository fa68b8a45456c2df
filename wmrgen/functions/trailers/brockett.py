"""Brockett's integrator x1' = u1, x2' = u2, x3' = x1 u2 - x2 u1 of a (2, 0) robot, from its (2,3) chain.

Tzafestas (2.64), (2.65): x1 = z1, x2 = z2, x3 = -2 z3 + z1 z2. The inputs are those of the chain.
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import function
from wmrgen.functions.trailers.chained import chain_inputs, chained_input, coordinates
from wmrgen.functions.trailers.train import V, Written, train, write
from wmrgen.kinematics.records import Formula, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, signal, subtract, times

SOURCE = "Tzafestas (2.59), (2.64), (2.65)"
WHAT = "Brockett's integrator"


def _written(robot: Robot, mobility: Mobility) -> Written:
    t = train(robot, mobility, what=WHAT)
    if not t.by_heading:
        raise NotDerivableError(
            f"{robot.name}: {WHAT} is equivalent to the (2,3) chain of a (2, 0) robot without trailers (Tzafestas "
            f"(2.65)); this one has {t.size} states and becomes the (2,{t.size}) chain: `chained`"
        )
    return write(t)


def _states(w: Written) -> tuple[Expr, Expr, Expr]:
    z1, z2, z3 = (w.names.define(f"chain_z{k + 1}", z) for k, z in enumerate(coordinates(w)))
    return z1, z2, add(times(sympy.Integer(-2), z3), times(z1, z2))


@function(SOURCE)
def brockett(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta to x1 x2 x3 (Tzafestas (2.64))."""
    w = _written(robot, mobility)
    outputs = tuple(
        (Port(f"x{k + 1}", Role.COMMAND, "", f"state {k + 1} of Brockett's integrator"), x)
        for k, x in enumerate(_states(w))
    )
    inputs = (*w.train.state, *tunable_ports(robot))
    return Formula(
        "brockett", inputs, tuple(w.names.items), outputs, "state of Brockett's integrator; Tzafestas (2.64)"
    )


@function(SOURCE)
def brockett_rates(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta, v, omega to x1' x2' x3' (Tzafestas (2.65)); u1, u2 are the first two."""
    w = _written(robot, mobility)
    x1, x2, _ = _states(w)
    u1, u2 = chain_inputs(w, signal("v"), signal("omega"))
    u2 = w.names.define("chain_u2", u2)
    rates = (u1, u2, subtract(times(x1, u2), times(x2, u1)))
    outputs = tuple(
        (Port(f"x{k + 1}_rate", Role.COMMAND, "1/s", f"rate of x{k + 1}"), rate)
        for k, rate in enumerate(rates)
    )
    inputs = (*w.train.state, V, w.train.turning, *tunable_ports(robot))
    return Formula(
        "brockett_rates", inputs, tuple(w.names.items), outputs,
        "rates of Brockett's integrator; Tzafestas (2.65)",
    )  # fmt: skip


@function(SOURCE)
def brockett_input(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta, u1, u2 to v, vx, vy, omega: the inputs are those of the chain."""
    _written(robot, mobility)
    return replace(
        chained_input(robot, mobility), name="brockett_input",
        text="inputs of Brockett's integrator to those of the robot; (2.63), (2.65)",
    )  # fmt: skip
