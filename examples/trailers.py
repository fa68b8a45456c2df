"""A car with two trailers backs into a parking space: the way there is planned once, then followed."""

from __future__ import annotations

import casadi as ca
import numpy as np

import wmrgen
from examples.model import ROOT, Model
from examples.mpc import Array, Controller, Course, Drive, chosen_solver, controller, drive, follow, rk4, tell

START = (14.0, 2.5, 0, 0, 0, 0)  # x y theta front.steer trailer1.theta trailer2.theta; it ends at the origin
STEPS, DT = 200, 0.1  # s
FOLD = 1.2  # rad: the largest angle between a trailer and what pulls it


def model() -> Model:
    """Trailers are no part of the default model: the form is named, and the bounds are those of the manoeuvre."""
    ode = wmrgen.derive(wmrgen.load(ROOT / "robots/car_with_trailers.yaml")).state_space("trailer")
    free = (-np.inf, np.inf)
    body = {"x": free, "y": free, "theta": free, "front.steer": (-0.6, 0.6)}
    trailers = {"trailer1.theta": free, "trailer2.theta": free}
    return Model(ode, body | trailers, {"rear.speed": (-1.0, 0.1), "front.steer_rate": (-1.0, 1.0)})


def plan(m: Model) -> Array:
    """States (6, steps + 1) of a way back to the origin that begins and ends at rest, with little steering."""
    opti = ca.Opti()
    x, u = opti.variable(6, STEPS + 1), opti.variable(2, STEPS)
    advance, steer, (speed, rate) = rk4(m.ode, DT), x[3, :], (u[0, :], u[1, :])
    opti.subject_to([x[:, k + 1] == advance(x[:, k], u[:, k], []) for k in range(STEPS)])
    opti.subject_to([x[:, 0] == START, x[:, -1] == 0, speed[0] == 0, speed[-1] == 0])
    opti.subject_to(
        [opti.bounded(-FOLD, x[2, :] - x[4, :], FOLD), opti.bounded(-FOLD, x[4, :] - x[5, :], FOLD)]
    )
    for row, (low, high) in (
        (steer, m.state["front.steer"]),
        *zip((speed, rate), m.inputs.values(), strict=True),
    ):
        opti.subject_to(opti.bounded(low, row, high))
    opti.minimize(ca.sumsqr(rate) + ca.sumsqr(steer) + 100 * ca.sumsqr(ca.diff(speed, 1, 1)))
    opti.set_initial(x, np.linspace(START, np.zeros(6), STEPS + 1).T)
    opti.solver("ipopt", {"expand": True, "print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}})
    solution: Array = opti.solve().value(x)
    return solution


def course(planned: Array) -> Course:
    """The plan as states but for steering, at times [s]; it ends where it ends."""
    times = np.arange(STEPS + 1) * DT
    return lambda t: np.array([np.interp(t, times, row) for row in np.delete(planned, 3, axis=0)])


def problem(m: Model, solver: str) -> Controller:
    """The angles of the trailers count: backwards they would fold by themselves."""
    track = {"x": 100, "y": 100, "theta": 100, "trailer1.theta": 100, "trailer2.theta": 100}
    return controller(m, track, {"rear.speed": 1e-2, "front.steer_rate": 1e-3}, solver, dt=DT)


def run(c: Controller, planned: Array, plant: ca.Function) -> Drive:
    """From the start to rest, and half a second more."""
    return drive(follow(c, course(planned), START, (0, 0)), plant, START, STEPS * DT + 0.5, DT)


def last_axle(states: Array) -> Array:
    """x and y [m] of the last trailer's axle, 1.1 m and 0.9 m behind the ones in front."""
    x, y, _, _, first, second = states
    return np.array(
        [x - 1.1 * np.cos(first) - 0.9 * np.cos(second), y - 1.1 * np.sin(first) - 0.9 * np.sin(second)]
    )


def main() -> None:
    solver, train = chosen_solver(__doc__), model()
    planned = plan(train)
    done = run(problem(train, solver), planned, train.ode)
    tell(done, course(planned), STEPS * DT)
    away = np.hypot(*(last_axle(done.states)[:, -1] + (2, 0)))
    print(f"{1000 * away:.2f} mm between the last axle and its place")


if __name__ == "__main__":
    main()
