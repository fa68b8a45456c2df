"""The state space of a robot: x' = f(x, u, p), with names, units and bounds of all entries."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Any

from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.twist import parallel, sliding
from wmrgen.functions.registry import system_builder
from wmrgen.functions.system import System
from wmrgen.kinematics.records import Formula
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port


@dataclass(frozen=True, slots=True)
class StateSpace:
    """``rates``: state, inputs and parameters of ``system`` to the rates of the state, in this order; ``constraints``:
    the same to what has to be 0, None where nothing has to; ``bounds``: low and high by contract name."""

    form: str
    system: System
    rates: Formula
    constraints: Formula | None
    bounds: dict[str, tuple[float, float]]


def default_form(robot: Robot, mobility: Mobility) -> str:
    """Twist inputs, which are regular in every motion, where two axles or more steer and where parallel wheels slide
    whatever the robot does; else driven speeds (`posture`)."""
    skids = mobility.degenerate and parallel(robot)
    return "twist" if mobility.degree_of_steerability > 1 or skids else "posture"


def state_space(robot: Robot, mobility: Mobility, form: str | None = None) -> StateSpace:
    """A model as a state space, of `default_form` unless told otherwise."""
    form = form or default_form(robot, mobility)
    system = system_builder(form)(robot, mobility, False)
    ports = (*system.state, *system.inputs)
    return StateSpace(
        form,
        system,
        system.formula(),
        sliding(robot, mobility) if form == "twist" else None,
        {port.name: _bounds(robot, port.name) for port in ports},
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
    names = {w.name: w for w in robot.wheels}
    limit = (
        robot.limits.get(quantity)
        if not wheel
        else robot.limit(names[wheel], quantity)
        if wheel in names
        else None
    )
    return (-inf, inf) if limit is None else (float(limit.low), float(limit.high))


def data(space: StateSpace) -> dict[str, Any]:
    """For model.json; null is no bound."""
    return {
        "form": space.form,
        "text": space.system.text,
        "x": list(_entries(space, space.system.state)),
        "u": list(_entries(space, space.system.inputs)),
        "p": [
            {"name": p.name, "unit": p.unit, "nominal": float(p.default)}
            for p in space.system.geometry
            if p.default is not None
        ],
        "constraints": [
            {"name": p.name, "unit": p.unit}
            for p, _ in (space.constraints.outputs if space.constraints else ())
        ],
    }


def _entries(space: StateSpace, ports: Iterable[Port]) -> Iterable[dict[str, Any]]:
    for port in ports:
        low, high = (None if abs(v) == inf else v for v in space.bounds[port.name])
        yield {"name": port.name, "unit": port.unit, "lower": low, "upper": high}
