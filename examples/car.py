"""A car with Ackermann steering follows a figure of eight."""

from __future__ import annotations

import casadi as ca
import numpy as np

from examples.model import Model, generated
from examples.mpc import Array, Controller, Drive, chosen_solver, controller, drive, follow, tell

WIDTH, HEIGHT, RATE = 16.0, 12.0, 0.12  # m, m, rad/s: 2.4 m/s in the middle
SECONDS = 2 * np.pi / RATE


def course(t: Array) -> Array:
    """x and y [m] at times [s]; it begins in the middle, where it is straight."""
    return np.array([WIDTH * np.sin(RATE * t), HEIGHT * np.sin(RATE * t) * np.cos(RATE * t)])


def problem(model: Model, solver: str) -> Controller:
    """Steering angles within the limits of the robot file; steering that moves little, speed that changes little."""
    spin, steer_rate = model.inputs
    return controller(model, {"x": 100, "y": 100}, {spin: 1e-3, steer_rate: 1e-2}, solver)


def run(c: Controller, plant: ca.Function, seconds: float = SECONDS) -> Drive:
    """From the middle, along the course, at its speed."""
    speed = RATE * np.hypot(WIDTH, HEIGHT)
    start = (0, 0, np.arctan2(HEIGHT, WIDTH), 0)
    return drive(follow(c, course, start, (speed / 0.3, 0)), plant, start, seconds, c.dt)


def main() -> None:
    car = generated("ackermann_car")
    tell(run(problem(car, chosen_solver(__doc__)), car.ode), course, SECONDS)


if __name__ == "__main__":
    main()
