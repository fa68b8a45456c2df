"""The car of `examples.car` on the same course, by acados, which is installed from source (https://docs.acados.org).

Without it ``python -m examples.car_acados`` prints what acados would be given.
"""

from __future__ import annotations

from importlib.util import find_spec
from tempfile import mkdtemp
from typing import Any

import casadi as ca
import numpy as np

from examples.car import HEIGHT, RATE, SECONDS, WIDTH, course
from examples.model import Model, generated
from examples.mpc import Array, Drive, drive, tell

STEPS, DT = 15, 0.1  # s
SPEED = RATE * np.hypot(WIDTH, HEIGHT) / 0.3  # rad/s of the wheels


def installed() -> bool:
    """Whether acados is there."""
    return find_spec("acados_template") is not None


def expressions(model: Model) -> dict[str, Any]:
    """What an AcadosModel holds: symbols, and the rates explicitly and as f(x', x, u) = 0."""
    x, u, p = (ca.SX.sym(name, model.ode.size1_in(name)) for name in "xup")
    xdot, rates = ca.SX.sym("xdot", x.numel()), model.ode(x, u, p)
    return {
        "name": model.ode.name(), "x": x, "xdot": xdot, "u": u, "p": p,
        "f_expl_expr": rates, "f_impl_expr": xdot - rates,
        "x_labels": list(model.state), "u_labels": list(model.inputs),
    }  # fmt: skip


def problem(model: Model) -> Any:
    """The AcadosOcp: the place, the speed of the wheels and the steering rate by least squares, one SQP step a time."""
    from acados_template import AcadosOcp

    ocp = AcadosOcp()
    for name, value in expressions(model).items():
        setattr(ocp.model, name, value)
    ocp.parameter_values = np.array(model.p)
    x, u = ocp.model.x, ocp.model.u
    ocp.cost.cost_type = ocp.cost.cost_type_e = "NONLINEAR_LS"
    ocp.model.cost_y_expr, ocp.cost.W, ocp.cost.yref = (
        ca.vertcat(x[:2], u),
        np.diag((100, 100, 1e-3, 1e-2)),
        np.zeros(4),
    )
    ocp.model.cost_y_expr_e, ocp.cost.W_e, ocp.cost.yref_e = x[:2], np.diag((100, 100)), np.zeros(2)
    low, high = np.array(list(model.state.values())).T
    ocp.constraints.idxbx = np.flatnonzero(np.isfinite(low))
    ocp.constraints.lbx, ocp.constraints.ubx = low[np.isfinite(low)], high[np.isfinite(low)]
    ocp.constraints.x0 = np.zeros(len(low))
    options = ocp.solver_options
    options.N_horizon, options.tf = STEPS, STEPS * DT
    options.qp_solver, options.nlp_solver_type = "PARTIAL_CONDENSING_HPIPM", "SQP_RTI"
    options.integrator_type, options.hessian_approx = "ERK", "GAUSS_NEWTON"
    return ocp


def run(ocp: Any, plant: ca.Function, seconds: float = SECONDS) -> Drive:
    """From the middle, along the course, at its speed."""
    from acados_template import AcadosOcpSolver

    ocp.code_gen_options.code_export_directory = mkdtemp()
    solver = AcadosOcpSolver(ocp, verbose=False)
    start = (0, 0, np.arctan2(HEIGHT, WIDTH), 0)
    for k in range(STEPS + 1):
        solver.set(k, "x", np.array(start))

    def command(k: int, now: Array) -> Array:
        for i, place in enumerate(course((k + np.arange(STEPS + 1)) * DT).T):
            solver.cost_set(i, "yref", np.array((*place, SPEED, 0)) if i < STEPS else place)
        inputs: Array = solver.solve_for_x0(np.array(now))
        return inputs

    return drive(command, plant, start, seconds, DT)


def main() -> None:
    car = generated("ackermann_car")
    if not installed():
        print(*(f"{name} = {value}" for name, value in expressions(car).items()), sep="\n")
        return
    tell(run(problem(car), car.ode), course, SECONDS)


if __name__ == "__main__":
    main()
