"""Steps of model predictive control with models of wmrgen, compared with models written by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import casadi as ca
import numpy as np

from examples import by_hand, car, car_acados, car_do_mpc, skid_steer, swerve, trailers
from examples.model import Model, generated
from examples.mpc import OPTIONS, Course, Drive, off_course

Loop = Callable[[Model, ca.Function], Drive]  # a problem with a model, in the loop with a plant


def table(runs: int) -> Iterator[str]:
    """Of each step the least time over ``runs`` drives, with either model in turn: their median, the ratio of their
    sums."""
    yield "| robot | solver | off the course | a step | of the time with a model typed by hand |"
    yield "|---|---|---|---|---|"
    for name, solver, model, typed, course, seconds, loop in _drives():
        pairs = [(loop(model, typed.ode), loop(typed, typed.ode)) for _ in range(runs)]
        ours, theirs = (
            np.min([drive.seconds for drive in side], axis=0) for side in zip(*pairs, strict=True)
        )
        off = 1000 * off_course(pairs[0][0].states, course, seconds)
        step, ratio = 1000 * np.median(ours), ours.sum() / theirs.sum()
        yield f"| {name} | {solver} | {off:.1f} mm | {step:.1f} ms | {ratio:.3f} |"


def _drives() -> Iterator[tuple[str, str, Model, Model, Course, float, Loop]]:
    """Robot and solver; its model, and by hand; its course and how long that takes [s]; the loop."""
    train = trailers.model()
    planned = trailers.plan(train)
    way, parked = trailers.course(planned), trailers.STEPS * trailers.DT
    cars, modules, husky = map(generated, ("ackermann_car", "wpilib_swervebot", "clearpath_a200"))
    for solver in OPTIONS:
        yield (
            "car", solver, cars, by_hand.car(cars), car.course, car.SECONDS,
            lambda m, plant, s=solver: car.run(car.problem(m, s), plant),
        )  # fmt: skip
        yield (
            "swerve", solver, modules, by_hand.swerve(modules), swerve.course, swerve.SECONDS,
            lambda m, plant, s=solver: swerve.run(swerve.problem(m, s), plant),
        )  # fmt: skip
        yield (
            "skid-steer", solver, husky, by_hand.skid_steer(husky), skid_steer.course, skid_steer.SECONDS,
            lambda m, plant, s=solver: skid_steer.run(skid_steer.problem(m, s), plant),
        )  # fmt: skip
        yield (
            "car with two trailers", solver, train, by_hand.trailers(train), way, parked,
            lambda m, plant, s=solver: trailers.run(trailers.problem(m, s), planned, plant),
        )  # fmt: skip
    yield (
        "car", "do-mpc", cars, by_hand.car(cars), car.course, car.SECONDS,
        lambda m, plant: car_do_mpc.run(car_do_mpc.problem(m), plant),
    )  # fmt: skip
    if car_acados.installed():
        yield (
            "car", "acados", cars, by_hand.car(cars), car.course, car.SECONDS,
            lambda m, plant: car_acados.run(car_acados.problem(m), plant),
        )  # fmt: skip
