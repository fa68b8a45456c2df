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
from wmrgen.functions.system import Lag, System, of_commands
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.layout.skid import parallel
from wmrgen.geometry.notation import listed
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import Expr, number, over, signal, subtract


class StateSpace(NamedTuple):
    """``rates``: ``state``, ``inputs`` and parameters (``geometry``) to the rates of the state, in this order;
    ``constraints``: the same to what has to be 0, None where nothing has to; ``limited``: what the robot file limits;
    ``text``: which model it is; ``singular``: where it does not hold; ``at_once``: wheels whose `lag` it leaves out."""

    form: str
    text: str
    singular: tuple[str, ...]
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    geometry: tuple[Port, ...]
    rates: Formula
    constraints: Formula | None
    limited: Limited
    at_once: tuple[str, ...]

    @property
    def limits(self) -> tuple[Port, ...]:
        """What is limited and is neither state nor input."""
        return tuple(p for p, _ in self.limited.formula.outputs) if self.limited.formula else ()


def default_form(robot: Robot, mobility: Mobility) -> str:
    """Twist inputs, which are regular in every motion, where two axles or more steer, castors are driven or parallel
    wheels slide whatever the robot does; else driven speeds: `trailer` for a robot with trailers, or `posture`."""
    castors = any(w.kind.swivels and w.actuated for w in robot.wheels)
    several = mobility.degree_of_steerability > 1 or mobility.degenerate or castors
    if several and parallel([w.zero_heading for w in robot.wheels if w.kind.fixed_axle]):
        return "twist"
    return "trailer" if robot.trailers else "posture"


def state_space(robot: Robot, mobility: Mobility, form: str | None = None) -> StateSpace:
    """A model as a state space, of `default_form` unless told otherwise."""
    form = form or default_form(robot, mobility)
    robot, mobility = driving(robot, mobility)
    system = system_builder(form)(robot, mobility, False)
    following = lags(robot, system)
    inputs = tuple(following[u.name].command if u.name in following else u for u in system.inputs)
    rolling = sliding(robot, mobility) if form == "twist" else None
    limits, at_once = limited(robot, mobility, form, system, following), _at_once(robot, following)
    text = of_commands(system.text, following)
    text += f"; it leaves out the lag of {listed(at_once)}" if at_once else ""
    text += "; trailers are in the form trailer alone" if robot.trailers and form != "trailer" else ""
    never = [name for name, (low, high) in limits.bounds.items() if low > high]
    text += f"; no {listed(never)} keeps the limits of all wheels that follow" if never else ""
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


def _at_once(robot: Robot, following: Mapping[str, Lag]) -> tuple[str, ...]:
    """Wheels that lag more than what they follow in a model, and driven castors whose angle it does not have."""
    slow = max((lag.constant for lag in following.values()), default=ZERO)
    names = []
    for w in (w for w in robot.wheels if "steer" in w.actuated):
        lead = robot.wheels[robot.steer_group[w.index]].name
        free = w.kind.swivels and f"{lead}.steer_rate" not in following
        if (robot.lag_of(w, "steer") or ZERO) > (ZERO if free else slow):
            names.append(w.name)
    return tuple(names)


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
            following[port.name] = Lag(command, rate, max(constants))
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


def forms(robot: Robot, mobility: Mobility) -> dict[str, System]:
    """The forms of the model that a robot has, parameters as symbols; the one with trailers if there are some."""
    systems = {}
    for form in ("posture", "twist", "eta", *(["trailer"] if robot.trailers else [])):
        try:
            systems[form] = system_builder(form)(*driving(robot, mobility), True)
        except NotDerivableError:
            continue
    return systems


def rolls_alone(form: str, mobility: Mobility) -> bool:
    """Whether a form leaves out the sliding of a robot that rolls in one motion and slides in all others."""
    return mobility.degenerate and form != "twist"


def regularity(robot: Robot, mobility: Mobility) -> dict[str, tuple[str, ...]]:
    """Forms of the model that a robot has, and where they are singular: nothing of one that holds in every motion."""
    acting = driving(robot, mobility)[1]
    return {
        form: singular_sets(system) + ((where_it_slides(acting),) if rolls_alone(form, acting) else ())
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
        "limits": list(_entries(space, space.limits)),
        "absent_limits": list(space.limited.absent),
    }


def limit_lines(space: StateSpace) -> list[str]:
    """Of each limit of the robot file a line: its bounds, and where they stand if not in x and u."""
    lines = []
    for port in (*space.state, *space.inputs, *space.limits):
        (low, high), change = space.limited.bounds[port.name], space.limited.changes.get(port.name)
        ranges = [f"{low:.6g} to {high:.6g} {port.unit}"] if (low, high) != NO_BOUND else []
        ranges += [f"changing by {change[0]:.6g} to {change[1]:.6g} {port.unit}^2"] if change else []
        ranges += ["in the function limits(x, u, p)"] if port in space.limits else []
        lines += [f"{port.name}: {', '.join(ranges)}"] if ranges else []
    return [*lines, *(f"{name}: this model has no variable for it" for name in space.limited.absent)]


def _entries(space: StateSpace, ports: Iterable[Port]) -> Iterable[dict[str, Any]]:
    for port in ports:
        low, high = _nullable(space.limited.bounds[port.name])
        change = space.limited.changes.get(port.name)
        rates = dict(zip(("rate_lower", "rate_upper"), _nullable(change), strict=True)) if change else {}
        yield {"name": port.name, "unit": port.unit, "lower": low, "upper": high, **rates}


def _nullable(bound: Bound) -> Iterable[float | None]:
    return (None if abs(v) == inf else v for v in bound)
