"""The examples keep to their courses, driving models that are typed by hand; those are what the robots' files say."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from examples import by_hand, car, car_acados, skid_steer, swerve, trailers
from examples.model import Model, generated
from examples.mpc import OPTIONS, off_course, rk4

MOST = 0.005  # m off the course
SOLVERS = pytest.mark.parametrize("solver", OPTIONS)
MODELS: dict[str, tuple[Callable[[], Model], Callable[[Model], Model]]] = {
    "car": (lambda: generated("ackermann_car"), by_hand.car),
    "swerve": (lambda: generated("wpilib_swervebot"), by_hand.swerve),
    "skid_steer": (lambda: generated("clearpath_a200"), by_hand.skid_steer),
    "trailers": (trailers.model, by_hand.trailers),
}


def model(name: str) -> tuple[Model, ca.Function]:
    """The model of an example, and the plant: the same by hand."""
    read, typed = MODELS[name]
    ours = read()
    return ours, typed(ours).ode


@pytest.mark.parametrize("name", MODELS)
def test_the_model_is_what_one_types_by_hand(name: str) -> None:
    read, typed = MODELS[name]
    ours = read()
    theirs, random = typed(ours), np.random.default_rng(5)
    for _ in range(20):
        x, u = random.uniform(-0.7, 0.7, len(ours.state)), random.uniform(-2, 2, len(ours.inputs))
        for a, b in ((ours.ode, theirs.ode), (ours.rolling, theirs.rolling)):
            assert (a is None) == (b is None)
            if a is not None and b is not None:
                np.testing.assert_allclose(a(x, u, ours.p), b(x, u, ours.p), rtol=1e-12, atol=1e-12)


def operations(m: Model) -> int:
    """Of a step of a model with its first and second derivatives, as a solver evaluates them."""
    x, u, weights = (
        ca.SX.sym(name, n) for name, n in (("x", len(m.state)), ("u", len(m.inputs)), ("w", len(m.state)))
    )
    both, after = ca.vertcat(x, u), rk4(m.ode, 0.1)(x, u, list(m.p))
    second = ca.triu(ca.hessian(ca.dot(weights, after), both)[0])
    return int(
        ca.Function("all", [both, weights], [after, ca.jacobian(after, both), second]).n_instructions()
    )


@pytest.mark.parametrize("name", MODELS)
def test_a_solver_computes_no_more_with_it(name: str) -> None:
    read, typed = MODELS[name]
    ours = read()
    assert operations(ours) <= 1.05 * operations(typed(ours))


def test_the_car_begins_well() -> None:
    ours, plant = model("car")
    done = car.run(car.problem(ours, "sqpmethod"), plant, 3)
    assert off_course(done.states, car.course, car.SECONDS) < MOST
    assert np.hypot(*(done.states[:2, -1] - car.course(np.array(3.0)))) < 0.05  # m, and not late


@pytest.mark.slow
@SOLVERS
@pytest.mark.parametrize(("name", "example"), [("car", car), ("skid_steer", skid_steer)])
def test_a_robot_keeps_to_its_course(name: str, example: Any, solver: str) -> None:
    """And its states within their bounds."""
    ours, plant = model(name)
    done = example.run(example.problem(ours, solver), plant)
    assert off_course(done.states, example.course, example.SECONDS) < MOST
    for row, (low, high) in zip(done.states, ours.state.values(), strict=True):
        assert (row > low).all() and (row < high).all()


@pytest.mark.slow
@SOLVERS
def test_the_swerve_drive_turns_on_the_spot_and_leaves(solver: str) -> None:
    ours, plant = model("swerve")
    c = swerve.problem(ours, solver)
    done = swerve.run(c, plant)
    assert off_course(done.states, swerve.course, swerve.SECONDS) < MOST
    times = np.arange(done.states.shape[1]) * c.dt / 10
    assert np.abs(done.states[2] - swerve.TURN * times).max() < 0.02  # rad
    still = done.states[:2, times < swerve.ON_THE_SPOT]
    assert np.abs(still).max() < MOST  # m: it does not orbit


@pytest.mark.slow
@SOLVERS
def test_the_trailers_are_parked(solver: str) -> None:
    """The car keeps to the plan, and so does the axle of the last trailer, which ends 2 m behind the car."""
    ours, plant = model("trailers")
    planned = trailers.plan(ours)
    done = trailers.run(trailers.problem(ours, solver), planned, plant)
    axle, wanted = trailers.last_axle(done.states), trailers.last_axle(planned)
    times = np.arange(trailers.STEPS + 1) * trailers.DT
    for states, course in (
        (done.states, trailers.course(planned)),
        (axle, lambda t: np.array([np.interp(t, times, row) for row in wanted])),
    ):
        assert off_course(states, course, trailers.STEPS * trailers.DT) < MOST
    assert np.hypot(*(axle[:, -1] + (2, 0))) < MOST
    assert np.abs(done.states[[2, 4, 5], -1]).max() < 0.01  # rad: car and trailers stand straight


@pytest.mark.slow
def test_do_mpc_keeps_to_the_course() -> None:
    from examples import car_do_mpc

    ours, plant = model("car")
    done = car_do_mpc.run(car_do_mpc.problem(ours), plant)
    assert off_course(done.states, car.course, car.SECONDS) < MOST


def test_what_acados_is_given_has_its_form() -> None:
    """Columns of symbols; rates of them alone, explicitly and implicitly the same (docs.acados.org, AcadosModel)."""
    ours, _ = model("car")
    given = car_acados.expressions(ours)
    x, xdot, u, p = (given[name] for name in ("x", "xdot", "u", "p"))
    assert all(v.is_column() and v.is_valid_input() for v in (x, xdot, u))
    assert x.shape == xdot.shape == given["f_expl_expr"].shape == given["f_impl_expr"].shape == (4, 1)
    assert (given["x_labels"], given["u_labels"]) == (list(ours.state), list(ours.inputs))
    assert given["name"].isidentifier()
    both = ca.Function("both", [x, xdot, u, p], [given["f_expl_expr"], given["f_impl_expr"]])
    at = ([0.1, 0.2, 0.3, 0.4], [0.0] * 4, [2.0, -0.1], [])
    explicit, implicit = (v.full() for v in both(*at))
    np.testing.assert_array_equal(explicit, ours.ode(at[0], at[2], []).full())
    np.testing.assert_array_equal(implicit, -explicit)


@pytest.mark.skipif(not car_acados.installed(), reason="acados is built from source")
def test_acados_keeps_to_the_course() -> None:
    ours, plant = model("car")
    done = car_acados.run(car_acados.problem(ours), plant)
    assert off_course(done.states, car.course, car.SECONDS) < MOST


@pytest.mark.slow
@pytest.mark.parametrize("example", [car, skid_steer, swerve, trailers])
def test_the_program_says_how_well_it_drives(
    example: Any, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["example", "--solver", "sqpmethod"])
    example.main()
    assert " mm off the " in capsys.readouterr().out
