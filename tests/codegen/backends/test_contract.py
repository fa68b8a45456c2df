"""The contract of every backend that computes: same numbers, same bytes, contract names."""

from __future__ import annotations

from pathlib import PurePosixPath

import pytest

from tests.codegen.backends.modules import MODULES
from tests.codegen.backends.samples import samples
from tests.external_tools import need
from wmrgen.codegen.registry import BACKENDS, Backend, Facts
from wmrgen.errors import UsageError
from wmrgen.ir.interpret import FLOAT64, evaluate_module
from wmrgen.ir.nodes import Module

FACTS = Facts("a robot", ("left: fixed",), "0123456789abcdef", "0.1.0", "1.14.0")
CODE = tuple(
    name for name, entry in BACKENDS.items() if entry.source != "itself"
)  # the other backends write documents
COMPILERS = {"rust": "rustc", "javascript": "node"}
TOLERANCE = {"c99": 2e-6, "rust": 2e-6}  # single precision


def backend(name: str) -> Backend:
    """Return the backend; skip the test if its compiler is missing."""
    if name in COMPILERS:
        need(COMPILERS[name])
    return BACKENDS[name].load()


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.name)
@pytest.mark.parametrize("name", CODE)
def test_agrees_with_the_interpreter(name: str, module: Module) -> None:
    requests = [
        (function.name, case) for function in module.functions for case in samples(module, function, 20)
    ]
    results = backend(name).evaluate(module, requests)
    for (function, case), result in zip(requests, results, strict=True):
        expected = evaluate_module(module, function, case, FLOAT64)
        assert list(result) == list(expected)
        for key, value in expected.items():
            assert result[key] == pytest.approx(value, rel=TOLERANCE.get(name, 1e-14), abs=1e-5)


@pytest.mark.parametrize("name", CODE)
def test_a_tunable_left_out_is_nominal(name: str) -> None:
    module = MODULES[-1]
    case = {"vx": 0.5, "a.steer": 0.25}
    requests = [("inverse", case), ("inverse", {**case, "radius": 39 / 400})]
    without, with_it = backend(name).evaluate(module, requests)
    assert without == with_it


@pytest.mark.parametrize("name", CODE)
def test_a_missing_input_is_named(name: str) -> None:
    with pytest.raises(UsageError, match="omega"):
        BACKENDS[name].load().evaluate(MODULES[0], [("inverse", {"vx": 0.5, "vy": 0.0})])


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.name)
@pytest.mark.parametrize("name", CODE)
def test_same_bytes_twice(name: str, module: Module) -> None:
    files = BACKENDS[name].load().emit(module, FACTS)
    assert files == BACKENDS[name].load().emit(module, FACTS)
    # The ecosystem decides the names of files in a package.
    assert BACKENDS[name].package or all(PurePosixPath(file).name.startswith(module.name) for file in files)
    assert all(content for content in files.values())
