"""A swerve drive turns on the spot and leaves along a figure of eight while it goes on turning."""

from __future__ import annotations

import casadi as ca
import numpy as np

from examples.model import ROOT, Model, generated
from examples.mpc import Array, Controller, Drive, chosen_solver, controller, drive, follow, tell

SIZE, RATE, TURN = 2.0, 0.4, 0.8  # m, rad/s of the figure, rad/s of the robot
ON_THE_SPOT = 2.0  # s
SECONDS = ON_THE_SPOT + 2 * np.pi / RATE


def course(t: Array) -> Array:
    """x, y [m] and theta [rad] at times [s]; the figure begins gently after the turn on the spot."""
    after = np.maximum(t - ON_THE_SPOT, 0)
    phase = RATE * (after - 2 * np.tanh(after / 2))
    return np.array([SIZE * np.sin(phase), SIZE * np.sin(phase) * np.cos(phase), TURN * t])


def problem(model: Model, solver: str) -> Controller:
    """The modules roll where `rolling` is 0; their angles are states, so that no motion of the robot is singular."""
    rates = {name: 1e-3 for name in model.inputs if name.endswith("_rate")}
    effort = {"vx": 1e-2, "vy": 1e-2, "omega": 1e-2, **rates}
    return controller(model, {"x": 1000, "y": 1000, "theta": 100}, effort, solver, dt=0.05)


def run(c: Controller, plant: ca.Function, seconds: float = SECONDS) -> Drive:
    """From the modules' angles for a turn on the spot, by the robot's own inverse kinematics."""
    inverse = ca.Function.load(str(ROOT / "generated/wpilib_swervebot/wpilib_swervebot_inverse.casadi"))
    turning = inverse(vx=0, vy=0, omega=TURN)
    angles = [float(turning[name]) for name in c.model.state if name.endswith(".steer")]
    start = (0, 0, 0, *angles)
    return drive(follow(c, course, start, (0, 0, TURN, 0, 0, 0, 0)), plant, start, seconds, c.dt)


def main() -> None:
    swerve = generated("wpilib_swervebot")
    tell(run(problem(swerve, chosen_solver(__doc__)), swerve.ode), course, SECONDS)


if __name__ == "__main__":
    main()
