"""Move a robot by its own functions: one step for several starts at once.

During a step the twist is constant. The pose then moves on an arc, which `odometry_increment` computes exactly. Angles
that follow the motion have no closed form: the steering angles of castors, and the headings of trailers. They are
integrated by the classical Runge-Kutta method, with their rates from `inverse` and `towed`. If the
commands are inputs of the model, such as wheel speeds and steering rates, the state space (`ode`) gives the rates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import atan2, ceil, hypot

import numpy as np
from numpy.typing import NDArray

from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.axle import THROUGH_P, axle_of, leading_axle
from wmrgen.geometry.constraints import nominal_view
from wmrgen.geometry.ports import POSE, TWIST_NAMES, Role
from wmrgen.ir.nodes import Module
from wmrgen.report.pages.live import towed

Reals = NDArray[np.float64]
Values = Mapping[str, Reals]  # by name of a quantity, (N,) for N starts
Twist = tuple[Reals, Reals, Reals]  # vx, vy [m/s], omega [rad/s] of P in the robot frame, (N,) each

SLIDING = 1e-6  # m/s: smaller slip is rounding error
TURNED = (
    0.05  # rad: rotation of a castor or trailer in one Runge-Kutta step; its error is then below 1e-8 rad
)
MOST_STEPS = (
    1000  # Runge-Kutta steps in one step: a limit for castors that are a fraction of a millimetre long
)
NAMES = tuple(port.name for port in POSE)


class Model:
    """The functions of a robot, over arrays, and the step that they make."""

    def __init__(self, derivation: Derivation) -> None:
        """Take a derivation that has inverse, forward and odometry_increment."""
        self.derivation = derivation
        self.robot = derivation.robot
        self._functions = derivation.numpy()
        self.castors = [w.name for w in self.robot.wheels if w.kind.swivels]
        self.steered = [w.name for w in self.robot.wheels if w.kind.steers]
        function = towed(derivation)
        self.trailers = [t.name for t in self.robot.trailers] if function else []
        self._towed: Callable[..., Values] | None = None
        if function is not None:
            self._ports = [port.name for port in function.inputs if port.role is not Role.GEOMETRY]
            module = Module(self.robot.name, (function,))
            self._towed = BACKENDS["numpy"].offers("functions")(module).towed
        arms = [hypot(float(w.nominal.d), float(w.nominal.o)) for w in self.robot.wheels if w.kind.swivels]
        lengths = [float(t.length.nominal) for t in self.robot.trailers]
        self.shortest = min([*arms, *lengths], default=1.0)  # m: of castors and trailers
        self.reach = max((abs(w.pivot) for w in self.robot.wheels), default=0.0)  # m from P

        fixed = [w for w in self.robot.wheels if w.kind.fixed_axle]
        # ex, ey, x, y of the axle that control laws steer: its direction of travel and its centre [m]
        self.axle = (axle_of(fixed, nominal_view) if fixed else THROUGH_P).nominal
        driven = derivation.driven
        # the same of the axle that trailers follow
        self.leading = leading_axle(driven.robot, driven.mobility, nominal_view).nominal

    def call(self, name: str, values: Values) -> dict[str, Reals]:
        """Evaluate a function of the robot at arrays; parameters have their nominal values."""
        ports = self.derivation.formula(name).inputs
        given = [values[port.name] for port in ports if port.role is not Role.GEOMETRY]
        size = np.broadcast_shapes(*(np.shape(value) for value in values.values()))
        result = getattr(self._functions, name)(*given)
        return {key: np.broadcast_to(np.asarray(value, float), size) for key, value in result.items()}

    def rates(self, state: Reals, inputs: Reals) -> Reals:
        """Return the rates of the state space, (N, number of states)."""
        return np.asarray(self._functions.ode(state, inputs), float)

    def start(self, poses: Reals, angles: Mapping[str, float]) -> dict[str, Reals]:
        """Return the state at the start.

        Args:
            poses: x, y [m], theta [rad] of each start, (N, 3).
            angles: ``<wheel>.steer`` and ``<trailer>.theta`` [rad]. Steering angles are 0 if they are not given, and
                trailers are in line with the robot.

        Returns:
            The state: name -> (N,) values.
        """
        state = {name: poses[:, k].astype(float) for k, name in enumerate(NAMES)}
        for wheel in (*self.steered, *self.castors):
            name = f"{wheel}.steer"
            state[name] = np.full(len(poses), float(angles.get(name, 0.0)))
        behind = atan2(self.leading[1], self.leading[0])
        for trailer in self.trailers:
            name = f"{trailer}.theta"
            given = angles.get(name)
            state[name] = state["theta"] + behind if given is None else np.full(len(poses), float(given))
        return state

    def command(self, state: Values, twist: Twist) -> tuple[dict[str, Reals], Twist]:
        """Return the joints that `inverse` commands for a twist, and the twist that is driven.

        Wheels slide if the robot cannot drive the twist. It then drives what `forward` computes from the joints.
        """
        wanted = dict(zip(TWIST_NAMES, twist, strict=True))
        joints = self.call("inverse", {**state, **wanted})
        sliding = joints["slip"] > SLIDING
        if not sliding.any():
            return joints, twist
        driven = self.call("forward", {**state, **joints})
        vx, vy, omega = (np.where(sliding, driven[name], wanted[name]) for name in TWIST_NAMES)
        return joints, (vx, vy, omega)

    def moved(self, state: Values, twist: Twist, dt: Reals) -> dict[str, Reals]:
        """Return the state after a constant twist.

        Args:
            state: the state at the start of the step, with the steering angles of the twist.
            twist: the twist that is driven.
            dt: duration [s], (N,).

        Returns:
            The state at the end.
        """
        after = {**state, **self._followed(state, twist, dt)}
        driven = dict(zip(TWIST_NAMES, twist, strict=True))
        increment = self.call("odometry_increment", {**driven, "theta": state["theta"], "dt": dt})
        for name in NAMES:
            after[name] = state[name] + increment[f"{name}_step"]
        return after

    def _followed(self, state: Values, twist: Twist, dt: Reals) -> dict[str, Reals]:
        """Return the angles of castors and trailers after a constant twist, by the Runge-Kutta method of order 4."""
        angles = {name: state[name] for name in self._following()}
        if not angles:
            return {}
        vx, vy, omega = twist
        speed = np.hypot(vx, vy) + np.abs(omega) * (self.reach + self.shortest)
        count = int(min(max(1, ceil(float(np.max(speed * dt)) / (TURNED * self.shortest))), MOST_STEPS))
        h = dt / count

        def rates(time: Reals, now: Values) -> dict[str, Reals]:
            return self._rates({**state, **now, "theta": state["theta"] + omega * time}, twist)

        for k in range(count):
            time = k * h
            first = rates(time, angles)
            second = rates(time + h / 2, {name: angles[name] + h / 2 * first[name] for name in angles})
            third = rates(time + h / 2, {name: angles[name] + h / 2 * second[name] for name in angles})
            fourth = rates(time + h, {name: angles[name] + h * third[name] for name in angles})
            for name in angles:
                mean = first[name] + 2 * second[name] + 2 * third[name] + fourth[name]
                angles[name] = angles[name] + h / 6 * mean
        return angles

    def _following(self) -> list[str]:
        """Return the names of the angles that follow the motion."""
        return [*(f"{name}.steer" for name in self.castors), *(f"{name}.theta" for name in self.trailers)]

    def _rates(self, state: Values, twist: Twist) -> dict[str, Reals]:
        """Return the rates of the angles that follow the motion [rad/s]."""
        values = {**state, **dict(zip(TWIST_NAMES, twist, strict=True))}
        found = {}
        if self.castors:
            joints = self.call("inverse", values)
            found = {f"{name}.steer": joints[f"{name}.steer_rate"] for name in self.castors}
        if self._towed is not None:
            turning = self._towed(*(values[name] for name in self._ports))
            found |= {f"{name}.theta": turning[f"{name}.theta_rate"] for name in self.trailers}
        return found
