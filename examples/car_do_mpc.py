"""The car of `examples.car` on the same course, by do-mpc."""

from __future__ import annotations

import warnings

import casadi as ca
import numpy as np

from examples.car import HEIGHT, RATE, SECONDS, WIDTH, course
from examples.model import Model, generated
from examples.mpc import OPTIONS, Array, Drive, drive, rk4, tell

with warnings.catch_warnings():  # of features that are not installed
    warnings.simplefilter("ignore")
    import do_mpc

STEPS, DT = 15, 0.1  # s


def problem(model: Model) -> do_mpc.controller.MPC:
    """The same weights and bounds; the reference is a parameter that changes with time."""
    m = do_mpc.model.Model("discrete", "SX")
    x, u = m.set_variable("_x", "x", (len(model.state), 1)), m.set_variable("_u", "u", (len(model.inputs), 1))
    reference = m.set_variable("_tvp", "reference", (2, 1))
    m.set_rhs("x", rk4(model.ode, DT)(x, u, list(model.p)))
    m.setup()

    mpc = do_mpc.controller.MPC(m)
    mpc.settings.n_horizon, mpc.settings.t_step = STEPS, DT
    mpc.settings.store_full_solution = False
    mpc.settings.nlpsol_opts = OPTIONS["ipopt"]
    off = 100 * ca.sumsqr(x[:2] - reference)
    mpc.set_objective(mterm=off, lterm=off + 1e-2 * u[1] ** 2)
    mpc.set_rterm(u=np.array([1e-3, 0]))
    for kind, bounds in (("x", model.state), ("u", model.inputs)):
        mpc.bounds["lower", f"_{kind}", kind], mpc.bounds["upper", f"_{kind}", kind] = zip(
            *bounds.values(), strict=True
        )
    template = mpc.get_tvp_template()

    def ahead(now: float) -> object:
        template["_tvp", :, "reference"] = list(course(now + np.arange(STEPS + 1) * DT).T)
        return template

    mpc.set_tvp_fun(ahead)
    mpc.setup()
    return mpc


def run(mpc: do_mpc.controller.MPC, plant: ca.Function, seconds: float = SECONDS) -> Drive:
    """From the middle, along the course, at its speed."""
    start = np.array((0, 0, np.arctan2(HEIGHT, WIDTH), 0))
    mpc.x0, mpc.u0 = start, np.array((RATE * np.hypot(WIDTH, HEIGHT) / 0.3, 0))
    mpc.set_initial_guess()

    def command(_: int, now: Array) -> Array:
        inputs: Array = mpc.make_step(now)[:, 0]
        return inputs

    return drive(command, plant, start, seconds, DT)


def main() -> None:
    car = generated("ackermann_car")
    tell(run(problem(car), car.ode), course, SECONDS)


if __name__ == "__main__":
    main()
