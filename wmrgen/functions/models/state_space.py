"""The state space of a robot: x' = f(x, u, p), with names, units and bounds of all entries."""

from __future__ import annotations

from cmath import exp, phase
from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.sheet import singular_sets
from wmrgen.functions.models.twist import sliding
from wmrgen.functions.registry import system_builder
from wmrgen.functions.system import Lag, System, of_commands
from wmrgen.kinematics.records import Formula, substituted
from wmrgen.layout.records import Robot, Virtual, Wheel
from wmrgen.layout.skid import parallel
from wmrgen.mobility.admissible import along
from wmrgen.mobility.analyse import driving
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, number, over, signal, subtract

ROLLING_ALONE = "wheels slide, as they do in every curve"


class StateSpace(NamedTuple):
    """``rates``: ``state``, ``inputs`` and parameters (``geometry``) to the rates of the state, in this order;
    ``constraints``: the same to what has to be 0, None where nothing has to; ``bounds``: low and high by contract
    name, of its rate as ``<name>_rate``; ``text``: which model it is; ``singular``: where it does not hold."""

    form: str
    text: str
    singular: tuple[str, ...]
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    geometry: tuple[Port, ...]
    rates: Formula
    constraints: Formula | None
    bounds: dict[str, tuple[float, float]]


def default_form(robot: Robot, mobility: Mobility) -> str:
    """Twist inputs, which are regular in every motion, where two axles or more steer, castors are driven or parallel
    wheels slide whatever the robot does; else driven speeds (`posture`)."""
    castors = any(w.kind.swivels and w.actuated for w in robot.wheels)
    several = mobility.degree_of_steerability > 1 or mobility.degenerate or castors
    return (
        "twist"
        if several and parallel([w.zero_heading for w in robot.wheels if w.kind.fixed_axle])
        else "posture"
    )


def state_space(robot: Robot, mobility: Mobility, form: str | None = None) -> StateSpace:
    """A model as a state space, of `default_form` unless told otherwise."""
    form = form or default_form(robot, mobility)
    robot, mobility = driving(robot, mobility)
    system = system_builder(form)(robot, mobility, False)
    following = lags(robot, system)
    inputs = tuple(following[u.name].command if u.name in following else u for u in system.inputs)
    rolling = sliding(robot, mobility) if form == "twist" else None
    return StateSpace(
        form,
        of_commands(system.text, following),
        singular_sets(system),
        system.state,
        inputs,
        system.geometry,
        _commanded(system.formula(guards=False), following),
        rolling and _commanded(rolling, following),
        {
            name: _bounds(robot, name)
            for port in (*system.state, *inputs)
            for name in (port.name, f"{port.name}_rate")
        },
    )


def lags(robot: Robot, system: System) -> dict[str, Lag]:
    """Steering rate that a model has for an input -> what decides it where the robot file says `lag`: the rate is
    (command - steer)/lag. Wheels that turn together have the longest lag of theirs."""
    states, following = {port.name for port in system.state}, {}
    for port in system.inputs:
        name, _, joint = port.name.rpartition(".")
        members = {v.name: v.wheels for v in robot.virtual}.get(name, (name,))
        wheels = [w for w in robot.wheels if robot.wheels[robot.steer_group[w.index]].name in members]
        constants = [time for w in wheels if (time := robot.lag_of(w, "steer")) is not None]
        if joint == "steer_rate" and f"{name}.steer" in states and constants:
            text = f"steering angle that {name} is to have, counter-clockwise from the zero of the robot file"
            command = Port(f"{name}.steer_command", Role.COMMAND, "rad", text)
            rate = over(subtract(signal(command.name), signal(f"{name}.steer")), number(max(constants)))
            following[port.name] = Lag(command, rate)
    return following


def _commanded(formula: Formula, following: Mapping[str, Lag]) -> Formula:
    """``formula`` with commands of steering angles in place of the rates that follow from them."""
    values: dict[Expr, Expr] = {signal(name): lag.rate for name, lag in following.items()}
    memo: dict[Expr, Expr] = {}
    return replace(
        formula,
        inputs=tuple(following[p.name].command if p.name in following else p for p in formula.inputs),
        locals=tuple((symbol, substituted(e, values, memo)) for symbol, e in formula.locals),
        outputs=tuple((port, substituted(e, values, memo)) for port, e in formula.outputs),
    )


def default_state_space(robot: Robot, mobility: Mobility) -> StateSpace | None:
    """As `state_space`; None where the robot has no model of motion."""
    try:
        return state_space(robot, mobility)
    except NotDerivableError:
        return None


def _bounds(robot: Robot, name: str) -> tuple[float, float]:
    """The limits that the robot file sets, infinite where it sets none."""
    wheel, _, quantity = name.rpartition(".")
    quantity = quantity.removesuffix("_command")
    real = {w.name: w for w in robot.wheels}
    virtual = {v.name: v for v in robot.virtual}
    if wheel in virtual and quantity == "steer":
        return _virtual_range(robot, virtual[wheel])
    if wheel and wheel not in real:
        return (-inf, inf)
    limit = robot.limit(real[wheel], quantity) if wheel else robot.limits.get(quantity)
    return (-inf, inf) if limit is None else (float(limit.low), float(limit.high))


def _virtual_range(robot: Robot, v: Virtual) -> tuple[float, float]:
    """The angles of a virtual wheel at which all that it steers keep their limits: where one of them is at a limit, the
    centre of rotation lies on its axle and on that of the fixed wheels. Limits beyond a right angle bound nothing."""
    fixed = next((w for w in robot.wheels if w.kind.fixed_axle), None)
    low, high = -inf, inf
    for w in map(robot.wheel, v.wheels):
        limit = robot.limit(w, "steer")
        if limit is None or fixed is None:
            continue
        ends = [
            _seen_by(v, w, fixed, float(end)) for end in (limit.low, limit.high) if abs(float(end)) < pi / 2
        ]
        if len(ends) == 2:
            low, high = max(low, min(ends)), min(high, max(ends))
    return low, high


def _seen_by(v: Virtual, w: Wheel, fixed: Wheel, angle: float) -> float:
    """The angle of the virtual wheel while ``w`` stands at ``angle`` [rad]: both roll, and the fixed wheel."""
    rows = along(fixed, 1j * fixed.zero_heading), along(w, 1j * w.zero_heading * exp(1j * angle))
    vx, vy, omega = np.cross(rows[0], rows[1])
    x, y = float(v.x.nominal), float(v.y.nominal)
    direction = phase(complex(vx - omega * y, vy + omega * x) / w.zero_heading)
    return direction - pi * round(direction / pi)


def forms(robot: Robot, mobility: Mobility) -> dict[str, System]:
    """The forms of the model that a robot has, parameters as symbols."""
    systems = {}
    for form in ("posture", "twist", "eta"):
        try:
            systems[form] = system_builder(form)(*driving(robot, mobility), True)
        except NotDerivableError:
            continue
    return systems


def rolls_alone(form: str, mobility: Mobility) -> bool:
    """Whether a form leaves out the sliding of a robot that slides in every curve."""
    return mobility.rank_C1f.value > 1 and form != "twist"


def regularity(robot: Robot, mobility: Mobility) -> dict[str, tuple[str, ...]]:
    """Forms of the model that a robot has, and where they do not hold: nothing of one that does in every motion."""
    acting = driving(robot, mobility)[1]
    return {
        form: singular_sets(system) + ((ROLLING_ALONE,) if rolls_alone(form, acting) else ())
        for form, system in forms(robot, mobility).items()
    }


def data(space: StateSpace) -> dict[str, Any]:
    """For model.json; null is no bound."""
    return {
        "form": space.form,
        "text": space.text,
        "singular": list(space.singular),
        "x": list(_entries(space, space.state)),
        "u": list(_entries(space, space.inputs)),
        "p": [
            {"name": p.name, "unit": p.unit, "nominal": float(p.default)}
            for p in space.geometry
            if p.default is not None
        ],
        "constraints": [
            {"name": p.name, "unit": p.unit}
            for p, _ in (space.constraints.outputs if space.constraints else ())
        ],
    }


def _entries(space: StateSpace, ports: Iterable[Port]) -> Iterable[dict[str, Any]]:
    for port in ports:
        low, high, *rate = (
            None if abs(v) == inf else v
            for name in (port.name, f"{port.name}_rate")
            for v in space.bounds[name]
        )
        rates = {} if rate == [None, None] else {"rate_lower": rate[0], "rate_upper": rate[1]}
        yield {"name": port.name, "unit": port.unit, "lower": low, "upper": high, **rates}
