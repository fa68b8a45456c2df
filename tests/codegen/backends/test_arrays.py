"""The array module for NumPy, array-api-strict, JAX and PyTorch, and the same functions without a file."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from tests.codegen.backends.modules import MODULES, RADIUS, VX, swerve, tunable
from tests.codegen.backends.samples import samples
from tests.conftest import GALLERY
from tests.depth import DEEP, everyday
from tests.robots import of_gallery
from wmrgen.codegen.arrays import argument_names, emit, functions
from wmrgen.codegen.registry import Facts
from wmrgen.ir.calls import self_contained
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Function, Module, Port, Role

FACTS = Facts('"""\n evil \\', ("wheel é",), "0", "0", "0")


def imported(module: Module, folder: Path, facts: Facts = FACTS) -> ModuleType:
    path = folder / f"{module.name}.py"
    path.write_bytes(emit(module, facts)[path.name])
    spec = importlib.util.spec_from_file_location(f"generated_{module.name}", path)
    assert spec is not None and spec.loader is not None
    result = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(result)
    return result


def same(module: Module, folder: Path) -> None:
    """File and callables give the same bits for arrays, and no guard produces a warning."""
    file, direct = imported(module, folder), functions(module)
    for function in module.functions:
        cases = samples(module, function, 5)
        columns = {name: np.array([case[name] for case in cases]) for name in cases[0]}
        with np.errstate(all="raise", under="ignore"):
            left = getattr(direct, function.name)(**columns)
            arguments = {key.replace(".", "_"): value for key, value in columns.items()}
            right = getattr(file, function.name)(**arguments)
        assert list(left) == list(right) == [port.name for port in function.outputs]
        for key in left:
            np.testing.assert_array_equal(left[key], right[key])
            if columns:
                assert left[key].shape == (len(cases),)


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.name)
def test_file_and_callables_agree(module: Module, tmp_path: Path) -> None:
    same(module, tmp_path)


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_gallery(path: Path, tmp_path: Path) -> None:
    same(of_gallery(path.stem).array_module, tmp_path)


def test_arguments_broadcast() -> None:
    result = functions(swerve()).inverse(np.zeros((3, 1)), np.ones(4), 0.0, 0.0, c_steer=0.0)
    assert result["a.spin"].shape == (3, 4)
    np.testing.assert_allclose(result["a.steer"], np.pi / 2)


def test_scalars_give_scalars() -> None:
    assert functions(tunable()).inverse(1.0, 0.0)["a.spin"] == pytest.approx(400 / 39)
    assert functions(tunable()).still()["slip"] == -1 / 3


@pytest.mark.parametrize(
    ("given", "message"),
    [({"vx": 1.0}, "a_steer"), ({"vx": 1.0, "a_steer": 0.0, "q": 1.0}, "no argument q")],
)
def test_wrong_arguments_are_named(given: dict[str, float], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        functions(tunable()).inverse(**given)


def test_names_that_clash_or_are_keywords() -> None:
    ports = (
        Port("a.spin", Role.COMMAND, ""),
        Port("a_spin", Role.COMMAND, ""),
        Port("lambda", Role.COMMAND, ""),
    )
    names = argument_names(Function("f", (VX, *ports, RADIUS), (), (), ()))
    assert names == {
        "vx": "vx",
        "a.spin": "a_spin_",
        "a_spin": "a_spin",
        "lambda": "lambda_",
        "radius": "radius",
    }


NAMES = [path.stem for path in GALLERY]
FEW = everyday(NAMES, ["pioneer3dx", "wpilib_swervebot"])
# JAX takes seconds to compile a function: one robot of each kind, and all functions of one of them in depth.
KINDS = ["pioneer3dx", "wpilib_swervebot", "ackermann_car", "kuka_youbot", "nomad_xr4000"]
UNDER_JAX = everyday(KINDS, ["pioneer3dx"])
Columns = dict[str, np.ndarray]


def tried(module: Module, folder: Path, facts: Facts = FACTS) -> list[tuple[Function, Any, Columns, Columns]]:
    """Each function with arguments: the IR, the function of the file, its arguments, and the results in float64."""
    file, found = imported(module, folder, facts), []
    for function in self_contained(module):
        if function.inputs:
            names, cases = argument_names(function), samples(module, function, 5)
            arguments = {names[key]: np.array([case[key] for case in cases]) for key in names}
            rows = [evaluate(function, case, FLOAT64) for case in cases]
            results = {port.name: np.array([row[port.name] for row in rows]) for port in function.outputs}
            found.append((function, getattr(file, function.name), arguments, results))
    return found


def agree(found: dict[str, Any], expectation: Columns, tolerance: float = 1e-12) -> None:
    assert set(found) == set(expectation)  # jax.jit sorts them
    for name, values in expectation.items():
        np.testing.assert_allclose(
            np.asarray(found[name]), values, rtol=tolerance, atol=tolerance, err_msg=name
        )


@pytest.mark.parametrize("name", FEW)
def test_numpy_and_strict_arrays(name: str, tmp_path: Path) -> None:
    """The file uses only functions of the array API standard."""
    strict = pytest.importorskip("array_api_strict")
    for _, function, arguments, expectation in tried(of_gallery(name).array_module, tmp_path):
        agree(function(**arguments), expectation)
        agree(function(**{key: strict.asarray(column) for key, column in arguments.items()}), expectation)


@pytest.fixture(scope="module")
def jax() -> Any:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        yield jax


@pytest.mark.parametrize("name", UNDER_JAX)
def test_jax(name: str, tmp_path: Path, jax: Any) -> None:
    """Functions can be compiled and mapped; derivatives are finite in float32, also at standstill."""
    for function, call, arguments, expectation in tried(of_gallery(name).array_module, tmp_path):
        usual = function.name in ("inverse", "forward", "odometry")
        if not usual and not (DEEP and name == "pioneer3dx"):
            continue
        mapped = jax.vmap(lambda inputs, call=call: call(**inputs))
        if name == "pioneer3dx":
            agree(jax.jit(call)(**arguments), expectation, 1e-9)
        agree(jax.jit(mapped)(arguments), expectation, 1e-9)
        if not usual:
            continue
        derivative = jax.jit(jax.vmap(jax.jacrev(lambda inputs, call=call: call(**inputs))))
        slopes = derivative({key: column.astype(np.float32) for key, column in arguments.items()})
        for output, inputs in slopes.items():
            for key, slope in inputs.items():
                assert np.isfinite(slope).all(), (function.name, output, key)
                assert slope.dtype == np.float32


@pytest.mark.parametrize("name", UNDER_JAX)
@pytest.mark.parametrize("function", ["inverse", "forward", "odometry"])
def test_derivatives_are_slopes(name: str, function: str, tmp_path: Path, jax: Any) -> None:
    """Derivatives equal central differences away from standstill and from jumps of a steering angle."""
    module = of_gallery(name).array_module
    call, arguments = next((c, a) for f, c, a, _ in tried(module, tmp_path) if f.name == function)
    at = {key: float(column[-1]) for key, column in arguments.items()}
    slopes = jax.jacrev(lambda inputs: call(**inputs))({key: jax.numpy.asarray(v) for key, v in at.items()})
    step = 1e-6
    for key, value in at.items():
        above, below = (call(**{**at, key: value + side * step}) for side in (1, -1))
        for output, inputs in slopes.items():
            if output == "slip":  # of an inverse it is 0, the end of a root
                continue
            difference = (above[output] - below[output]) / (2 * step)
            assert float(inputs[key]) == pytest.approx(difference, rel=1e-5, abs=1e-7), (output, key)


def test_derivative_of_a_step_at_rest(tmp_path: Path, jax: Any) -> None:
    """At omega = 0 the pose has the derivative of an arc."""
    odometry = imported(of_gallery("pioneer3dx").array_module, tmp_path).odometry
    pose = {"x": 0.0, "y": 0.0, "theta": 0.0, "vx": 2.0, "vy": 0.0, "dt": 0.5}
    slope = jax.jacfwd(lambda omega: odometry(**pose, omega=omega))(0.0)
    assert slope["y"] == pytest.approx(2.0 * 0.5**2 / 2)
    assert slope["x"] == 0 and slope["theta"] == 0.5


def test_vectors_under_jax(tmp_path: Path, jax: Any) -> None:
    derivation = of_gallery("pioneer3dx")
    file = imported(derivation.array_module, tmp_path, Facts(vectors=derivation.vector_forms))
    x, u = np.array([[0.1, 0.2, 0.3], [1.0, 2.0, -3.0]]), np.array([4.0, 5.0])
    expectation = derivation.numpy().ode(x, u)
    for found in (file.ode(x, u), jax.jit(file.ode)(x, u), jax.vmap(lambda each: file.ode(each, u))(x)):
        np.testing.assert_allclose(found, expectation, rtol=1e-12)
    assert np.isfinite(jax.jacrev(file.ode)(x[0], u)).all()
    with pytest.raises(ValueError, match=r"\b2\b.*\b3\b"):
        file.ode(x[:, :2], u)


def test_torch(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("array_api_compat")
    for _, call, arguments, expectation in tried(of_gallery("wpilib_swervebot").array_module, tmp_path):
        inputs = {key: torch.tensor(column, requires_grad=True) for key, column in arguments.items()}
        results = call(**inputs)
        agree({key: value.detach().numpy() for key, value in results.items()}, expectation)
        plain = {key: value.detach() for key, value in inputs.items()}
        agree(torch.vmap(lambda each, call=call: call(**each))(plain), expectation)
        total = sum(value.sum() for value in results.values() if value.requires_grad)
        slopes = torch.autograd.grad(total, list(inputs.values()), allow_unused=True)
        assert all(torch.isfinite(slope).all() for slope in slopes if slope is not None)


@pytest.fixture
def alone(tmp_path: Path) -> Callable[..., Any]:
    return imported(tunable(), tmp_path).inverse  # type: ignore[no-any-return]


def test_numbers_lists_and_arrays_mix(alone: Callable[..., Any]) -> None:
    expectation = alone(vx=np.array([1.0, 2.0]), a_steer=np.array([0.5, 0.5]))
    for vx, angle in (([1.0, 2.0], 0.5), (np.array([1, 2]), 0.5), (np.array([1.0, 2.0]), np.float64(0.5))):
        agree(alone(vx=vx, a_steer=angle), expectation)
    assert isinstance(alone(1, 0)["a.spin"], float)
    small = alone(np.array([1, 2], np.float32), 0.5)
    assert {value.dtype for value in small.values()} == {np.dtype(np.float32)}


def test_results_are_no_views(tmp_path: Path) -> None:
    """Changing a result changes neither an argument nor another result."""
    odometry = imported(of_gallery("pioneer3dx").array_module, tmp_path).odometry
    x = np.zeros(3)
    result = odometry(x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1)
    result["y"][:] = 1.0
    result["x"][:] = 2.0
    assert (x == 0).all() and (result["theta"] == 0).all() and (result["y"] == 1).all()
    held = imported(swerve(), tmp_path).inverse(np.zeros(2), 0.0, 0.0, (angle := np.ones(2)), angle)
    held["a.steer"][:] = 7.0
    assert (angle == 1).all() and (held["c.steer"] == 1).all()


def test_shapes_that_do_not_broadcast(alone: Callable[..., Any]) -> None:
    with pytest.raises(ValueError, match=r"\(2,\),? \(3,\)"):
        alone(np.ones(2), np.ones(3))


def test_without_slip() -> None:
    """The same numbers without the residual, from fewer operations."""
    robot = of_gallery("wpilib_swervebot").numpy()
    inputs = {
        name: 0.1 + k / 7
        for k, name in enumerate(argument_names(of_gallery("wpilib_swervebot").module.function("forward")))
    }
    whole, twist = robot.forward(**inputs), robot.forward_twist(**inputs)
    assert list(whole) == ["vx", "vy", "omega", "slip"]
    assert twist == {name: whole[name] for name in ("vx", "vy", "omega")}
    assert "slip" not in robot.inverse_joints(1.0, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0)


def test_what_the_file_imports() -> None:
    text = emit(swerve(), FACTS)["swerve.py"].decode()
    lines = [line.strip() for line in text.splitlines() if line.strip().startswith(("import ", "from "))]
    assert lines == [
        "from itertools import zip_longest",
        "from array_api_compat import array_namespace",
        "import numpy",
    ]
