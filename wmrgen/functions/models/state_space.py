"""The state space of a robot: x' = f(x, u, p), with names, units and bounds of all entries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

from wmrgen.analysis.kinematics.records import Formula, substituted
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.limits import NO_BOUND, Bound, Limited, limited
from wmrgen.functions.models.sheet import singular_sets
from wmrgen.functions.models.twist import sliding, where_it_slides
from wmrgen.functions.registry import system_builder
from wmrgen.functions.system import Lag, System, with_commands
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.layout.skid import parallel
from wmrgen.geometry.notation import listed
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import Expr, number, over, signal, subtract


class StateSpace(NamedTuple):
    """A model as a state space."""

    form: str
    text: str  # which model it is
    singular: tuple[str, ...]  # where it does not hold, a sentence each
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    geometry: tuple[Port, ...]  # parameters p
    rates: Formula  # state, inputs and parameters to the rates of the state, in the order of ``state``
    # the same arguments to residuals that must be 0; None if the model has no constraint
    constraints: Formula | None
    limited: Limited  # bounds from the robot file
    at_once: tuple[str, ...]  # wheels whose `lag` the model leaves out

    @property
    def limits(self) -> tuple[Port, ...]:
        """Return the limited quantities that are neither state nor input."""
        return tuple(p for p, _ in self.limited.formula.outputs) if self.limited.formula else ()


def default_form(robot: Robot, mobility: Mobility) -> str:
    """Return the form of the model that fits the robot.

    It is ``twist``, which is regular in every motion, if two axles or more steer, if castors are driven, or if
    parallel wheels slide in every motion. Otherwise it is ``trailer`` for a robot with trailers, else ``posture``.
    """
    castors = any(w.kind.swivels and w.actuated for w in robot.wheels)
    several = mobility.degree_of_steerability > 1 or mobility.degenerate or castors
    if several and parallel([w.zero_heading for w in robot.wheels if w.kind.fixed_axle]):
        return "twist"
    return "trailer" if robot.trailers else "posture"


def state_space(robot: Robot, mobility: Mobility, form: str | None = None) -> StateSpace:
    """Return a model as a state space.

    Args:
        robot: The robot.
        mobility: Its mobility.
        form: The form of the model; None for `default_form`.
    """
    form = form or default_form(robot, mobility)
    robot, mobility = driving(robot, mobility)
    system = system_builder(form)(robot, mobility, False)
    following = lags(robot, system)
    inputs = tuple(following[u.name].command if u.name in following else u for u in system.inputs)
    rolling = sliding(robot, mobility) if form == "twist" else None
    limits, at_once = limited(robot, mobility, form, system, following), _without_lag(robot, following)
    text = with_commands(system.text, following)
    text += f"; it leaves out the lag of {listed(at_once)}" if at_once else ""
    text += "; only the form trailer has the trailers" if robot.trailers and form != "trailer" else ""
    never = [name for name, (low, high) in limits.bounds.items() if low > high]
    text += f"; no value of {listed(never)} satisfies the limits of all wheels that follow" if never else ""
    return StateSpace(
        form,
        text,
        singular_sets(system),
        system.state,
        inputs,
        system.geometry,
        _commanded(system.formula(guards=False), following),
        rolling and _commanded(rolling, following),
        limits,
        at_once,
    )


def _without_lag(robot: Robot, following: Mapping[str, Lag]) -> tuple[str, ...]:
    """Return wheels whose lag the model leaves out: they follow faster in the model than in the robot file."""
    slow = max((lag.constant for lag in following.values()), default=ZERO)
    names = []
    for w in robot.wheels:
        if "steer" not in w.actuated:
            continue
        lead = robot.wheels[robot.steer_group[w.index]].name
        free = w.kind.swivels and f"{lead}.steer_rate" not in following
        if (robot.lag_of(w, "steer") or ZERO) > (ZERO if free else slow):
            names.append(w.name)
    return tuple(names)


def lags(robot: Robot, system: System) -> dict[str, Lag]:
    """Return the lag of each steering rate that a model has as an input, if the robot file has a `lag`.

    The rate is then (command - steer)/lag. Wheels that turn together have their longest lag.
    """
    states, following = {port.name for port in system.state}, {}
    for port in system.inputs:
        name, _, joint = port.name.rpartition(".")
        members = {v.name: v.wheels for v in robot.virtual}.get(name, (name,))
        wheels = [w for w in robot.wheels if robot.wheels[robot.steer_group[w.index]].name in members]
        constants = [time for w in wheels if (time := robot.lag_of(w, "steer")) is not None]
        if joint == "steer_rate" and f"{name}.steer" in states and constants:
            text = f"wanted steering angle of {name}, counter-clockwise from the zero of the robot file"
            command = Port(f"{name}.steer_command", Role.COMMAND, "rad", text)
            rate = over(subtract(signal(command.name), signal(f"{name}.steer")), number(max(constants)))
            following[port.name] = Lag(command, rate, max(constants))
    return following


def _commanded(formula: Formula, following: Mapping[str, Lag]) -> Formula:
    """Return ``formula`` with commands of steering angles in place of the rates that follow from them."""
    values: dict[Expr, Expr] = {signal(name): lag.rate for name, lag in following.items()}
    memo: dict[Expr, Expr] = {}
    return replace(
        formula,
        inputs=tuple(following[p.name].command if p.name in following else p for p in formula.inputs),
        locals=tuple((symbol, substituted(e, values, memo)) for symbol, e in formula.locals),
        outputs=tuple((port, substituted(e, values, memo)) for port, e in formula.outputs),
    )


def default_state_space(robot: Robot, mobility: Mobility) -> StateSpace | None:
    """Return the state space in the default form; None if the robot has no model of motion."""
    try:
        return state_space(robot, mobility)
    except NotDerivableError:
        return None


def forms(robot: Robot, mobility: Mobility) -> dict[str, System]:
    """Return the forms of the model that a robot has, with parameters as symbols."""
    systems = {}
    for form in ("posture", "twist", "eta", *(["trailer"] if robot.trailers else [])):
        try:
            systems[form] = system_builder(form)(*driving(robot, mobility), True)
        except NotDerivableError:
            continue
    return systems


def ignores_sliding(form: str, mobility: Mobility) -> bool:
    """Return whether a form leaves out the sliding of a robot that rolls in one motion and slides in all others."""
    return mobility.degenerate and form != "twist"


def regularity(robot: Robot, mobility: Mobility) -> dict[str, tuple[str, ...]]:
    """Return where each form of the model is singular; an empty tuple for a form that holds in every motion."""
    acting = driving(robot, mobility)[1]
    return {
        form: singular_sets(system) + ((where_it_slides(acting),) if ignores_sliding(form, acting) else ())
        for form, system in forms(robot, mobility).items()
    }


def data(space: StateSpace) -> dict[str, Any]:
    """Return the state space as data for model.json; null means no bound."""
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
        "limits": list(_entries(space, space.limits)),
        "absent_limits": list(space.limited.absent),
    }


def limit_lines(space: StateSpace) -> list[str]:
    """Return a line for each limit: its bounds, and where to find it if it is not in x and u."""
    lines = []
    for port in (*space.state, *space.inputs, *space.limits):
        (low, high), change = space.limited.bounds[port.name], space.limited.changes.get(port.name)
        ranges = [f"{low:.6g} to {high:.6g} {port.unit}"] if (low, high) != NO_BOUND else []
        ranges += [f"changing by {change[0]:.6g} to {change[1]:.6g} {port.unit}^2"] if change else []
        ranges += ["in the function limits(x, u, p)"] if port in space.limits else []
        lines += [f"{port.name}: {', '.join(ranges)}"] if ranges else []
    return [*lines, *(f"{name}: this model has no variable for it" for name in space.limited.absent)]


def _entries(space: StateSpace, ports: Iterable[Port]) -> Iterable[dict[str, Any]]:
    """Yield name, unit and bounds of each entry."""
    for port in ports:
        low, high = _nullable(space.limited.bounds[port.name])
        change = space.limited.changes.get(port.name)
        rates = dict(zip(("rate_lower", "rate_upper"), _nullable(change), strict=True)) if change else {}
        yield {"name": port.name, "unit": port.unit, "lower": low, "upper": high, **rates}


def _nullable(bound: Bound) -> Iterable[float | None]:
    """Return a bound with None for infinity."""
    return (None if abs(v) == inf else v for v in bound)
