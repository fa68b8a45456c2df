"""Limits of a robot file in the terms of a model.

They are bounds of its state and inputs, and bounds of further quantities h(x, u, p): the twist if wheel speeds are
inputs, wheel speeds if the twist is the input, and the angles of wheels that follow.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator, Mapping
from functools import cached_property
from math import copysign, cos, inf, pi, sin
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import NEGLIGIBLE
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.frame import Frame, frame, steering_direction, steering_rates
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.system import Lag, System
from wmrgen.geometry.constraints import driving_row, steer_gens, working_view
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, Row, at_angle, dot, each, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import POSE, TWIST, TWIST_NAMES, Port, Role
from wmrgen.geometry.symbolic import Expr, add, angle_of, expression, norm, over, signal, times

Bound = tuple[float, float]
NO_BOUND = (-inf, inf)


class Limited(NamedTuple):
    """The limits of a robot in one form of its model."""

    bounds: dict[str, Bound]  # low and high of state, inputs and outputs of ``formula``, by name
    changes: dict[str, Bound]  # low and high of their rates, if limited
    formula: Formula | None  # h of state, inputs and parameters; None if nothing else is limited
    absent: tuple[str, ...]  # limits for which the model has no variable


def limited(
    robot: Robot, mobility: Mobility, form: str, system: System, following: Mapping[str, Lag]
) -> Limited:
    """Return the limits of a robot in one form of its model.

    Args:
        robot: The robot.
        mobility: Its mobility.
        form: The form of the model, for example ``posture``.
        system: The model in this form.
        following: Inputs that are replaced by commands, with the lag between command and steering angle.
    """
    inputs = tuple(following[u.name].command if u.name in following else u for u in system.inputs)
    entries = (*system.state, *inputs)
    terms = _LimitedQuantities(robot, mobility, form, system, following)
    outputs, absent = [], []
    for port, same in _limits(robot):
        if same & {p.name for p in entries} or port.name in terms.narrowing:
            continue
        value = terms.value(port)
        if value is None:
            absent.append(port.name)
        elif value is not sympy.S.Zero:
            outputs.append((port, value))
    ports = (*entries, *system.geometry)
    text = f"limited quantities in addition to x and u: {', '.join(p.name for p, _ in outputs)}"
    h = terms.locals.formula("limits", ports, outputs, text)
    names = [p.name for p in entries] + [p.name for p, _ in outputs]
    bounds = {name: _bound(robot, name) for name in names}
    bounds |= {p.name: terms.range(p.name) for p in entries if p.name.endswith((".steer", ".steer_command"))}
    changes = {n: _bound(robot, rate) for n in names if (rate := _rate_of(n)) and robot.limit_of(rate)}
    return Limited(bounds, changes, h if outputs else None, tuple(absent))


def _limits(robot: Robot) -> Iterator[tuple[Port, set[str]]]:
    """Yield each limited quantity, once for coupled joints, with the names of all joints of the coupling."""
    for port in TWIST:
        if {port.name, f"{port.name}_rate"} & robot.limits.keys():
            yield port, {port.name}
    for joint, quantities in {"spin": ("spin",), "steer": ("steer", "steer_rate")}.items():
        wheels = [w for w in robot.wheels if (w.has_spin if joint == "spin" else w.turns)]
        for members in robot.together(joint, wheels):
            for quantity in quantities:
                rate = _RATES.get(quantity)
                if robot.limit(members[0], quantity) or (rate and robot.limit(members[0], rate)):
                    port = joint_port(members[0], quantity, Role.COMMAND)
                    yield port, {f"{w.name}.{quantity}" for w in members}


_RATES = {
    **{name: f"{name}_rate" for name in TWIST_NAMES},
    "spin": "spin_rate",
    "steer_rate": "steer_acceleration",
}


def _rate_of(name: str) -> str:
    """Return the name of the limit of how fast a quantity may change: ``vx`` -> ``vx_rate``; "" if there is none."""
    owner, dot, quantity = name.rpartition(".")
    return f"{owner}{dot}{_RATES[quantity]}" if quantity in _RATES else ""


def _bound(robot: Robot, name: str) -> Bound:
    """Return the bounds of the robot file, infinite if it has none."""
    limit = robot.limit_of(name.removesuffix("_command"))
    return NO_BOUND if limit is None else (float(limit.low), float(limit.high))


class _LimitedQuantities:
    """The limited quantities, written in state and inputs of a model."""

    def __init__(
        self, robot: Robot, mobility: Mobility, form: str, system: System, following: Mapping[str, Lag]
    ) -> None:
        self.robot, self.mobility, self.form = robot, mobility, form
        self.system, self.following = system, following
        self.state = {p.name for p in system.state}
        self.locals = Locals()

    @cached_property
    def frame(self) -> Frame:
        """Return the steering coordinates that other wheels follow."""
        build = frame if self.form == "eta" else steering_frame
        return build(self.robot, self.mobility, False)

    @cached_property
    def narrowing(self) -> dict[str, Wheel]:
        """Return angles that follow from one coordinate beside a fixed axle: their limits limit the coordinate."""
        axle, wheels = self.axle, {}
        if axle and self.posed:
            apart = [w for w in self.robot.wheels if abs(_seen_from(axle, w).real) > NEGLIGIBLE]
            wheels = {f"{w.name}.steer": w for w in apart if w.kind.steers and not self._is_state(w)}
        return wheels if wheels and len(self.frame.wheels) == 1 else {}

    @cached_property
    def axle(self) -> Wheel | None:
        """Return a fixed wheel."""
        return next((w for w in self.robot.wheels if w.kind.fixed_axle), None)

    @property
    def posed(self) -> bool:
        """Return whether the state begins with the pose of the robot."""
        return self.system.state[:3] == POSE

    def range(self, name: str) -> Bound:
        """Return the range of a coordinate in which it and all angles that follow are inside their limits."""
        low, high = _bound(self.robot, name)
        for follower in self.narrowing.values():
            limit = self.robot.limit(follower, "steer")
            (lead,) = self.frame.wheels
            if limit and self.axle and name.startswith(f"{lead.name}."):
                ends = [
                    _lead_angle(self.robot, lead, follower, self.axle, float(end))
                    for end in (limit.low, limit.high)
                ]
                low, high = max(low, min(ends)), min(high, max(ends))
        return low, high

    @cached_property
    def rates(self) -> dict[str, Expr]:
        """Return the rate of each state, with the axes of the world along the axes of the robot."""
        ahead = {signal("theta"): sympy.S.Zero}
        following, system = self.following, self.system
        inputs = [following[u.name].rate if u.name in following else signal(u.name) for u in system.inputs]
        rates = {}
        for i, p in enumerate(system.state):
            parts = [times(f[i].xreplace(ahead), u) for f, u in zip(system.fields, inputs, strict=True)]
            rates[p.name] = add(*parts)
        return rates

    def value(self, port: Port) -> Expr | None:
        """Return the expression of a quantity; None if the model has no variable for it."""
        wheel, _, quantity = port.name.rpartition(".")
        if not self.posed:
            return None
        if not wheel:
            return self.rates[POSE[TWIST.index(port)].name]
        return {"spin": self._spin, "steer": self._steer, "steer_rate": self._steer_rate}[quantity](
            self.robot.wheel(wheel)
        )

    def _lead(self, w: Wheel) -> Wheel:
        """Return the wheel whose joint turns ``w``."""
        return self.robot.wheels[self.robot.steer_group[w.index]]

    def _is_state(self, w: Wheel) -> bool:
        """Return whether the steering angle of a wheel is a state."""
        return f"{self._lead(w).name}.steer" in self.state

    def _steer(self, w: Wheel) -> Expr | None:
        """Return the steering angle of a wheel that follows."""
        if not w.kind.steers:
            return None
        along, across = steering_direction(self.frame, w)
        return angle_of(expression(across), expression(along))

    def _steer_rate(self, w: Wheel) -> Expr | None:
        """Return the steering rate of a wheel; None for a castor whose angle is no state."""
        if self._is_state(w):
            return times(w.steer_sign, self.rates[f"{self._lead(w).name}.steer"])
        if not w.kind.steers:
            return None
        shares = steering_rates(self.frame, w)
        return add(*(times(expression(k), self.rates[f"{name}.steer"]) for name, k in shares.items()))

    def _spin(self, w: Wheel) -> Expr | None:
        """Return the spin of a wheel [rad/s]; None for a castor whose angle is no state."""
        g = working_view(w)
        row = driving_row(w, g)
        if w.turns:
            turned = self._turned(w)
            if turned is None:
                return None
            c, s = turned
            row = each(row, lambda p: at_angle(p, c, s))
        rim, rate = dot(row, self._twist), self._steer_rate(w) if w.kind.steers and g.steer_arm else None
        if rate is not None:
            rim = rim - g.steer_arm * self.locals.poly(f"{w.name}_rate", rate)
        return expression(rim * g.rolling_radius.inverse())

    def _turned(self, w: Wheel) -> tuple[Poly, Poly] | None:
        """Return cosine and sine of a steering angle; None for a castor whose angle is no state."""
        if self._is_state(w):
            c, s = steer_gens(self._lead(w))
            return c, s.scale(Exact(w.steer_sign))
        if not w.kind.steers:
            return None
        along, across = map(expression, steering_direction(self.frame, w))
        size = norm(along, across)
        return (
            self.locals.poly(f"{w.name}_cos", over(along, size)),
            self.locals.poly(f"{w.name}_sin", over(across, size)),
        )

    @cached_property
    def _twist(self) -> Row:
        """Return the twist of P in the robot frame."""
        return triple(
            self._named(twist.name, self.rates[p.name]) for twist, p in zip(TWIST, POSE, strict=True)
        )

    def _named(self, name: str, value: Expr) -> Poly:
        """Return a value as an intermediate result; 0 needs no name."""
        return Poly({}) if value is sympy.S.Zero else self.locals.poly(name, value)


def _seen_from(axle: Wheel, w: Wheel) -> complex:
    """Return the position of a wheel from a fixed wheel, along its rolling direction and to the left [m]."""
    a, g = axle.nominal, w.nominal
    x, y = g.x - a.x, g.y - a.y
    return complex(float(x * a.ch + y * a.sh), float(y * a.ch - x * a.sh))


def _straight_ahead(robot: Robot, w: Wheel, axle: Wheel) -> float:
    """Return the angle [rad] at which the robot drives straight on; of two, the one nearer to the middle of its
    limits."""
    limit, turn = robot.limit(w, "steer"), phase(axle.zero_heading / w.zero_heading)
    middle = float(limit.low + limit.high) / 2 if limit else 0.0
    return turn - pi * round((turn - middle) / pi)


def _lead_angle(robot: Robot, lead: Wheel, w: Wheel, axle: Wheel, angle: float) -> float:
    """Return the angle of ``lead`` [rad] when ``w`` is at ``angle`` and both roll beside the fixed wheel ``axle``.

    The result is infinite if ``w`` may turn round.
    """
    here, there = _seen_from(axle, w), _seen_from(axle, lead)
    delta = angle - _straight_ahead(robot, w, axle)
    side = copysign(1.0, here.real)
    if abs(delta) >= pi:
        return copysign(inf, delta * here.real * there.real)
    omega, speed = side * sin(delta), side * (here.real * cos(delta) + here.imag * sin(delta))
    return _straight_ahead(robot, lead, axle) + phase(complex(speed - omega * there.imag, omega * there.real))
