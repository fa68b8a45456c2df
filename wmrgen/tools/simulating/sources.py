"""The sources of commands of a simulated drive: segments, a control law that goes to a goal, and a recorded table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wmrgen.functions.motion.segments import Phase
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.tools.simulating.drive import Moment, Order, steps_of
from wmrgen.tools.simulating.limits import Limiter
from wmrgen.tools.simulating.model import Model, Reals, Twist, Values
from wmrgen.tools.simulating.table import Table

Booleans = NDArray[np.bool_]

NEAR = 1e-3  # m: a goal that is nearer than this is reached
ALIGNED = 0.01  # rad, half a degree: the heading at the goal is reached
_INSTANT = 1e-12  # s: shorter phases take no time


class Segments:
    """The phases of `functions.motion.segments.plan`, cut into steps of equal length."""

    def __init__(self, phases: Sequence[Phase], step: float) -> None:
        """Take phases, and the longest step [s]."""
        self._steps: list[tuple[Phase, float, int]] = []  # phase, duration of a step [s], and its number
        steps_of(sum(float(phase.dt) for phase in phases), step)
        for phase in phases:
            seconds = float(phase.dt)
            if seconds > _INSTANT:
                count = steps_of(seconds, step)
                self._steps += [(phase, seconds / count, k) for k in range(count)]
        self._steps.reverse()

    def order(self, now: Moment) -> Order | None:
        """Return the next step of the present phase."""
        if not self._steps:
            return None
        phase, dt, number = self._steps.pop()
        size, state = now.starts, now.state
        vx, vy, omega = (np.full(size, float(value)) for value in phase.twist)
        joints = {f"{name}.spin": np.full(size, float(value)) for name, value in phase.spins.items()}
        if phase.action != "steer":
            return Order((vx, vy, omega), np.full(size, dt), joints=joints)
        remaining = float(phase.dt) - number * dt
        swings = {}
        for wheel, angle in phase.steers.items():
            swings[f"{wheel}.steer"] = (float(angle) - state[f"{wheel}.steer"]) / remaining
        held = {f"{wheel}.steer": state[f"{wheel}.steer"] for wheel in phase.steers}
        return Order((vx, vy, omega), np.full(size, dt), joints=joints | held, swings=swings)


class _ToGoal:
    """A control law that is evaluated once in a step, until all starts have arrived or the time is over."""

    def __init__(self, step: float, time: float) -> None:
        """Take the step [s], and the time [s] after which the robot gives up."""
        self._step, self._time = step, time
        steps_of(time, step)
        self.arrived: Reals | None = None  # [s], nan before
        self._limiter: Limiter | None = None  # of the robot, once it drives

    @property
    def limited_by(self) -> tuple[str, ...]:
        """Return the functions that reduced commands of the law; none if all were inside the limits."""
        return self._limiter.functions if self._limiter and self._limiter.acted else ()

    def _law(self, now: Moment) -> tuple[Twist, Booleans, Reals]:
        """Return the twist of the law, which starts are at the goal, and the distance of each to the end [m].

        The last step ends after this distance.
        """
        raise NotImplementedError

    def order(self, now: Moment) -> Order | None:
        """Return the twist of the law; a start that has reached the goal stands still."""
        if self.arrived is None:
            self.arrived = np.full(now.starts, np.nan)
        self._limiter = self._limiter or Limiter(now.model)
        twist, there, distance = self._law(now)
        self.arrived = np.where(np.isnan(self.arrived) & there, now.t, self.arrived)
        moving = np.isnan(self.arrived)
        time = float(now.t.max())
        if not moving.any() or time >= self._time - _INSTANT:
            return None
        vx, vy, omega = (np.where(moving, v, 0.0) for v in self._limiter.limited(now.state, twist))
        _, _, qx, qy = now.model.axle
        speed = np.hypot(vx - omega * qy, vy + omega * qx)  # of the axle centre
        longest = min(self._step, self._time - time)
        with np.errstate(divide="ignore"):  # a robot that does not move takes the whole step
            seconds = np.minimum(longest, distance / speed)
        return Order((vx, vy, omega), np.where(moving, seconds, longest))


class GoToPose(_ToGoal):
    """The polar feedback law `goto_pose` (Siegwart (3.56)-(3.58))."""

    def __init__(self, goal: tuple[float, float, float], step: float, time: float) -> None:
        """Take the goal (x, y [m], theta [rad]), the step [s], and the time [s] after which the robot gives up."""
        super().__init__(step, time)
        self._goal = goal
        self._direction: Reals | None = None

    def _law(self, now: Moment) -> tuple[Twist, Booleans, Reals]:
        if self._direction is None:
            self._direction = np.zeros(now.starts)
        x, y, theta = self._goal
        c, s = np.cos(theta), np.sin(theta)
        dx, dy, turned = now.state["x"] - x, now.state["y"] - y, now.state["theta"] - theta
        pose = {"x": c * dx + s * dy, "y": c * dy - s * dx, "theta": turned}
        found = now.model.call("goto_pose", {**now.state, **pose, "direction": self._direction})
        self._direction = found["direction"]
        error = np.abs(np.arctan2(np.sin(turned), np.cos(turned)))
        there = (found["rho"] < NEAR) & (error < ALIGNED)
        return _of_axle(now.model, found["v"], found["omega"]), there, np.full(now.starts, np.inf)


class Pursue(_ToGoal):
    """The law `pursuit` (Tzafestas (2.57)) towards a fixed point: a circle that is tangent to the heading."""

    def __init__(self, goal: tuple[float, float], speed: float, step: float, time: float) -> None:
        """Take the goal (x, y) [m], the speed [m/s], the step [s] and the time [s] after which the robot gives up."""
        super().__init__(step, time)
        self._goal, self._speed = goal, speed

    def _law(self, now: Moment) -> tuple[Twist, Booleans, Reals]:
        c, s = np.cos(now.state["theta"]), np.sin(now.state["theta"])
        dx, dy = self._goal[0] - now.state["x"], self._goal[1] - now.state["y"]
        ahead = {"goal_x": c * dx + s * dy, "goal_y": c * dy - s * dx, "v": np.full(now.starts, self._speed)}
        found = now.model.call("pursuit", {**now.state, **ahead})
        _, _, qx, qy = now.model.axle
        distance = np.hypot(ahead["goal_x"] - qx, ahead["goal_y"] - qy)  # of the axle centre
        return _of_axle(now.model, ahead["v"], found["omega"]), distance < NEAR, np.maximum(distance, NEAR)


def _of_axle(model: Model, v: Reals, omega: Reals) -> Twist:
    """Return the twist of P for the speed v of the axle centre and the yaw rate: v e - omega z x Q."""
    ex, ey, qx, qy = model.axle
    return v * ex + omega * qy, v * ey - omega * qx, omega


class Recorded:
    """The commands of a table. A row holds until the time of the next row; the last row ends the drive."""

    def __init__(self, table: Table, step: float) -> None:
        """Take the commands, and the longest step [s]."""
        self._table = table
        self._steps: list[tuple[int, float]] = []  # row, and duration of a step [s]
        steps_of(float(table.t[-1]), step)
        for row, seconds in enumerate(np.diff(table.t)):
            count = steps_of(float(seconds), step)
            self._steps += [(row, float(seconds) / count)] * count
        self._steps.reverse()
        self._x: Reals | None = None  # state of the model, for commands in its inputs

    def order(self, now: Moment) -> Order | None:
        """Return the next step of the present row."""
        if not self._steps:
            return None
        row, seconds = self._steps.pop()
        size, model, state = now.starts, now.model, now.state
        dt = np.full(size, seconds)
        values = {name: np.full(size, column[row]) for name, column in self._table.columns.items()}
        if self._table.kind == "twist":
            vx, vy, omega = (values.get(name, np.zeros(size)) for name in TWIST_NAMES)
            return Order((vx, vy, omega), dt)
        if self._table.kind == "joints":
            found = model.call("forward", {**state, **values})
            return Order(
                (found["vx"], found["vy"], found["omega"]), dt, joints={**values, "slip": found["slip"]}
            )
        return self._of_inputs(model, state, values, dt)

    def _of_inputs(self, model: Model, state: Values, values: Values, dt: Reals) -> Order:
        """Return the step of the state space (`ode`), by the Runge-Kutta method of order 4.

        The driven twist is the constant one that leads to the same pose.
        """
        space = model.derivation.default_state_space
        if space is None:
            raise TypeError(f"{model.robot.name} has no state space")  # `read_table` has checked it
        names = [port.name for port in space.state]
        u = np.stack([values[port.name] for port in space.inputs], axis=-1)
        if self._x is None:
            zero = np.zeros(len(dt))
            self._x = np.stack([state.get(name, zero) for name in names], axis=-1)
        x, h = self._x, dt[:, None]
        first = model.rates(x, u)
        second = model.rates(x + h / 2 * first, u)
        third = model.rates(x + h / 2 * second, u)
        fourth = model.rates(x + h * third, u)
        self._x = x + h / 6 * (first + 2 * second + 2 * third + fourth)
        after = {name: self._x[:, k] for k, name in enumerate(names) if name in state}
        driven = _constant(self._x[:, :3] - x[:, :3], x[:, 2], dt)
        return Order(_in_body(first, x[:, 2]), dt, driven=driven, after=after)


def _in_body(rates: Reals, theta: Reals) -> Twist:
    """Return the twist in the robot frame of the rates of x, y and theta."""
    c, s = np.cos(theta), np.sin(theta)
    return c * rates[:, 0] + s * rates[:, 1], c * rates[:, 1] - s * rates[:, 0], rates[:, 2]


def _constant(change: Reals, theta: Reals, dt: Reals) -> Twist:
    """Return the constant twist that changes the pose by x, y, theta in dt, from the heading theta."""
    vx, vy, omega = _in_body(change / dt[:, None], theta + change[:, 2] / 2)
    chord = np.sinc(change[:, 2] / (2 * np.pi))  # of an arc, by its length
    return vx / chord, vy / chord, omega
