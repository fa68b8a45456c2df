"""Model predictive control that follows a course, in CasADi's Opti: by IPOPT or by CasADi's own SQP method."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from examples.model import Model

Array = NDArray[np.float64]
Command = Callable[[int, Array], Array]  # number of the step and state to the inputs
Course = Callable[[Array], Array]  # times (N,) [s] to the states that are tracked (states, N)
OPTIONS = {
    "ipopt": {
        "expand": True, "print_time": False,
        "ipopt": {
            "print_level": 0, "sb": "yes", "tol": 1e-4, "max_iter": 50, "mu_init": 1e-5, "warm_start_init_point": "yes",
            "warm_start_bound_push": 1e-8, "warm_start_slack_bound_push": 1e-8, "warm_start_mult_bound_push": 1e-8,
        },
    },
    "sqpmethod": {
        "expand": True, "print_time": False, "print_header": False, "print_iteration": False, "print_status": False,
        "qpsol": "qrqp", "qpsol_options": {"print_iter": False, "print_header": False, "error_on_fail": False},
        "max_iter": 5, "error_on_fail": False,
    },
}  # fmt: skip


@dataclass(frozen=True)
class Controller:
    """``solve``: (state now, reference, guesses of states, inputs and multipliers) -> (states, inputs, multipliers), of
    ``steps`` steps of ``dt`` [s]."""

    model: Model
    solve: ca.Function
    steps: int
    dt: float


def controller(
    model: Model,
    track: Mapping[str, float],
    effort: Mapping[str, float],
    solver: str,
    steps: int = 15,
    dt: float = 0.1,
) -> Controller:
    """``track``: weights of squared distances of states from the reference; ``effort``: of squared changes of inputs
    from step to step, or of inputs themselves where they are rates."""
    opti = ca.Opti()
    state, inputs = list(model.state), list(model.inputs)
    x, u = opti.variable(len(state), steps + 1), opti.variable(len(inputs), steps)
    now, reference = opti.parameter(len(state)), opti.parameter(len(track), steps + 1)
    advance, p = rk4(model.ode, dt), list(model.p)

    opti.subject_to(x[:, 0] == now)
    for k in range(steps):
        opti.subject_to(x[:, k + 1] == advance(x[:, k], u[:, k], p))
        if model.rolling and k:  # at 0 the wheels are where they are
            opti.subject_to(model.rolling(x[:, k], u[:, k], p) == 0)
    for row, (low, high) in [(x[i, 1:], b) for i, b in enumerate(model.state.values())] + [
        (u[i, :], b) for i, b in enumerate(model.inputs.values())
    ]:
        if np.isfinite([low, high]).any():
            opti.subject_to(opti.bounded(low, row, high))

    cost = 0
    for i, (name, weight) in enumerate(track.items()):
        cost += weight * ca.sumsqr(x[state.index(name), 1:] - reference[i, 1:])
    for name, weight in effort.items():
        row = u[inputs.index(name), :]
        cost += weight * ca.sumsqr(row if name.endswith("_rate") else ca.diff(row, 1, 1))
    opti.minimize(cost)
    opti.solver(solver, OPTIONS[solver])
    solve = opti.to_function("solve", [now, reference, x, u, opti.lam_g], [x, u, opti.lam_g])
    return Controller(model, solve, steps, dt)


def rk4(ode: ca.Function, dt: float) -> ca.Function:
    """The step (x, u, p) -> x after ``dt`` [s] under constant inputs."""
    x, u, p = (ca.SX.sym(name, ode.size1_in(i)) for i, name in enumerate("xup"))
    a = ode(x, u, p)
    b = ode(x + dt / 2 * a, u, p)
    c = ode(x + dt / 2 * b, u, p)
    d = ode(x + dt * c, u, p)
    return ca.Function("rk4", [x, u, p], [x + dt / 6 * (a + 2 * b + 2 * c + d)])


def follow(c: Controller, course: Course, start: Sequence[float], inputs: Sequence[float]) -> Command:
    """The controller on a course that begins at ``start`` with about these inputs; each step starts from the solution
    of the one before."""
    x, u = (np.tile(np.array(v, float)[:, None], n) for v, n in ((start, c.steps + 1), (inputs, c.steps)))
    duals = np.zeros(c.solve.size1_in(4))

    def command(k: int, now: Array) -> Array:
        nonlocal x, u, duals
        reference = course((k + np.arange(c.steps + 1)) * c.dt)
        solution = c.solve(now, reference, *(np.hstack((v[:, 1:], v[:, -1:])) for v in (x, u)), duals)
        x, u, duals = (part.full() for part in solution)
        return u[:, 0]

    return command


@dataclass(frozen=True)
class Drive:
    """``states`` (states, N) of the robot, ten a step; ``seconds`` that each step of the controller took."""

    states: Array
    seconds: Array


def drive(
    command: Command, plant: ca.Function, start: Sequence[float], seconds: float, dt: float = 0.1
) -> Drive:
    """A controller of steps of ``dt`` [s] in the loop with ``plant``, (x, u, p) -> xdot of a robot without p."""
    substep, now = rk4(plant, dt / 10), np.array(start, float)
    states, took = [now], []
    for k in range(round(seconds / dt)):
        began = perf_counter()
        u = command(k, now)
        took.append(perf_counter() - began)
        for _ in range(10):
            now = substep(now, u, []).full()[:, 0]
            states.append(now)
    return Drive(np.array(states).T, np.array(took))


def off_course(states: Array, course: Course, seconds: float) -> float:
    """The largest distance [m] of x and y, the first two rows, from the curve that x and y of the course are."""
    curve = course(np.linspace(0, seconds, 4_000))[:2]
    starts, edges = curve[:, :-1], np.diff(curve)
    squares = np.maximum((edges**2).sum(axis=0), 1e-30)
    distances = []
    for point in states[:2].T:
        along = np.clip(((point[:, None] - starts) * edges).sum(axis=0) / squares, 0, 1)
        distances.append(np.hypot(*(starts + along * edges - point[:, None])).min())
    return float(max(distances))


def chosen_solver(description: str | None) -> str:
    """What the command line says of the solver."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--solver", choices=OPTIONS, default="ipopt")
    return str(parser.parse_args().solver)


def tell(done: Drive, course: Course, seconds: float) -> None:
    """Print how well a robot kept to its course, and how long a step took."""
    print(f"{1000 * off_course(done.states, course, seconds):.2f} mm off the course at most")
    print(f"{1000 * np.median(done.seconds):.2f} ms a step")
