"""Chained form z1' = u1, z2' = u2, z3' = z2 u1, ..., zn' = z_(n-1) u1 (Tzafestas (2.58)), and Brockett's integrator.

A robot of type (2, 0) without trailers has (2.62), (2.63): z1 = theta, everywhere. A car has (2.66)-(2.69). With N
trailers coupled on the axle the construction is that of Sordalen (1993): z1 and zn are the position of the last axle,
and z_(k-1) = dz_k/dz_1 along its path (module `series`). It requires that cos theta_N and the cosines of all hitch
angles are not 0. `chained_input` converts u1, u2 to the robot's own inputs; `chained_rates` is its inverse.

Brockett's integrator x1' = u1, x2' = u2, x3' = x1 u2 - x2 u1 of a (2, 0) robot follows from its (2,3) chain with the
same inputs: x1 = z1, x2 = z2, x3 = -2 z3 + z1 z2 (Tzafestas (2.64), (2.65)).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.records import Formula, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, UnderivableError, function
from wmrgen.functions.trailers.train import TrainTerms, V, terms_of, train
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST, Port, output
from wmrgen.geometry.symbolic import Expr, add, signal, subtract, times

Outputs = tuple[tuple[Port, Expr], ...]

SOURCE = "Tzafestas (2.58); Tzafestas (2.61)-(2.63); Tzafestas (2.66)-(2.69)"
BROCKETT_SOURCE = "Tzafestas (2.59), (2.64), (2.65)"
INTEGRATOR = "Brockett's integrator"
U = (
    output("u1", "", "first input of the chain"),
    output("u2", "", "second input of the chain"),
)


def _states(letter: str, values: Iterable[Expr], form: str) -> Outputs:
    """Return the values as outputs: states of a form."""
    return tuple(
        (output(f"{letter}{k}", "", f"state {k} of {form}"), value) for k, value in enumerate(values, 1)
    )


def _rates(letter: str, values: Iterable[Expr]) -> Outputs:
    """Return the values as outputs: rates of states."""
    return tuple(
        (output(f"{letter}{k}_rate", "1/s", f"rate of {letter}{k}"), value)
        for k, value in enumerate(values, 1)
    )


def _formula(name: str, w: TrainTerms, inputs: tuple[Port, ...], outputs: Outputs, text: str) -> Formula:
    """Return a function of the state and of ``inputs`` with the intermediate results of the train."""
    ports = (*w.train.state, *inputs, *tunable_ports(w.train.robot))
    return w.names.formula(name, ports, outputs, text)


@function(SOURCE, reads=("trailers",))
def chained(robot: Robot, mobility: Mobility) -> Formula:
    """Return z1 ... zn for x y theta, steering and trailers."""
    w = terms_of(train(robot, mobility))
    outputs = _states("z", _coordinates(w), "the chain")
    cite = "Tzafestas (2.62)" if w.train.by_heading else "Tzafestas (2.66), Sordalen (1993)"
    return _formula("chained", w, (), outputs, f"state of the (2,{w.train.size}) chain; {cite}")


def _coordinates(w: TrainTerms) -> tuple[Expr, ...]:
    """Return z1 ... zn in terms of the state."""
    if w.path is None:
        along = add(times(w.x, w.cosine), times(w.y, w.sine))
        to_the_right = subtract(times(w.x, w.sine), times(w.y, w.cosine))
        return signal("theta"), along, to_the_right
    slopes = w.path.slopes[1:-1]
    return (w.x, *reversed(slopes), w.y)


@function(SOURCE, reads=("trailers",))
def chained_input(robot: Robot, mobility: Mobility) -> Formula:
    """Return v, the steering rate and the twist of P for a state and u1, u2; `inverse` takes the twist."""
    w = terms_of(train(robot, mobility))
    u1, u2 = (signal(p.name) for p in U)
    v, turning = _own_inputs(w, u1, u2)
    v = w.names.define("axle_speed", v)
    outputs = _commands(w, v, turning)
    text = "inputs of the chain to inputs of the robot; " + ("(2.63)" if w.path is None else "(2.68)")
    return _formula("chained_input", w, U, outputs, text)


def _own_inputs(w: TrainTerms, u1: Expr, u2: Expr) -> tuple[Expr, Expr]:
    """Return v, and the yaw rate or the steering rate."""
    p = w.path
    if p is None:
        return add(u2, times(u1, _coordinates(w)[2])), u1
    rest = subtract(u2, times(p.slopes[-1], u1))
    bend = times(p.along, w.inverse_leverage) if w.curvature is not None else sympy.S.One
    return times(u1, p.speed), times(p.inverse_gain, bend, rest)


def _commands(w: TrainTerms, v: Expr, turning: Expr) -> Outputs:
    """Return v, vx, vy, omega of P and the steering rate, if there is one."""
    omega = turning if w.curvature is None else times(w.curvature, v)
    omega = w.names.define("yaw_rate", omega)
    twist = (*w.train.axle.velocity_of_p(v, omega), omega)
    steering = () if w.curvature is None else ((w.train.turning, turning),)
    return ((V, v), *zip(TWIST, twist, strict=True), *steering)


@function(SOURCE, reads=("trailers",))
def chained_rates(robot: Robot, mobility: Mobility) -> Formula:
    """Return z1' ... zn' for a state, v and the yaw or steering rate; u1, u2 are the first two."""
    w = terms_of(train(robot, mobility))
    u1, u2 = _chain_inputs(w, signal("v"), signal(w.train.turning.name))
    z = _coordinates(w)
    u1 = w.names.define("chain_u1", u1)
    rates = [u1, u2, *(times(z[k], u1) for k in range(1, len(z) - 1))]
    text = "rates of the chained state; z1_rate and z2_rate are the chain's inputs u1 and u2"
    return _formula("chained_rates", w, (V, w.train.turning), _rates("z", rates), text)


def _chain_inputs(w: TrainTerms, v: Expr, turning: Expr) -> tuple[Expr, Expr]:
    """Return u1, u2 for the robot's own inputs."""
    p = w.path
    if p is None:
        return turning, subtract(v, times(_coordinates(w)[2], turning))
    leverage = times(p.speed, w.leverage) if w.curvature is not None else sympy.S.One
    u1 = w.names.define("path_rate", times(v, p.along))
    return u1, add(times(p.slopes[-1], u1), times(p.gain, leverage, turning))


def _chain_of_three(robot: Robot, mobility: Mobility) -> TrainTerms:
    """Return the terms of a (2,3) chain. Raise NotDerivableError for any other robot."""
    t = train(robot, mobility, what=INTEGRATOR)
    if not t.by_heading:
        raise UnderivableError(
            f"{robot.name}: {INTEGRATOR} is equivalent to the (2,3) chain of a (2, 0) robot without trailers "
            f"(Tzafestas (2.65)); this robot has {t.size} states, and its form is the (2,{t.size}) chain: `chained`",
            Reason.ROBOT_TYPE,
        )
    return terms_of(t)


def _integrator(w: TrainTerms) -> tuple[Expr, Expr, Expr]:
    """Return x1, x2, x3."""
    z1, z2, z3 = (w.names.define(f"chain_z{k}", z) for k, z in enumerate(_coordinates(w), 1))
    return z1, z2, add(times(sympy.Integer(-2), z3), times(z1, z2))


@function(BROCKETT_SOURCE, reads=("trailers",))
def brockett(robot: Robot, mobility: Mobility) -> Formula:
    """Return x1 x2 x3 for x y theta (Tzafestas (2.64))."""
    w = _chain_of_three(robot, mobility)
    outputs = _states("x", _integrator(w), INTEGRATOR)
    return _formula("brockett", w, (), outputs, "state of Brockett's integrator; Tzafestas (2.64)")


@function(BROCKETT_SOURCE, reads=("trailers",))
def brockett_rates(robot: Robot, mobility: Mobility) -> Formula:
    """Return x1' x2' x3' for x y theta, v, omega (Tzafestas (2.65)); u1, u2 are the first two."""
    w = _chain_of_three(robot, mobility)
    x1, x2, _ = _integrator(w)
    u1, u2 = _chain_inputs(w, signal("v"), signal("omega"))
    u2 = w.names.define("chain_u2", u2)
    outputs = _rates("x", (u1, u2, subtract(times(x1, u2), times(x2, u1))))
    text = "rates of Brockett's integrator; Tzafestas (2.65)"
    return _formula("brockett_rates", w, (V, w.train.turning), outputs, text)


@function(BROCKETT_SOURCE, reads=("trailers",))
def brockett_input(robot: Robot, mobility: Mobility) -> Formula:
    """Return v, vx, vy, omega for x y theta, u1, u2: the inputs are those of the chain."""
    _chain_of_three(robot, mobility)
    text = "inputs of Brockett's integrator to inputs of the robot; (2.63), (2.65)"
    return replace(chained_input(robot, mobility), name="brockett_input", text=text)
