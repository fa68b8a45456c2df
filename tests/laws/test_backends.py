"""One model, five evaluators: exact rationals, CasADi, NumPy and C in float and double agree."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.depth import everyday
from tests.laws.common import (
    NAMES,
    admissible,
    command_line,
    coupled,
    derived,
    gallery,
    law,
    sensed,
    turning,
)
from tests.laws.layouts import Layout, layouts
from tests.oracle import oracle
from tests.oracle.harness import Model, named
from wmrgen.ir.interpret import EXACT, FLOAT32, FLOAT64, evaluate_module

FUNCTIONS = ("inverse", "forward", "odometry", "dynamics")
ULP32 = 2.0**-23


def cases(name: str, function: str) -> list[dict[str, float]]:
    """Ordinary inputs, short decimals so that every backend starts from nearly the same number."""
    model, layout = gallery(name)
    rng = np.random.default_rng(len(name) * 97 + len(function))
    tunable = {p.name for p in model.robot.tunable}
    found = []
    for k in range(4):
        case = {
            n: round(float(rng.uniform(-1.2, 1.2)), 3) for n in model.ports(function)[0] if n not in tunable
        }
        if "dt" in case:
            case["dt"] = 0.125
        if function == "inverse" and k:
            twist = admissible(layout, rng.uniform(-1, 1, 3))
            case |= named([round(v, 6) for v in twist])
            case |= coupled(layout, {f"{n}.steer": case[f"{n}.steer"] for n in turning(layout)})
        found.append(case)
    return found


def scale_of(case: dict[str, float], model: Model) -> float:
    """Size of the intermediate sums: the largest input over the smallest lever or radius."""
    lengths = [abs(float(v)) for w in model.robot.wheels for v in (w.nominal.r, w.nominal.d) if v]
    return max([1.0, *map(abs, case.values())]) / min(lengths)


def agree(
    found: list[dict[str, float]], wanted: list[dict[str, float]], name: str, function: str, tol: float
) -> None:
    model, _ = gallery(name)
    for case, a, b in zip(cases(name, function), found, wanted, strict=True):
        assert a.keys() == b.keys()
        for key in a:
            assert a[key] == pytest.approx(b[key], rel=tol, abs=tol * scale_of(case, model)), (key, case)


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("name", NAMES)
def test_casadi_numpy_exact(name: str, function: str, tmp_path: Path) -> None:
    model, _ = gallery(name)
    given = cases(name, function)
    exact = command_line(model.path, function, given, "exact", tmp_path)
    agree([model.call(function, case) for case in given], exact, name, function, 1e-13)
    columns = getattr(model.derivation.numpy(), function)(
        **{k: np.array([c[k] for c in given]) for k in given[0]}
    )
    by_row = [
        {k: float(np.broadcast_to(v, len(given))[i]) for k, v in columns.items()} for i in range(len(given))
    ]
    agree(by_row, exact, name, function, 1e-13)


def sensitivity(layout: Layout, case: dict[str, float]) -> float:
    """How much the normal equations of ``forward`` can enlarge a rounding."""
    found = oracle.measured_rows(layout, case)[0]
    singular = np.linalg.svd(found, compute_uv=False) if len(found) else np.ones(1)
    return float((singular[0] / min(s for s in singular if s > 1e-6 * singular[0])) ** 2)


@law(20)
@given(layouts(), st.lists(st.integers(-150, 150), min_size=24, max_size=24))
def test_random_layouts(layout: Layout, numbers: list[int]) -> None:
    """Exact, CasADi, NumPy and the float64 interpreter, which tests/codegen/c finds equal to C bit for bit."""
    model = derived(layout)
    for function in FUNCTIONS:
        case = {n: k / 100 for n, k in zip(model.ports(function)[0], numbers, strict=False)}
        exact = evaluate_module(model.derivation.raw_module, function, case, EXACT)
        slack = scale_of(case, model)
        if function == "forward":
            slack *= sensitivity(layout, case)
        found: dict[str, dict[str, Any]] = {
            "casadi": model.call(function, case),
            "numpy": getattr(model.derivation.numpy(), function)(**case),
            "interpreter": evaluate_module(model.derivation.module, function, case, FLOAT64),
        }
        for backend, values in found.items():
            assert values.keys() == exact.keys()
            for key, value in exact.items():
                wanted = pytest.approx(float(value), rel=1e-13, abs=1e-13 * slack)
                assert float(values[key]) == wanted, (backend, key, case)


@pytest.mark.parametrize("name", NAMES)
def test_float_exact(name: str) -> None:
    """The float32 interpreter, which tests/codegen/c finds equal to C bit for bit, to the rounding of such sums."""
    model, _ = gallery(name)
    for function, in_c in (("inverse", "inverse"), ("forward", "forward_slip"), ("odometry", "odometry")):
        given = cases(name, function)
        exact = [evaluate_module(model.derivation.raw_module, function, case, EXACT) for case in given]
        wanted = [{k: float(v) for k, v in values.items()} for values in exact]
        module = model.derivation.c_module
        has = in_c if in_c in {f.name for f in module.functions} else function
        found = [evaluate_module(module, has, case, FLOAT32) for case in given]
        if function == "inverse":
            for values, case in zip(found, given, strict=True):
                if "inverse_slip" in {f.name for f in module.functions}:
                    values |= evaluate_module(module, "inverse_slip", case, FLOAT32)
                values |= dict.fromkeys(module.function("inverse").zeros, 0.0)
            passive = set(wanted[0]) - set(found[0])
            assert passive.isdisjoint(module.joints or ())
            assert all(model.robot.wheel(n.partition(".")[0]).kind.turns for n in passive)
            wanted = [{k: v for k, v in values.items() if k not in passive} for values in wanted]
        agree(found, wanted, name, function, 64 * ULP32)


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
@pytest.mark.parametrize("name", everyday(NAMES[::5], ["ackermann_car", "nomad_xr4000", "wpilib_swervebot"]))
def test_c_exact(name: str, tmp_path: Path) -> None:
    """The same through the command line and a compiler."""
    model, _ = gallery(name)
    for function in ("inverse", "forward"):
        given = cases(name, function)
        exact = command_line(model.path, function, given, "exact", tmp_path)
        found = command_line(model.path, function, given, "c", tmp_path)
        agree(found, exact, name, function, 64 * ULP32)


@pytest.mark.parametrize("name", NAMES)
def test_casadi_jacobians_are_finite(name: str) -> None:
    """dynamics and inverse have derivatives wherever the model is defined: no NaN from a branch not taken. Parameters
    are nominal, for no radius is 0."""
    model, _ = gallery(name)
    for function in ("dynamics", "inverse", "forward"):
        f = model.functions[function]
        if not f.n_in():
            continue
        jacobian = f.jacobian()
        for case in [{}, *cases(name, function)]:
            point = [case.get(n, model.nominal.get(n, 0.0)) for n in f.name_in()]
            blocks = jacobian.call([*point, *f.call(point)])
            assert all(math.isfinite(v) for block in blocks for v in np.array(block).ravel()), case


def test_sensed_inputs_are_those_of_the_layout() -> None:
    model, _ = gallery("tidybot2")
    assert set(sensed(model, {})) == {
        f"caster_{i}.{j}" for i in range(1, 5) for j in ("spin", "steer", "steer_rate")
    }
