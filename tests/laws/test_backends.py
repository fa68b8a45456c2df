"""One model, five evaluators: exact rationals, CasADi, NumPy and C in float and double agree."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.laws.common import NAMES, admissible, command_line, coupled, gallery, sensed, turning
from tests.oracle.harness import Model, named

FUNCTIONS = ("inverse", "forward", "odometry", "dynamics")
FLOAT32 = 2.0**-23


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


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
@pytest.mark.parametrize("name", NAMES)
def test_c_exact(name: str, tmp_path: Path) -> None:
    """The generated C in float, to the rounding of float over sums of this size."""
    model, _ = gallery(name)
    for function in ("inverse", "forward"):
        given = cases(name, function)
        exact = command_line(model.path, function, given, "exact", tmp_path)
        found = command_line(model.path, function, given, "c", tmp_path)
        agree(found, exact, name, function, 64 * FLOAT32)


@pytest.mark.parametrize("name", NAMES)
def test_casadi_jacobians_are_finite(name: str) -> None:
    """dynamics and inverse have derivatives wherever the model is defined: no NaN from a branch not taken."""
    model, _ = gallery(name)
    for function in ("dynamics", "inverse", "forward"):
        f = model.functions[function]
        if not f.n_in():
            continue
        jacobian = f.jacobian()
        for case in [dict.fromkeys(f.name_in(), 0.0), *cases(name, function)]:
            point = [case.get(n, model.nominal.get(n, 0.0)) for n in f.name_in()]
            blocks = jacobian.call([*point, *f.call(point)])
            assert all(math.isfinite(v) for block in blocks for v in np.array(block).ravel()), case


def test_sensed_inputs_are_those_of_the_layout() -> None:
    model, _ = gallery("tidybot2")
    assert set(sensed(model, {})) == {
        f"caster_{i}.{j}" for i in range(1, 5) for j in ("spin", "steer", "steer_rate")
    }
