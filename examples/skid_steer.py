"""A skid-steer robot follows a figure of eight. Its model takes the twist, whatever the wheels slip."""

from __future__ import annotations

import casadi as ca
import numpy as np

from examples.model import Model, generated
from examples.mpc import Array, Controller, Drive, chosen_solver, controller, drive, follow, tell

SIZE, RATE = 2.5, 0.2  # m, rad/s: 0.7 m/s in the middle
SECONDS = 2 * np.pi / RATE


def course(t: Array) -> Array:
    """x and y [m] at times [s]."""
    return np.array([SIZE * np.sin(RATE * t), SIZE * np.sin(RATE * t) * np.cos(RATE * t)])


def problem(model: Model, solver: str) -> Controller:
    """The twist keeps the limits of the robot file and changes little."""
    return controller(model, {"x": 100, "y": 100}, {"vx": 1e-2, "omega": 1e-2}, solver)


def run(c: Controller, plant: ca.Function, seconds: float = SECONDS) -> Drive:
    """From the middle, along the course, at its speed."""
    start = (0, 0, np.pi / 4)
    return drive(follow(c, course, start, (np.sqrt(2) * SIZE * RATE, 0)), plant, start, seconds, c.dt)


def main() -> None:
    robot = generated("clearpath_a200")
    tell(run(problem(robot, chosen_solver(__doc__)), robot.ode), course, SECONDS)


if __name__ == "__main__":
    main()
