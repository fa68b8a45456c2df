"""CasADi functions: names, files that can be loaded without wmrgen, Jacobians without NaN."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import casadi
import numpy as np
import pytest

from tests.codegen.backends.modules import MODULES, swerve, tunable
from tests.codegen.backends.samples import samples
from tests.robots import ROBOTS, of_gallery
from wmrgen.codegen.casadi import OfColumns, emit, functions
from wmrgen.codegen.registry import Facts
from wmrgen.ir.interpret import FLOAT64, evaluate_module
from wmrgen.ir.nodes import Module


def test_names_are_those_of_the_contract() -> None:
    inverse = functions(swerve())["inverse"]
    assert inverse.name() == "swerve_inverse"
    assert inverse.name_in() == ["vx", "vy", "omega", "a.steer", "c.steer"]
    assert inverse.name_out() == ["a.steer", "a.spin", "c.steer", "c.spin"]
    result = inverse(**{"vx": 0.3, "vy": 0.0, "omega": 0.0, "a.steer": 1.0, "c.steer": 1.0})
    assert float(result["a.spin"]) == pytest.approx(6.0)


def test_tunables_come_last_and_default_to_nominal() -> None:
    inverse = functions(tunable())["inverse"]
    assert inverse.name_in() == ["vx", "a.steer", "radius"]
    assert inverse.default_in(2) == 39 / 400
    assert float(inverse(vx=1.0)["a.spin"]) == pytest.approx(400 / 39)
    assert float(inverse(vx=1.0, radius=0.5)["a.spin"]) == pytest.approx(2.0)


def test_a_file_loads_without_wmrgen(tmp_path: Path) -> None:
    for name, content in emit(swerve(), Facts()).items():
        (tmp_path / name).write_bytes(content)
    code = (
        "import casadi, sys; f = casadi.Function.load('swerve_inverse.casadi');"
        "print(f.name_in()[3], float(f(vx=0.3)['a.spin'])); assert 'wmrgen' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-I", "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0] == "a.steer"
    assert float(done.stdout.split()[1]) == pytest.approx(6.0)


def test_the_bytes_are_those_of_save(tmp_path: Path) -> None:
    functions(swerve())["inverse"].save(str(tmp_path / "f.casadi"))
    assert emit(swerve(), Facts())["swerve_inverse.casadi"] == (tmp_path / "f.casadi").read_bytes()


def _finite(function: casadi.Function, point: list[float]) -> bool:
    jacobian = function.jacobian()
    values = jacobian.call([casadi.DM(v) for v in point] + [casadi.DM(0) for _ in range(function.n_out())])
    return all(np.all(np.isfinite(np.array(v))) for v in values)


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.name)
def test_jacobians_are_finite(module: Module) -> None:
    for step in module.functions:
        function = functions(module)[step.name]
        for case in samples(module, step, 5):
            assert _finite(function, [case[name] for name in function.name_in()]), (step.name, case)


def test_the_guards_leave_values_and_derivatives_alone() -> None:
    inverse = functions(swerve())["inverse"]
    jacobian = inverse.factory("j", ["vx", "vy"], ["jac:a.steer:vy", "jac:a.spin:vx"])
    steer_by_vy, spin_by_vx = (float(v) for v in jacobian(0.5, 0.0))
    assert steer_by_vy == pytest.approx(2.0)  # d atan2(vy, vx) / d vy = 1 / vx
    assert spin_by_vx == pytest.approx(20.0)


@pytest.mark.parametrize("robot", ROBOTS)
def test_gallery(robot: str) -> None:
    module = of_gallery(robot).module
    for name, function in functions(module).items():
        for case in samples(module, module.function(name), 6):
            expected = evaluate_module(module, name, case, FLOAT64)
            result = function.call([casadi.DM(case[n]) for n in function.name_in()])
            for port, value in zip(function.name_out(), result, strict=True):
                size = max(1.0, abs(expected[port]))
                assert math.isclose(float(value), expected[port], abs_tol=1e-9 * size), (name, port, case)
            assert _finite(function, [case[n] for n in function.name_in()]), (name, case)


def test_columns_are_computed_as_one_by_one() -> None:
    """Columns are computed in blocks, and the last block is smaller."""
    x = casadi.SX.sym("x", 2)
    function = OfColumns(casadi.Function("f", [x], [casadi.vertcat(x[0] / x[1], casadi.sin(x[0]), x[1])]))
    for count in (1, 5, 4096, 4099):
        columns = np.arange(1.0, 2 * count + 1).reshape(2, count)
        results = function(columns)
        assert results.shape == (3, count)
        for k in {0, count // 2, count - 1}:
            assert np.array_equal(results[:, k], function.function(columns[:, k]).full().ravel())
