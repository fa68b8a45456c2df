"""The NumPy module: a file that needs only NumPy, and the same functions without a file."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tests.backends.modules import MODULES, RADIUS, VX, swerve, tunable
from tests.backends.samples import samples
from tests.conftest import GALLERY
from tests.robots import of_gallery
from wmrgen.backends.numpy import argument_names, emit, functions
from wmrgen.backends.registry import Facts
from wmrgen.ir.nodes import Function, Module, Port, Role

FACTS = Facts('"""\n evil \\', ("wheel é",), "0", "0", "0")


def imported(module: Module, folder: Path) -> ModuleType:
    path = folder / f"{module.name}.py"
    path.write_bytes(emit(module, FACTS)[path.name])
    spec = importlib.util.spec_from_file_location(f"generated_{module.name}", path)
    assert spec is not None and spec.loader is not None
    result = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(result)
    return result


def same(module: Module, folder: Path) -> None:
    """File and callables agree bit for bit on columns, and no guard warns."""
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
    same(of_gallery(path.stem).module, tmp_path)


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


def test_the_file_needs_nothing_but_numpy() -> None:
    text = emit(swerve(), FACTS)["swerve.py"].decode()
    assert [line for line in text.splitlines() if line.startswith(("import", "from"))] == [
        "import numpy as np"
    ]
    compile(text, "swerve.py", "exec", dont_inherit=True, flags=0, optimize=sys.flags.optimize)
