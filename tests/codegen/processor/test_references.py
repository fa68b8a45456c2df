"""The hand-written references compute the same as wmrgen's functions, compared with the interpreter in double
precision.

Compiled and run with packages from PyPI alone, with libm's functions answered by the host and with polynomials.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

from benchmarks.emulator.fleet import Fleet, answers
from benchmarks.emulator.zig import FLAGS
from benchmarks.jobs import JOBS, Job, derivations, outputs
from benchmarks.processor import inputs as every_input
from benchmarks.processor import references
from wmrgen.codegen.unit import Step
from wmrgen.ir.calls import nominal
from wmrgen.ir.interpret import FLOAT32, FLOAT64, evaluate_module

FLAGS_OF = {"libm": (), "inline": ("-DREFERENCE_INLINE",)}
KINDS = ["inline", pytest.param("libm", marks=pytest.mark.slow)]


@cache
def _built(folder: Path, kind: str) -> Fleet:
    modules = [derivation.c_module for derivation in derivations().values()]
    extra = list(references(folder, {module.name for module in modules}))
    return Fleet.build(
        folder,
        modules,
        {"atanf": math.atan, **answers(FLOAT32)},
        flags=(*FLAGS, *FLAGS_OF[kind]),
        extra=extra,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("references")


def inputs(fleet: Fleet, step: Step) -> list[dict[str, float]]:
    """Return every third of the inputs of the measurement."""
    module = next(m for m in fleet.modules if step.name.startswith(f"{m.name}_"))
    return list(every_input(fleet.inputs(step), nominal(module), step.name))[::3]


def motion(values: Mapping[str, float]) -> dict[str, float]:
    """``values`` with the velocity of each steered wheel in place of its speed and angle: both branches drive it so.

    A wheel that rolls freely has twice its angle, which is the same on both branches.
    """
    found = dict(values)
    for name in [n.removesuffix(".steer") for n in values if n.endswith(".steer")]:
        driven, angle = f"{name}.spin" in found, found.pop(f"{name}.steer")
        speed, angle = (found.pop(f"{name}.spin"), angle) if driven else (1.0, 2 * angle)
        found |= {f"{name}.x": speed * math.cos(angle), f"{name}.y": speed * math.sin(angle)}
    return found


def rolls(case: Mapping[str, float]) -> bool:
    """Return whether both front wheels of the car reach their direction within 40 degrees."""
    return all(
        abs(2.5 * case["omega"]) < math.tan(math.radians(40)) * abs(case["vx"] + side * case["omega"])
        for side in (0.75, -0.75)
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("job", JOBS, ids=lambda job: f"{job.robot}-{job.function}")
def test_a_reference_does_the_same_job(job: Job, kind: str, folder: Path) -> None:
    fleet = _built(folder, kind)
    module = derivations()[job.robot].c_module
    step = next(s for s in fleet.steps(job.robot) if s.name == f"{job.robot}_{job.function}")
    for case in inputs(fleet, step):
        if "limited" in job.reference and not rolls(case):
            continue
        _, found = fleet.call(step, case, name=job.reference)
        every = evaluate_module(module, job.function, case, FLOAT64)
        wanted = {name: every[name] for name in outputs(job)}
        size = max(1.0, *(abs(value) for value in wanted.values()))
        got = motion({name: found[name] for name in wanted})
        for name, value in motion(wanted).items():
            assert abs(got[name] - value) <= 3e-6 * size, (name, case)
        if "nearest" in job.reference:
            assert all(abs(found[n] - case[n]) <= math.pi / 2 + 1e-6 for n in wanted if n.endswith(".steer"))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("job", [j for j in JOBS if j.simpler], ids=lambda job: job.simpler)
def test_simpler_code_steers_along_the_velocity(job: Job, kind: str, folder: Path) -> None:
    """If no limit applies, each wheel has the same velocity."""
    fleet = _built(folder, kind)
    module = derivations()[job.robot].c_module
    step = next(s for s in fleet.steps(job.robot) if s.name == f"{job.robot}_{job.function}")
    compared = 0
    for case in inputs(fleet, step):
        if "ackermann" in job.robot and not rolls(case):
            continue
        _, found = fleet.call(step, case, name=job.simpler)
        every = evaluate_module(module, job.function, case, FLOAT64)
        wanted = motion({name: every[name] for name in outputs(job)})
        for name, value in motion({name: found[name] for name in outputs(job)}).items():
            assert abs(wanted[name] - value) <= 1e-4, (name, case)
        compared += 1
    assert compared > 3


@pytest.mark.parametrize("kind", KINDS)
def test_at_its_limit_the_car_slides_least(kind: str, folder: Path) -> None:
    job = next(j for j in JOBS if "limited" in j.reference)
    fleet = _built(folder, kind)
    step = next(s for s in fleet.steps(job.robot) if s.name == f"{job.robot}_{job.function}")
    grid = [math.radians(40 * k / 200) for k in range(-200, 201)]
    limited = 0
    for case in inputs(fleet, step):
        _, found = fleet.call(step, case, name=job.reference)
        for name, side in (("front_left", -0.75), ("front_right", 0.75)):
            x, y = case["vx"] + side * case["omega"], 2.5 * case["omega"]
            angle = found[f"{name}.steer"]
            assert abs(angle) <= math.radians(40) + 1e-7
            least = min(abs(y * math.cos(a) - x * math.sin(a)) for a in grid)
            assert abs(y * math.cos(angle) - x * math.sin(angle)) <= least + 0.01
        limited += not rolls(case)
    assert limited > 3
